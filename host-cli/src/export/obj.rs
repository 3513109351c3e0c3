//! Wavefront OBJ: vertices in the order of the input; face indices count from 1.

use std::io::{self, Write};
use std::path::PathBuf;

use super::series::Series;
use super::whole::{self, WriteError};
use super::{Clip, Writer};

/// The files.
pub const FRAMES: Series = Series { folder: "frames", stem: "frame", ending: "obj" };

/// Writes `frames/frame_00000.obj` and so on.
pub struct ObjFrames;

impl Writer for ObjFrames {
    fn begins(&self, clip: &Clip) -> u32 {
        FRAMES.begins(&clip.dir, clip.first_frame)
    }

    fn frame(&mut self, clip: &Clip, frame: u32, positions: &[[f64; 3]]) -> Result<(), WriteError> {
        whole::write(clip.dir.join(FRAMES.name(frame)), |file| mesh(file, clip, positions))?;
        Ok(())
    }

    fn finish(self: Box<Self>, clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError> {
        // The run may have been longer before it was resumed.
        FRAMES.remove(&clip.dir, frames);
        Ok(vec![clip.dir.join(FRAMES.folder)])
    }
}

/// Writes one mesh; each number is the shortest that reads back as the same `f64`.
pub fn mesh(file: &mut impl Write, clip: &Clip, positions: &[[f64; 3]]) -> io::Result<()> {
    for [x, y, z] in positions {
        writeln!(file, "v {x} {y} {z}")?;
    }
    for [a, b, c] in clip.triangles.iter().map(|triangle| triangle.map(|v| u64::from(v) + 1)) {
        writeln!(file, "f {a} {b} {c}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::tests::{QUAD, export, quad};
    use crate::mesh_io;

    #[test]
    fn reads_back_the_same() {
        let dir = tempfile::tempdir().unwrap();
        let paths = export(dir.path(), Format::Obj, 7, 9).finish().unwrap();
        assert_eq!(std::fs::read_dir(&paths[0]).unwrap().count(), 2);
        let mesh = mesh_io::load(&paths[0].join("frame_00008.obj")).unwrap();
        assert_eq!(mesh.triangles, QUAD);
        assert_eq!(mesh.positions, quad(8.0));
    }
}
