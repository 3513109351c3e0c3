//! Point Cache 2 (as read by Blender's mesh cache modifier): a header of 32 bytes, then all
//! frames, little-endian. An interrupted cache can be continued.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

use super::whole::{self, Partial, WriteError};
use super::{Clip, Writer, obj};

const MAGIC: [u8; 12] = *b"POINTCACHE2\0";
const HEADER_BYTES: u64 = 32;

/// Streams `cloth.pc2` and adds `cloth.obj`, the mesh in its first frame.
pub struct Pc2 {
    partial: Partial,
    /// The number of its first frame.
    begins: u32,
}

impl Pc2 {
    /// Continues the cache of an interrupted or shorter run, if it has all frames before the first one and a mesh
    /// of this size; otherwise begins a new cache.
    pub fn begin(clip: &Clip) -> Result<Pc2, WriteError> {
        let path = clip.dir.join("cloth.pc2");
        if clip.first_frame > 0
            && let Some(mut partial) = Partial::reopen(&path)?
            && let Some(begins) = partial.with(|file| rewind(file, clip))?
        {
            return Ok(Pc2 { partial, begins });
        }
        let mut partial = Partial::create(path)?;
        partial.with(|file| file.write_all(&header(clip)))?;
        Ok(Pc2 { partial, begins: clip.first_frame })
    }
}

impl Writer for Pc2 {
    fn begins(&self, _clip: &Clip) -> u32 {
        self.begins
    }

    fn frame(&mut self, _clip: &Clip, _frame: u32, positions: &[[f64; 3]]) -> Result<(), WriteError> {
        let scalars = positions.as_flattened().iter().map(|&x| x as f32);
        self.partial.with(|file| scalars.into_iter().try_for_each(|x| file.write_all(&x.to_le_bytes())))
    }

    fn finish(mut self: Box<Self>, clip: &Clip, _frames: u32) -> Result<Vec<PathBuf>, WriteError> {
        let first = self.partial.with(|file| complete(file, clip))?;
        let mesh = self.partial.path().with_extension("obj");
        let mesh = first.map(|positions| whole::write(mesh, |file| obj::mesh(file, clip, &positions)));
        Ok([self.partial.finish()?].into_iter().chain(mesh.transpose()?).collect())
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        self.partial.sync()
    }
}

/// Magic, version, points, start, sample rate, samples. The number of samples is set when the cache is complete.
fn header(clip: &Clip) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend((clip.points as i32).to_le_bytes());
    bytes.extend((clip.first_frame as f32).to_le_bytes());
    bytes.extend(1_f32.to_le_bytes());
    bytes.extend(0_i32.to_le_bytes());
    bytes
}

fn frame_bytes(clip: &Clip) -> u64 {
    clip.points as u64 * 12
}

/// Truncates an older cache to the frames before the first one. Returns the number of its first frame; `None` if it
/// cannot be continued.
fn rewind(file: &mut BufWriter<File>, clip: &Clip) -> io::Result<Option<u32>> {
    let mut found = Vec::new();
    file.get_mut().take(HEADER_BYTES).read_to_end(&mut found)?;
    let Some(start) = found.get(20..24).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])) else {
        return Ok(None);
    };
    // Headers with the same mesh and start differ only in the number of samples, the last field.
    let older = Clip { first_frame: start as u32, dir: PathBuf::new(), triangles: Vec::new(), ..*clip };
    let length = HEADER_BYTES + u64::from(clip.first_frame.saturating_sub(older.first_frame)) * frame_bytes(clip);
    let same = found.len() as u64 == HEADER_BYTES && header(&older).starts_with(&found[..28]);
    let fit = same && older.first_frame <= clip.first_frame && file.get_ref().metadata()?.len() >= length;
    if fit {
        file.get_ref().set_len(length)?;
        file.seek(SeekFrom::End(0))?;
    }
    Ok(fit.then_some(older.first_frame))
}

/// Sets the number of samples in the header; returns the first frame, if there is one.
fn complete(file: &mut BufWriter<File>, clip: &Clip) -> io::Result<Option<Vec<[f64; 3]>>> {
    let length = file.seek(SeekFrom::End(0))? - HEADER_BYTES;
    let samples = length.checked_div(frame_bytes(clip)).unwrap_or(0);
    file.seek(SeekFrom::Start(HEADER_BYTES - 4))?;
    file.write_all(&(samples as i32).to_le_bytes())?;
    file.flush()?;
    if samples == 0 {
        return Ok(None);
    }
    let mut bytes = vec![[[0; 4]; 3]; clip.points];
    file.get_mut().read_exact(bytes.as_flattened_mut().as_flattened_mut())?;
    Ok(Some(bytes.into_iter().map(|p| p.map(|x| f32::from_le_bytes(x).into())).collect()))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{export, quad};
    use super::super::{Exporter, Format};
    use crate::mesh_io;
    use std::fs;
    use std::path::Path;

    /// Start, samples and height of each frame of a finished cache of quads.
    fn read(dir: &Path) -> (f32, i32, Vec<f32>) {
        let bytes = fs::read(dir.join("cloth.pc2")).unwrap();
        assert_eq!(&bytes[..20], b"POINTCACHE2\0\x01\0\0\0\x04\0\0\0");
        assert_eq!(bytes[24..28], 1_f32.to_le_bytes());
        let float = |place: usize| f32::from_le_bytes(bytes[place..place + 4].try_into().unwrap());
        let frames = bytes[32..].chunks_exact(48).enumerate();
        (float(20), float(28).to_bits() as i32, frames.map(|(k, _)| float(32 + 48 * k + 4)).collect())
    }

    #[test]
    fn writes_header_frames_and_mesh() {
        let dir = tempfile::tempdir().unwrap();
        let paths = export(dir.path(), Format::Pc2, 0, 3).finish().unwrap();
        assert_eq!(paths, [dir.path().join("cloth.pc2"), dir.path().join("cloth.obj")]);
        assert_eq!(read(dir.path()), (0.0, 3, vec![0.0, 1.0, 2.0]));
        assert_eq!(fs::read(&paths[0]).unwrap()[32 + 48 + 32..][..4], (quad(1.0)[2][2] as f32).to_le_bytes());
        assert_eq!(mesh_io::load(&paths[1]).unwrap().positions[1], [1.0, 0.0, 0.0]);
        let cache = mesh_io::pc2::load(&paths[0]).unwrap();
        let frames = [0.0, 1.0, 2.0].map(|y| quad(y).map(|p| p.map(|x| x as f32)));
        assert_eq!(cache.positions, frames.as_flattened());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }

    #[test]
    fn continues_what_was_begun() {
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), Format::Pc2, 0, 5).flush().unwrap();
        export(dir.path(), Format::Pc2, 3, 6).flush().unwrap();
        export(dir.path(), Format::Pc2, 6, 7).finish().unwrap();
        assert_eq!(read(dir.path()), (0.0, 7, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        assert_eq!(mesh_io::load(&dir.path().join("cloth.obj")).unwrap().positions[1], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn begins_anew_when_frames_are_missing() {
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), Format::Pc2, 0, 2).flush().unwrap();
        export(dir.path(), Format::Pc2, 3, 5).flush().unwrap();
        export(dir.path(), Format::Pc2, 4, 5).finish().unwrap();
        assert_eq!(read(dir.path()), (3.0, 2, vec![3.0, 4.0]));
    }

    #[test]
    fn begins_anew_for_another_mesh_or_damage() {
        let dir = tempfile::tempdir().unwrap();
        let partial = dir.path().join("cloth.pc2.partial");
        let mut other = Exporter::create(dir.path(), &[Format::Pc2], &[[0, 1, 2]], 25.0, 0).unwrap();
        (0..9).for_each(|_| other.frame(&[[0.0; 3]; 3]).unwrap());
        other.flush().unwrap();
        export(dir.path(), Format::Pc2, 2, 3).finish().unwrap();
        assert_eq!(read(dir.path()), (2.0, 1, vec![2.0]));

        for damage in [&b""[..], b"POINTCACHE2\0", &[0xff; 500]] {
            fs::write(&partial, damage).unwrap();
            export(dir.path(), Format::Pc2, 2, 3).finish().unwrap();
            assert_eq!(read(dir.path()), (2.0, 1, vec![2.0]));
        }
    }

    #[test]
    fn an_empty_run_gives_an_empty_cache() {
        let dir = tempfile::tempdir().unwrap();
        let paths = export(dir.path(), Format::Pc2, 0, 0).finish().unwrap();
        assert_eq!(paths.len(), 1);
        assert_eq!(read(dir.path()), (0.0, 0, vec![]));
    }
}
