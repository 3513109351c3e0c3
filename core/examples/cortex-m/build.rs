//! Cooks the scene, and takes its steps on this machine: the firmware must reach the same states.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use muslin_core::cooked::{Room, cook, required_bytes};
use muslin_core::diagnostics::StateHash;
use muslin_core::dispatch::Serial;
use muslin_core::scene::SceneDesc;
use muslin_core::simulation::Simulation;

const STEPS: usize = 40;

fn main() {
    println!("cargo::rerun-if-changed=scene.toml");
    println!("cargo::rerun-if-changed=memory.x");
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let out = Path::new(&out);
    let desc: SceneDesc = toml::from_str(&fs::read_to_string("scene.toml").expect("it is there")).expect("a scene");
    let start = Simulation::new(&desc, &[]).expect("it builds");
    let mut sim = start.clone();
    sim.measure_room(false);
    let (mut hash, mut hashes) = (StateHash::default(), String::new());
    for _ in 0..STEPS {
        sim.step(&Serial).expect("it steps");
        hash.add(sim.positions(), sim.velocities());
        write!(hashes, "{:#018x}, ", hash.0).expect("a string takes all text");
    }
    let [pairs, contacts] = sim.room();
    let block = cook(&start, Room { pairs, contacts, ..Room::default() });
    let memory = required_bytes(&block).expect("it is cooked");
    fs::write(out.join("cloth.bin"), &block).expect("it can be written");
    let table = format!(
        "/// Memory, bytes.\nconst MEMORY: usize = {memory};\n/// The states.\nconst HASHES: [u64; {STEPS}] = [{hashes}];\n"
    );
    fs::write(out.join("expected.rs"), table).expect("it can be written");
    fs::copy("memory.x", out.join("memory.x")).expect("it can be copied");
    println!("cargo::rustc-link-search={}", out.display());
}
