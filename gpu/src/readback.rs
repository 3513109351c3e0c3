//! What comes back of a detection, in a row in one buffer.

use std::ops::Range;

use crate::params::{COUNTER_WORDS, Capacities, counters};
use crate::slots::Slot;

/// What a host wants to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectionQuery {
    /// All candidates and their distances: what a step responds to.
    Candidates,
    /// Only those nearer than the reach.
    Contacts,
    /// All candidates, their distances and when they meet.
    Times,
}

/// What was found; as the core's, in another order that is always the same. What was not query is
/// empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetectionResult {
    /// How many candidates: vertices with triangles, and edges.
    pub candidates: [usize; 2],
    /// Vertex and triangle.
    pub vertex_triangle: Vec<[u32; 2]>,
    /// Two edges, the lesser first.
    pub edge_edge: Vec<[u32; 2]>,
    /// m.
    pub vertex_triangle_distances: Vec<f32>,
    /// m.
    pub edge_edge_distances: Vec<f32>,
    /// Parts of the step.
    pub vertex_triangle_times: Vec<f32>,
    /// Likewise.
    pub edge_edge_times: Vec<f32>,
}

/// What is read back, and how much of it.
#[derive(Clone, Copy, Debug)]
pub struct ReadbackLayout {
    /// Of all.
    pub query: DetectionQuery,
    /// Pairs: vertices with triangles, and edges; contacts come together, as the first.
    pub pairs: [usize; 2],
}

/// Pairs more than last time that are read back.
const SPARE: usize = 1024;

impl ReadbackLayout {
    /// All that there is room for.
    pub fn most(query: DetectionQuery, capacities: &Capacities) -> Self {
        let Capacities { vertex_triangle, edge_edge, contacts, .. } = *capacities;
        let pairs = match query {
            DetectionQuery::Contacts => [contacts, 0],
            _ => [vertex_triangle, edge_edge],
        };
        Self { query, pairs }
    }

    /// As much as was counted and some more, as far as there is room for it.
    pub fn expecting(self, counted: [usize; 2], capacities: &Capacities) -> Self {
        let most = Self::most(self.query, capacities).pairs;
        Self { pairs: [0, 1].map(|k| most[k].min(counted[k] + counted[k] / 4 + SPARE)), ..self }
    }

    /// How much there is to be read back.
    pub fn counted(&self, counters: &[u32]) -> [usize; 2] {
        let [vertex_triangle, edge_edge] = counts(counters, self.query);
        match self.query {
            DetectionQuery::Contacts => [vertex_triangle + edge_edge, 0],
            _ => [vertex_triangle, edge_edge],
        }
    }

    fn slots(&self) -> &'static [Slot] {
        use Slot::{
            Contacts, Counters, EdgeEdge, EdgeEdgeDistances, EdgeEdgeTimes, VertexTriangle, VertexTriangleDistances,
            VertexTriangleTimes,
        };
        match self.query {
            DetectionQuery::Candidates => {
                &[Counters, VertexTriangle, EdgeEdge, VertexTriangleDistances, EdgeEdgeDistances]
            }
            DetectionQuery::Contacts => &[Counters, Contacts],
            DetectionQuery::Times => &[
                Counters,
                VertexTriangle,
                EdgeEdge,
                VertexTriangleDistances,
                EdgeEdgeDistances,
                VertexTriangleTimes,
                EdgeEdgeTimes,
            ],
        }
    }

    fn words_of(&self, slot: Slot) -> usize {
        let [first, second] = self.pairs;
        match slot {
            Slot::VertexTriangle | Slot::Contacts => 2 * first,
            Slot::EdgeEdge => 2 * second,
            Slot::VertexTriangleDistances | Slot::VertexTriangleTimes => first,
            Slot::EdgeEdgeDistances | Slot::EdgeEdgeTimes => second,
            Slot::Counters => COUNTER_WORDS,
            // Nothing of the others is read back.
            _ => 0,
        }
    }

    /// Each column and the words it comes to.
    pub fn parts(&self) -> impl Iterator<Item = (Slot, Range<usize>)> {
        self.slots().iter().scan(0, |at, &slot| {
            let start = core::mem::replace(at, *at + self.words_of(slot));
            Some((slot, start..*at))
        })
    }

    /// Words of all columns.
    pub fn words(&self) -> usize {
        self.slots().iter().map(|&slot| self.words_of(slot)).sum()
    }

    /// Takes what was found out of an answer that is whole.
    pub fn read(&self, all: &[u32], found: &mut DetectionResult) {
        let counters = &all[..COUNTER_WORDS];
        found.candidates = counts(counters, DetectionQuery::Candidates);
        let [first, second] = counts(counters, self.query);
        for (slot, words) in self.parts() {
            let words = &all[words];
            match slot {
                Slot::VertexTriangle => take(words, first, &mut found.vertex_triangle),
                Slot::EdgeEdge => take(words, second, &mut found.edge_edge),
                Slot::Contacts => {
                    take(words, first, &mut found.vertex_triangle);
                    take(&words[2 * first..], second, &mut found.edge_edge);
                }
                Slot::VertexTriangleDistances => take(words, first, &mut found.vertex_triangle_distances),
                Slot::EdgeEdgeDistances => take(words, second, &mut found.edge_edge_distances),
                Slot::VertexTriangleTimes => take(words, first, &mut found.vertex_triangle_times),
                Slot::EdgeEdgeTimes => take(words, second, &mut found.edge_edge_times),
                _ => {}
            }
        }
    }
}

/// How many the plan says there are: vertices with triangles, and edges.
fn counts(counters: &[u32], query: DetectionQuery) -> [usize; 2] {
    let places = match query {
        DetectionQuery::Contacts => [counters::CONTACTS, counters::CONTACTS + 1],
        _ => [counters::VERTEX_TRIANGLE, counters::EDGE_EDGE],
    };
    places.map(|at| counters[at] as usize)
}

/// Takes the first things out of words.
fn take<T: bytemuck::Pod>(words: &[u32], count: usize, to: &mut Vec<T>) {
    to.clear();
    to.extend_from_slice(&bytemuck::cast_slice(words)[..count]);
}
