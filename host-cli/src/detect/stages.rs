//! The stages of detection on the CPU, each for both kinds of pairs: candidates, distances, impact times.

use std::time::{Duration, Instant};

use muslin_core::broad_phase::{self, Candidates, Counts, GridColumns, Surface, brute_force, reference_cell};
use muslin_core::geometry::aabb::Aabb;
use muslin_core::narrow_phase::continuous::{self, LinearMotion};
use muslin_core::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
use muslin_core::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity};
use muslin_core::real::Vec3;

use super::mesh::Subject;
use crate::args::Method;
use crate::pool::Pool;

/// The candidates of both kinds.
#[derive(Default)]
pub struct CandidateLists {
    /// `[vertex, triangle]`.
    pub vertex_triangle: Vec<[u32; 2]>,
    /// `[edge, edge]`.
    pub edge_edge: Vec<[u32; 2]>,
}

impl CandidateLists {
    /// Finds all candidates: counts them, allocates memory, and repeats. Returns the duration of the last pass.
    pub fn find(&mut self, method: Method, boxes: &[Aabb], surface: &Surface<'_>, pool: &Pool) -> Duration {
        let cells = if method == Method::Grid { [boxes.len(), surface.triangles.len()] } else { [0; 2] };
        let mut work = GridColumns::build(cells[0], cells[1]);
        loop {
            let mut out = Candidates { vertex_triangle: &mut self.vertex_triangle, edge_edge: &mut self.edge_edge };
            let started = Instant::now();
            let counts = match method {
                Method::Grid => broad_phase::candidates(boxes, surface, &mut work.view(), None, &mut out, pool),
                Method::Reference => Some(reference_cell::candidates(boxes, surface, &mut out)),
                Method::Brute => Some(brute_force::candidates(boxes, surface, &mut out)),
            };
            let counts = counts.expect("a pool does not stop a search");
            let time = started.elapsed();
            let Counts { vertex_triangle, edge_edge } = counts;
            if [vertex_triangle, edge_edge] == [self.vertex_triangle.len(), self.edge_edge.len()] {
                return time;
            }
            // Filled with a value other than zero, so that the timed pass does not wait for memory pages.
            self.vertex_triangle = vec![[u32::MAX; 2]; vertex_triangle];
            self.edge_edge = vec![[u32::MAX; 2]; edge_edge];
        }
    }
}

/// Distance between the features of each candidate, m. Where their boxes are farther apart than the thickness,
/// the distance between the boxes instead.
pub struct Distances {
    /// In the order of the candidates.
    pub vertex_triangle: Vec<f32>,
    /// In the order of the candidates.
    pub edge_edge: Vec<f32>,
}

/// Measures the candidates at the start of the motion.
pub fn distances(found: &CandidateLists, subject: &Subject, pool: &Pool) -> Distances {
    Distances {
        vertex_triangle: measure::<VertexTriangle>(&found.vertex_triangle, subject, pool),
        edge_edge: measure::<EdgeEdge>(&found.edge_edge, subject, pool),
    }
}

fn measure<P: Pairing>(candidates: &[[u32; 2]], subject: &Subject, pool: &Pool) -> Vec<f32> {
    let mut distances = vec![0.0; candidates.len()];
    let (surface, radii) = (subject.surface.view(), vec![0.0; subject.positions.len()]);
    let (x, reach) = (&subject.positions, subject.thickness);
    proximity::distances::<P>(candidates, &surface, x, &radii, reach, &mut distances, pool);
    distances
}

/// The impacts during the motion.
pub struct Touch {
    /// Number of vertex-triangle pairs that collide.
    pub vertex_triangle: usize,
    /// Number of edge-edge pairs that collide.
    pub edge_edge: usize,
    /// Time of the first impact as a fraction of the motion, 0..1.
    pub first: Option<f32>,
}

impl Touch {
    /// Finds the impacts of all candidates on the way to `next`.
    pub fn find(found: &CandidateLists, distances: &Distances, subject: &Subject, next: &[Vec3], pool: &Pool) -> Self {
        let (vertices, edges) = (&found.vertex_triangle, &found.edge_edge);
        let (start, radii) = (&subject.positions[..], &vec![0.0; next.len()][..]);
        let motion = LinearMotion { start, end: next, radii, rounds: &[], round: 0 };
        let vertex_triangle = times::<VertexTriangle>(vertices, &distances.vertex_triangle, subject, motion, pool);
        let edge_edge = times::<EdgeEdge>(edges, &distances.edge_edge, subject, motion, pool);
        Self::of(&vertex_triangle, &edge_edge)
    }

    /// Counts the impacts, given the impact times of all candidates.
    pub fn of(vertex_triangle: &[StoredTime], edge_edge: &[StoredTime]) -> Self {
        Self {
            vertex_triangle: hits(vertex_triangle).count(),
            edge_edge: hits(edge_edge).count(),
            first: hits(vertex_triangle).chain(hits(edge_edge)).reduce(f32::min),
        }
    }
}

/// The times of the candidates that collide. Features that touch at the start collide at once.
fn hits(times: &[StoredTime]) -> impl Iterator<Item = f32> {
    times.iter().filter_map(|&time| match time.into() {
        TimeOfImpact::Never => None,
        TimeOfImpact::At(time) => Some(time),
        TimeOfImpact::Touching => Some(0.0),
    })
}

/// Impact time of each candidate: when rounding can no longer tell its features apart.
fn times<P: Pairing>(
    candidates: &[[u32; 2]],
    distances: &[f32],
    subject: &Subject,
    motion: LinearMotion<'_>,
    pool: &Pool,
) -> Vec<StoredTime> {
    let mut times = vec![TimeOfImpact::Never.into(); candidates.len()];
    continuous::times::<P>(candidates, distances, &subject.surface.view(), motion, 0.0, &mut times, pool);
    times
}
