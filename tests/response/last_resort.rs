//! The last resort holds back what nothing else could part, but never what a pin prescribes: held axes end
//! where they were to end.
//!
//! Run: `cargo test --release -p muslin-tests --test response last_resort`.

use glam::DVec3;
use harness::both_precisions;
use harness::pieces::Piece;

/// m.
const THICKNESS: f64 = 1e-3;

/// A wall, a point above it and a plate above that, which comes down on both; its corners move aside by different ways.
fn pressed() -> Vec<Piece> {
    let triangle = |y: f64, moves: [DVec3; 3], mass: f64| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
        let start = corners.map(|[x, z]| DVec3::new(x, y, z)).to_vec();
        Piece { start, moves: moves.to_vec(), masses: vec![mass; 3] }
    };
    let spacing = 4.0 * THICKNESS;
    let light = Piece { start: vec![DVec3::Y * spacing], moves: vec![DVec3::ZERO], masses: vec![1e-9] };
    let plate = triangle(2.0 * spacing, [0.125, 0.25, 0.0625].map(|x| DVec3::new(x, -3.0 * spacing, 0.0)), 1.0);
    vec![triangle(0.0, [DVec3::ZERO; 3], f64::INFINITY), light, plate]
}

/// The corners of the plate.
const PLATE: [usize; 3] = [4, 5, 6];

both_precisions! {
    use super::{PLATE, THICKNESS, pressed};

    #[test]
    fn held_axes_are_not_held_back() {
        for held in [vec![], PLATE.map(|corner| (corner, 0)).to_vec(), vec![(PLATE[1], 0), (PLATE[1], 2)]] {
            let response = kit::respond_at_last(&pressed(), THICKNESS, &held);
            let what = format!("{} {held:?}: {}", muslin::real::NAME, response.outcome);
            assert!(response.outcome == "Free" && response.failsafe == 1, "{what}: the last resort was not needed");
            for &(vertex, axis) in &held {
                let [end, wanted] = [&response.end, &response.predicted].map(|column| column[vertex][axis]);
                assert_eq!(end, wanted, "{what}: axis {axis} of vertex {vertex} is held and did not end there");
            }
        }
    }
}
