//! Queries with exact answers [Wang 2021].

use std::sync::OnceLock;

use glam::DVec3;

use crate::data;
use crate::query::{Pair, Query};

/// The sources of the queries.
pub const FAMILIES: [&str; 5] =
    ["erleben-cube-cliff-edges", "erleben-spike-wedge", "erleben-spikes", "erleben-wedges", "unit-tests"];

/// A query with its answer.
pub struct Known {
    /// One of the families.
    pub family: &'static str,
    /// The query.
    pub query: Query,
    /// Whether the features touch, as published.
    pub touches: bool,
}

/// All queries; if they are absent and `MUSLIN_REQUIRE_DATA` is not 1, prints a note and returns an empty
/// slice.
pub fn queries() -> &'static [Known] {
    static QUERIES: OnceLock<Vec<Known>> = OnceLock::new();
    QUERIES.get_or_init(|| {
        let Some(data) = data::path("ccd-queries") else { return Vec::new() };
        let mut known = Vec::new();
        for family in FAMILIES {
            for (pair, folder) in [(Pair::VertexTriangle, "vertex-face"), (Pair::EdgeEdge, "edge-edge")] {
                for part in ["data_0_0.csv", "data_0_1.csv"] {
                    let path = data.join(family).join(folder).join(part);
                    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                    known.extend(parse(&text, pair).map(|(query, touches)| Known { family, query, touches }));
                }
            }
        }
        known
    })
}

fn parse(text: &str, pair: Pair) -> impl Iterator<Item = (Query, bool)> {
    let row = |line: &str| {
        let n: Vec<f64> = line.split(',').map(|n| n.parse().expect("a number")).collect();
        (DVec3::new(n[0] / n[1], n[2] / n[3], n[4] / n[5]), n[6] == 1.0)
    };
    let rows: Vec<_> = text.lines().map(row).collect();
    let query = move |rows: &[(DVec3, bool)]| {
        let at = |from: usize| std::array::from_fn(|i| rows[from + i].0);
        (Query { pair, start: at(0), end: at(4) }, rows[0].1)
    };
    rows.chunks_exact(8).map(query).collect::<Vec<_>>().into_iter()
}
