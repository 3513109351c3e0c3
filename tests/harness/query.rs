//! Queries for continuous collision detection: two features and their motion.

use std::fmt;

use glam::DVec3;

/// The pair of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// A vertex and a triangle, `[vertex, t0, t1, t2]`.
    VertexTriangle,
    /// Two edges, `[a0, a1, b0, b1]`.
    EdgeEdge,
}

/// Both pairs.
pub const PAIRS: [Pair; 2] = [Pair::VertexTriangle, Pair::EdgeEdge];

/// Four vertices that move linearly.
#[derive(Clone, Debug)]
pub struct Query {
    /// The features that the vertices form.
    pub pair: Pair,
    /// Start positions.
    pub start: [DVec3; 4],
    /// End positions.
    pub end: [DVec3; 4],
}

impl Query {
    /// Replaces every position.
    pub fn map(&self, new: impl Fn(DVec3) -> DVec3) -> Self {
        Self { pair: self.pair, start: self.start.map(&new), end: self.end.map(&new) }
    }

    /// The vertices in another order.
    pub fn reordered(&self, order: [usize; 4]) -> Self {
        Self { pair: self.pair, start: order.map(|i| self.start[i]), end: order.map(|i| self.end[i]) }
    }

    /// Orders of the vertices that describe the same features.
    pub fn orders(&self) -> &'static [[usize; 4]] {
        match self.pair {
            Pair::VertexTriangle => &[[0, 2, 3, 1], [0, 3, 1, 2], [0, 2, 1, 3], [0, 1, 3, 2], [0, 3, 2, 1]],
            Pair::EdgeEdge => &[[1, 0, 2, 3], [0, 1, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]],
        }
    }

    /// Positions at a time.
    pub fn at(&self, time: f64) -> [DVec3; 4] {
        std::array::from_fn(|i| self.start[i] * (1.0 - time) + self.end[i] * time)
    }

    /// The motion between two times.
    pub fn between(&self, from: f64, to: f64) -> Self {
        Self { pair: self.pair, start: self.at(from), end: self.at(to) }
    }

    /// The motion relative to the first vertex.
    pub fn local(&self) -> Self {
        let from_first = |x: &[DVec3; 4]| x.map(|v| v - x[0]);
        Self { pair: self.pair, start: from_first(&self.start), end: from_first(&self.end) }
    }

    /// The largest coordinate relative to the first vertex.
    pub fn size(&self) -> f64 {
        let Self { start, end, .. } = self.local();
        start.iter().chain(&end).map(|v| v.abs().max_element()).fold(0.0, f64::max)
    }
}

impl fmt::Display for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:?}", self.pair)?;
        for (start, end) in self.start.iter().zip(&self.end) {
            writeln!(f, "  {:?} -> {:?}", start.to_array(), end.to_array())?;
        }
        Ok(())
    }
}
