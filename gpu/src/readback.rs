//! Layout of the buffer that a detection is read back from.

use std::ops::Range;

use muslin_core::narrow_phase::time_of_impact::StoredTime;

use crate::params::{COUNTER_WORDS, Capacities, counters};
use crate::slots::Slot;

/// The results that a detection reads back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectionQuery {
    /// All candidates, as a step needs them.
    Candidates,
    /// Only the candidates nearer than the reach.
    #[cfg(feature = "narrow-phase")]
    Contacts,
    /// All candidates, their distances and their times of impact.
    #[cfg(feature = "narrow-phase")]
    Times,
}

/// Results of a detection. The pairs are those of the core, in a different order that is the same in every
/// run. Columns that the query does not include are not written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetectionResult {
    /// Number of vertex-triangle candidates, then of edge-edge candidates.
    pub candidates: [usize; 2],
    /// Vertex and triangle of each pair.
    pub vertex_triangle: Vec<[u32; 2]>,
    /// Two edges of each pair, the smaller index first.
    pub edge_edge: Vec<[u32; 2]>,
    /// Distance of each vertex-triangle pair, m.
    pub vertex_triangle_distances: Vec<f32>,
    /// Distance of each edge-edge pair, m.
    pub edge_edge_distances: Vec<f32>,
    /// Time of impact of each vertex-triangle pair.
    pub vertex_triangle_times: Vec<StoredTime>,
    /// Time of impact of each edge-edge pair.
    pub edge_edge_times: Vec<StoredTime>,
}

/// The columns that are read back, and their lengths.
#[derive(Clone, Copy, Debug)]
pub struct ReadbackLayout {
    /// Selects the columns.
    pub query: DetectionQuery,
    /// Number of vertex-triangle pairs, then of edge-edge pairs. Contacts of both kinds are one column and count as the
    /// first.
    pub pairs: [usize; 2],
}

/// Spare pairs of each kind in the next readback, beyond the last count and a quarter of it.
const SPARE: usize = 1024;

impl ReadbackLayout {
    /// A layout for all pairs that the columns can hold.
    pub fn most(query: DetectionQuery, capacities: &Capacities) -> Self {
        let Capacities { vertex_triangle, edge_edge, .. } = *capacities;
        let pairs = match query {
            #[cfg(feature = "narrow-phase")]
            DetectionQuery::Contacts => [capacities.contacts, 0],
            _ => [vertex_triangle, edge_edge],
        };
        Self { query, pairs }
    }

    /// A layout for the counted pairs and some spare, limited by the capacities of the columns.
    pub fn expecting(self, counted: [usize; 2], capacities: &Capacities) -> Self {
        let most = Self::most(self.query, capacities).pairs;
        Self { pairs: [0, 1].map(|k| most[k].min(counted[k] + counted[k] / 4 + SPARE)), ..self }
    }

    /// Number of pairs to be read back, according to the counters.
    pub fn counted(&self, counters: &[u32]) -> [usize; 2] {
        let [vertex_triangle, edge_edge] = counts(counters, self.query);
        match self.query {
            #[cfg(feature = "narrow-phase")]
            DetectionQuery::Contacts => [vertex_triangle + edge_edge, 0],
            _ => [vertex_triangle, edge_edge],
        }
    }

    fn slots(&self) -> &'static [Slot] {
        match self.query {
            DetectionQuery::Candidates => &[Slot::Counters, Slot::VertexTriangle, Slot::EdgeEdge],
            #[cfg(feature = "narrow-phase")]
            DetectionQuery::Contacts => &[Slot::Counters, Slot::Contacts],
            #[cfg(feature = "narrow-phase")]
            DetectionQuery::Times => &[
                Slot::Counters,
                Slot::VertexTriangle,
                Slot::EdgeEdge,
                Slot::VertexTriangleDistances,
                Slot::EdgeEdgeDistances,
                Slot::VertexTriangleTimes,
                Slot::EdgeEdgeTimes,
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
            // The other columns are not read back.
            _ => 0,
        }
    }

    /// Each column and the words of the readback buffer that it is copied to.
    pub fn parts(&self) -> impl Iterator<Item = (Slot, Range<usize>)> {
        self.slots().iter().scan(0, |at, &slot| {
            let start = core::mem::replace(at, *at + self.words_of(slot));
            Some((slot, start..*at))
        })
    }

    /// Number of words of all columns.
    pub fn words(&self) -> usize {
        self.slots().iter().map(|&slot| self.words_of(slot)).sum()
    }

    /// Copies the results from a complete readback.
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

/// The counted vertex-triangle pairs, then the edge-edge pairs: contacts or candidates, depending on the query.
fn counts(counters: &[u32], query: DetectionQuery) -> [usize; 2] {
    let places = match query {
        #[cfg(feature = "narrow-phase")]
        DetectionQuery::Contacts => [counters::CONTACTS, counters::CONTACTS + 1],
        _ => [counters::VERTEX_TRIANGLE, counters::EDGE_EDGE],
    };
    places.map(|at| counters[at] as usize)
}

/// Copies the first `count` elements of a column of words.
fn take<T: bytemuck::Pod>(words: &[u32], count: usize, to: &mut Vec<T>) {
    to.clear();
    to.extend_from_slice(&bytemuck::cast_slice(words)[..count]);
}
