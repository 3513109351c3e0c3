//! Steps so short, or a cloth so far from the origin, that a step moves it by less than the last digit of its position.
//! It falls, follows its pins and rests in single precision as in double.

use glam::DVec3;
use harness::kit::{double, single};
use muslin_core::integrate::Method;

const G: f64 = 9.81;

/// A scene of one sheet at `position`, with more lines for the sheet and for the scene.
fn sheet(position: [f64; 3], method: Method, step: f64, of_cloth: &str, of_scene: &str) -> String {
    format!(
        r#"
        name = "sheet"
        duration = 1.0
        frame_rate = 1
        gravity = [0.0, -{G}, 0.0]
        integrator = {{ method = "{}", step = {step}, error = 0.0 }}
        {of_scene}
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        position = {position:?}
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 100.0, damping = 0.001 }}
        shear = {{ stiffness = 50.0 }}
        bend = {{ model = "hinge", rigidity = 1e-5 }}
        {of_cloth}"#,
        method.name()
    )
}

/// Distance that each method falls in n steps, in units of g h^2 / 2.
fn fallen(method: Method, n: f64) -> f64 {
    match method {
        Method::ExplicitEuler => n * (n - 1.0),
        Method::SymplecticEuler | Method::BackwardEuler => n * (n + 1.0),
        Method::Midpoint | Method::Rk4 | Method::ImplicitMidpoint | Method::Bdf2 => n * n,
    }
}

/// The displacement and the velocity of the centre of a thrown sheet after so many steps, from the place and the
/// velocity of the throw.
fn thrown(text: &str, throw: DVec3, steps: u32) -> [DVec3; 2] {
    let mut sim = single::simulation(text, &[]);
    sim.state_mut().1.fill(throw.as_vec3());
    let centre = |sim: &muslin_core::simulation::Simulation| {
        sim.places_in_world().map(DVec3::from).sum::<DVec3>() / sim.positions().len() as f64
    };
    let start = centre(&sim);
    for _ in 0..steps {
        sim.take_step().expect("finite");
    }
    let velocity = sim.velocities().iter().map(|v| v.as_dvec3()).sum::<DVec3>() / sim.positions().len() as f64;
    [centre(&sim) - start, velocity - throw]
}

#[test]
fn a_sheet_falls_in_steps_below_the_last_digit_and_far_away() {
    let throw = DVec3::new(3.0, 0.0, -2.0);
    for position in [[0.0, 0.75, 0.0], [0.0, 100.0, 0.0], [0.0, 1e3, 0.0], [1e5, 1.0, 0.0]] {
        for step in [1e-6, 1e-5, 1e-4] {
            for method in Method::ALL {
                let (n, place) = (500, format!("{} in steps of {step} s at {position:?}", method.name()));
                let [moved, gained] = thrown(&sheet(position, method, step, "", ""), throw, n);
                let time = f64::from(n) * step;
                let want = throw * time + DVec3::NEG_Y * (0.5 * G * step * step * fallen(method, n.into()));
                // The sum over steps of a part of a micrometre is exact to its seven digits.
                let (fall, drift) = ((moved.y / want.y - 1.0).abs(), (moved.x / want.x - 1.0).abs());
                assert!(fall < 1e-4 && drift < 1e-5, "{place}: moved by {moved}, expected {want}");
                let speed = (gained.y / (-G * time) - 1.0).abs();
                assert!(speed < 1e-3, "{place}: gained {gained} m/s in {time} s");
            }
        }
    }
}

/// The velocities of all vertices after 500 steps of a microsecond, while two corners move at half a metre per second.
macro_rules! pulled {
    ($kit:ident, $core:ident, $method:expr) => {{
        let pin = "pin = [{ select = { corners = [0, 1] }, motion = { keys = [[0, 0, 0, 0], [1, 0.3, 0.4, 0]] } }]";
        let mut sim = $kit::simulation(&sheet([0.0, 0.75, 0.0], $method, 1e-6, pin, ""), &[]);
        for _ in 0..500 {
            sim.take_step().expect("finite");
        }
        sim.velocities().iter().map(|&v| DVec3::from($core::real::to_f64(v))).collect::<Vec<_>>()
    }};
}

#[test]
fn a_sheet_follows_its_pins_in_steps_below_the_last_digit() {
    for method in Method::ALL {
        let exact = muslin_core_f64::integrate::Method::ALL[method as usize];
        let (got, want) = (pulled!(single, muslin_core, method), {
            assert_eq!(exact.name(), method.name());
            pulled!(double, muslin_core_f64, method)
        });
        for (vertex, (got, want)) in got.iter().zip(&want).enumerate() {
            let off = (*got - *want).length();
            assert!(off < 1e-3, "{}: vertex {vertex} moves with {got} m/s, in double with {want} m/s", method.name());
        }
    }
}

/// Rounding errors of positions are no velocity: over a step of a microsecond, the last digit is 0.1 m/s.
#[test]
fn a_sheet_rests_on_a_plane_in_steps_below_the_last_digit() {
    let ground = "contact = { thickness = 0.002, friction = 0.3 }\n\
                  collider = [{ shape = \"plane\", point = [0, 0.748, 0], normal = [0, 1, 0] }]";
    for method in [Method::SymplecticEuler, Method::BackwardEuler, Method::Bdf2] {
        let mut sim = single::simulation(&sheet([0.0, 0.75, 0.0], method, 1e-6, "", ground), &[]);
        let (mut fastest, mut touching) = (0.0, 0);
        for _ in 0..1000 {
            sim.take_step().expect("finite");
            fastest = sim.velocities().iter().map(|v| v.length()).fold(fastest, f32::max);
            touching += usize::from(sim.contact_statistics().proximity > 0);
        }
        // In one step gravity gives 1e-5 m/s.
        assert!(
            fastest < 1e-3 && touching > 500,
            "{}: up to {fastest} m/s at rest, {touching} contacts",
            method.name()
        );
    }
}

/// Contact, too, sees the same numbers at any distance from the origin.
#[test]
fn a_far_scene_goes_through_the_same_bits() {
    let at = |x: f64| {
        let ball = format!(
            "contact = {{ thickness = 0.004, friction = 0.3 }}\n\
             collider = [{{ shape = \"sphere\", center = [{x}, 0.55, 0], radius = 0.15 }},\n\
             {{ shape = \"plane\", point = [0, 0.4, 0], normal = [0, 1, 0] }}]"
        );
        let pin = format!(
            "pin = [{{ select = {{ nearest = [{x}, 0.75, 0] }}, motion = {{ turn = {{ axis = [0, 1, 0], rate = 1 }} }} }}]"
        );
        let mut sim = single::simulation(&sheet([x, 0.75, 0.0], Method::BackwardEuler, 0.005, &pin, &ball), &[]);
        for _ in 0..100 {
            sim.take_step().expect("a step");
        }
        assert!(sim.contact_statistics().proximity > 100, "nothing touches: {:?}", sim.contact_statistics());
        (sim.origin(), sim.positions().to_vec(), sim.velocities().to_vec())
    };
    let [(origin, x, v), (far, far_x, far_v)] = [at(0.0), at(131_072.0)];
    assert_eq!((origin, far), ([0.0; 3], [131_072.0, 0.0, 0.0]));
    assert!(x == far_x && v == far_v, "131 km away, the sheet moves otherwise");
}
