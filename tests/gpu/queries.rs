//! Queries with exact answers, rounded to single precision: the device misses no contact.

use bytemuck::{cast, cast_slice, cast_vec};
use glam::DVec3;
use harness::kit::single::rounded;
use harness::query::{Pair, Query};
use harness::rng::Rng;
use harness::truth::queries;
use muslin_core::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
use muslin_gpu::params::{COUNTER_WORDS, Params, counters};
use muslin_gpu::schedule::Dispatch;
use muslin_gpu::single_stage::{Columns, run};
use muslin_gpu::slots::Slot;

use super::methods::gpu;
use harness::exact;
use harness::head_on::{KINDS, Row, cases};

/// Separation that features keep, m; nearly all features that do not touch are less than this apart.
const SEPARATION: f32 = 1e-6;

/// The stages for a kind of pair, the slots of its candidates, distances and times, and its counter.
fn kind(pair: Pair) -> ([&'static str; 2], [Slot; 3], usize) {
    match pair {
        Pair::VertexTriangle => (
            ["narrow_phase/proximity, vertex_triangle", "narrow_phase/continuous, vertex_triangle"],
            [Slot::VertexTriangle, Slot::VertexTriangleDistances, Slot::VertexTriangleTimes],
            counters::VERTEX_TRIANGLE,
        ),
        Pair::EdgeEdge => (
            ["narrow_phase/proximity, edge_edge", "narrow_phase/continuous, edge_edge"],
            [Slot::EdgeEdge, Slot::EdgeEdgeDistances, Slot::EdgeEdgeTimes],
            counters::EDGE_EDGE,
        ),
    }
}

/// Time of impact of each query.
fn times(pair: Pair, queries: &[Query]) -> Option<Vec<TimeOfImpact>> {
    times_to_keep(SEPARATION, pair, queries, &vec![0.0; queries.len()])
}

/// Time at which each query's features come within a separation, m, plus the radius of the first feature.
fn times_to_keep(separation: f32, pair: Pair, queries: &[Query], radii: &[f32]) -> Option<Vec<TimeOfImpact>> {
    let gpu = gpu()?;
    let (stages, [candidates, distances, times], place) = kind(pair);
    let count = queries.len() as u32;
    let positions = |of: fn(&Query) -> &[glam::DVec3; 4]| -> Vec<u32> {
        let vertices = queries.iter().flat_map(|query| of(query).map(|x| x.as_vec3().to_array()));
        cast_vec(vertices.flatten().collect::<Vec<f32>>())
    };
    let mut told = vec![0; COUNTER_WORDS];
    told[place] = count;
    let pairs: Vec<[u32; 2]> = match pair {
        Pair::VertexTriangle => (0..count).map(|i| [4 * i, i]).collect(),
        Pair::EdgeEdge => (0..count).map(|i| [2 * i, 2 * i + 1]).collect(),
    };
    let triangles: Vec<[u32; 3]> = (0..count).map(|i| [4 * i + 1, 4 * i + 2, 4 * i + 3]).collect();
    let around: Vec<f32> = match pair {
        Pair::VertexTriangle => radii.iter().flat_map(|&r| [r, 0.0, 0.0, 0.0]).collect(),
        Pair::EdgeEdge => radii.iter().flat_map(|&r| [r, r, 0.0, 0.0]).collect(),
    };
    let empty = vec![0; queries.len()];
    let mut all = Columns::from([
        (candidates, cast_slice(&pairs).to_vec()),
        (Slot::Triangles, cast_slice(&triangles).to_vec()),
        (Slot::Edges, (0..4 * count).collect()),
        (Slot::Start, positions(|query| &query.start)),
        (Slot::End, positions(|query| &query.end)),
        (Slot::Radii, cast_vec(around)),
        (distances, empty.clone()),
        (times, empty),
        (Slot::Counters, told),
    ]);
    let params = Params { vertex_triangle: count, edge_edge: count, reach: 1e9, separation, ..Params::default() };
    let dispatch =
        |shader, entry, group: usize| Dispatch { shader, entry, groups: queries.len().div_ceil(group), params };
    let both = vec![dispatch(stages[0], "write_distances", 256), dispatch(stages[1], "write_times", 64)];
    pollster::block_on(run(gpu, both, &mut all)).unwrap();
    Some(all[&times].iter().map(|&bits| cast::<u32, StoredTime>(bits).into()).collect())
}

#[test]
#[ignore = "takes a graphics driver"]
fn no_contact_is_missed() {
    for pair in [Pair::VertexTriangle, Pair::EdgeEdge] {
        let own: Vec<_> =
            queries().iter().map(|known| rounded(&known.query)).filter(|query| query.pair == pair).collect();
        let Some(times) = times(pair, &own) else { return };
        let (mut touching, mut hits) = (0, 0);
        for (query, &time) in own.iter().zip(&times) {
            let touches = exact::touch(query);
            let hit = match time {
                TimeOfImpact::Never => false,
                TimeOfImpact::At(0.0..=1.0) | TimeOfImpact::Touching => true,
                TimeOfImpact::At(time) => panic!("a time of {time}: {query}"),
            };
            assert!(hit || !touches, "missed a contact: {query}");
            touching += usize::from(touches);
            hits += usize::from(hit);
        }
        println!("{pair:?}: {} queries, {touching} touch, {hits} hit", own.len());
        assert!(own.is_empty() || hits < own.len(), "all are hit: the test says nothing");
    }
}

/// The same query as `detect --backend gpu --stage ccd`.
fn fuzz_head_on(seed: u64, count: u64) {
    let (rng, mut missed) = (&mut Rng::new(seed), 0);
    for kind in KINDS {
        let (own, mut row) = (cases(rng, kind, count, 24, true, rounded), Row::default());
        let queries: Vec<_> = own.iter().map(|case| case.query.clone()).collect();
        let radii: Vec<_> = own.iter().map(|case| case.radius as f32).collect();
        let Some(times) = times_to_keep(0.0, kind.pair(), &queries, &radii) else { return };
        for (case, &time) in own.iter().zip(&times) {
            row.add(&case.query, case.touches || exact::touch(&case.query), time != TimeOfImpact::Never);
        }
        missed += row.print("device", kind);
    }
    assert_eq!(missed, 0, "the first missed of each kind is printed above");
}

#[test]
#[ignore = "takes a graphics driver"]
fn no_hit_head_on_is_missed() {
    fuzz_head_on(506, 1_000);
}

#[test]
#[ignore = "a command of its own"]
fn long_form_of_head_on_hits() {
    fuzz_head_on(507, 60_000);
}

#[test]
#[ignore = "takes a graphics driver"]
fn what_is_too_large_or_no_number_is_hit_at_once() {
    let corners = [DVec3::ZERO, DVec3::new(2.0, 1.0, 3.0), DVec3::new(3.0, 1.0, -1.0), DVec3::new(2.0, 4.0, 1.0)];
    for pair in [Pair::VertexTriangle, Pair::EdgeEdge] {
        let bad = [1e18, 1e25, 3e38, f64::NAN, f64::INFINITY];
        let all = bad.map(|bad| Query { pair, start: corners, end: corners.map(|x| DVec3::splat(bad) - x) });
        let one = bad.map(|bad| Query { pair, start: corners, end: [DVec3::splat(bad), DVec3::X, DVec3::Y, DVec3::Z] });
        let back =
            |own: &[Query; 5]| own.clone().map(|Query { start, end, .. }| Query { pair, start: end, end: start });
        for own in [back(&all), back(&one), all, one] {
            let Some(times) = times(pair, &own) else { return };
            assert_eq!(times, [TimeOfImpact::Touching; 5], "{pair:?} on the way to or from {bad:?}");
        }
    }
}

/// A vertex above a triangle, or an edge across another one, at a height.
fn above(pair: Pair, height: f64) -> [DVec3; 4] {
    let up = height * DVec3::Y;
    match pair {
        Pair::VertexTriangle => [up, DVec3::new(-1.0, 0.0, -1.0), DVec3::X, DVec3::Z],
        Pair::EdgeEdge => [up - DVec3::X, up + DVec3::X, -DVec3::Z, DVec3::Z],
    }
}

/// Both features end in one plane, far away: rounding makes the displacements of both features equal.
#[test]
#[ignore = "takes a graphics driver"]
fn nothing_is_missed_that_moves_far_together() {
    for pair in [Pair::VertexTriangle, Pair::EdgeEdge] {
        let own = [1e-4, 1e-3, 3e-3].map(|height| {
            let start = above(pair, height);
            Query { pair, start, end: start.map(|x| DVec3::new(x.x, 1e5, x.z)) }
        });
        let Some(times) = times(pair, &own) else { return };
        assert!(times.iter().all(|time| matches!(time, TimeOfImpact::At(..=1.0))), "{pair:?}: {times:?}");
    }
}

/// Features only a few roundings apart: rounding hides whether they collide.
#[test]
#[ignore = "takes a graphics driver"]
fn what_rounding_hides_is_hit_at_once() {
    for pair in [Pair::VertexTriangle, Pair::EdgeEdge] {
        let down = |height: f64| {
            let (start, end) = (above(pair, height), above(pair, -1.0));
            Query { pair, start, end }
        };
        let Some(times) = times(pair, &[3e-6, 3e-5].map(down)) else { return };
        assert_eq!(times[0], TimeOfImpact::Touching, "{pair:?}: three millionths of the size apart");
        let TimeOfImpact::At(time) = times[1] else { panic!("{pair:?}: ten times as far apart: {:?}", times[1]) };
        assert!(time > 0.0 && time < 1e-4, "{pair:?}: ten times as far apart they meet at {time}");
    }
}
