//! The readers of all files that a stranger may have written, from bytes. The fuzzer calls them; commands read files.

use std::path::Path;

use muslin_core::mesh::TriMesh;
use muslin_core::scene::{PointCache, SceneDesc};

use crate::args::Precision;
use crate::checkpoint::{self, Checkpoint};
use crate::engine::{self, Engine};
use crate::pool::Pool;
use crate::record::{self, Record};
use crate::stopwatch::Stopwatch;
use crate::study::sweep::Sweep;
use crate::{mesh_io, scene_file};

/// A mesh in the format OBJ.
pub fn obj(bytes: &[u8]) -> Result<TriMesh, String> {
    mesh_io::parse_obj(bytes).map_err(|error| error.to_string())
}

/// A mesh in the format PLY.
pub fn ply(bytes: &[u8]) -> Result<TriMesh, String> {
    mesh_io::parse_ply(bytes).map_err(|error| error.to_string())
}

/// A point cache in the format PC2.
pub fn pc2(bytes: &[u8]) -> Result<PointCache, String> {
    mesh_io::pc2::parse(bytes).map_err(|error| error.to_string())
}

/// A scene that names no files.
pub fn scene(text: &str) -> Result<SceneDesc, String> {
    scene_file::from_text("scene", text.to_owned()).map(|scene| scene.desc).map_err(|failure| failure.to_string())
}

/// A sweep; the number of its runs.
pub fn sweep(text: &str) -> Result<usize, String> {
    let read = Sweep::parse("sweep".to_owned(), text.to_owned(), Path::new(".")).and_then(|sweep| sweep.count());
    read.map_err(|failure| failure.to_string())
}

/// A checkpoint, from which a simulation of a scene goes on by one step. `bytes` lack the checksum at the end of the file.
pub fn checkpoint(scene: &str, bytes: &[u8]) -> Result<(), String> {
    let whole = [bytes, &crc32fast::hash(bytes).to_le_bytes()].concat();
    let found = checkpoint::decode(&whole).map_err(|error| error.to_string())?;
    let mut engine = start(scene)?;
    if !engine.restore(&found.snapshot) {
        return Err("it belongs to another scene".to_owned());
    }
    let pool = Pool::new(Some(1)).map_err(|error| error.to_string())?;
    engine.step(&Stopwatch::new(&pool)).map_err(|_| "the step failed".to_owned())
}

/// The bytes of a checkpoint at the start of a scene, without the checksum at the end.
pub fn write_checkpoint(scene: &str) -> Result<Vec<u8>, String> {
    let snapshot = start(scene)?.snapshot();
    let record = Record::decode([0; record::WORDS]);
    let precision = Precision::F32;
    let checkpoint = Checkpoint { precision, scene: 0, chain: 0, record, snapshot, impulses: Vec::new() };
    let mut bytes = checkpoint::encode(&checkpoint);
    bytes.truncate(bytes.len() - size_of::<u32>());
    Ok(bytes)
}

fn start(scene: &str) -> Result<Box<dyn Engine>, String> {
    let scene = scene_file::from_text("scene", scene.to_owned()).map_err(|failure| failure.to_string())?;
    engine::build(&scene, Precision::F32).map(|(engine, _)| engine)
}
