//! The default integrator with contact: sheets slide and collide as they should although its solves stop early.
//!
//! Run: `cargo test -p muslin-tests --test response default_integrator`; with `-- --nocapture` it prints the measured
//! values beside the expected ones.

use harness::both_precisions;

/// Gravitational acceleration, m/s^2.
const GRAVITY: f64 = 9.81;

const FLOOR: &str = r#"
    [[collider]]
    shape = "plane"
    point = [0, 0, 0]
    normal = [0, 1, 0]
"#;

/// Cloth of a bending rigidity, N m.
fn cloth(size: [f64; 2], cells: [u32; 2], more: &str, rigidity: f64) -> String {
    format!(
        r#"
        [[cloth]]
        grid = {{ size = {size:?}, cells = {cells:?} }}
        {more}
        stretch = {{ model = "membrane", stiffness = 1000.0, damping = 0.001 }}
        shear = {{ stiffness = 200.0, damping = 0.001 }}
        bend = {{ model = "hinge", rigidity = {rigidity:?}, damping = 0.001 }}
        "#
    )
}

/// A sheet of 0.2 m that lies on a box, which moves.
fn lying(motion: &str) -> String {
    format!(
        "duration = 0.5\nframe_rate = 20\ngravity = [0, -9.81, 0]\n{}[[collider]]\nshape = \"box\"\n\
         center = [0, -0.5, 0]\nhalf = [3, 0.5, 3]\nfriction = 0.3\nmotion = {motion}\n[contact]\nthickness = 0.002\n",
        cloth([0.2, 0.2], [8, 9], "position = [0, 0.0021, 0]\ndensity = 0.2", 1e-4)
    )
}

both_precisions! {
    use super::{FLOOR, GRAVITY, cloth, lying};
    use harness::stiff::STIFF;
    use muslin::real::Sum;

    /// On a slope of 0.5 the upper sheet slides over the lower one, which its friction on the plane holds. A large part
    /// of the residual is that of the weight: beside it the rest of the slide looked small.
    #[test]
    fn a_sheet_slides_over_another_one() {
        let (slope, friction) = (0.5, 0.3);
        let level = GRAVITY / f64::hypot(1.0, slope);
        let text = format!(
            "duration = 0.4\nframe_rate = 20\ngravity = [{:?}, {:?}, 0]\n{}{}{FLOOR}friction = 0.8\n\
             [contact]\nthickness = 0.004\nfriction = {friction:?}\n",
            slope * level,
            -level,
            cloth([0.8, 0.4], [20, 12], "position = [0, 0.00408, 0]\ndensity = 0.2", 1e-5),
            cloth([0.2, 0.2], [8, 9], "position = [-0.2, 0.00816, 0.013]\ndensity = 0.2", 1e-5),
        );
        let mut sim = kit::simulation(&text, &[]);
        kit::run(&mut sim, 0.4, |_| ());
        let expected = 0.2 * 0.2 * 0.2 * (slope - friction) * level * 0.4;
        let part = sim.momentum()[0] / expected;
        println!("the sheets have {part:.3} of their momentum");
        assert!((part - 1.0).abs() < 0.1, "the sheets have {part} of their momentum");
    }

    /// Friction stops at its bound. A preconditioner in which it sticks makes the residual of a stiff sheet look a
    /// million times smaller.
    #[test]
    fn a_stiff_sheet_slows_down_by_friction_alone() {
        for integrator in ["", "[integrator]\nstep = 0.001\n"] {
            let text = format!(
                "duration = 0.2\nframe_rate = 50\ngravity = [0, -9.81, 0]\n{}{FLOOR}friction = 0.3\n\
                 [contact]\nthickness = 0.0001\n{integrator}",
                cloth([0.01, 0.01], [8, 9], "position = [0, 0.000101, 0]\ndensity = 0.2\nvelocity = [1, 0, 0]", 1e-4)
            );
            let mut sim = kit::simulation(&text, &[]);
            kit::run(&mut sim, 0.2, |_| ());
            let mass: f64 = sim.scene().particles.masses.iter().map(|&m| f64::from(m)).sum();
            let (velocity, expected) = (sim.momentum()[0] / mass, 1.0 - 0.3 * GRAVITY * 0.2);
            println!("the sheet has {velocity:.3} m/s, {expected:.3} expected");
            assert!((velocity - expected).abs() < 0.06, "the sheet has {velocity} m/s, not {expected}: {integrator}");
        }
    }

    /// Without friction, by short steps of a sheet of 100 kN/m.
    #[test]
    fn a_stiff_sheet_slides_without_friction() {
        let scene = STIFF.replace("gravity = [0.0, -9.81, 0.0]", "gravity = [4.905, -8.4957, 0.0]");
        let scene = scene.replace("rotation = [30.0, 20.0, 10.0]", "position = [0.0, 0.002, 0.0]");
        let text = format!(
            "{scene}{FLOOR}[contact]\nthickness = 0.002\nfriction = 0.0\n\
             [integrator]\nmethod = \"implicit-midpoint\"\nerror = 0.001\nstep = 1e-4\n"
        );
        let mut sim = kit::simulation(&text, &[]);
        kit::run(&mut sim, 0.1, |_| ());
        let mass: f64 = sim.scene().particles.masses.iter().map(|&m| f64::from(m)).sum();
        let part = sim.momentum()[0] / mass / (4.905 * 0.1);
        println!("the sheet reaches {part:.4} of its velocity");
        assert!((part - 1.0).abs() < 0.01, "the sheet reaches {part} of its velocity");
    }

    /// Gravity along the slope exceeds friction by little: the rests of inexact solves would stop the sheet.
    #[test]
    fn a_sheet_slides_down_a_slope_that_is_hardly_steeper_than_friction() {
        for (size, friction, slope, most) in [(0.2, 0.5, 0.51, 0.02), (2.0, 0.5, 0.51, 0.02), (2.0, 0.0, 0.01, 0.002)] {
            let level = GRAVITY / f64::hypot(1.0, slope);
            let text = format!(
                "duration = 0.5\nframe_rate = 20\ngravity = [{:?}, {:?}, 0]\n{}{FLOOR}friction = {friction:?}\n\
                 [contact]\nthickness = 0.002\n",
                slope * level,
                -level,
                cloth([size, size], [12, 14], "position = [0, 0.00202, 0]\ndensity = 0.2", 1e-5)
            );
            let mut sim = kit::simulation(&text, &[]);
            kit::run(&mut sim, 0.5, |_| ());
            let mass: f64 = sim.scene().particles.masses.iter().map(|&m| f64::from(m)).sum();
            let part = sim.momentum()[0] / mass / ((slope - friction) * level * 0.5);
            println!("{size} m, friction {friction}: {part:.3} of the velocity");
            assert!((part - 1.0).abs() < most, "{part} of the velocity of {size} m on {slope} with friction {friction}");
        }
    }

    /// A light sheet hits a heavy one.
    #[test]
    fn a_collision_keeps_the_momentum() {
        let text = format!(
            "duration = 0.3\nframe_rate = 40\n{}{}[contact]\nthickness = 0.004\n",
            cloth([0.2, 0.2], [10, 12], "density = 0.02\nvelocity = [0, 2, 0]", 1e-4),
            cloth([0.2, 0.2], [8, 9], "position = [0.01, 0.03, 0.007]\ndensity = 10.0", 1e-4),
        );
        let mut sim = kit::simulation(&text, &[]);
        let before: Sum = sim.momentum()[1];
        kit::run(&mut sim, 0.3, |_| ());
        let kept = sim.momentum()[1] / before;
        println!("{kept:.5} of the momentum is kept");
        assert!((kept - 1.0).abs() < 1e-4, "{kept} of the momentum is kept");
    }

    /// By half a turn in each step of a frame: in a step a collider moves straight from its first to its last pose, so
    /// error control takes shorter ones.
    #[test]
    fn a_table_that_turns_fast_spins_the_sheet_on_it() {
        let mut sim = kit::simulation(&lying("{ turn = { axis = [0, 1, 0], rate = 188.4956 } }"), &[]);
        kit::run(&mut sim, 0.2, |_| ());
        let mass: f64 = sim.scene().particles.masses.iter().map(|&m| f64::from(m)).sum();
        // Friction acts at the mean distance of a square from its centre, 0.3826 of its side. Its moment of inertia is
        // that of its mass at 1 / sqrt(6) of the side.
        let expected = 0.3 * GRAVITY * 0.3826 * 6.0 / 0.2 * 0.2;
        let spin = sim.angular_momentum()[1] / (mass * 0.2 * 0.2 / 6.0);
        println!("the sheet spins with {spin:.2} rad/s, {expected:.2} expected");
        assert!((spin / expected - 1.0).abs() < 0.15, "the sheet spins with {spin} rad/s, {expected} expected");
    }

    /// Two loads turn a sheet on ice: solves that stop early must not leave its moment.
    #[test]
    fn a_couple_of_loads_turns_a_sheet_on_ice() {
        for (size, density) in [(0.4, 0.05), (0.3, 0.2)] {
            let force = 0.08 * density * size * size;
            let load = |corner: u32, force: f64| format!("{{ select = {{ corners = [{corner}] }}, force = [{force:?}, 0, 0] }}");
            let more = format!(
                "position = [0, 0.004, 0]\ndensity = {density:?}\nload = [{}, {}]",
                load(0, force),
                load(3, -force)
            );
            let text = format!(
                "duration = 0.5\ngravity = [0, -9.81, 0]\n{}{FLOOR}[contact]\nthickness = 0.004\nfriction = 0.0\n",
                cloth([size, size], [10, 12], &more, 2e-5)
            );
            let mut sim = kit::simulation(&text, &[]);
            kit::run(&mut sim, 0.5, |_| ());
            let part = sim.angular_momentum()[1].abs() / (force * size * 0.5);
            println!("{size} m, {density} kg/m^2: {part:.3} of the angular momentum");
            // It turns by a tenth of a turn, which changes the arm of the forces.
            assert!((part - 1.0).abs() < 0.1, "{part} of the angular momentum of {size} m, {density} kg/m^2");
        }
    }

    /// Cloth of 2 kN/m that is extrapolated along its tangents is stretched, and would resist the torque of friction.
    #[test]
    fn friction_stops_a_rotation() {
        let text = format!(
            "duration = 0.5\ngravity = [0, -9.81, 0]\n{}{FLOOR}friction = 0.2\n[contact]\nthickness = 0.004\n\
             [integrator]\nerror = 0\nstep = 0.016666667\n",
            cloth([0.2, 0.2], [10, 12], "position = [0, 0.004, 0]\ndensity = 0.13\nspin = { axis = [0, 1, 0], rate = 3.0 }", 2e-5)
                .replace("1000.0", "2000.0")
        );
        let mut sim = kit::simulation(&text, &[]);
        let before = sim.angular_momentum()[1];
        kit::run(&mut sim, 0.1, |_| ());
        let (left, deceleration) = (sim.angular_momentum()[1] / before, 0.2 * GRAVITY * 0.3826 * 6.0 / 0.2);
        let expected = 1.0 - deceleration * 0.1 / 3.0;
        println!("{left:.3} of the rotation is left, {expected:.3} expected");
        assert!((left - expected).abs() < 0.06, "{left} of the rotation is left, not {expected}");
    }

    /// A slope between the two coefficients: from rest the static one holds every vertex.
    #[test]
    fn static_friction_holds_a_sheet_on_a_box() {
        for (cells, size) in [([8, 9], 0.3), ([20, 23], 0.3)] {
            let text = format!(
                "duration = 1.0\ngravity = [4, -9.81, 0]\n{}[[collider]]\nshape = \"box\"\ncenter = [0, -0.5, 0]\n\
                 half = [3, 0.5, 3]\n[contact]\nthickness = 0.005\nfriction = {{ static = 0.6, kinetic = 0.2 }}\n",
                cloth([size, size], cells, "position = [0, 0.005, 0]\ndensity = 0.2", 2e-5)
            );
            let mut sim = kit::simulation(&text, &[]);
            let before = kit::places(&sim, 0);
            kit::run(&mut sim, 1.0, |_| ());
            let ways = kit::places(&sim, 0).into_iter().zip(before).map(|(now, before)| (now - before).length());
            let most = ways.fold(0.0, f64::max);
            println!("{cells:?}: moved by {most:.1e} m");
            assert!(most < 1e-3, "{cells:?}: the sheet slides by {most} m");
        }
    }

    /// To and fro within a step of a frame.
    #[test]
    fn a_kick_within_a_step_throws_the_sheet() {
        let kick = "{ keys = [[0.2, 0, 0, 0], [0.208, 0, 0.02, 0], [0.216, 0, 0, 0]] }";
        let mut sim = kit::simulation(&lying(kick), &[]);
        let mut fastest: f64 = 0.0;
        kit::run(&mut sim, 0.3, |sim| fastest = fastest.max(kit::fastest(sim).into()));
        println!("at most {fastest:.3} m/s");
        assert!((2.0..3.0).contains(&fastest), "the sheet moves at {fastest} m/s; the kick has 2.5 m/s");
    }

    /// A corner is pulled aside and back within a step of a frame.
    #[test]
    fn a_jerk_of_a_pin_within_a_step_moves_the_sheet() {
        let pin = "pin = [{ select = { corners = [0] }, motion = { keys = [[0.101, 0, 0, 0], [0.108, 0, 0.02, 0], \
                   [0.115, 0, 0, 0]] } }]";
        let text = format!("duration = 0.2\n{}", cloth([0.2, 0.2], [8, 9], &format!("density = 0.2\n{pin}"), 1e-4));
        let mut sim = kit::simulation(&text, &[]);
        let mut fastest: f64 = 0.0;
        kit::run(&mut sim, 0.2, |sim| fastest = fastest.max(kit::fastest(sim).into()));
        println!("at most {fastest:.3} m/s");
        assert!(fastest > 0.1, "the sheet moves at {fastest} m/s");
    }
}
