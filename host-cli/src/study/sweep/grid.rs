//! The runs of a sweep: every combination of the grid, and how each is known.

use crate::args::Precision;
use crate::checkpoint;
use crate::failure::Failure;
use crate::scene_file::{Change, SceneFile};

use super::file::Sweep;

/// Most runs of a sweep; more than this is a slip of the hand.
const MOST_RUNS: usize = 1_000_000;

/// One run of a sweep.
#[derive(Debug)]
pub struct Point {
    /// Its place among all runs, from 0.
    pub index: usize,
    /// In which precision.
    pub precision: Precision,
    /// What it changes of the scene, the changes of all runs first.
    pub changes: Vec<Change>,
    /// How many of the changes all runs make.
    common: usize,
}

impl Sweep {
    /// How many runs it has.
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

    /// The run of an index: the precision changes fastest, then the last key of the grid.
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
    /// What it changes and other runs do not.
    pub fn varied(&self) -> &[Change] {
        &self.changes[self.common..]
    }

    /// As messages name it: by what differs.
    pub fn name(&self) -> String {
        let varied = self.varied().iter().map(|change| format!("{} = {}", change.key, change.value));
        let words: Vec<_> = varied.chain([self.precision.name().into()]).collect();
        words.join(", ")
    }

    /// What its line is found by: the version of the tool, all that is in the scene with these changes,
    /// and in words what those are.
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
