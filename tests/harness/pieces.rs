//! Loose points, edges and triangles that move straight for a step: contact alone, without forces
//! and without cloth between them. In plain doubles; the step is 1 s, so that displacements are
//! velocities.

use glam::DVec3;

use crate::kit::double as kit;
use crate::query::Pair;

/// A point, an edge or a triangle by itself.
#[derive(Clone, Debug)]
pub struct Piece {
    /// m.
    pub start: Vec<DVec3>,
    /// How each vertex would move if nothing touched, m.
    pub moves: Vec<DVec3>,
    /// kg; infinite: nothing moves it but its own motion.
    pub masses: Vec<f64>,
}

/// One contact that had to be kept.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Over the vertices of all pieces.
    pub vertices: [usize; 4],
    /// Positive on the first feature.
    pub weights: [f64; 4],
    /// From the second feature to the first.
    pub normal: DVec3,
    /// At the start, m.
    pub gap: f64,
    /// Asked for at the end, m.
    pub target: f64,
    /// Along the normal, kg m.
    pub impulse: f64,
    /// Across it, kg m.
    pub friction: DVec3,
}

/// What the response made of the pieces; columns over the vertices of all.
#[derive(Clone, Debug)]
pub struct Response {
    /// What it was, as it names itself.
    pub outcome: String,
    /// Contacts near at the start, meetings, zones.
    pub counts: [u64; 3],
    /// Whether the last resort was needed.
    pub failsafe: u64,
    /// m, as the core was given it.
    pub start: Vec<DVec3>,
    /// m.
    pub predicted: Vec<DVec3>,
    /// m.
    pub end: Vec<DVec3>,
    /// Whether the response touched it.
    pub touched: Vec<bool>,
    /// kg.
    pub masses: Vec<f64>,
    /// Every contact there was.
    pub kept: Vec<Kept>,
}

impl Kept {
    /// The relative displacement that a column of displacements gives, m.
    pub fn relative(&self, moves: &[DVec3]) -> DVec3 {
        self.vertices.iter().zip(self.weights).map(|(&v, w)| moves[v] * w).sum()
    }

    /// By how much it is violated, m.
    pub fn missing(&self, moves: &[DVec3]) -> f64 {
        self.target - self.gap - self.normal.dot(self.relative(moves))
    }
}

impl Response {
    /// How each vertex would have moved, m.
    pub fn before(&self) -> Vec<DVec3> {
        self.predicted.iter().zip(&self.start).map(|(x, start)| *x - *start).collect()
    }

    /// How it moved, m.
    pub fn moves(&self) -> Vec<DVec3> {
        self.end.iter().zip(&self.start).map(|(x, start)| *x - *start).collect()
    }

    /// The change of momentum of what is free, of the sum of all |changes|.
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

    /// The least distance of two pieces in `samples` instants of the step, m.
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
