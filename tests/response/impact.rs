//! What meets inside a step: loose points, edges and triangles far apart beside the thickness, and
//! so fast that they would be through one another at its end.
//!
//! Run: `cargo test -p muslin-tests --test response impact`; with `-- --nocapture` it
//! prints the worst error of every comparison beside its bound.

use glam::DVec3;
use harness::both_precisions;
use harness::kit::double as exact;
use harness::pieces::{Piece, Response};
use harness::query::{PAIRS, Pair, Query};
use harness::rng::Rng;

/// m.
const THICKNESS: f64 = 1e-3;
/// Surfaces nearer than this meet, m.
const SEPARATION: f64 = 0.1 * THICKNESS;
/// Meetings of each kind.
const MEETINGS: u64 = 300;

/// Two pieces.
fn pieces(pair: Pair, start: [DVec3; 4], moves: [DVec3; 4], masses: [f64; 4]) -> [Piece; 2] {
    let first = if pair == Pair::VertexTriangle { 1 } else { 2 };
    let piece = |range: std::ops::Range<usize>| Piece {
        start: start[range.clone()].to_vec(),
        moves: moves[range.clone()].to_vec(),
        masses: masses[range].to_vec(),
    };
    [piece(0..first), piece(first..4)]
}

fn random_masses(rng: &mut Rng) -> [f64; 4] {
    let mut masses = [0; 4].map(|_| rng.magnitude(1e-3, 1e-1));
    match rng.bits() % 3 {
        0 => (),
        1 => masses[0] = f64::INFINITY,
        _ => masses[2..].fill(f64::INFINITY),
    }
    masses
}

/// Two features that approach along the line between their nearest points and do not turn.
#[derive(Debug)]
struct HeadOn {
    start: [DVec3; 4],
    moves: [DVec3; 4],
    masses: [f64; 4],
    /// Of the points that meet.
    weights: [f64; 4],
    normal: DVec3,
    /// m.
    gap: f64,
    /// How far they come together, m.
    closing: f64,
}

impl HeadOn {
    fn random(pair: Pair, rng: &mut Rng) -> Self {
        let [a, b, c] = [0; 3].map(|_| rng.between(0.3, 0.7));
        let (gap, closing) = (rng.between(0.01, 0.05), rng.between(0.1, 0.3));
        let (weights, level) = match pair {
            Pair::VertexTriangle => {
                let corners = [DVec3::new(-0.1, 0.0, -0.06), DVec3::new(0.1, 0.0, -0.06), DVec3::new(0.0, 0.0, 0.12)];
                let [a, b, c] = [a, b, c].map(|w| w / (a + b + c));
                let at = corners[0] * a + corners[1] * b + corners[2] * c;
                ([1.0, -a, -b, -c], [at, corners[0], corners[1], corners[2]])
            }
            Pair::EdgeEdge => {
                let [along, across] = [DVec3::X * 0.2, DVec3::new(rng.between(-0.1, 0.1), 0.0, 0.2)];
                ([1.0 - a, a, b - 1.0, -b], [-along * a, along * (1.0 - a), -across * b, across * (1.0 - b)])
            }
        };
        let turn = rng.rotation();
        let first = |k: usize| k == 0 || (pair == Pair::EdgeEdge && k == 1);
        // All drift along, which must not matter.
        let (place, drift, share) = (rng.cube(0.1), rng.cube(0.1), rng.between(0.0, 1.0));
        let normal = turn * DVec3::Y;
        let at = |k: usize| place + turn * level[k] + normal * if first(k) { gap } else { 0.0 };
        let way = |k: usize| drift + normal * closing * if first(k) { -share } else { 1.0 - share };
        Self {
            start: std::array::from_fn(at),
            moves: std::array::from_fn(way),
            masses: random_masses(rng),
            weights,
            normal,
            gap,
            closing,
        }
    }

    /// Where the four vertices end: apart by the thickness.
    fn closed_form(&self) -> [DVec3; 4] {
        let inverse_mass: f64 = self.weights.iter().zip(self.masses).map(|(w, m)| w * w / m).sum();
        let impulse = self.normal * (THICKNESS - self.gap + self.closing) / inverse_mass;
        std::array::from_fn(|k| self.start[k] + self.moves[k] + impulse * self.weights[k] / self.masses[k])
    }
}

/// Two features whose vertices all go their own ways and that meet if nothing stops them.
fn astray(pair: Pair, rng: &mut Rng) -> [Piece; 2] {
    loop {
        let at = |k: usize, rng: &mut Rng| {
            let side = if k == 0 || (pair == Pair::EdgeEdge && k == 1) { 0.05 } else { -0.05 };
            rng.cube(0.1) * DVec3::new(1.0, 0.3, 1.0) + DVec3::Y * side
        };
        let start: [DVec3; 4] = std::array::from_fn(|k| at(k, rng));
        let end: [DVec3; 4] = std::array::from_fn(|k| at(k, rng) * DVec3::new(1.0, -3.0, 1.0));
        let query = Query { pair, start, end };
        let near = exact::distance(pair, &start) < 5.0 * THICKNESS;
        if !near && exact::time_of_impact(&query, SEPARATION, 1e-6).is_some_and(|time| time < 0.99) {
            return pieces(pair, start, std::array::from_fn(|k| end[k] - start[k]), random_masses(rng));
        }
    }
}

/// Nothing but a meeting was found, and it was parted.
fn assert_met(response: &Response, what: &str) {
    let [proximity, impacts, _] = response.counts;
    assert_eq!(response.outcome, "Free", "{what}: not resolved, counts {:?}", response.counts);
    assert_eq!(proximity, 0, "{what}: {proximity} contacts near at the start");
    assert!(impacts > 0, "{what}: no impact was found");
}

both_precisions! {
    use super::*;
    use harness::worst::Worst;

    #[test]
    fn a_head_on_impact_ends_where_the_closed_form_says() {
        for pair in PAIRS {
            // The direction of the meeting is that between points a tenth of a thickness apart.
            let mut worst = Worst::new(format!("{} {pair:?}, of the push", muslin::real::NAME), kit::bound(3e-3, 1e-10));
            let mut rng = Rng::new(51);
            for _ in 0..MEETINGS {
                let case = HeadOn::random(pair, &mut rng);
                let response = kit::respond(&pieces(pair, case.start, case.moves, case.masses), THICKNESS, 0.0);
                assert_met(&response, &format!("{case:?}"));
                worst.vectors(case.closing, &response.end, &case.closed_form(), || format!("{case:?}"));
            }
            worst.check();
        }
    }

    #[test]
    fn nothing_meets_after_an_impact_and_the_gap_is_that_asked() {
        for pair in PAIRS {
            let mut gaps = Worst::new(format!("{} {pair:?}, violation in thicknesses", muslin::real::NAME), 0.05);
            let mut rng = Rng::new(52);
            let mut closest = f64::INFINITY;
            for case in 0..MEETINGS {
                let pieces = astray(pair, &mut rng);
                let response = kit::respond(&pieces, THICKNESS, 0.0);
                let what = format!("{} {pair:?}, case {case}", muslin::real::NAME);
                assert_met(&response, &what);
                let nearest = response.closest(&pieces, 1000);
                closest = closest.min(nearest);
                assert!(nearest >= 0.999 * SEPARATION, "{what}: {nearest:e} m apart, at least {SEPARATION:e} asked");
                let last = response.kept.last().expect("it met");
                gaps.see(last.missing(&response.moves()) / THICKNESS, || format!("{what}: {last:?}"));
            }
            println!("{} {pair:?}: at least {closest:.2e} m apart, bound {SEPARATION:.0e}", muslin::real::NAME);
            gaps.check();
        }
    }

    #[test]
    fn an_impact_keeps_momentum_and_adds_no_energy() {
        for pair in PAIRS {
            let mut worst = Worst::new(format!("{} {pair:?}, momentum", muslin::real::NAME), kit::bound(3e-5, 1e-12));
            let mut rng = Rng::new(53);
            for case in 0..MEETINGS {
                let friction = rng.pick(&[0.0, 0.5]);
                let mut pieces = astray(pair, &mut rng);
                for mass in pieces.iter_mut().flat_map(|piece| &mut piece.masses) {
                    *mass = rng.magnitude(1e-3, 1e-1);
                }
                let response = kit::respond(&pieces, THICKNESS, friction);
                assert_met(&response, &format!("case {case}"));
                let [before, after] = response.energy();
                assert!(after < before, "case {case}: {after} J of {before} J after an inelastic impact");
                worst.see(response.drift(), || format!("case {case}, friction {friction}"));
            }
            worst.check();
        }
    }

    /// What two features lose is that along the line between them, and no more: they do not bounce.
    #[test]
    fn a_head_on_impact_loses_the_energy_of_the_approach() {
        for pair in PAIRS {
            let mut worst = Worst::new(format!("{} {pair:?}, energy lost", muslin::real::NAME), kit::bound(2e-4, 1e-10));
            let mut rng = Rng::new(54);
            for _ in 0..MEETINGS {
                let mut case = HeadOn::random(pair, &mut rng);
                case.masses = [0; 4].map(|_| rng.magnitude(1e-3, 1e-1));
                let response = kit::respond(&pieces(pair, case.start, case.moves, case.masses), THICKNESS, 0.0);
                let [before, after] = response.energy();
                let inverse_mass: f64 = case.weights.iter().zip(case.masses).map(|(w, m)| w * w / m).sum();
                // They still close the gap but for the thickness.
                let left = case.gap - THICKNESS;
                let want = 0.5 * (case.closing * case.closing - left * left) / inverse_mass;
                worst.compare(before, &[before - after], &[want], || format!("{case:?}"));
            }
            worst.check();
        }
    }

    /// Beside a pair that meets: one that passes by, and one that stands in the way of nothing.
    #[test]
    fn what_does_not_meet_is_not_touched() {
        for pair in PAIRS {
            let mut rng = Rng::new(55);
            for case in 0..MEETINGS {
                let [meets, mut passes] = [0; 2].map(|_| HeadOn::random(pair, &mut rng));
                // A metre aside; it stops five thicknesses before it meets.
                let aside = DVec3::X * 1.0;
                let part = (passes.gap - 5.0 * THICKNESS) / passes.closing;
                passes.start = passes.start.map(|x| x + aside);
                passes.moves = passes.moves.map(|d| d * part);
                let [a, b] = pieces(pair, meets.start, meets.moves, meets.masses);
                let [c, d] = pieces(pair, passes.start, passes.moves, passes.masses);
                let corners = vec![DVec3::Y, DVec3::Y + DVec3::X, DVec3::Y * 2.0];
                let bystander = Piece { start: corners, moves: vec![DVec3::Z * 0.1; 3], masses: vec![0.1; 3] };
                let response = kit::respond(&[a, b, c, d, bystander], THICKNESS, 0.3);
                let what = format!("{} {pair:?}, case {case}", muslin::real::NAME);
                assert_met(&response, &what);
                assert!(response.touched[..4].contains(&true), "{what}: what meets is not touched");
                for v in 4..response.end.len() {
                    let (end, free) = (response.end[v], response.predicted[v]);
                    assert!(end == free && !response.touched[v], "{what}: vertex {v} meets nothing and ends at {end}, not {free}");
                }
            }
        }
    }
}
