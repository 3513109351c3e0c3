//! The live interface: what a host changes between steps, and what it reads. A change by the host must give what a scene
//! gives that describes it.
//!
//! Run: `cargo test --release -p muslin-tests --test live`.
#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

use glam::DVec3;
use harness::kit::double as kit;
use muslin_core_f64::simulation::Simulation;

mod both_owners;
mod changes;
mod colliders;
mod forces;
mod pins;
mod query;
mod refusal;
mod snapshot;
mod teleport;
mod two_way;

/// Material of the sheets.
const CLOTH: &str = r#"
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
    shear = { stiffness = 300.0 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
"#;

/// A sheet that hangs at one edge, in steps of 5 ms.
fn hanging(head: &str) -> String {
    format!(
        r#"
        name = "hanging"
        duration = 1.0
        frame_rate = 100
        {head}
        [[cloth]]
        grid = {{ size = [0.4, 0.4], cells = [10, 10] }}
        pin = [{{ select = {{ edge = "left" }} }}]
        {CLOTH}
        "#
    )
}

/// A sheet 2 cm above a ball of 10 cm. Gravity acts, and step and thickness are fixed.
fn ball(motion: &str, more: &str) -> String {
    format!(
        r#"
        name = "ball"
        duration = 1.0
        frame_rate = 100
        gravity = [0, -9.81, 0]
        integrator = {{ step = 0.005, tolerance = 1e-10 }}
        contact = {{ thickness = 0.004, friction = 0.3 }}
        [[collider]]
        shape = "sphere"
        center = [0, -0.12, 0]
        radius = 0.1
        {motion}
        {more}
        [[cloth]]
        grid = {{ size = [0.5, 0.5], cells = [12, 12] }}
        {CLOTH}
        "#
    )
}

/// The largest distance of vertices between two simulations, m.
fn apart(one: &Simulation, other: &Simulation) -> f64 {
    let places = one.places_in_world().zip(other.places_in_world());
    places.map(|(a, b)| DVec3::from(a).distance(b.into())).fold(0.0, f64::max)
}

/// Takes steps; before each one the host acts.
fn lead(sim: &mut Simulation, steps: u32, mut act: impl FnMut(&mut Simulation, u32)) {
    for n in 0..steps {
        act(sim, n);
        sim.take_step().unwrap_or_else(|failed| panic!("step {n}: {failed}"));
    }
}
