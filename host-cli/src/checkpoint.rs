//! Checkpoints: the saved state of a run, which a later run continues bit for bit.
//!
//! Little-endian layout: magic, version, precision, CRC of the scene, steps, whether contact changed the state, halvings of
//! the substeps, length of the last one, hash chain, counters of work, counters of contact, record of the run, each column
//! after its length, and the CRC of all bytes before. The file is written completely or not at all.

use std::io::Write;
use std::path::Path;

use muslin_core::scene::Content;

use crate::args::Precision;
use crate::engine::{Engine, Snapshot};
use crate::export::whole::{self, WriteError};
use crate::failure::Failure;
use crate::record::{self, Record};
use crate::scene_file::SceneFile;

const MAGIC: &[u8; 8] = b"MUSLINCP";
const VERSION: u32 = 8;

/// The contents of a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Precision of the columns.
    pub precision: Precision,
    /// [`scene_crc`] of the scene that was run.
    pub scene: u32,
    /// The hash chain over the first state and all steps.
    pub chain: u64,
    /// Observations of the run up to the checkpoint.
    pub record: Record,
    /// The state.
    pub snapshot: Snapshot,
}

/// The state, besides the engine, that a resumed run continues from.
#[derive(Clone, Copy, Debug)]
pub struct Resumed {
    /// The hash chain up to the checkpoint.
    pub chain: u64,
    /// Observations of the run up to the checkpoint.
    pub record: Record,
}

/// Why a checkpoint cannot be resumed.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file could not be read.
    #[error("cannot read checkpoint: {0}")]
    Read(#[from] std::io::Error),
    /// Not a checkpoint.
    #[error("this is not a checkpoint of muslin")]
    Foreign,
    /// Written by another version.
    #[error(
        "this checkpoint has format {found}, this version of muslin reads format {VERSION}; run the scene from its start"
    )]
    Version {
        /// Format of the file.
        found: u32,
    },
    /// Truncated or altered.
    #[error("this checkpoint is damaged (its checksum is wrong); use an older one or run the scene from its start")]
    Damaged,
}

/// Writes a checkpoint atomically.
pub fn write(path: &Path, checkpoint: &Checkpoint) -> Result<(), WriteError> {
    let bytes = encode(checkpoint);
    let written = whole::write(path.into(), |file| {
        file.write_all(&bytes)?;
        file.flush()?;
        file.get_ref().sync_all()
    });
    written.map(|_| ())
}

/// Reads a checkpoint back.
fn read(path: &Path) -> Result<Checkpoint, CheckpointError> {
    decode(&std::fs::read(path)?)
}

/// Restores the engine of a run of `total` steps from a checkpoint; returns the rest of the saved state. All
/// errors are usage errors, as for any other input, and say what to do instead.
pub fn resume(
    path: &Path,
    engine: &mut dyn Engine,
    precision: Precision,
    scene_crc: u32,
    total: u64,
) -> Result<Resumed, Failure> {
    let failed = |why: String| Failure::Usage(format!("{}: {why}", path.display()));
    let found = read(path).map_err(|error| failed(error.to_string()))?;
    if found.precision != precision {
        return Err(failed("has the other precision; give the --precision of the first run".into()));
    }
    if found.scene != scene_crc || !engine.restore(&found.snapshot) {
        return Err(failed("belongs to another scene; resume with the scene and the --set of the first run".into()));
    }
    let steps = found.snapshot.steps;
    if steps > total {
        return Err(failed(format!("is at step {steps}, the run ends with step {total}; give a longer --duration")));
    }
    Ok(Resumed { chain: found.chain, record: found.record })
}

/// CRC that identifies a scene: its keys except the duration, and the contents of the files that it names.
pub fn scene_crc(scene: &SceneFile) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    if let Ok(mut table) = toml::from_str::<toml::Table>(&scene.text) {
        table.remove("duration");
        crc.update(table.to_string().as_bytes());
    }
    for (name, content) in &scene.resources {
        crc.update(name.as_bytes());
        let mesh = match content {
            Content::Mesh(mesh) => mesh,
            Content::Cache(cache) => {
                crc.update(bytemuck::cast_slice(&cache.positions));
                continue;
            }
        };
        crc.update(bytemuck::cast_slice(&mesh.positions));
        crc.update(bytemuck::cast_slice(&mesh.triangles));
        crc.update(bytemuck::cast_slice(&mesh.uvs));
        crc.update(bytemuck::cast_slice(&mesh.uv_triangles));
        for stitch in &mesh.stitches {
            crc.update(bytemuck::cast_slice(&[stitch.a, stitch.edge[0], stitch.edge[1]]));
            crc.update(&stitch.weight.to_le_bytes());
        }
    }
    crc.finalize()
}

fn encode(checkpoint: &Checkpoint) -> Vec<u8> {
    let Checkpoint { precision, scene, chain, record, snapshot } = checkpoint;
    let mut bytes = MAGIC.to_vec();
    for word in [VERSION, *precision as u32, *scene] {
        bytes.extend(word.to_le_bytes());
    }
    let Snapshot { steps, after_contact, halvings, last_step, .. } = *snapshot;
    let state = [steps, after_contact.into(), halvings.into(), last_step.to_bits(), *chain];
    for word in state.iter().chain(&snapshot.work).chain(&snapshot.contacts).chain(&record.encode()) {
        bytes.extend(word.to_le_bytes());
    }
    for column in &snapshot.columns {
        bytes.extend((column.len() as u64).to_le_bytes());
        bytes.extend(column);
    }
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

fn decode(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let mut rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
    let version = take(&mut rest).map(u32::from_le_bytes).ok_or(CheckpointError::Damaged)?;
    if version != VERSION {
        return Err(CheckpointError::Version { found: version });
    }
    let (body, crc) = bytes.split_last_chunk().ok_or(CheckpointError::Damaged)?;
    if crc32fast::hash(body) != u32::from_le_bytes(*crc) {
        return Err(CheckpointError::Damaged);
    }
    fields(rest).ok_or(CheckpointError::Damaged)
}

fn fields(mut rest: &[u8]) -> Option<Checkpoint> {
    let precision = match u32::from_le_bytes(take(&mut rest)?) {
        p if p == Precision::F32 as u32 => Precision::F32,
        p if p == Precision::F64 as u32 => Precision::F64,
        _ => return None,
    };
    let scene = u32::from_le_bytes(take(&mut rest)?);
    let mut word = || take(&mut rest).map(u64::from_le_bytes);
    let (steps, after_contact) = (word()?, word()? != 0);
    let (halvings, last_step, chain) = (word()? as u32, f64::from_bits(word()?), word()?);
    let mut snapshot = Snapshot { steps, after_contact, halvings, last_step, ..Snapshot::default() };
    let mut record = [0; record::WORDS];
    for counter in snapshot.work.iter_mut().chain(&mut snapshot.contacts).chain(&mut record) {
        *counter = word()?;
    }
    for column in &mut snapshot.columns {
        let length = usize::try_from(u64::from_le_bytes(take(&mut rest)?)).ok()?;
        let (bytes, after) = rest.split_at_checked(length)?;
        *column = bytes.into();
        rest = after;
    }
    Some(Checkpoint { precision, scene, chain, record: Record::decode(record), snapshot })
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Start;

    fn example() -> Checkpoint {
        let columns = [vec![1, 2, 3, 4], vec![5; 24], vec![6; 4], vec![8; 4], vec![], vec![9; 12], vec![7; 28]];
        let (work, contacts) = ([1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2], [8, 9, 1, 2, 3, 4, 5]);
        let snapshot =
            Snapshot { steps: 77, work, contacts, columns, after_contact: true, halvings: 3, last_step: 0.125 };
        let start = Start { crossings: Some(3), untangled: None };
        let record = Record {
            start,
            size: [1.0, 0.5, 2.0],
            stretch: 1.25,
            first_stretch: 1.125,
            penetration: Some(1e-3),
            crossings: Some((4, 17)),
        };
        Checkpoint { precision: Precision::F64, scene: 0xdead_beef, chain: 42, record, snapshot }
    }

    #[test]
    fn a_checkpoint_reads_back_as_written() {
        assert_eq!(decode(&encode(&example())).unwrap(), example());
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_is_an_error() {
        let good = encode(&example());
        for length in 0..good.len() {
            assert!(decode(&good[..length]).is_err(), "truncated to {length} bytes it was read");
        }
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(decode(&bad).is_err(), "with bit {bit} flipped it was read");
        }
    }
}
