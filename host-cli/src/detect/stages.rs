//! The stages, each over the candidates of both kinds: find them, measure them, move them.

use std::time::{Duration, Instant};

use muslin_core::broad_phase::{self, Candidates, Counts, GridColumns, Surface, brute_force, reference_cell};
use muslin_core::dispatch::Dispatch;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::narrow_phase::continuous::NEVER;
use muslin_core::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, gather, proximity};
use muslin_core::real::Vec3;

use super::mesh::Subject;
use crate::args::Method;
use crate::pool::Pool;

/// The candidates.
#[derive(Default)]
pub struct Found {
    /// `[vertex, triangle]`.
    pub vertex_triangle: Vec<[u32; 2]>,
    /// `[edge, edge]`.
    pub edge_edge: Vec<[u32; 2]>,
}

impl Found {
    /// Finds them all: counts, makes room, and comes again. Returns how long the last time took.
    pub fn find(&mut self, method: Method, boxes: &[Aabb], surface: &Surface<'_>, pool: &Pool) -> Duration {
        let cells = if method == Method::Grid { [boxes.len(), surface.triangles.len()] } else { [0; 2] };
        let mut work = GridColumns::build(cells[0], cells[1]);
        loop {
            let mut out = Candidates { vertex_triangle: &mut self.vertex_triangle, edge_edge: &mut self.edge_edge };
            let started = Instant::now();
            let counts = match method {
                Method::Grid => broad_phase::candidates(boxes, surface, &mut work.view(), &mut out, pool),
                Method::Reference => reference_cell::candidates(boxes, surface, &mut out),
                Method::Brute => brute_force::candidates(boxes, surface, &mut out),
            };
            let time = started.elapsed();
            let Counts { vertex_triangle, edge_edge } = counts;
            if [vertex_triangle, edge_edge] == [self.vertex_triangle.len(), self.edge_edge.len()] {
                return time;
            }
            // Written once, so that the clock does not see memory being handed out.
            self.vertex_triangle = vec![[u32::MAX; 2]; vertex_triangle];
            self.edge_edge = vec![[u32::MAX; 2]; edge_edge];
        }
    }
}

/// How far apart each candidate's features are; where their boxes lie farther apart than the
/// thickness, how far those are. m.
pub struct Distances {
    /// As the candidates.
    pub vertex_triangle: Vec<f32>,
    /// As the candidates.
    pub edge_edge: Vec<f32>,
}

/// Measures the candidates as the mesh stands.
pub fn distances(found: &Found, subject: &Subject, pool: &Pool) -> Distances {
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

/// What touches in the course of the motion.
pub struct Touch {
    /// How many pairs of a vertex and a triangle do.
    pub vertex_triangle: usize,
    /// How many pairs of edges do.
    pub edge_edge: usize,
    /// When the first do, of the motion, 0..1.
    pub first: Option<f32>,
}

impl Touch {
    /// Moves all candidates to `next`.
    pub fn find(found: &Found, distances: &Distances, subject: &Subject, next: &[Vec3], pool: &Pool) -> Self {
        let (vertices, edges) = (&found.vertex_triangle, &found.edge_edge);
        let vertex_triangle = times::<VertexTriangle>(vertices, &distances.vertex_triangle, subject, next, pool);
        let edge_edge = times::<EdgeEdge>(edges, &distances.edge_edge, subject, next, pool);
        let count = |times: &[f32]| times.iter().filter(|&&time| time <= 1.0).count();
        let first = vertex_triangle.iter().chain(&edge_edge).copied().fold(NEVER, f32::min);
        Self {
            vertex_triangle: count(&vertex_triangle),
            edge_edge: count(&edge_edge),
            first: Some(first).filter(|&time| time <= 1.0),
        }
    }
}

/// When each candidate's features come so near that rounding cannot tell them apart.
fn times<P: Pairing>(
    candidates: &[[u32; 2]],
    distances: &[f32],
    subject: &Subject,
    next: &[Vec3],
    pool: &Pool,
) -> Vec<f32> {
    let mut times = vec![NEVER; candidates.len()];
    let surface = subject.surface.view();
    let meeting = |candidate: [u32; 2], distance: f32| {
        let vertices = P::vertices(&surface, candidate);
        let [start, end] = [&subject.positions, next].map(|x| gather(vertices, x));
        let moves = std::array::from_fn(|k| end[k] - start[k]);
        // Nearly all candidates cannot have come near enough.
        let reaches = P::approach(&moves) * (1.0 + 1e-5) >= distance;
        reaches.then(|| P::time_of_impact(&start, &end, 0.0, 0.0)).flatten().unwrap_or(NEVER)
    };
    pool.run(&mut times[..], |first, part| {
        let pairs = candidates[first..].iter().zip(&distances[first..]);
        pairs.zip(part).for_each(|((&candidate, &distance), time)| *time = meeting(candidate, distance));
    });
    times
}
