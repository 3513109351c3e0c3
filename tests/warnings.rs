//! The conditions of the core's warnings. The texts that `muslin` prints are tested in `tests/cli`.
//!
//! Run: `cargo test -p muslin-tests --test warnings`.

use harness::kit::single;
use muslin_core::integrate::stability::Mode;
use muslin_core::warning::{self, Code, Start};

/// The warning that masses are lost beside the stiffness knows all that moves cloth. A strip of 20 g may lose 12 % of
/// its masses.
#[test]
fn whatever_moves_the_cloth_can_lose_masses() {
    let warn = |of_scene: &str, cloth: &str, tables: &str| {
        let text = format!(
            "duration = 1.0\n{of_scene}\n[[cloth]]\ngrid = {{ size = [1.0, 0.1], cells = [10, 2] }}\n\
             density = 0.2\n{cloth}\n{tables}"
        );
        let modes = [Mode { stiffness: 2e10, damping: 0.0 }; 2];
        warning::masses(&modes, &single::scene(&text), 1.0, 0.02, 0.01)
    };
    assert_eq!(warn("", "", ""), None, "nothing moves it");
    assert_eq!(warn("", "velocity = [1, 0, 0]", ""), None, "nothing changes its velocity");
    let ball = "[[collider]]\nshape = \"sphere\"\ncenter = [0, -2, 0]\nradius = 1.0\nmotion = ";
    let pin = "pin = [{ select = { edge = \"left\" }";
    let keys = "{ keys = [[0, 0, 0, 0], [1, 0, 1, 0]] }";
    let turn = "{ turn = { axis = [1, 0, 0], rate = 1.0 } }";
    let drivers = [
        ["gravity = [0, -1, 0]", "", ""],
        ["", "spin = { axis = [0, 1, 0], rate = 2.0 }", ""],
        ["", "start = [{ select = { edge = \"left\" }, velocity = [0, 1, 0] }]", ""],
        ["", &format!("velocity = [1, 0, 0]\n{pin}, from = 0.5 }}]"), ""],
        ["", "load = [{ select = { edge = \"left\" }, force = [0, 0, 0.02] }]", ""],
        ["", &format!("{pin}, motion = {keys} }}]"), ""],
        ["", &format!("{pin}, motion = {turn} }}]"), ""],
        ["", "", "[drag]\nwind = { velocity = [0, 2, 0], normal = 0.1 }"],
        ["", "", &format!("{ball}{keys}")],
        ["", "", &format!("{ball}{turn}")],
    ];
    for [of_scene, cloth, tables] in drivers {
        let found = warn(of_scene, cloth, tables);
        assert!(found.is_some_and(|found| !found.is_doubtful), "{of_scene}{cloth}{tables}: {found:?}");
    }
    let far = warn("gravity = [0, -1000, 0]", "", "");
    assert!(far.is_some_and(|far| far.is_doubtful), "all of a long way may be lost: {far:?}");
    let held = warn("gravity = [0, -1000, 0]", &format!("{pin} }}]"), "");
    assert!(held.is_some_and(|held| !held.is_doubtful), "cloth that pins hold goes no long way: {held:?}");
}

/// The rigidity of hinges by the shape of the triangles: the answers of `validate` for vertices that are held on a
/// cylinder, and a warning where they are far from 1.
#[test]
fn triangles_that_bend_too_stiffly_are_warned_of() {
    for (grid, largest, warned) in [
        ("cells = [60, 69], pattern = \"equilateral\"", 1.0, false),
        ("cells = [60, 60], pattern = \"equilateral\"", 1.125, false),
        ("cells = [60, 60], pattern = \"alternating\"", 1.5, false),
        ("cells = [60, 60], pattern = \"diagonal\"", 3.0, true),
        // Along x: l^4 / 2 h^4 + a^4 / 16 h^4 with cells of a, rows of h and l^2 = a^2 / 4 + h^2.
        ("cells = [30, 60], pattern = \"equilateral\"", 3.0, true),
        ("cells = [20, 60], pattern = \"equilateral\"", 10.34, true),
    ] {
        let text = format!(
            "duration = 1.0\n[[cloth]]\ngrid = {{ size = [1.0, 1.0], {grid} }}\ndensity = 0.2\n\
             bend = {{ model = \"hinge\", rigidity = 1e-5 }}"
        );
        let rigidity = single::simulation(&text, &[]).scene().largest_rigidity;
        println!("{grid}: {rigidity:.3}");
        assert!((rigidity / largest - 1.0).abs() < 0.05, "{grid}: {rigidity}, not {largest}");
        let start =
            Start { mean_edge: 0.02, size: 1.0, smallest: 1.0, mass: 0.2, rigidity, deviation: 0.0, is_single: false };
        let warnings = warning::of_settings(&single::scene(&text), &start, || unreachable!());
        let is_warned = warnings.into_iter().flatten().any(|warning| warning.code == Code::Rigidity);
        assert_eq!(is_warned, warned, "{grid}: {warnings:?}");
    }
}

/// Fixed steps do not follow motion within them: a warning where the cloth would feel it. Error control follows it.
#[test]
fn motion_within_a_fixed_step_is_warned_of() {
    let scene = |motion: &str, integrator: &str| {
        format!(
            "duration = 1.0\nframe_rate = 20\n[[cloth]]\ngrid = {{ size = [0.4, 0.2], cells = [4, 2] }}\n\
             position = [0, 0.02, 0]\ndensity = 0.2\nstretch = {{ model = \"spring\", stiffness = 100.0 }}\n\
             [[collider]]\nshape = \"box\"\ncenter = [0, -0.5, 0]\nhalf = [3, 0.5, 3]\nmotion = {motion}\n\
             [contact]\nthickness = 0.01\n[integrator]\n{integrator}\n"
        )
    };
    let fixed = |step: f64| format!("error = 0\nstep = {step:?}");
    let turn = "{ turn = { axis = [0, 1, 0], rate = 10.0 } }";
    let radius = 0.2f64.hypot(0.1);
    for (motion, integrator, expected, doubtful) in [
        // The height of the arc of the corners of the cloth, not of those of the box.
        (turn, fixed(0.05), Some(radius * (1.0 - 0.25f64.cos())), false),
        (turn, fixed(0.01), None, false),
        (turn, "error = 0.001".to_owned(), None, false),
        ("{ turn = { axis = [0, 1, 0], rate = 62.83185 } }", fixed(0.05), Some(radius), true),
        // Cloth that is thrown at 0.4 m/s flies on for 25 ms.
        ("{ keys = [[0.1, 0, 0, 0], [0.125, 0, 0.01, 0]] }", fixed(0.05), Some(0.01), false),
        // A kick of 0.5 m/s for 2 ms that ends 46 ms before the step: the table is back where it was.
        ("{ keys = [[0.1, 0, 0, 0], [0.102, 0, 0.001, 0], [0.104, 0, 0, 0]] }", fixed(0.05), Some(0.025), true),
        // It comes after the end.
        ("{ keys = [[2.1, 0, 0, 0], [2.102, 0, 0.001, 0], [2.104, 0, 0, 0]] }", fixed(0.05), None, false),
        ("{ keys = [[0.1, 0, 0, 0], [0.15, 0, 0.01, 0]] }", fixed(0.05), None, false),
        ("{ keys = [[0.1, 0, 0, 0], [0.12, 0, 0.03, 0], [0.15, 0, 0, 0]] }", fixed(0.05), Some(0.075), true),
        ("{ keys = [[0.1, 0, 0, 0], [0.12, 0, 0.03, 0], [0.15, 0, 0, 0]] }", "method = \"rk4\"".into(), None, false),
    ] {
        let text = scene(motion, &integrator);
        let (desc, sim) = (single::scene(&text), single::simulation(&text, &[]));
        let deviation = sim.scene().largest_deviation(desc.timing().step, desc.duration);
        let start =
            Start { mean_edge: 0.1, size: 0.4, smallest: 0.4, mass: 0.2, rigidity: 0.0, deviation, is_single: false };
        let modes = || [Mode { stiffness: 0.0, damping: 0.0 }; 2];
        let warnings = warning::of_settings(&desc, &start, modes);
        let found = warnings.into_iter().flatten().find(|warning| warning.code == Code::Motion);
        let as_expected = match (found, expected) {
            (Some(found), Some(expected)) => {
                (found.value / expected - 1.0).abs() < 1e-3 && found.is_doubtful == doubtful
            }
            (found, expected) => found.is_none() && expected.is_none(),
        };
        assert!(as_expected, "{motion} by {integrator}: {found:?}, expected {expected:?}");
    }
}

/// An error that is a large part of the cloth.
#[test]
fn a_large_error_for_small_cloth_is_warned_of() {
    let warned = |size: f64, integrator: &str| {
        let text = format!(
            "duration = 1.0\n[[cloth]]\ngrid = {{ size = [{size:?}, {size:?}], cells = [2, 2] }}\ndensity = 0.2\n\
             [integrator]\n{integrator}"
        );
        let start = Start {
            mean_edge: 0.5 * size,
            size: 2.0,
            smallest: size,
            mass: 0.2,
            rigidity: 0.0,
            deviation: 0.0,
            is_single: false,
        };
        let warnings = warning::of_settings(&single::scene(&text), &start, || unreachable!());
        warnings.into_iter().flatten().find(|warning| warning.code == Code::Error).map(|found| found.beside)
    };
    assert_eq!(warned(0.01, ""), Some(1e-4));
    assert_eq!(warned(0.01, "error = 1e-4"), None);
    assert_eq!(warned(0.01, "error = 0"), None);
    assert_eq!(warned(0.2, ""), None);
}

/// A kick of a pin counts while the pin holds, along the axes that it holds.
#[test]
fn only_pins_that_hold_deviate() {
    let deviation = |pin: &str| {
        let text = format!(
            "duration = 1.0\nframe_rate = 20\n[[cloth]]\ngrid = {{ size = [0.4, 0.2], cells = [4, 2] }}\ndensity = 0.2\n\
             pin = [{{ select = {{ corners = [0] }}, {pin}motion = {{ keys = [[0.5, 0, 0, 0], [0.51, 0.01, 0, 0], \
             [0.52, 0, 0, 0]] }} }}]"
        );
        single::simulation(&text, &[]).scene().largest_deviation(0.05, 1.0)
    };
    for (pin, expected) in [
        // 1 m/s for the whole step.
        ("", 0.05),
        ("axes = \"x\", ", 0.05),
        ("axes = \"yz\", ", 0.0),
        ("until = 0.4, ", 0.0),
        ("from = 0.6, ", 0.0),
        ("from = 0.4, until = 0.7, ", 0.05),
    ] {
        let found = deviation(pin);
        assert!((found - expected).abs() < 1e-6, "{pin:?}: {found}, not {expected}");
    }
}

/// The size of the smallest cloth, which an error is compared with.
#[test]
fn the_smallest_cloth_counts() {
    let text = "duration = 1.0\n[[cloth]]\ngrid = { size = [2.0, 1.0], cells = [4, 2] }\ndensity = 0.2\n\
                [[cloth]]\ngrid = { size = [0.01, 0.02], cells = [2, 4] }\nposition = [5, 0, 0]\ndensity = 0.2\n";
    let smallest = single::simulation(text, &[]).scene().smallest_size();
    assert!((smallest - 0.02).abs() < 1e-6, "{smallest}");
}

/// Edges shorter than the thickness, and the mean of all edges is a hundred times as long.
#[test]
fn a_thickness_beyond_short_edges_is_warned_of() {
    let warned = |thickness: f64| {
        let cloth = |size: f64| {
            format!("[[cloth]]\ngrid = {{ size = [{size:?}, {size:?}], cells = [10, 10] }}\ndensity = 0.2\n")
        };
        let sheets = [cloth(1.0), cloth(0.002)].concat();
        let text = format!("duration = 1.0\n{sheets}[contact]\nthickness = {thickness:?}\n");
        let start = Start {
            mean_edge: single::simulation(&text, &[]).scene().mean_edge(),
            size: 1.0,
            smallest: 0.002,
            mass: 0.2,
            rigidity: 0.0,
            deviation: 0.0,
            is_single: false,
        };
        let warnings = warning::of_settings(&single::scene(&text), &start, || unreachable!());
        warnings.into_iter().flatten().any(|warning| warning.code == Code::Thickness)
    };
    assert!(warned(0.001), "five times the short edges");
    assert!(!warned(0.0001), "half of the short edges");
}
