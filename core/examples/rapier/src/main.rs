//! A sheet is thrown over a ball, a box and a capsule that slide, roll and fall: rapier3d moves the bodies, Muslin the
//! cloth, and each feels the other. It writes scenes and meshes of some moments, which the command line draws:
//!
//! ```sh
//! cargo run --release -p muslin-example-rapier            # writes out/rapier/moment-1.toml, ...
//! cargo run --release -p muslin-cli -- run out/rapier/moment-3.toml --preview png
//! ```

mod bodies;
mod coupled;

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use bodies::{Body, Shape, pose};
use coupled::{Coupled, STEPS};
use muslin_core::dispatch::Serial;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, Vector};

/// A sheet of 1.6 m, thrown sideways over a floor.
const SHEET: &str = r#"
duration = 0.0041666666
frame_rate = 240
gravity = [0, -9.81, 0]
integrator = { step = 0.004166666666666667 }
contact = { thickness = 0.005, friction = 0.4 }
[[cloth]]
grid = { size = [1.6, 1.6], cells = [40, 40] }
position = [-0.3, 0.75, 0.0]
velocity = [1.5, 0, 0]
density = 0.4
stretch = { model = "membrane", stiffness = 2000.0, damping = 0.002 }
shear = { stiffness = 500.0, damping = 0.002 }
bend = { model = "hinge", rigidity = 5e-5, damping = 0.01 }
"#;

const FLOOR: &str = r#"
[[collider]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
"#;

/// Moments that are written, s.
const MOMENTS: [f64; 6] = [0.05, 0.3, 0.5, 0.7, 1.0, 1.5];

fn bodies() -> [Body; 3] {
    [
        Body {
            shape: Shape::Ball(0.18),
            mass: 1.5,
            place: [-0.5, 0.18, 0.25],
            velocity: [1.2, 0.0, 0.0],
            spin: [0.0, 0.0, -6.0],
        },
        Body {
            shape: Shape::Cuboid([0.15, 0.2, 0.15]),
            mass: 2.0,
            place: [0.25, 0.2, -0.25],
            velocity: [0.0; 3],
            spin: [0.0; 3],
        },
        Body {
            shape: Shape::Capsule(0.18, 0.1),
            mass: 1.0,
            place: [0.3, 0.42, 0.35],
            velocity: [0.0; 3],
            spin: [0.5, 0.0, 1.0],
        },
    ]
}

fn floor() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.insert_collider(
        ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::new(0.0, -0.5, 0.0)).friction(0.4),
        None,
    );
    world
}

/// Writes a moment as a scene that the command line draws.
fn write_moment(coupled: &Coupled, folder: &Path, number: usize) -> io::Result<()> {
    let mut mesh = String::new();
    for [x, y, z] in coupled.cloth.places_in_world() {
        writeln!(mesh, "v {x} {y} {z}").expect("a string takes all text");
    }
    for [a, b, c] in coupled.cloth.triangles() {
        writeln!(mesh, "f {} {} {}", a + 1, b + 1, c + 1).expect("a string takes all text");
    }
    fs::write(folder.join(format!("cloth-{number}.obj")), mesh)?;
    let start = "position = [-0.3, 0.75, 0.0]\nvelocity = [1.5, 0, 0]";
    let mut scene = SHEET.replace(start, &format!("state = \"cloth-{number}.obj\"")) + FLOOR;
    for (body, handle) in &coupled.bodies {
        body.describe(&pose(&coupled.world.bodies[*handle]), &mut scene);
    }
    fs::write(folder.join(format!("moment-{number}.toml")), scene)
}

fn main() -> io::Result<()> {
    let folder = Path::new("out/rapier");
    fs::create_dir_all(folder)?;
    let mut coupled = Coupled::new(floor(), &bodies(), &format!("{SHEET}{FLOOR}"));
    println!("time, s  speeds of ball, box and capsule, m/s  momentum of all, kg m/s  crossings");
    let mut written = 0;
    for n in 1..=(MOMENTS[5] * f64::from(STEPS)) as u32 {
        coupled.step();
        let time = f64::from(n) / f64::from(STEPS);
        if written < MOMENTS.len() && time >= MOMENTS[written] {
            written += 1;
            write_moment(&coupled, folder, written)?;
            let speeds = coupled.bodies.iter().map(|(_, handle)| coupled.world.bodies[*handle].linvel().length());
            let speeds: Vec<_> = speeds.map(|speed| format!("{speed:5.2}")).collect();
            let [linear, _] = coupled.momentum();
            let crossings = coupled.cloth.crossings(&Serial);
            println!("{time:4.2}  {}  {:5.2}  {crossings}", speeds.join("  "), linear.length());
        }
    }
    println!("wrote {0}/moment-1.toml to {0}/moment-{written}.toml", folder.display());
    println!("draw one: cargo run --release -p muslin-cli -- run {}/moment-3.toml --preview png", folder.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Without gravity and floor, bodies that fly into a sheet keep their momentum together with it.
    #[test]
    fn bodies_and_cloth_keep_their_momentum() {
        let scene = SHEET.replace("gravity = [0, -9.81, 0]", "").replace("velocity = [1.5, 0, 0]", "");
        let flying = bodies().map(|body| Body { velocity: [body.velocity[0], 1.5, 0.0], ..body });
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut coupled = Coupled::new(world, &flying, &scene);
        let before = coupled.momentum();
        let mut worst = [0.0_f64; 2];
        for _ in 0..STEPS {
            coupled.step();
            assert_eq!(coupled.cloth.crossings(&Serial), 0);
            for (worst, (now, before)) in worst.iter_mut().zip(coupled.momentum().iter().zip(before)) {
                *worst = worst.max(now.distance(before));
            }
        }
        let mass = 1.6 * 1.6 * 0.4;
        let given = coupled.cloth.momentum();
        assert!(DVec3::from(given).y > 0.2 * mass, "the cloth hardly moves: {given:?} kg m/s");
        println!("lost of {before:?}: {worst:?}");
        let bound = 1e-5 * before[0].length();
        assert!(worst[0] < bound, "{} kg m/s of {} are lost", worst[0], before[0]);
        assert!(worst[1] < 1e-2 * before[0].length(), "{} kg m^2/s of {} are lost", worst[1], before[1]);
    }

    /// The ball rolls under the sheet: this slows it down, and nothing passes through anything.
    #[test]
    fn the_cloth_slows_bodies_down_and_nothing_passes_through() {
        let speed = |coupled: &Coupled| {
            let (_, ball) = coupled.bodies[0];
            coupled.world.bodies[ball].linvel().length()
        };
        let mut with = Coupled::new(floor(), &bodies(), &format!("{SHEET}{FLOOR}"));
        let mut without = floor();
        without.integration_parameters.dt = 1.0 / STEPS as f32;
        let alone: Vec<_> = bodies().iter().map(|body| body.add_to(&mut without)).collect();
        for _ in 0..STEPS {
            with.step();
            without.step();
            assert_eq!(with.cloth.crossings(&Serial), 0);
            let deepest = with.cloth.penetration().expect("there are colliders");
            assert!(deepest < 1e-3, "a vertex is {deepest} m inside a body");
        }
        let [with, without] = [speed(&with), without.bodies[alone[0]].linvel().length()];
        assert!(with < 0.8 * without, "the ball has {with} m/s with the sheet and {without} without");
    }
}
