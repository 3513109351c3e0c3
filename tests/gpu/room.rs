//! A reused detector finds the same pairs as a new one, also after a detection that exceeded its capacity.

use glam::DVec3;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::real::Vec3;
use muslin_gpu::{DetectionError, DetectionQuery, DetectionResult, Detector};

use super::methods::{columns, gpu};
use harness::case::Case;

/// Triangles on top of one another, or `spread` apart: so many that their candidates are too large for a buffer.
fn soup(spread: f64) -> Case {
    layers(2200, 2200, spread, 0.0)
}

/// `count` triangles one above the other: `close` of them at the distance `spread`, the others farther apart; boxes are
/// enlarged by `inflation`.
fn layers(count: u32, close: u32, spread: f64, inflation: f64) -> Case {
    let corner = |i: u32| DVec3::splat(spread * f64::from(i.min(close)) + 2.0 * f64::from(i.saturating_sub(close)));
    let corners: Vec<_> = (0..count).map(|i| [corner(i), corner(i) + DVec3::X, corner(i) + DVec3::Y]).collect();
    Case::soup("", &corners, inflation)
}

#[test]
#[ignore = "takes a graphics driver"]
fn what_had_no_room_spoils_nothing_after_it() {
    let Some(gpu) = gpu() else { return };
    let [(dense, surface), (sparse, _)] = [0.0, 2.0].map(|spread| columns(&soup(spread)));
    let (start, radii) = (vec![Vec3::ZERO; dense.len()], vec![0.0; dense.len()]);
    let detector = || Detector::new(gpu, &surface.view(), &radii, DetectionQuery::Candidates).unwrap();
    let detect = |detector: &mut Detector, boxes: &[Aabb]| {
        let mut found = DetectionResult::default();
        pollster::block_on(detector.detect(gpu, boxes, &start, &start, &mut found)).map(|()| found)
    };
    let (mut used, expected) = (detector(), detect(&mut detector(), &sparse).unwrap());
    for boxes in [&dense[..], &dense[..9]] {
        let failed = detect(&mut used, boxes);
        assert!(matches!(failed, Err(DetectionError::TooLarge(_) | DetectionError::Lengths { .. })), "{failed:?}");
        assert!(detect(&mut used, &sparse).unwrap() == expected, "after {failed:?} something else is found");
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn a_detector_finds_what_a_fresh_one_does() {
    let Some(gpu) = gpu() else { return };
    // Apart; then more pairs of edges than the initial readback capacity, other kinds unchanged; then more pairs of
    // every kind.
    let cases = [(0, 0.38), (150, 0.38), (1750, 0.15), (0, 0.38), (1750, 0.38), (1750, 0.38)];
    let cases = cases.map(|(close, spread)| layers(1750, close, spread, 0.2));
    let radii = vec![0.0; cases[0].boxes.len()];
    let reaches = [[0.1, 0.02], [0.1, 0.02], [0.3, 0.01], [0.8, 0.01], [0.8, 0.01], [0.8, 0.04]];
    for query in [DetectionQuery::Candidates, DetectionQuery::Contacts, DetectionQuery::Times] {
        let fresh = || Detector::new(gpu, &columns(&cases[0]).1.view(), &radii, query).unwrap();
        let (mut used, mut most) = (fresh(), [0; 2]);
        for (case, [reach, separation]) in cases.iter().zip(reaches) {
            let (boxes, _) = columns(case);
            let [start, end] = [1.0, -1.0].map(|part| boxes.iter().map(|b| part * b.min).collect::<Vec<_>>());
            let [found, expected] = [&mut used, &mut fresh()].map(|detector| {
                let mut found = DetectionResult::default();
                detector.set_distances(gpu, reach, separation);
                pollster::block_on(detector.detect(gpu, &boxes, &start, &end, &mut found)).unwrap();
                found
            });
            assert!(found == expected, "{query:?}: {:?} candidates, {:?}", found.candidates, expected.candidates);
            most = [0, 1].map(|k| most[k].max(found.candidates[k]));
        }
        assert!(most.iter().all(|&most| most > 1500), "{query:?}: {most:?} candidates at most say little");
    }
}
