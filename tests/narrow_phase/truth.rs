//! Queries with exact truth [Wang 2021], as they are and rounded to f32: every contact is found.
//!
//! All their coordinates are doubles. The exact decision is first held against the published
//! truth, then decides for the rounded copies. False hits are counted: what comes closer than the
//! rounding reserve without touching is one.

use std::path::Path;
use std::sync::OnceLock;

use glam::DVec3;

use crate::exact;
use muslin_tests::query::{Pair, Query};

const FAMILIES: [&str; 5] =
    ["erleben-cube-cliff-edges", "erleben-spike-wedge", "erleben-spikes", "erleben-wedges", "unit-tests"];

struct Known {
    family: &'static str,
    query: Query,
    touches: bool,
}

/// All queries; none, with a word on it, where they are absent and need not be there.
fn queries() -> &'static [Known] {
    static QUERIES: OnceLock<Vec<Known>> = OnceLock::new();
    QUERIES.get_or_init(|| {
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/ccd-queries"));
        if !data.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
            eprintln!("skipped: {} is absent", data.display());
            return Vec::new();
        }
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

#[test]
fn exact_decision_is_the_published_truth() {
    for Known { family, query, touches } in queries() {
        assert_eq!(exact::touch(query), *touches, "{family}: {query}");
    }
}

muslin_tests::both_precisions! {
    use super::{FAMILIES, Known, queries};
    use crate::exact;

    /// With a tolerance of a micrometre, of 2,324 queries. Nearly all are separated by less than
    /// that; rounded to f32, many of those touch.
    const MOST_FALSE_HITS: usize = kit::bound(180.0, 415.0) as usize;

    #[test]
    fn no_contact_is_missed() {
        let mut all_false = 0;
        for name in FAMILIES {
            let (mut count, mut hits, mut changed, mut false_hits, mut distances, mut most) = (0, 0, 0, 0, 0, 0);
            for Known { query, touches: published, .. } in queries().iter().filter(|q| q.family == name) {
                let query = kit::rounded(query);
                let touches = exact::touch(&query);
                let hit = kit::time_of_impact(&query, 0.0, 1e-6).is_some();
                assert!(hit || !touches, "missed a contact of {name}: {query}");
                count += 1;
                hits += usize::from(touches);
                changed += usize::from(touches != *published);
                false_hits += usize::from(hit && !touches);
                let n = kit::distances(&query, 0.0, 1e-6);
                distances += n;
                most = most.max(n);
            }
            if count > 0 {
                println!(
                    "{name}: {count} queries, {hits} touch ({changed} changed by rounding), {false_hits} false hits, \
                     {:.2} distances each, at most {most}",
                    f64::from(distances) / f64::from(count)
                );
            }
            all_false += false_hits;
        }
        assert!(all_false <= MOST_FALSE_HITS, "{all_false} false hits");
    }

    /// What rounding the coordinates moves is below the reserve.
    #[test]
    fn no_published_contact_is_missed() {
        for Known { family, query, touches } in queries() {
            assert!(!touches || kit::time_of_impact(query, 0.0, 1e-6).is_some(), "missed a contact of {family}: {query}");
        }
    }
}
