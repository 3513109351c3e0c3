//! The order in which stages run, for a surface of some size and for some capacities.

use crate::answer::Wanted;
use crate::params::{Capacities, Params, ROUND, SCAN_BLOCK, SIDE};
use crate::slots::Sizes;
use crate::stages::{self, Stage};

/// A stage's entry, run once.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch {
    /// The stage.
    pub stage: &'static str,
    /// The entry point.
    pub entry: &'static str,
    /// Groups of invocations.
    pub groups: usize,
    /// What it is told.
    pub params: Params,
}

/// Invocations of a group.
const GROUP: usize = 256;

/// Those of a continuous test, which differ in length.
const SMALL_GROUP: usize = 64;

/// Bits of a key that a pass of the sort sorts by.
const DIGIT: usize = 4;

/// How to run a detection.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// What all stages are told, but for the room.
    pub params: Params,
    /// Of the surface.
    pub sizes: Sizes,
    /// Room.
    pub capacities: Capacities,
    /// What is to be found.
    pub wanted: Wanted,
}

/// All dispatches of a detection.
pub fn of(order: &Order) -> Vec<Dispatch> {
    let order = &Order { params: order.params.with_room(&order.capacities), ..*order };
    let mut list = List { order, all: Vec::new() };
    let Sizes { vertices, triangles, .. } = order.sizes;
    let Capacities { levels, rounds, pairs, vertex_triangle, edge_edge, .. } = order.capacities;
    list.each(&stages::BOUNDS, "write_bounds", triangles);
    list.each(&stages::LEVELS, "count_sizes", triangles);
    let division = Params { level: levels as u32, length: (ROUND * rounds) as u32, ..order.params };
    list.add(&stages::LEVELS, "divide", 1, division);
    list.each(&stages::LEVELS, "assign", triangles);
    for level in 0..levels {
        list.level(level as u32, vertices, triangles);
    }
    list.each(&stages::PLAIN, "count_last", triangles);
    list.scan(triangles);
    list.each(&stages::PLAIN, "list_last", triangles);
    for round in 0..rounds {
        list.round(round as u32, triangles);
    }
    list.each(&stages::FEATURES, "find_features", pairs);
    list.each(&stages::CANDIDATES, "count_candidates", pairs);
    list.scan(2 * pairs);
    list.each(&stages::CANDIDATES, "write_candidates", pairs);
    list.each(&stages::VERTEX_TRIANGLE, "write_distances", vertex_triangle);
    list.each(&stages::EDGE_EDGE, "write_distances", edge_edge);
    if order.wanted == Wanted::Contacts {
        let both = vertex_triangle + edge_edge;
        list.each(&stages::CONTACTS, "count_contacts", both);
        list.scan(both);
        list.each(&stages::CONTACTS, "write_contacts", both);
    }
    if order.wanted == Wanted::Times {
        for (stage, count) in [(&stages::VERTEX_TRIANGLE_CCD, vertex_triangle), (&stages::EDGE_EDGE_CCD, edge_edge)] {
            list.add(stage, "write_times", count.div_ceil(SMALL_GROUP), order.params);
        }
    }
    list.all
}

struct List<'a> {
    order: &'a Order,
    all: Vec<Dispatch>,
}

impl List<'_> {
    fn add(&mut self, stage: &'static Stage, entry: &'static str, groups: usize, params: Params) {
        self.all.push(Dispatch { stage: stage.name, entry, groups, params });
    }

    /// An invocation a thing.
    fn each(&mut self, stage: &'static Stage, entry: &'static str, count: usize) {
        self.add(stage, entry, count.div_ceil(GROUP), self.order.params);
    }

    fn scan(&mut self, length: usize) {
        let params = Params { length: length as u32, ..self.order.params };
        let groups = length.div_ceil(SCAN_BLOCK);
        self.add(&stages::SCAN, "sum_blocks", groups, params);
        self.add(&stages::SCAN, "scan_blocks", 1, params);
        self.add(&stages::SCAN, "spread", groups, params);
    }

    /// Some triangles of the last level with all others.
    fn round(&mut self, round: u32, triangles: usize) {
        let (params, groups) = (Params { level: round, ..self.order.params }, triangles.div_ceil(GROUP));
        self.add(&stages::PLAIN, "count_plain", groups, params);
        self.scan(triangles);
        self.add(&stages::PLAIN, "write_plain", groups, params);
        self.add(&stages::PLAIN, "close_plain", 1, params);
    }

    fn level(&mut self, level: u32, vertices: usize, triangles: usize) {
        let Capacities { entries, tiles, .. } = self.order.capacities;
        let params = Params { level, ..self.order.params };
        let mut each = |stage, entry, count: usize| self.add(stage, entry, count.div_ceil(GROUP), params);
        each(&stages::UNITS, "choose_scale", 1);
        each(&stages::UNITS, "write_units", vertices);
        each(&stages::SPHERES, "write_spheres", triangles);
        each(&stages::CELLS, "choose_lattice", 1);
        each(&stages::CELLS, "write_cells", triangles);
        each(&stages::ENTRIES, "count_entries", triangles);
        self.scan(4 * triangles);
        self.add(&stages::ENTRIES, "write_entries", triangles.div_ceil(GROUP), params);
        self.sort(triangles, entries);
        self.add(&stages::BYTE_BOXES, "write_byte_boxes", triangles.div_ceil(GROUP), params);
        self.add(&stages::BYTE_BOXES, "gather", entries.div_ceil(GROUP), params);
        self.add(&stages::TILES, "count_tiles", entries.div_ceil(SIDE), params);
        self.scan(entries.div_ceil(SIDE));
        self.add(&stages::TILES, "write_tiles", entries.div_ceil(SIDE), params);
        self.add(&stages::PAIRS, "count_pairs", tiles, params);
        self.scan(tiles);
        self.add(&stages::PAIRS, "write_pairs", tiles, params);
        self.add(&stages::PAIRS, "close_pairs", 1, params);
    }

    /// Passes there and back.
    fn sort(&mut self, triangles: usize, entries: usize) {
        let bits = (triangles.max(1).ilog2() as usize + 2).max(6);
        let blocks = entries.div_ceil(SCAN_BLOCK);
        for pass in 0..bits.div_ceil(2 * DIGIT) * 2 {
            let stage = [&stages::SORT, &stages::SORT_BACK][pass % 2];
            let params = Params { shift: (DIGIT * pass) as u32, ..self.order.params };
            self.add(stage, "count_digits", blocks, params);
            self.scan(16 * blocks);
            self.add(stage, "scatter", blocks, params);
        }
    }
}
