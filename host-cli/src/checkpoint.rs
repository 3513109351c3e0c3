//! Checkpoints: the saved state of a run, which a later run continues bit for bit.
//!
//! Little-endian layout: magic, format, version of muslin after its length, precision, CRC of the scene, steps, whether
//! contact changed the state, halvings of the substeps, length of the last one, hash chain, counters of work, counters
//! of contact, record of the run, each column after its length, the impulses of the last frame likewise, and the CRC of
//! all bytes before. The file is written completely or not at all.

use std::io::Write;
use std::path::Path;

use muslin_core::scene::Content;

use crate::args::Precision;
use crate::engine::{Engine, Snapshot};
use crate::export::whole::{self, WriteError};
use crate::failure::Failure;
use crate::limits;
use crate::record::{self, Record};
use crate::scene_file::SceneFile;

const MAGIC: &[u8; 8] = b"MUSLINCP";
const FORMAT: u32 = 13;

/// The version of muslin: another one may take other steps.
const VERSION: &str = env!("CARGO_PKG_VERSION");

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
    /// [`Engine::impulses`] since the last frame.
    pub impulses: Vec<[f64; 6]>,
}

/// The state, besides the engine, that a resumed run continues from.
#[derive(Clone, Debug)]
pub struct Resumed {
    /// The hash chain up to the checkpoint.
    pub chain: u64,
    /// Observations of the run up to the checkpoint.
    pub record: Record,
    /// [`Engine::impulses`] since the last frame.
    pub impulses: Vec<[f64; 6]>,
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
    /// Written by a version of muslin with another format.
    #[error("this checkpoint has format {found}, muslin {VERSION} reads format {FORMAT}; run the scene from its start")]
    Format {
        /// Format of the file.
        found: u32,
    },
    /// Written by another version of muslin.
    #[error(
        "this checkpoint is of muslin {found}, this is muslin {VERSION}, whose steps may differ; run the scene from \
         its start, or resume with muslin {found}"
    )]
    Version {
        /// Version of muslin that wrote the file.
        found: String,
    },
    /// Truncated or altered.
    #[error("this checkpoint is damaged (its checksum is wrong); use an older one or run the scene from its start")]
    Damaged,
}

/// Writes a checkpoint atomically.
pub fn write(path: &Path, checkpoint: &Checkpoint) -> Result<(), WriteError> {
    let bytes = encode(checkpoint);
    whole::write(path.into(), |file| file.write_all(&bytes)).map(drop)
}

/// Reads a checkpoint back.
fn read(path: &Path) -> Result<Checkpoint, CheckpointError> {
    decode(&limits::read(path, limits::DATA)?)
}

/// The number of steps that the run of a checkpoint has taken; `None` if it cannot be read.
pub fn step(path: &Path) -> Option<u64> {
    read(path).ok().map(|found| found.snapshot.steps)
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
    Ok(Resumed { chain: found.chain, record: found.record, impulses: found.impulses })
}

/// The identity of a run: two runs with the same one have the same frames.
pub fn identity(scene_crc: u32, precision: Precision) -> String {
    format!("muslin {VERSION} scene {scene_crc:08x} {}", precision.name())
}

/// CRC that identifies a scene: its keys except the duration, and the contents of the files that it names.
pub fn scene_crc(scene: &SceneFile) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    if let Ok(mut table) = toml::from_str::<toml::Table>(&scene.text) {
        table.remove("duration");
        crc.update(table.to_string().as_bytes());
    }
    for (name, content) in &*scene.resources {
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

/// The bytes of a checkpoint.
pub fn encode(checkpoint: &Checkpoint) -> Vec<u8> {
    encode_as(checkpoint, VERSION)
}

fn encode_as(checkpoint: &Checkpoint, version: &str) -> Vec<u8> {
    let Checkpoint { precision, scene, chain, record, snapshot, impulses } = checkpoint;
    let mut bytes = MAGIC.to_vec();
    bytes.extend(FORMAT.to_le_bytes());
    push(&mut bytes, version.as_bytes());
    for word in [*precision as u32, *scene] {
        bytes.extend(word.to_le_bytes());
    }
    let Snapshot { steps, after_contact, halvings, last_step, .. } = *snapshot;
    let state = [steps, after_contact.into(), halvings.into(), last_step.to_bits(), *chain];
    for word in state.iter().chain(&snapshot.work).chain(&snapshot.contacts).chain(&record.encode()) {
        bytes.extend(word.to_le_bytes());
    }
    for column in &snapshot.columns {
        push(&mut bytes, column);
    }
    let impulses: Vec<_> = impulses.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    push(&mut bytes, &impulses);
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Appends bytes after their number.
fn push(bytes: &mut Vec<u8>, more: &[u8]) {
    bytes.extend((more.len() as u64).to_le_bytes());
    bytes.extend(more);
}

/// Reads the bytes of a checkpoint.
pub fn decode(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let mut rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
    let format = take(&mut rest).map(u32::from_le_bytes).ok_or(CheckpointError::Damaged)?;
    if format != FORMAT {
        return Err(CheckpointError::Format { found: format });
    }
    let (body, crc) = bytes.split_last_chunk().ok_or(CheckpointError::Damaged)?;
    if crc32fast::hash(body) != u32::from_le_bytes(*crc) {
        return Err(CheckpointError::Damaged);
    }
    let version = take_bytes(&mut rest).ok_or(CheckpointError::Damaged)?;
    if version != VERSION.as_bytes() {
        return Err(CheckpointError::Version { found: String::from_utf8_lossy(version).into() });
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
        *column = take_bytes(&mut rest)?.into();
    }
    let scalars: Vec<_> = take_bytes(&mut rest)?.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
    let impulses = scalars.as_chunks().0.into();
    Some(Checkpoint { precision, scene, chain, record: Record::decode(record), snapshot, impulses })
}

/// Takes bytes that stand after their number.
fn take_bytes<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = usize::try_from(u64::from_le_bytes(take(rest)?)).ok()?;
    let (bytes, after) = rest.split_at_checked(length)?;
    *rest = after;
    Some(bytes)
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
    use muslin_core::balance::Balance;

    fn example() -> Checkpoint {
        let columns =
            [vec![1, 2, 3, 4], vec![5; 24], vec![6; 4], vec![8; 4], vec![], vec![9; 12], vec![7; 28], vec![3; 12]];
        let (work, contacts) = ([1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2], [8, 9, 1, 2, 3, 4, 5]);
        let snapshot =
            Snapshot { steps: 77, work, contacts, columns, after_contact: true, halvings: 3, last_step: 0.125 };
        let start = Start { crossings: Some(3), untangled: None };
        let record = Record {
            start,
            size: [1.0, 0.5, 2.0],
            stretch: 1.25,
            first_stretch: 1.125,
            balance: Balance::default(),
            measures_reactions: true,
            rounding: 1e-6,
            fastest: 0.25,
            penetration: Some(1e-3),
            audited: 18,
            crossings: Some((4, 17)),
            awaits_audit: true,
        };
        let impulses = vec![[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.5; 6]];
        Checkpoint { precision: Precision::F64, scene: 0xdead_beef, chain: 42, record, snapshot, impulses }
    }

    #[test]
    fn a_checkpoint_reads_back_as_written() {
        assert_eq!(decode(&encode(&example())).unwrap(), example());
    }

    #[test]
    fn a_checkpoint_of_another_version_names_both() {
        let message = decode(&encode_as(&example(), "0.0.9")).unwrap_err().to_string();
        assert!(message.contains("muslin 0.0.9") && message.contains(&format!("muslin {VERSION}")), "{message}");
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
