//! The runs of a sweep: every combination of the grid, and the key that identifies each run.

use crate::args::Precision;
use crate::checkpoint;
use crate::failure::Failure;
use crate::scene_file::{Change, SceneFile};

use super::file::Sweep;

/// Largest number of runs of a sweep; more are assumed to be a mistake.
const MOST_RUNS: usize = 1_000_000;

/// One run of a sweep.
#[derive(Clone, Debug)]
pub struct Point {
    /// Index among all runs, from 0.
    pub index: usize,
    /// The precision.
    pub precision: Precision,
    /// Changes of the scene; the changes that all runs make come first.
    pub changes: Vec<Change>,
    /// Number of changes that all runs make.
    common: usize,
}

impl Sweep {
    /// Number of runs. More than `MOST_RUNS` are an error.
    pub fn count(&self) -> Result<usize, Failure> {
        let lengths = self.grid.iter().map(Vec::len);
        let count = lengths.fold(self.precisions.len(), usize::saturating_mul);
        match count {
            0..=MOST_RUNS => Ok(count),
            _ => Err(Failure::Usage(format!(
                "{}: the grid has more than {MOST_RUNS} combinations; make several sweeps of it",
                self.label
            ))),
        }
    }

    /// The run with an index: the precision changes fastest, then the last key of the grid.
    pub fn point(&self, index: usize) -> Point {
        let precision = self.precisions[index % self.precisions.len()];
        let mut rest = index / self.precisions.len();
        let mut varied = Vec::new();
        for values in self.grid.iter().rev() {
            varied.push(values[rest % values.len()].clone());
            rest /= values.len();
        }
        varied.reverse();
        Point { index, precision, changes: [self.set.as_slice(), &varied].concat(), common: self.set.len() }
    }
}

impl Point {
    /// Changes that differ between runs.
    pub fn varied(&self) -> &[Change] {
        &self.changes[self.common..]
    }

    /// Name in messages: the values that differ.
    pub fn name(&self) -> String {
        let varied = self.varied().iter().map(|change| format!("{} = {}", change.key, change.value));
        let words: Vec<_> = varied.chain([self.precision.name().into()]).collect();
        words.join(", ")
    }

    /// The key of its line: the version of the tool, a checksum of the changed scene, its duration, the precision
    /// and the changes in words.
    pub fn key(&self, scene: &SceneFile) -> String {
        let mut changes: Vec<_> =
            self.changes.iter().map(|change| format!(" {}={}", change.key, change.value)).collect();
        changes.sort_unstable();
        format!(
            "muslin {} scene {:08x} {:?} s {}{}",
            env!("CARGO_PKG_VERSION"),
            checkpoint::scene_crc(scene),
            scene.desc.duration,
            self.precision.name(),
            changes.concat()
        )
    }
}
