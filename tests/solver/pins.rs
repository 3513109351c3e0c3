//! Held axes: exactly on their prescribed path after every step of every method, in position and velocity,
//! while the other axes are free.

use glam::{DMat3, DVec3};
use harness::kit::double as kit;
use harness::net::{converged, linearised};
use harness::worst::Worst;
use muslin_core_f64::integrate::{Method, Scheme};
use muslin_core_f64::live::Live as _;
use muslin_core_f64::simulation::Simulation;

const STEP: f64 = 0.001;
const STEPS: u32 = 120;
/// Axis of the turn about the centre of the selection.
const AXIS: DVec3 = DVec3::new(1.0, 2.0, 0.5);
const RATE: f64 = 4.0;
/// No step ends at a key or at the end of the turn, where the velocity jumps.
const UNTIL: f64 = 0.0675;
const KEYS: [(f64, DVec3); 3] =
    [(0.0215, DVec3::ZERO), (0.0535, DVec3::new(0.01, -0.03, 0.02)), (0.0915, DVec3::new(-0.02, 0.0, 0.02))];

fn sheet(scheme: Scheme) -> Simulation {
    let keys: Vec<_> = KEYS.iter().map(|(t, x)| format!("[{t}, {}, {}, {}]", x.x, x.y, x.z)).collect();
    let keys = keys.join(", ");
    let built = kit::build(&format!(
        r#"
        name = "pins"
        duration = 1.0
        gravity = [1.0, -9.81, 2.0]
        [[cloth]]
        grid = {{ size = [0.4, 0.4], cells = [4, 4], pattern = "diagonal" }}
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 20.0, damping = 0.004 }}
        shear = {{ stiffness = 8.0, damping = 0.004 }}
        bend = {{ model = "hinge", rigidity = 1e-5, damping = 0.004 }}
        pin = [
            {{ select = {{ corners = [0] }} }},
            {{ select = {{ corners = [1] }}, axes = "xz" }},
            {{ select = {{ vertices = [9, 14] }}, axes = "y", motion = {{ keys = [{keys}] }} }},
            {{ select = {{ corners = [2, 3] }}, motion = {{ keys = [{keys}], turn = {{ axis = [{}, {}, {}], rate = {RATE}, until = {UNTIL} }} }} }}]"#,
        AXIS.x, AXIS.y, AXIS.z
    ));
    Simulation::from_columns(built, scheme, STEP)
}

/// Offset and rate of the keys.
fn keyed(t: f64) -> (DVec3, DVec3) {
    let span = |k: usize| {
        let ((t0, x0), (t1, x1)) = (KEYS[k], KEYS[k + 1]);
        (x0 + (x1 - x0) * ((t - t0) / (t1 - t0)), (x1 - x0) / (t1 - t0))
    };
    match t {
        t if t < KEYS[0].0 => (KEYS[0].1, DVec3::ZERO),
        t if t < KEYS[1].0 => span(0),
        t if t < KEYS[2].0 => span(1),
        _ => (KEYS[2].1, DVec3::ZERO),
    }
}

/// Position and velocity of a turning point.
fn turned(at: DVec3, centre: DVec3, t: f64) -> (DVec3, DVec3) {
    let axis = AXIS.normalize();
    let arm = DMat3::from_axis_angle(axis, RATE * t.min(UNTIL)) * (at - centre);
    (centre + arm, if t < UNTIL { axis.cross(arm) * RATE } else { DVec3::ZERO })
}

#[test]
fn held_axes_follow_their_path_exactly() {
    let schemes = Method::ALL.into_iter().flat_map(|method| [linearised(method), converged(method, 1e-8)]);
    for scheme in schemes {
        let mut sim = sheet(scheme);
        let start = sim.positions().to_vec();
        let corners = [4, 20, 24].map(|i| start[i]);
        let centre = (corners[1] + corners[2]) / 2.0;
        let what = format!("{}, newton = {}: held axes against their path", scheme.method.name(), scheme.newton);
        let mut worst = Worst::new(what, 1e-13);
        for n in 1..=STEPS {
            sim.take_step().expect("finite");
            let t = f64::from(n) * STEP;
            let (offset, rate) = keyed(t);
            let mut see = |vertex: usize, axes: &[usize], (x, v): (DVec3, DVec3)| {
                for &axis in axes {
                    let place = || format!("vertex {vertex}, axis {axis}, t {t}");
                    worst.compare(1.0, &[sim.positions()[vertex][axis]], &[x[axis]], place);
                    worst.compare(1.0, &[sim.velocities()[vertex][axis]], &[v[axis]], place);
                }
            };
            see(0, &[0, 1, 2], (start[0], DVec3::ZERO));
            see(4, &[0, 2], (start[4], DVec3::ZERO));
            for i in [9, 14] {
                see(i, &[1], (start[i] + offset, rate));
            }
            for i in [20, 24] {
                let (x, v) = turned(start[i], centre, t);
                see(i, &[0, 1, 2], (x + offset, v + rate));
            }
        }
        worst.check();
        // Exactly: the position of a vertex at rest is unchanged to the last bit.
        assert_eq!(sim.positions()[0], start[0], "{}: a held vertex", scheme.method.name());
        for (vertex, axis) in [(4, 1), (9, 0), (9, 2), (14, 0), (14, 2)] {
            let moved = (sim.positions()[vertex] - start[vertex])[axis];
            assert!(
                moved.abs() > 1e-6,
                "{}: vertex {vertex} is not held along axis {axis}, but moved by {moved}",
                scheme.method.name()
            );
        }
    }
}

/// Takes `steps` steps; after each one the vertex must be at `place`, a function of the fraction of the steps
/// taken.
fn follow(sim: &mut Simulation, vertex: u32, steps: u32, place: impl Fn(f64) -> DVec3) {
    for n in 1..=steps {
        sim.take_step().unwrap();
        let off = (sim.positions()[vertex as usize] - place(f64::from(n) / f64::from(steps))).length();
        assert!(off < 1e-15, "{}: vertex {vertex} is {off} m off after {n} steps", sim.scheme().method.name());
    }
}

#[test]
fn a_hand_leads_exactly_and_lets_go() {
    for scheme in Method::ALL.map(linearised) {
        let mut sim = sheet(scheme);
        // A free vertex, and one that the scene holds.
        for vertex in [12, 0] {
            let grip = sim.positions()[vertex as usize];
            let target = grip + DVec3::new(0.02, 0.01, -0.03);
            assert_eq!(sim.move_to(vertex, grip.into(), 0.0), Ok(()));
            follow(&mut sim, vertex, 10, |_| grip);
            assert_eq!(sim.move_to(vertex, target.into(), 20.0 * STEP), Ok(()));
            follow(&mut sim, vertex, 20, |part| grip + part * (target - grip));
            assert_eq!(sim.velocities()[vertex as usize], DVec3::ZERO, "it has arrived");
            follow(&mut sim, vertex, 10, |_| target);
            assert_eq!(sim.move_to(vertex, grip.into(), 0.0), Ok(()));
            follow(&mut sim, vertex, 1, |_| grip);
            assert!(sim.release(vertex) && !sim.release(vertex));
            (0..20).for_each(|_| sim.take_step().unwrap());
            let moved = (sim.positions()[vertex as usize] - grip).length();
            assert!(moved > 1e-6, "{}: let go, vertex {vertex} moved {moved} m", scheme.method.name());
        }
    }
}

#[test]
fn hands_that_come_and_go_need_no_more_room() {
    let mut sim = sheet(linearised(Method::BackwardEuler));
    let room = |sim: &Simulation| [sim.pins().table.len(), sim.pins().keys.len()];
    let (count, before) = (sim.positions().len() as u32, room(&sim));
    assert!(sim.move_to(count, [0.0; 3], 1.0).is_err() && !sim.release(count) && sim.pins().held().count() < 10);
    let pins: Vec<_> = sim.pins().held().collect();
    for (place, seconds) in [(DVec3::NAN, 1.0), (DVec3::INFINITY, 1.0), (DVec3::ONE, -1.0), (DVec3::ONE, f64::NAN)] {
        assert!(sim.move_to(12, place.into(), seconds).is_err(), "to {place} in {seconds} s");
    }
    assert!(sim.pins().held().eq(pins), "nothing was done");
    for vertex in (0..count).chain(0..count) {
        let moved = [[1.0; 3], [0.0; 3]].map(|place| sim.move_to(vertex, place, 1.0));
        assert!(moved == [Ok(()); 2] && sim.release(vertex));
    }
    assert_eq!(sim.pins().held().count(), 0);
    assert_eq!(room(&sim), [before[0] + 1, before[1] + 3]);
}
