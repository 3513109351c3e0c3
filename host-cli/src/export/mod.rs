//! Writing the moving cloth for other programs: OBJ, PC2, USD and VTK files.

mod obj;
mod pc2;
mod usda;
mod vtp;
pub mod whole;

use std::path::{Path, PathBuf};

use whole::WriteError;

/// A file format that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// One Wavefront OBJ file for each frame, in `frames/`.
    Obj,
    /// A point cache `cloth.pc2` beside the mesh `cloth.obj` that it moves (Blender).
    Pc2,
    /// `cloth.usda`, one animated mesh (USD).
    Usda,
    /// One VTK file for each frame, in `vtp/`, and `cloth.vtp.series` (ParaView).
    Vtp,
    /// No frames.
    None,
}

/// Why the cloth could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A frame does not fit the triangles.
    #[error("a frame has {found} vertices, but the triangles need {expected}; pass the whole mesh")]
    Points {
        /// Vertices that the triangles name.
        expected: usize,
        /// Vertices in the frame.
        found: usize,
    },
}

/// The input that the files of all formats share.
struct Clip {
    dir: PathBuf,
    triangles: Vec<[u32; 3]>,
    points: usize,
    frame_rate: f64,
    first_frame: u32,
}

/// The file or files of one format.
trait Writer: Send {
    /// Writes the positions (metres) of frame number `frame`.
    fn frame(&mut self, clip: &Clip, frame: u32, positions: &[[f32; 3]]) -> Result<(), WriteError>;

    /// Completes the files; `frames` is one more than the last frame's number. Returns the paths that a user
    /// would open.
    fn finish(self: Box<Self>, clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError>;

    /// Writes buffered data to disk, for a later run to continue.
    fn flush(&mut self) -> Result<(), WriteError> {
        Ok(())
    }

    /// Leaves unfinished files for a later run to continue.
    fn suspend(self: Box<Self>) -> Result<(), WriteError> {
        Ok(())
    }
}

/// Writes frames in all requested formats. Files get their final names when they are complete.
pub struct Exporter {
    clip: Clip,
    writers: Vec<Box<dyn Writer>>,
    next: u32,
}

impl Exporter {
    /// Begins files in `dir`, which is created if necessary. `frame_rate` is in frames per second. Frames are
    /// numbered from `first_frame`, which is above 0 to continue a suspended run.
    pub fn create(
        dir: &Path,
        formats: &[Format],
        triangles: &[[u32; 3]],
        frame_rate: f64,
        first_frame: u32,
    ) -> Result<Exporter, ExportError> {
        let points = triangles.as_flattened().iter().max().map_or(0, |&last| last as usize + 1);
        let clip = Clip { dir: dir.into(), triangles: triangles.into(), points, frame_rate, first_frame };
        // A format that is named twice gets one writer: two writers would overwrite each other's file.
        let once = formats.iter().enumerate().filter(|(place, format)| !formats[..*place].contains(format));
        let writers = once.filter_map(|(_, &format)| writer(format, &clip).transpose()).collect::<Result<_, _>>()?;
        Ok(Exporter { clip, writers, next: first_frame })
    }

    /// Writes the next frame: the positions of all vertices, metres.
    pub fn frame(&mut self, positions: &[[f32; 3]]) -> Result<(), ExportError> {
        let (expected, found) = (self.clip.points, positions.len());
        if expected != found {
            return Err(ExportError::Points { expected, found });
        }
        for writer in &mut self.writers {
            writer.frame(&self.clip, self.next, positions)?;
        }
        self.next += 1;
        Ok(())
    }

    /// Writes buffered data to disk, so that a later run can continue if this one is killed.
    pub fn flush(&mut self) -> Result<(), ExportError> {
        self.writers.iter_mut().try_for_each(|writer| writer.flush()).map_err(ExportError::from)
    }

    /// Completes all files; returns the paths that a user would open.
    pub fn finish(self) -> Result<Vec<PathBuf>, ExportError> {
        let mut paths = Vec::new();
        for writer in self.writers {
            paths.extend(writer.finish(&self.clip, self.next)?);
        }
        Ok(paths)
    }

    /// Leaves unfinished files under their partial names, for a later run to continue.
    pub fn suspend(self) -> Result<(), ExportError> {
        self.writers.into_iter().try_for_each(|writer| writer.suspend()).map_err(ExportError::from)
    }
}

fn writer(format: Format, clip: &Clip) -> Result<Option<Box<dyn Writer>>, WriteError> {
    Ok(Some(match format {
        Format::Obj => Box::new(obj::ObjFrames),
        Format::Pc2 => Box::new(pc2::Pc2::begin(clip)?),
        Format::Usda => Box::new(usda::Usda::begin(clip)?),
        Format::Vtp => Box::new(vtp::Vtp::new(clip)),
        Format::None => return Ok(None),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    pub const QUAD: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    /// A quad at height `y` metres.
    pub fn quad(y: f32) -> [[f32; 3]; 4] {
        [[0.0, y, 0.0], [1.0, y, 0.0], [1.0, y, 0.1], [0.0, y, 1.0]]
    }

    /// Writes frames `first..end`, each at the height of its number; the exporter is neither finished nor suspended.
    pub fn export(dir: &Path, format: Format, first: u32, end: u32) -> Exporter {
        let mut exporter = Exporter::create(dir, &[format], &QUAD, 25.0, first).unwrap();
        (first..end).for_each(|frame| exporter.frame(&quad(frame as f32)).unwrap());
        exporter
    }

    #[test]
    fn writes_all_formats_at_once_and_leaves_nothing_partial() {
        let dir = tempfile::tempdir().unwrap();
        let formats = [Format::Obj, Format::Pc2, Format::Usda, Format::Vtp];
        let mut exporter = Exporter::create(&dir.path().join("a/b"), &formats, &QUAD, 60.0, 0).unwrap();
        exporter.frame(&quad(0.0)).unwrap();
        exporter.frame(&quad(1.0)).unwrap();
        let paths = exporter.finish().unwrap();
        assert_eq!(paths.len(), 5);
        assert!(paths.iter().all(|path| path.exists()));
        let names = fs::read_dir(dir.path().join("a/b")).unwrap().map(|e| e.unwrap().file_name());
        assert!(names.into_iter().all(|name| !name.to_string_lossy().contains("partial")));
    }

    #[test]
    fn dropped_leaves_no_final_name() {
        let dir = tempfile::tempdir().unwrap();
        for format in [Format::Pc2, Format::Usda] {
            drop(export(dir.path(), format, 0, 2));
        }
        assert!(!dir.path().join("cloth.pc2").exists() && !dir.path().join("cloth.usda").exists());
    }

    #[test]
    fn refuses_a_frame_of_another_mesh() {
        let dir = tempfile::tempdir().unwrap();
        let message = export(dir.path(), Format::Obj, 0, 0).frame(&quad(0.0)[..3]).unwrap_err().to_string();
        assert!(message.contains("3 vertices") && message.contains("need 4"));
    }

    #[test]
    fn names_the_file_that_cannot_be_written() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("cloth.pc2.partial"), "").unwrap();
        let inside_a_file = dir.path().join("cloth.pc2.partial");
        let failed = Exporter::create(&inside_a_file, &[Format::Pc2], &QUAD, 25.0, 0);
        assert!(failed.err().unwrap().to_string().contains("cloth.pc2: "));
    }
}
