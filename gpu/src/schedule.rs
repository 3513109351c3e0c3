//! The order in which stages run, for the sizes of a surface and the capacities of the columns.

use crate::params::{Capacities, Params, ROUND, SCAN_BLOCK, SIDE};
use crate::readback::DetectionQuery;
use crate::shaders::{self, Shader};
use crate::slots::SurfaceSizes;

/// One run of an entry point.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch {
    /// The shader.
    pub shader: &'static str,
    /// The entry point.
    pub entry: &'static str,
    /// Number of workgroups.
    pub groups: usize,
    /// Its parameters.
    pub params: Params,
}

/// Invocations per workgroup.
const GROUP: usize = 256;

/// Invocations per workgroup of the continuous tests, whose run times differ.
#[cfg(feature = "narrow-phase")]
const SMALL_GROUP: usize = 64;

/// Bits of a key that one pass of the sort looks at.
const DIGIT: usize = 4;

/// Input of the schedule of a detection.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// Parameters of all stages, except the capacities.
    pub params: Params,
    /// Sizes of the surface.
    pub sizes: SurfaceSizes,
    /// Capacities of the columns.
    pub capacities: Capacities,
    /// The results that are read back.
    pub query: DetectionQuery,
}

/// All dispatches of a detection, in order.
pub fn of(order: &Order) -> Vec<Dispatch> {
    let order = &Order { params: order.params.with_room(&order.capacities), ..*order };
    let mut list = List { order, all: Vec::new() };
    let SurfaceSizes { vertices, triangles, .. } = order.sizes;
    let Capacities { levels, rounds, pairs, .. } = order.capacities;
    list.each(&shaders::BOUNDS, "write_bounds", triangles);
    list.each(&shaders::LEVELS, "count_sizes", triangles);
    let division = Params { level: levels as u32, length: (ROUND * rounds) as u32, ..order.params };
    list.add(&shaders::LEVELS, "divide", 1, &division);
    list.each(&shaders::LEVELS, "assign", triangles);
    for level in 0..levels {
        list.level(level as u32, vertices, triangles);
    }
    list.each(&shaders::BRUTE_FORCE_LEVEL, "count_last", triangles);
    list.scan(triangles);
    list.each(&shaders::BRUTE_FORCE_LEVEL, "list_last", triangles);
    for round in 0..rounds {
        list.round(round as u32, triangles);
    }
    list.each(&shaders::FEATURES, "find_features", pairs);
    list.each(&shaders::CANDIDATES, "count_candidates", pairs);
    list.scan(2 * pairs);
    list.each(&shaders::CANDIDATES, "write_candidates", pairs);
    #[cfg(feature = "narrow-phase")]
    if order.query != DetectionQuery::Candidates {
        list.narrow_phase();
    }
    list.all
}

struct List<'a> {
    order: &'a Order,
    all: Vec<Dispatch>,
}

impl List<'_> {
    fn add(&mut self, shader: &'static Shader, entry: &'static str, groups: usize, params: &Params) {
        self.all.push(Dispatch { shader: shader.name, entry, groups, params: *params });
    }

    /// Adds an entry point with one invocation per element.
    fn each(&mut self, shader: &'static Shader, entry: &'static str, count: usize) {
        self.add(shader, entry, count.div_ceil(GROUP), &self.order.params);
    }

    #[cfg(feature = "narrow-phase")]
    fn narrow_phase(&mut self) {
        let Capacities { vertex_triangle, edge_edge, .. } = self.order.capacities;
        self.each(&shaders::VERTEX_TRIANGLE, "write_distances", vertex_triangle);
        self.each(&shaders::EDGE_EDGE, "write_distances", edge_edge);
        if self.order.query == DetectionQuery::Contacts {
            let both = vertex_triangle + edge_edge;
            self.each(&shaders::CONTACTS, "count_contacts", both);
            self.scan(both);
            self.each(&shaders::CONTACTS, "write_contacts", both);
        }
        if self.order.query == DetectionQuery::Times {
            for (shader, count) in
                [(&shaders::VERTEX_TRIANGLE_CCD, vertex_triangle), (&shaders::EDGE_EDGE_CCD, edge_edge)]
            {
                self.add(shader, "write_times", count.div_ceil(SMALL_GROUP), &self.order.params);
            }
        }
    }

    fn scan(&mut self, length: usize) {
        let params = Params { length: length as u32, ..self.order.params };
        let groups = length.div_ceil(SCAN_BLOCK);
        self.add(&shaders::SCAN, "sum_blocks", groups, &params);
        self.add(&shaders::SCAN, "scan_blocks", 1, &params);
        self.add(&shaders::SCAN, "spread", groups, &params);
    }

    /// Compares the triangles of the last level that belong to a round with all others.
    fn round(&mut self, round: u32, triangles: usize) {
        let (params, groups) = (Params { level: round, ..self.order.params }, triangles.div_ceil(GROUP));
        self.add(&shaders::BRUTE_FORCE_LEVEL, "count_brute_force", groups, &params);
        self.scan(triangles);
        self.add(&shaders::BRUTE_FORCE_LEVEL, "write_brute_force", groups, &params);
        self.add(&shaders::BRUTE_FORCE_LEVEL, "close_brute_force", 1, &params);
    }

    fn level(&mut self, level: u32, vertices: usize, triangles: usize) {
        let Capacities { entries, tiles, .. } = self.order.capacities;
        let params = Params { level, ..self.order.params };
        let mut each = |shader, entry, count: usize| self.add(shader, entry, count.div_ceil(GROUP), &params);
        each(&shaders::QUANTIZED_BOXES, "choose_scale", 1);
        each(&shaders::QUANTIZED_BOXES, "write_quantized_boxes", vertices);
        each(&shaders::SPHERES, "write_spheres", triangles);
        each(&shaders::CELLS, "choose_grid", 1);
        each(&shaders::CELLS, "write_cells", triangles);
        each(&shaders::ENTRIES, "count_entries", triangles);
        self.scan(4 * triangles);
        self.add(&shaders::ENTRIES, "write_entries", triangles.div_ceil(GROUP), &params);
        self.sort(triangles, entries);
        self.add(&shaders::BYTE_BOXES, "write_byte_boxes", triangles.div_ceil(GROUP), &params);
        self.add(&shaders::BYTE_BOXES, "gather", entries.div_ceil(GROUP), &params);
        self.add(&shaders::TILES, "count_tiles", entries.div_ceil(SIDE), &params);
        self.scan(entries.div_ceil(SIDE));
        self.add(&shaders::TILES, "write_tiles", entries.div_ceil(SIDE), &params);
        self.add(&shaders::PAIRS, "count_pairs", tiles, &params);
        self.scan(tiles);
        self.add(&shaders::PAIRS, "write_pairs", tiles, &params);
        self.add(&shaders::PAIRS, "close_pairs", 1, &params);
    }

    /// Adds an even number of passes, so that the sorted entries end in their own column and not in the spare one.
    fn sort(&mut self, triangles: usize, entries: usize) {
        let bits = (triangles.max(1).ilog2() as usize + 2).max(6);
        let blocks = entries.div_ceil(SCAN_BLOCK);
        for pass in 0..bits.div_ceil(2 * DIGIT) * 2 {
            let shader = [&shaders::SORT, &shaders::SORT_BACK][pass % 2];
            let params = Params { shift: (DIGIT * pass) as u32, ..self.order.params };
            self.add(shader, "count_digits", blocks, &params);
            self.scan(16 * blocks);
            self.add(shader, "scatter", blocks, &params);
        }
    }
}
