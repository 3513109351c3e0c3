//! Isolated points, edges and triangles that move along straight lines for a step: contact alone, without
//! forces or cloth between them. In plain doubles; the step is 1 s, so that displacements are velocities.

use glam::DVec3;

use crate::kit::double as kit;
use crate::query::Pair;

/// An isolated point, edge or triangle.
#[derive(Clone, Debug)]
pub struct Piece {
    /// m.
    pub start: Vec<DVec3>,
    /// Displacement of each vertex without contact, m.
    pub moves: Vec<DVec3>,
    /// kg; a vertex of infinite mass follows its own motion only.
    pub masses: Vec<f64>,
}

/// One contact that the response enforced.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Numbered over the vertices of all pieces.
    pub vertices: [usize; 4],
    /// Positive for the first feature.
    pub weights: [f64; 4],
    /// From the second feature to the first.
    pub normal: DVec3,
    /// At the start, m.
    pub gap: f64,
    /// Gap that is required at the end, m.
    pub target: f64,
    /// Along the normal, kg m.
    pub impulse: f64,
    /// Perpendicular to the normal, kg m.
    pub friction: DVec3,
}

/// Result of the response; the columns cover the vertices of all pieces.
#[derive(Clone, Debug)]
pub struct Response {
    /// The outcome as its `Debug` text.
    pub outcome: String,
    /// Counts of contacts at the start, impacts, and impact zones.
    pub counts: [u64; 3],
    /// Count of uses of the failsafe.
    pub failsafe: u64,
    /// Start, m, as passed to the core.
    pub start: Vec<DVec3>,
    /// Predicted positions, m.
    pub predicted: Vec<DVec3>,
    /// Final positions, m.
    pub end: Vec<DVec3>,
    /// Whether the response changed the vertex.
    pub touched: Vec<bool>,
    /// kg.
    pub masses: Vec<f64>,
    /// Every contact.
    pub kept: Vec<Kept>,
}

impl Kept {
    /// The relative displacement of the features for a column of displacements, m.
    pub fn relative(&self, moves: &[DVec3]) -> DVec3 {
        self.vertices.iter().zip(self.weights).map(|(&v, w)| moves[v] * w).sum()
    }

    /// The amount by which the contact is violated, m.
    pub fn missing(&self, moves: &[DVec3]) -> f64 {
        self.target - self.gap - self.normal.dot(self.relative(moves))
    }
}

impl Response {
    /// Displacement of each vertex without the response, m.
    pub fn before(&self) -> Vec<DVec3> {
        self.predicted.iter().zip(&self.start).map(|(x, start)| *x - *start).collect()
    }

    /// Displacement of each vertex after the response, m.
    pub fn moves(&self) -> Vec<DVec3> {
        self.end.iter().zip(&self.start).map(|(x, start)| *x - *start).collect()
    }

    /// The change of momentum of the free vertices, divided by the sum of the magnitudes of all changes.
    pub fn drift(&self) -> f64 {
        let free = (0..self.end.len()).filter(|&v| self.masses[v].is_finite());
        let changes = free.map(|v| (self.end[v] - self.predicted[v]) * self.masses[v]);
        let (sum, sizes) = changes.fold((DVec3::ZERO, 0.0), |(sum, sizes), p| (sum + p, sizes + p.length()));
        sum.length() / sizes
    }

    /// Kinetic energy before and after, J.
    pub fn energy(&self) -> [f64; 2] {
        let free = || (0..self.end.len()).filter(|&v| self.masses[v].is_finite());
        let energy = |moves: &[DVec3]| free().map(|v| 0.5 * self.masses[v] * moves[v].length_squared()).sum();
        [energy(&self.before()), energy(&self.moves())]
    }

    /// The smallest distance of two pieces at `samples` instants of the step, m.
    pub fn closest(&self, pieces: &[Piece], samples: u32) -> f64 {
        let mut firsts = vec![0];
        firsts.extend(pieces.iter().scan(0, |sum, piece| {
            *sum += piece.start.len();
            Some(*sum)
        }));
        let ranges: Vec<Vec<usize>> = firsts.windows(2).map(|pair| (pair[0]..pair[1]).collect()).collect();
        let mut features = Vec::new();
        for (a, b) in ranges.iter().enumerate().flat_map(|(k, a)| ranges[..k].iter().map(move |b| (a, b))) {
            for (points, face) in [(a, b), (b, a)].into_iter().filter(|(_, face)| face.len() == 3) {
                features.extend(points.iter().map(|&v| (Pair::VertexTriangle, [v, face[0], face[1], face[2]])));
            }
            for [a0, a1] in edges(a) {
                features.extend(edges(b).map(|[b0, b1]| (Pair::EdgeEdge, [a0, a1, b0, b1])));
            }
        }
        let mut least = f64::INFINITY;
        for k in 0..=samples {
            let time = f64::from(k) / f64::from(samples);
            for &(pair, vertices) in &features {
                let at = vertices.map(|v| self.start[v] * (1.0 - time) + self.end[v] * time);
                least = kit::distance(pair, &at).min(least);
            }
        }
        least
    }
}

fn edges(piece: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    let count = if piece.len() == 3 { 3 } else { piece.len() - 1 };
    (0..count).map(|k| [piece[k], piece[(k + 1) % piece.len()]])
}
