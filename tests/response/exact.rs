//! What is too near for a time of impact is left to the exact test of the step's end: what passes through
//! then and did not before is refused, whatever else comes free in the same step.
//!
//! Run: `cargo test --release -p muslin-tests --test response exact`.

use harness::both_precisions;

const HEAD: &str = r#"
    name = "exact"
    duration = 1.0
    frame_rate = 200
    [contact]
    thickness = 0.02
    [[collider]]
    shape = "mesh"
    file = "plate"
    [integrator]
    step = 0.005
"#;

both_precisions! {
    use super::HEAD;
    use glam::DVec3;
    use muslin::dispatch::Serial;
    use muslin::mesh::TriMesh;
    use muslin::scene::{Content, Resource};
    use muslin::simulation::{Cause, StepError, Simulation};
    use harness::pieces::Piece;

    /// Below this distance rounding hides what happens: a part of the thickness.
    const NEAR: f64 = 2e-6;

    /// A large square at y = 0, and a triangle on its point at y = 0.
    fn meshes() -> [Resource; 2] {
        let mesh = |positions: &[[f64; 3]], triangles: &[[u32; 3]]| {
            let (positions, triangles) = (positions.to_vec(), triangles.to_vec());
            Content::Mesh(TriMesh { positions, triangles, ..TriMesh::default() })
        };
        let plate = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
        let needle = [[0.0, 0.0, 0.0], [0.1, 0.3, 0.0], [0.0, 0.3, 0.1]];
        [
            ("plate".into(), mesh(&plate, &[[0, 2, 1], [0, 3, 2]])),
            ("needle".into(), mesh(&needle, &[[0, 1, 2]])),
        ]
    }

    /// A needle on the plate or above it, held and led up or down by so much in a step, m.
    fn needle(x: f64, height: f64, by: f64) -> String {
        format!(
            "[[cloth]]\nmesh = \"needle\"\nposition = [{x:?}, {height:?}, 0.25]\ndensity = 0.2\n\
             stretch = {{ model = \"membrane\", stiffness = 100.0 }}\n\
             pin = [{{ select = {{ vertices = [0, 1, 2] }}, motion = {{ keys = [[0, 0, 0, 0], [0.005, 0, {by:?}, 0]] }} }}]\n"
        )
    }

    /// A step of needles: crossings before and after it, and why it was refused.
    fn step(needles: &[String]) -> (Simulation, [usize; 2], Result<(), StepError>) {
        let mut sim = kit::simulation(&format!("{HEAD}{}", needles.concat()), &meshes());
        let before = sim.crossings(&Serial);
        let taken = sim.take_step();
        let crossings = [before, sim.crossings(&Serial)];
        (sim, crossings, taken)
    }

    #[test]
    fn a_new_crossing_is_refused_although_another_vanishes() {
        let falls = needle(-0.5, 0.4 * NEAR, -0.8 * NEAR);
        let rises = needle(0.5, 0.0, 0.8 * NEAR);
        let (sim, crossings, taken) = step(std::slice::from_ref(&rises));
        assert!(taken.is_ok() && crossings == [2, 0], "{}: {taken:?}, {crossings:?} crossings", muslin::real::NAME);
        assert!(sim.contact_statistics().touching > 0, "nothing touched, choose a start nearer");
        for needles in [vec![falls.clone()], vec![falls, rises]] {
            let (_, crossings, taken) = step(&needles);
            let what = format!("{}, {} needles: {taken:?}, {crossings:?} crossings", muslin::real::NAME, needles.len());
            let cause = taken.expect_err(&what).cause;
            assert_eq!(cause, Cause::Contact { collider: Some(0), pinned: true }, "{what}");
            assert_eq!(crossings[0], crossings[1], "{what}: refused, and the state is not that before");
        }
    }

    /// Who drives the phases of a step by hand must know it too.
    #[test]
    fn the_response_says_where_only_an_exact_test_decides() {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let piece = |start: Vec<DVec3>| Piece { moves: vec![DVec3::ZERO; start.len()], masses: vec![1.0; start.len()], start };
        let outcome = |height: f64| {
            let ground = piece(vec![corner(-1.0, 0.0, -1.0), corner(1.0, 0.0, -1.0), corner(0.0, 0.0, 1.0)]);
            let above = piece(vec![corner(0.0, height, 0.0)]);
            kit::respond(&[ground, above], 0.02, 0.0).outcome
        };
        assert_eq!(outcome(10.0 * NEAR), "Free");
        assert_eq!(outcome(0.4 * NEAR), "Touches");
    }
}
