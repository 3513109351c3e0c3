//! Times of impact: never late, never needlessly early, and independent of the order and frame of the query.
//! The contacts are exact in both precisions, see [`lattice`](crate::lattice).

use glam::DVec3;

use crate::lattice;
use harness::query::{PAIRS, Query};
use harness::rng::Rng;

/// Contacts of both pairs, scaled by powers of two and translated.
fn contacts(seed: u64, count: usize) -> impl Iterator<Item = lattice::Contact> {
    let mut rng = Rng::new(seed);
    (0..count).map(move |i| {
        let lattice::Contact { query, time } = lattice::contact(&mut rng, PAIRS[i % 2]);
        let (far, scale) = (lattice::far(&mut rng), 2f64.powi((rng.bits() % 21) as i32 - 10));
        lattice::Contact { query: query.map(|x| (x + far) * scale), time }
    })
}

/// Random motions; about a third of them touch.
fn motions(seed: u64, count: usize) -> impl Iterator<Item = Query> {
    let mut rng = Rng::new(seed);
    (0..count).map(move |i| {
        let speed = rng.magnitude(1e-3, 2.0);
        let pair = PAIRS[i % 2];
        let start = super::distances::features(&mut rng, pair, 1e-3);
        Query { pair, start, end: start.map(|x| x + rng.cube(speed)) }
    })
}

/// The smallest distance during a motion, sampled up to the time `until`.
fn least_distance(query: &Query, until: f64, distance: impl Fn(&[DVec3; 4]) -> f64) -> f64 {
    (0..=64).map(|i| distance(&query.at(until * f64::from(i) / 64.0))).fold(f64::INFINITY, f64::min)
}

harness::both_precisions! {
    use super::{contacts, least_distance, motions};
    use harness::exact;
    use crate::tight_inclusion::{self, Contact};
    use glam::DVec3;
    use muslin::dispatch::Serial;
    use muslin::mesh::SurfaceColumns;
    use muslin::narrow_phase::VertexTriangle;
    use muslin::narrow_phase::advance::MOST_ADVANCES;
    use muslin::narrow_phase::continuous::{LinearMotion, times};
    use muslin::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
    use muslin::real::Real;
    use harness::kit::double::distance;
    use harness::query::{PAIRS, Query};
    use harness::rng::Rng;

    const COUNT: usize = 20_000;

    /// Distance within which a hit counts as close: separation plus tolerance, which is at least the reserve.
    fn reach(query: &Query, separation: f64, tolerance: f64) -> f64 {
        separation + tolerance.max(kit::reserve(query))
    }

    #[test]
    fn contacts_are_found_in_time() {
        let (mut distances, mut most) = (0, 0);
        for contact in contacts(301, COUNT) {
            let query = &contact.query;
            let tolerance = 1e-6 * query.size();
            let Some(time) = kit::time_of_impact(query, 0.0, tolerance) else { panic!("missed {query}") };
            assert!(time <= contact.time, "{time} is later than {}: {query}", contact.time);
            let apart = [distance(query.pair, &query.start), distance(query.pair, &query.at(time))];
            assert!(apart[0] == 0.0 || apart[1] > 0.0, "already touching at {time}: {query}");
            let moves = apart[0] > 1.01 * kit::reserve(query);
            assert_eq!(time > 0.0, moves, "time {time}, apart by {} at the start: {query}", apart[0]);
            let n = kit::distances(query, 0.0, tolerance);
            distances += n;
            most = most.max(n);
        }
        let mean = f64::from(distances) / COUNT as f64;
        println!("contacts: {mean:.2} distances each, at most {most}");
        assert!(mean < 32.0, "{mean:.2} distances each: slower than it was");
    }

    /// Bisection, an independent method, proves that nothing touches before the reported time.
    #[test]
    fn nothing_touches_before() {
        let (mut proved, mut unknown) = (0, 0);
        for contact in contacts(302, COUNT / 20) {
            let query = &contact.query;
            let time = kit::time_of_impact(query, 0.0, 1e-4 * query.size()).unwrap_or_else(|| panic!("missed {query}"));
            if time > 0.0 {
                let before = query.between(0.0, time);
                match tight_inclusion::first_contact(&before, 0.0, 1e-8 * query.size()) {
                    Contact::Never => proved += 1,
                    Contact::NotBefore(part) => panic!("may touch at {part} of {time}: {query}"),
                    Contact::Unknown => unknown += 1,
                }
            }
        }
        println!("{proved} times proved by bisection, {unknown} took too many boxes");
        assert!(unknown * 20 <= proved, "{unknown} not proved, {proved} proved");
    }

    /// Random motions with a separation: without a hit the features stay apart, with a hit they are close at
    /// its time.
    #[test]
    fn separation_is_kept() {
        let (mut hits, mut capped, rng) = (0, 0, &mut Rng::new(303));
        for query in motions(304, COUNT) {
            let query = kit::rounded(&query);
            let (separation, tolerance) = (f64::from(rng.magnitude(1e-5, 1e-1) as f32), 1e-4);
            let time = kit::time_of_impact(&query, separation, tolerance);
            let apart = |x: &_| distance(query.pair, x);
            if apart(&query.start) <= separation {
                assert_eq!(time, Some(0.0), "starts within {separation:e}: {query}");
                continue;
            }
            let least = least_distance(&query, time.unwrap_or(1.0), apart);
            assert!(least > separation, "{least:e} apart before {time:?}, separation {separation:e}: {query}");
            let Some(time) = time else { continue };
            hits += 1;
            let apart = apart(&query.at(time));
            let close = apart <= reach(&query, separation, tolerance) + 1e-6 * query.size();
            let tired = kit::distances(&query, separation, tolerance) == MOST_ADVANCES;
            assert!(close || tired, "{apart:e} apart at {time}, separation {separation:e}: {query}");
            capped += usize::from(!close);
        }
        println!("separation: {hits} of {COUNT} hit, {capped} at the limit of advances");
        assert!(capped * 100 <= hits, "{capped} of {hits} hits are where nothing is close");
    }

    /// Random motions without separation, compared with the exact decision.
    #[test]
    fn random_contacts_are_found() {
        let (mut touching, mut hits) = (0, 0);
        for query in motions(305, COUNT / 4) {
            let query = kit::rounded(&query);
            let (touches, hit) = (exact::touch(&query), kit::time_of_impact(&query, 0.0, 0.0).is_some());
            assert!(hit || !touches, "missed {query}");
            touching += usize::from(touches);
            hits += usize::from(hit);
        }
        println!("random: {touching} of {} touch, {hits} hit", COUNT / 4);
        assert!(hits <= touching + COUNT / 200, "{hits} hits, {touching} touch");
    }

    /// The lattice's contacts are real contacts.
    #[test]
    fn made_contacts_are_contacts() {
        for contact in contacts(306, 1000) {
            let single = harness::kit::single::rounded(&contact.query);
            assert_eq!(single.start, contact.query.start, "not exact in f32");
            assert_eq!(single.end, contact.query.end, "not exact in f32");
            assert!(exact::touch(&contact.query), "{}", contact.query);
        }
    }

    #[test]
    fn order_and_direction_lose_no_contact() {
        for contact in contacts(307, COUNT / 4) {
            let query = &contact.query;
            let finds = |query: &Query| kit::time_of_impact(query, 0.0, 0.0).is_some();
            for &order in query.orders() {
                assert!(finds(&query.reordered(order)), "missed in order {order:?}: {query}");
            }
            let back = Query { pair: query.pair, start: query.end, end: query.start };
            assert!(finds(&back), "missed backwards: {query}");
            let halves = [query.between(0.0, 0.5), query.between(0.5, 1.0)];
            assert!(halves.iter().any(finds), "missed in both halves: {query}");
        }
    }

    /// Differences of positions are exact, and so is scaling by a power of two: the time has the same bits.
    #[test]
    fn place_and_scale_change_nothing() {
        let (rng, tolerance) = (&mut Rng::new(308), 2f64.powi(-12));
        for i in 0..COUNT / 4 {
            let query = crate::lattice::contact(rng, PAIRS[i % 2]).query;
            let separation = if i % 3 == 0 { 0.0 } else { tolerance * 4.0 };
            let time = kit::time_of_impact(&query, separation, tolerance);
            let (far, scale) = (crate::lattice::far(rng), 2f64.powi((rng.bits() % 21) as i32 - 10));
            let moved = kit::time_of_impact(&query.map(|x| x + far), separation, tolerance);
            assert_eq!(moved, time, "translated by {far}: {query}");
            let scaled = kit::time_of_impact(&query.map(|x| x * scale), separation * scale, tolerance * scale);
            assert_eq!(scaled, time, "scaled by {scale}: {query}");
        }
    }

    #[test]
    fn rest_is_a_hit_only_within_the_separation() {
        for contact in contacts(309, 1000) {
            let query = contact.query.between(0.0, 0.0);
            let (apart, size) = (distance(query.pair, &query.start), query.size());
            assert_eq!(kit::time_of_impact(&query, apart, 0.0), Some(0.0), "{query}");
            if apart > 0.01 * size {
                assert_eq!(kit::time_of_impact(&query, 0.99 * apart, size), None, "{query}");
            }
        }
    }

    /// The vertex approaches the triangle by less than the rounding of its displacement.
    #[test]
    fn nothing_is_missed_that_moves_far_together() {
        let surface = SurfaceColumns::build(4, &[[1, 2, 3]], &[]);
        let (gap, far) = (1e-3, kit::bound(1e5, 1e14));
        let start = [DVec3::new(0.2, gap, 0.2), DVec3::ZERO, DVec3::X, DVec3::Z];
        let [start, end] = [start, start.map(|x| DVec3::new(x.x, far, x.z))].map(|x| kit::narrow(&x));
        let motion = LinearMotion {
            start: &start, end: &end,
            radii: &[0.0; 4], rounds: &[], round: 0,
        };
        let (distances, mut found) = ([gap as Real], [TimeOfImpact::Never.into()]);
        times::<VertexTriangle>(&[[0, 0]], &distances, &surface.view(), motion, 0.0, &mut found, &Serial);
        let found = TimeOfImpact::from(found[0]);
        assert_ne!(found, TimeOfImpact::Never, "features that end in one plane collide");
    }

    #[test]
    fn a_stored_time_is_the_same_when_it_is_read() {
        let times = [0.0, Real::MIN_POSITIVE, 0.5, 1.0 - Real::EPSILON, 1.0].map(TimeOfImpact::At);
        for time in times.into_iter().chain([TimeOfImpact::Never, TimeOfImpact::Touching]) {
            assert_eq!(TimeOfImpact::from(StoredTime::from(time)), time);
        }
    }

    #[test]
    fn what_is_not_finite_is_hit_at_once() {
        let query = contacts(310, 1).next().expect("one").query;
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, kit::bound(1e30, 1e300)] {
            for place in 0..24 {
                for pair in PAIRS {
                    let mut bad = Query { pair, ..query.clone() };
                    let (vertex, axis) = (place / 3 % 4, place % 3);
                    if place < 12 { bad.start[vertex][axis] = value } else { bad.end[vertex][axis] = value }
                    assert_eq!(kit::time_of_impact(&bad, 0.0, 1e-6), Some(0.0), "{bad}");
                }
            }
        }
        assert_eq!(kit::time_of_impact(&query, f64::NAN, 1e-6), Some(0.0));
    }
}
