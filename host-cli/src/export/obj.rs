//! Wavefront OBJ: vertices in the order of the input; face indices count from 1.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::whole::{self, WriteError};
use super::{Clip, Writer};

/// Writes `frames/frame_00000.obj` and so on.
pub struct ObjFrames;

impl Writer for ObjFrames {
    fn frame(&mut self, clip: &Clip, frame: u32, positions: &[[f32; 3]]) -> Result<(), WriteError> {
        whole::write(place(clip, frame), |file| mesh(file, clip, positions))?;
        Ok(())
    }

    fn finish(self: Box<Self>, clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError> {
        // Frames after the last one are from an older, longer run.
        let older = (frames..).map(|frame| place(clip, frame)).take_while(|path| path.exists());
        older.for_each(|path| drop(std::fs::remove_file(path)));
        Ok(vec![folder(&clip.dir)])
    }
}

fn place(clip: &Clip, frame: u32) -> PathBuf {
    folder(&clip.dir).join(format!("frame_{frame:05}.obj"))
}

fn folder(dir: &Path) -> PathBuf {
    dir.join("frames")
}

/// Writes one mesh; each number is the shortest that reads back as the same `f32`.
pub fn mesh(file: &mut impl Write, clip: &Clip, positions: &[[f32; 3]]) -> io::Result<()> {
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
        assert_eq!(mesh.positions.iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>(), quad(8.0));
    }
}
