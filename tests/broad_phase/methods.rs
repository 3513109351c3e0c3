//! Every method in both precisions, as functions from a case to its candidates.

use harness::case::Case;

/// The candidates that a method wrote, and the numbers that it counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    pub vertex_triangle: Vec<[u32; 2]>,
    pub edge_edge: Vec<[u32; 2]>,
    /// Number of pairs of each kind.
    pub counts: [usize; 2],
}

impl Found {
    /// Sorts the pairs in ascending order.
    pub fn sorted(mut self) -> Self {
        self.vertex_triangle.sort_unstable();
        self.edge_edge.sort_unstable();
        self
    }
}

/// A method with a capacity for the candidates of each kind.
pub type Method = fn(&Case, [usize; 2]) -> Found;

pub const METHODS: [(&str, Method); 8] = [
    ("brute force in f32", single::brute_force),
    ("brute force in f64", double::brute_force),
    ("reference cell in f32", single::reference_cell),
    ("reference cell in f64", double::reference_cell),
    ("lean search in f32", single::lean),
    ("lean search in f64", double::lean),
    ("grid in f32", single::grid),
    ("grid in f64", double::grid),
];

/// All candidates of a method: a first call counts them, a second has the exact capacity.
pub fn all(method: Method, case: &Case) -> Found {
    let counts = method(case, [0, 0]).counts;
    method(case, counts)
}

harness::both_precisions! {
    use super::{Case, Found};
    use muslin::broad_phase::{self, Candidates, Counts, GridColumns, Surface, brute_force, lean, reference_cell};
    use muslin::dispatch::Serial;
    use muslin::geometry::aabb::Aabb;
    use muslin::mesh::SurfaceColumns;
    use kit::narrow;
    use harness::threads::Uneven;

    /// The columns of a case.
    pub fn columns(case: &Case) -> (Vec<Aabb>, SurfaceColumns) {
        let to_box = |corners: &[glam::DVec3; 2]| {
            let [min, max] = narrow(corners);
            Aabb { min, max }
        };
        let mut surface = SurfaceColumns::build(case.boxes.len(), &case.triangles, &case.sewn);
        surface.first_passive = case.first_passive.unwrap_or(surface.first_passive);
        surface.own_contact = !case.without_own_contact;
        (case.boxes.iter().map(to_box).collect(), surface)
    }

    fn found(
        case: &Case,
        room: [usize; 2],
        method: impl Fn(&[Aabb], &Surface<'_>, &mut Candidates<'_>) -> Counts,
    ) -> Found {
        let (boxes, surface) = columns(case);
        let [mut vertex_triangle, mut edge_edge] = room.map(|room| vec![[u32::MAX; 2]; room]);
        let mut out = Candidates { vertex_triangle: &mut vertex_triangle, edge_edge: &mut edge_edge };
        let counts = method(&boxes, &surface.view(), &mut out);
        Found { vertex_triangle, edge_edge, counts: [counts.vertex_triangle, counts.edge_edge] }
    }

    pub fn brute_force(case: &Case, room: [usize; 2]) -> Found {
        found(case, room, brute_force::candidates)
    }

    pub fn reference_cell(case: &Case, room: [usize; 2]) -> Found {
        found(case, room, reference_cell::candidates)
    }

    pub fn grid(case: &Case, room: [usize; 2]) -> Found {
        found(case, room, |boxes, surface, out| {
            let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
            broad_phase::candidates(boxes, surface, &mut work.view(), None, out, &Serial).expect("nothing stops the search")
        })
    }

    pub fn lean(case: &Case, room: [usize; 2]) -> Found {
        found(case, room, |boxes, surface, out| {
            lean::candidates(boxes, surface, out, &Serial).expect("nothing stops the search")
        })
    }

    /// The grid with kernels divided unevenly among threads.
    pub fn on_threads(case: &Case, threads: usize) -> Found {
        let counts = grid(case, [0, 0]).counts;
        found(case, counts, |boxes, surface, out| {
            let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
            broad_phase::candidates(boxes, surface, &mut work.view(), None, out, &Uneven::new(threads)).expect("nothing stops the search")
        })
    }

    /// Counts for cases with the same triangles, all computed in the same columns.
    pub fn in_turn<const K: usize>(cases: &[&Case; K]) -> [[usize; 2]; K] {
        let (boxes, surface) = columns(cases[0]);
        let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
        cases.map(|case| {
            let (boxes, _) = columns(case);
            let out = &mut Candidates::default();
            let counts = broad_phase::candidates(&boxes, &surface.view(), &mut work.view(), None, out, &Serial).expect("nothing stops the search");
            [counts.vertex_triangle, counts.edge_edge]
        })
    }
}
