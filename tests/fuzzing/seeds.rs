//! Writes the first inputs of every target to `corpus`: built-in scenes, small meshes, a checkpoint, cooked scenes.
//!
//! `cargo run --release --bin seeds` in this folder.

use std::fs;
use std::path::Path;

use muslin_cli::readers;
use muslin_core::cooked::{Room, cook};
use muslin_core::scene::BUILT_IN;
use muslin_core::simulation::Simulation;

const OBJ: &str = "# a square\nv 0 0 0\nv 1 0 0\nv 1 0 1 \\\n\nv 0 0 1\nvt 0 0\nvt 1 0.5\nf 1/1 2/2 3/1\nf -4 -2 -1\nl 1 2\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment a triangle\nelement vertex 3\nproperty float x\nproperty float y\n\
                   property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n";
const SWEEP: &str = "scene = \"flag\"\nduration = 0.1\nprecision = [\"f32\", \"f64\"]\n[set]\ncloth.density = 0.2\n\
                     [grid]\nintegrator.step = [0.01, 0.005]\n";

fn main() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let put = |target: &str, name: &str, bytes: &[u8]| {
        let folder = corpus.join(target);
        fs::create_dir_all(&folder).expect("it can be made");
        fs::write(folder.join(name), bytes).expect("it can be written");
    };
    put("obj", "square", OBJ.as_bytes());
    put("ply", "ascii", PLY.as_bytes());
    let (head, _) = PLY.split_once("0 0 0").expect("it is there");
    for (format, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
        let mut bytes = head.replace("ascii", format).into_bytes();
        for x in [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0_f32] {
            bytes.extend(if little { x.to_le_bytes() } else { x.to_be_bytes() });
        }
        bytes.push(3);
        for vertex in [0, 1, 2_u32] {
            bytes.extend(if little { vertex.to_le_bytes() } else { vertex.to_be_bytes() });
        }
        put("ply", format, &bytes);
    }
    let mut cache = b"POINTCACHE2\0".to_vec();
    cache.extend([1, 2].map(u32::to_le_bytes).as_flattened());
    cache.extend([0.0, 1.0_f32].map(f32::to_le_bytes).as_flattened());
    cache.extend(2_u32.to_le_bytes());
    cache.extend([0.5_f32; 12].map(f32::to_le_bytes).as_flattened());
    put("pc2", "two", &cache);
    put("sweep", "flag", SWEEP.as_bytes());
    put("checkpoint", "start", &readers::write_checkpoint(include_str!("small.toml")).expect("it is valid"));
    put("live", "calls", &(0..160).map(|n: u32| (n * 97 % 251) as u8).collect::<Vec<_>>());
    for (name, text) in BUILT_IN.iter().filter(|(_, text)| !text.contains("file =")) {
        put("scene", name, text.as_bytes());
        let mut scene = readers::scene(text).expect("it is built in");
        for grid in scene.cloth.iter_mut().filter_map(|cloth| cloth.grid.as_mut()) {
            grid.cells = [4, 4];
        }
        if ["ball", "flag", "twist"].contains(name) {
            let simulation = Simulation::new(&scene, &[]).expect("it builds");
            let room = Room { pairs: 500, contacts: 50, hands: 1, forces: 1, ..Room::default() };
            put("cooked", name, &cook(&simulation, room));
        }
    }
}
