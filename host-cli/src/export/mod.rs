//! Writing the moving cloth for other programs: OBJ, PC2, USD and VTK files.

mod obj;
mod pc2;
mod series;
mod usda;
mod vtp;
pub mod whole;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::warning::Warning;
use whole::{WriteError, partial_name};

/// Largest rounding of exported positions, relative to the mean length of an edge.
const MOST_ROUNDED: f64 = 0.01;

/// A file format that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
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

impl Format {
    /// All formats that have files.
    pub const ALL: [Format; 4] = [Format::Obj, Format::Pc2, Format::Usda, Format::Vtp];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Pc2 => "pc2",
            Format::Usda => "usda",
            Format::Vtp => "vtp",
            Format::None => "none",
        }
    }

    /// Whether its files contain positions in single precision.
    const fn is_single(self) -> bool {
        matches!(self, Format::Pc2 | Format::Usda | Format::Vtp)
    }

    /// The folder of its frames inside the output folder, if it has one.
    pub const fn folder(self) -> Option<&'static str> {
        match self {
            Format::Obj => Some(obj::FRAMES.folder),
            Format::Vtp => Some(vtp::FRAMES.folder),
            Format::Pc2 | Format::Usda | Format::None => None,
        }
    }

    /// The files of this format in a folder, complete or partial.
    pub fn files(self, dir: &Path) -> Vec<PathBuf> {
        let named = |names: &[&str]| {
            let paths = names.iter().flat_map(|name| [dir.join(name), partial_name(&dir.join(name))]);
            paths.filter(|path| path.symlink_metadata().is_ok()).collect()
        };
        match self {
            Format::Obj => obj::FRAMES.files(dir, 0),
            Format::Pc2 => named(&["cloth.pc2", "cloth.obj"]),
            Format::Usda => named(&["cloth.usda"]),
            Format::Vtp => [vtp::FRAMES.files(dir, 0), named(&["cloth.vtp.series"])].concat(),
            Format::None => Vec::new(),
        }
    }
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
    /// The number of the first frame in the files: below the clip's first frame if they are continued.
    fn begins(&self, clip: &Clip) -> u32;

    /// Writes the positions (metres) of frame number `frame`.
    fn frame(&mut self, clip: &Clip, frame: u32, positions: &[[f64; 3]]) -> Result<(), WriteError>;

    /// Completes the files; `frames` is one more than the last frame's number. Returns the paths that a user
    /// would open.
    fn finish(self: Box<Self>, clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError>;

    /// Writes buffered data to disk, for a later run to continue.
    fn flush(&mut self) -> Result<(), WriteError> {
        Ok(())
    }
}

/// Writes frames in all requested formats. Files get their final names when they are complete; without `finish`, files
/// of several frames keep their partial names.
pub struct Exporter {
    clip: Clip,
    writers: Vec<(Format, Box<dyn Writer>)>,
    next: u32,
    /// Largest coordinate of all frames, m.
    farthest: f64,
}

impl Exporter {
    /// Begins files in `dir`, which is created if necessary. `frame_rate` is in frames per second. Frames are
    /// numbered from `first_frame`, which is above 0 to continue an earlier run.
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
        let writer = |&format| Ok(writer(format, &clip)?.map(|writer| (format, writer)));
        let writers = once.filter_map(|(_, format)| writer(format).transpose()).collect::<Result<_, WriteError>>()?;
        Ok(Exporter { clip, writers, next: first_frame, farthest: 0.0 })
    }

    /// Formats whose files have not all frames from number 0 on, and the number of their first frame.
    pub fn incomplete(&self) -> Vec<(Format, u32)> {
        let begins = self.writers.iter().map(|(format, writer)| (*format, writer.begins(&self.clip)));
        begins.filter(|&(_, frame)| frame > 0).collect()
    }

    /// Writes the next frame: the positions of all vertices, metres.
    pub fn frame(&mut self, positions: &[[f64; 3]]) -> Result<(), ExportError> {
        let (expected, found) = (self.clip.points, positions.len());
        if expected != found {
            return Err(ExportError::Points { expected, found });
        }
        for (_, writer) in &mut self.writers {
            writer.frame(&self.clip, self.next, positions)?;
        }
        self.next += 1;
        self.farthest = positions.as_flattened().iter().fold(self.farthest, |most, x| most.max(x.abs()));
        Ok(())
    }

    /// A warning if formats in single precision round positions visibly; `edge` is the mean length of an edge, m.
    pub fn rounded(&self, edge: f64) -> Option<Warning> {
        let rounding = self.farthest * f64::from(f32::EPSILON) / edge;
        let formats = self.writers.iter().map(|(format, _)| format).filter(|format| format.is_single());
        let names: Vec<_> = formats.map(|format| format.name()).collect();
        (rounding > MOST_ROUNDED && !names.is_empty()).then(|| {
            let text = format!(
                "--export {}: the cloth is so far from the world's origin that single precision rounds the exported positions to {:.1} \
                 % of an edge; use --export obj, or bring the scene near to the origin",
                names.join(","),
                1e2 * rounding
            );
            Warning::new("export", text)
        })
    }

    /// Writes buffered data to disk, so that a later run can continue the unfinished files if this one ends here.
    pub fn flush(&mut self) -> Result<(), ExportError> {
        self.writers.iter_mut().try_for_each(|(_, writer)| writer.flush()).map_err(ExportError::from)
    }

    /// Completes all files; returns the paths that a user would open.
    pub fn finish(self) -> Result<Vec<PathBuf>, ExportError> {
        let mut paths = Vec::new();
        for (_, writer) in self.writers {
            paths.extend(writer.finish(&self.clip, self.next)?);
        }
        Ok(paths)
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
    pub fn quad(y: f64) -> [[f64; 3]; 4] {
        [[0.0, y, 0.0], [1.0, y, 0.0], [1.0, y, 0.1], [0.0, y, 1.0]]
    }

    /// Writes frames `first..end`, each at the height of its number; the exporter is neither finished nor flushed.
    pub fn export(dir: &Path, format: Format, first: u32, end: u32) -> Exporter {
        let mut exporter = Exporter::create(dir, &[format], &QUAD, 25.0, first).unwrap();
        (first..end).for_each(|frame| exporter.frame(&quad(frame.into())).unwrap());
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
