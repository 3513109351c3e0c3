//! A series of files, each of which contains one frame.

use std::fs;
use std::path::{Path, PathBuf};

use super::whole::partial_name;
use crate::disk;

/// The names of a series: `FOLDER/STEM_00000.ENDING`, `FOLDER/STEM_00001.ENDING` and so on.
pub struct Series {
    /// Folder of the files.
    pub folder: &'static str,
    /// How the names of the files begin.
    pub stem: &'static str,
    /// How the names of the files end.
    pub ending: &'static str,
}

impl Series {
    /// Name of the file of a frame, with its folder.
    pub fn name(&self, frame: u32) -> String {
        let Series { folder, stem, ending } = self;
        format!("{folder}/{stem}_{frame:05}.{ending}")
    }

    /// The files in `dir`, complete or partial, of all frames from number `from` on.
    pub fn files(&self, dir: &Path, from: u32) -> Vec<PathBuf> {
        let entries = fs::read_dir(dir.join(self.folder)).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path());
        paths.filter(|path| self.frame(dir, path).is_some_and(|frame| frame >= from)).collect()
    }

    /// The frame of a file; `None` for a file that does not belong to the series.
    fn frame(&self, dir: &Path, path: &Path) -> Option<u32> {
        let rest = path.file_name()?.to_str()?.strip_prefix(self.stem)?.strip_prefix('_')?;
        let frame = rest.split('.').next()?.parse().ok()?;
        let complete = dir.join(self.name(frame));
        (path == complete || path == partial_name(&complete)).then_some(frame)
    }

    /// The first of the frames that are complete in `dir` and reach without a gap to frame `end`, which is excluded.
    pub fn begins(&self, dir: &Path, end: u32) -> u32 {
        (0..end).rev().take_while(|&frame| dir.join(self.name(frame)).is_file()).last().unwrap_or(end)
    }

    /// Removes the files in `dir` of all frames from number `from` on; a file that cannot be removed stays.
    pub fn remove(&self, dir: &Path, from: u32) {
        self.files(dir, from).iter().for_each(|path| drop(disk::remove(path)));
    }
}
