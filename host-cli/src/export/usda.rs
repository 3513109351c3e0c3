//! Universal Scene Description, text form (openusd.org, UsdGeomMesh): one mesh with a sample of
//! its points for each frame. An interrupted file can be continued.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::PathBuf;

use super::whole::{Partial, WriteError};
use super::{Clip, Writer};

const BEGIN: &str = "#usda 1.0\n(\n    defaultPrim = \"Cloth\"\n    endTimeCode = ";

/// Streams `cloth.usda`.
pub struct Usda {
    partial: Partial,
    /// The number of its first frame.
    begins: u32,
}

impl Usda {
    /// Continues the file of an interrupted or shorter run, if it has this mesh and all frames before the first
    /// one; otherwise begins a new file with the data that all frames share.
    pub fn begin(clip: &Clip) -> Result<Usda, WriteError> {
        let path = clip.dir.join("cloth.usda");
        if clip.first_frame > 0
            && let Some(mut partial) = Partial::reopen(&path)?
            && let Some(begins) = partial.with(|file| rewind(file, clip))?
        {
            return Ok(Usda { partial, begins });
        }
        let mut partial = Partial::create(path)?;
        partial.with(|file| head(file, clip))?;
        Ok(Usda { partial, begins: clip.first_frame })
    }
}

impl Writer for Usda {
    fn begins(&self, _clip: &Clip) -> u32 {
        self.begins
    }

    fn frame(&mut self, _clip: &Clip, frame: u32, positions: &[[f64; 3]]) -> Result<(), WriteError> {
        self.partial.with(|file| {
            write!(file, "        {frame}: ")?;
            list(file, positions.iter().map(|p| point(p.map(|x| x as f32))))?;
            writeln!(file, ",")
        })
    }

    fn finish(mut self: Box<Self>, _clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError> {
        self.partial.with(|file| {
            file.write_all(b"    }\n}\n")?;
            file.seek(SeekFrom::Start(BEGIN.len() as u64))?;
            end_time(file, frames.saturating_sub(1).max(self.begins))
        })?;
        Ok(vec![self.partial.finish()?])
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        self.partial.sync()
    }
}

/// Truncates an older file to the frames before the first one. Returns the number of its first frame; `None` if it
/// cannot be continued.
fn rewind(file: &mut BufWriter<File>, clip: &Clip) -> io::Result<Option<u32>> {
    let mut lines = BufReader::new(file.get_mut());
    let mut line = Vec::new();
    // Every line of the head must be the same, except the start time and the end time.
    let mut expected = Vec::new();
    head(&mut expected, clip)?;
    let mut length = 0;
    let mut frame = None;
    for expected in expected.split_inclusive(|&byte| byte == b'\n') {
        line.clear();
        length += lines.read_until(b'\n', &mut line)?;
        let key = &expected[..expected.iter().position(|&byte| byte == b'=').unwrap_or(0)];
        match key.trim_ascii() {
            b"endTimeCode" => {}
            b"startTimeCode" => frame = str::from_utf8(&line[key.len().min(line.len())..]).ok().and_then(number),
            _ if line == expected => {}
            _ => return Ok(None),
        }
    }
    let Some(start) = frame.filter(|start| *start <= clip.first_frame) else { return Ok(None) };
    for frame in start..clip.first_frame {
        line.clear();
        length += lines.read_until(b'\n', &mut line)?;
        if !line.starts_with(format!("        {frame}: ").as_bytes()) || !line.ends_with(b"],\n") {
            return Ok(None);
        }
    }
    file.get_ref().set_len(length as u64)?;
    file.seek(SeekFrom::End(0))?;
    Ok(Some(start))
}

fn number(text: &str) -> Option<u32> {
    text.trim_start_matches('=').trim().parse().ok()
}

fn head(file: &mut impl Write, clip: &Clip) -> io::Result<()> {
    let Clip { frame_rate, first_frame, triangles, .. } = clip;
    file.write_all(BEGIN.as_bytes())?;
    end_time(file, *first_frame)?;
    write!(
        file,
        "
    framesPerSecond = {frame_rate}
    metersPerUnit = 1
    startTimeCode = {first_frame}
    timeCodesPerSecond = {frame_rate}
    upAxis = \"Y\"
)

def Mesh \"Cloth\"
{{
    uniform bool doubleSided = 1
    uniform token subdivisionScheme = \"none\"
    int[] faceVertexCounts = "
    )?;
    list(file, triangles.iter().map(|_| 3))?;
    file.write_all(b"\n    int[] faceVertexIndices = ")?;
    list(file, triangles.as_flattened().iter())?;
    file.write_all(b"\n    point3f[] points.timeSamples = {\n")
}

/// A point as text. USD accepts `nan` in lower case only.
fn point([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})").replace("NaN", "nan")
}

/// Writes the end time with a fixed width, so that it can be overwritten when the last frame is known.
fn end_time(file: &mut impl Write, frame: u32) -> io::Result<()> {
    write!(file, "{frame:>10}")
}

fn list<T: Display>(file: &mut impl Write, items: impl Iterator<Item = T>) -> io::Result<()> {
    file.write_all(b"[")?;
    for (place, item) in items.enumerate() {
        write!(file, "{}{item}", if place > 0 { ", " } else { "" })?;
    }
    file.write_all(b"]")
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::tests::export;

    #[test]
    fn writes_a_mesh_in_motion() {
        let dir = tempfile::tempdir().unwrap();
        let paths = export(dir.path(), Format::Usda, 3, 15).finish().unwrap();
        let text = std::fs::read_to_string(&paths[0]).unwrap();
        for part in [
            "#usda 1.0\n",
            "endTimeCode =         14\n",
            "startTimeCode = 3\n",
            "timeCodesPerSecond = 25\n",
            "upAxis = \"Y\"",
            "faceVertexCounts = [3, 3]\n",
            "faceVertexIndices = [0, 1, 2, 0, 2, 3]\n",
            "        14: [(0, 14, 0), (1, 14, 0), (1, 14, 0.1), (0, 14, 1)],\n    }\n}\n",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
        assert_eq!(text.matches(['{', '[', '(']).count(), text.matches(['}', ']', ')']).count());
    }

    #[test]
    fn ends_with_its_last_frame_where_nothing_is_added() {
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), Format::Usda, 0, 3).flush().unwrap();
        let paths = export(dir.path(), Format::Usda, 3, 3).finish().unwrap();
        let text = std::fs::read_to_string(&paths[0]).unwrap();
        assert!(text.contains("endTimeCode =          2\n"), "{text}");
    }
}
