//! Cooks the scene, and takes its steps on this machine: the firmware must reach the same states. `SCENE` names another
//! scene, from this folder, `STEPS` another number of steps, and `LEAN=1` saves memory.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use muslin_core::cooked::{Room, cook};
use muslin_core::diagnostics::StateHash;
use muslin_core::scene::SceneDesc;
use muslin_core::simulation::Simulation;

fn main() {
    println!("cargo::rerun-if-env-changed=SCENE");
    println!("cargo::rerun-if-env-changed=STEPS");
    println!("cargo::rerun-if-env-changed=LEAN");
    println!("cargo::rerun-if-changed=memory.x");
    let steps = env::var("STEPS").map_or(40, |steps| steps.parse().expect("STEPS is a number"));
    let scene = env::var("SCENE").unwrap_or_else(|_| "scene.toml".into());
    println!("cargo::rerun-if-changed={scene}");
    let is_lean = env::var_os("LEAN").is_some();
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let out = Path::new(&out);
    let desc: SceneDesc = toml::from_str(&fs::read_to_string(scene).expect("it is there")).expect("a scene");
    let start = Simulation::new(&desc, &[]).expect("it builds");
    let mut sim = start.clone();
    sim.measure_room(is_lean);
    let (mut hash, mut hashes) = (StateHash::default(), String::new());
    for step in 0..=steps {
        if step > 0 {
            sim.take_step().expect("it steps");
        }
        hash.add(sim.positions(), sim.velocities());
        write!(hashes, "{:#018x}, ", hash.0).expect("a string takes all text");
    }
    let [pairs, contacts] = sim.room();
    let block = cook(&start, Room { pairs, contacts, is_lean, ..Room::default() });
    fs::write(out.join("cloth.bin"), &block).expect("it can be written");
    let table = format!(
        "/// Of the states at the start and after each step.\nconst HASHES: [u64; {steps} + 1] = [{hashes}];\n"
    );
    fs::write(out.join("expected.rs"), table).expect("it can be written");
    fs::copy("memory.x", out.join("memory.x")).expect("it can be copied");
    println!("cargo::rustc-link-search={}", out.display());
}
