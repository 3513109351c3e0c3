//! Cooks the scenes, and takes their steps on this machine: the firmware must reach the same states. `SCENE` names another
//! scene for the firmware `cortex-m`, from this folder, `STEPS` another number of steps, and `LEAN=1` saves memory.

#[path = "src/ball.rs"]
mod ball;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use ball::Ball;
use muslin_core::cooked::{Room, cook};
use muslin_core::diagnostics::StateHash;
use muslin_core::simulation::Simulation;

fn main() {
    println!("cargo::rerun-if-env-changed=SCENE");
    println!("cargo::rerun-if-env-changed=STEPS");
    println!("cargo::rerun-if-env-changed=LEAN");
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-changed=src/ball.rs");
    let steps = env::var("STEPS").map_or(40, |steps| steps.parse().expect("STEPS is a number"));
    let scene = env::var("SCENE").unwrap_or_else(|_| "scene.toml".into());
    let room = Room { is_lean: env::var_os("LEAN").is_some(), ..Room::default() };
    write("cloth", &scene, room, steps, |_, _| ());
    let mut ball = Ball::new();
    write("driven", "scene.toml", Room { hands: 1, ..Room::default() }, 40, |cloth, step| {
        let seconds = cloth.step_length().into();
        ball.lead(cloth, step, seconds).expect("it can be obeyed");
        ball.go_on(seconds);
    });
    fs::copy("memory.x", out("memory.x")).expect("it can be copied");
    println!("cargo::rustc-link-search={}", out("").display());
}

/// Cooks a scene with the room that its steps need, and writes the hashes of its states; `lead` makes calls before each step.
fn write(name: &str, scene: &str, room: Room, steps: usize, mut lead: impl FnMut(&mut Simulation, usize)) {
    println!("cargo::rerun-if-changed={scene}");
    let text = fs::read_to_string(scene).unwrap_or_else(|error| panic!("{scene}: {error}"));
    let desc = toml::from_str(&text).unwrap_or_else(|error| panic!("{scene}: {error}"));
    let start = Simulation::new(&desc, &[]).unwrap_or_else(|error| panic!("{scene}: {error}"));
    let mut sim = start.clone();
    sim.measure_room(room.is_lean);
    let (mut hash, mut hashes) = (StateHash::default(), String::new());
    for step in 0..=steps {
        if step > 0 {
            lead(&mut sim, step - 1);
            sim.take_step().unwrap_or_else(|error| panic!("{scene}: {error}"));
        }
        hash.add(sim.positions(), sim.velocities());
        write!(hashes, "{:#018x}, ", hash.0).expect("a string takes all text");
    }
    let [pairs, contacts] = sim.room();
    let block = cook(&start, Room { pairs, contacts, ..room });
    fs::write(out(&format!("{name}.bin")), &block).expect("it can be written");
    let table = format!("static HASHES: [u64; {steps} + 1] = [{hashes}];\n");
    fs::write(out(&format!("{name}.rs")), table).expect("it can be written");
}

/// A file in the folder of the build.
fn out(name: &str) -> PathBuf {
    Path::new(&env::var_os("OUT_DIR").expect("cargo sets it")).join(name)
}
