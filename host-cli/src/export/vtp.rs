//! VTK XML PolyData (docs.vtk.org, VTKXMLFileFormats) with inline base64 arrays, and the JSON index with which
//! ParaView opens the files as one animation.

use std::io::{self, Write};
use std::path::PathBuf;

use serde_json::json;

use super::series::Series;
use super::whole::{self, WriteError};
use super::{Clip, Writer};

/// The files of the frames.
pub const FRAMES: Series = Series { folder: "vtp", stem: "cloth", ending: "vtp" };

/// Writes `vtp/cloth_00000.vtp` and so on, and `cloth.vtp.series`.
pub struct Vtp {
    /// The polygons, which all frames share.
    polygons: String,
}

impl Vtp {
    /// Encodes the triangles, once for all frames.
    pub fn new(clip: &Clip) -> Vtp {
        let connectivity = clip.triangles.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        let offsets = (1..=clip.triangles.len() as u32).flat_map(|k| (3 * k).to_le_bytes()).collect();
        Vtp { polygons: array("UInt32", "connectivity", 1, connectivity) + &array("UInt32", "offsets", 1, offsets) }
    }
}

impl Writer for Vtp {
    fn begins(&self, clip: &Clip) -> u32 {
        FRAMES.begins(&clip.dir, clip.first_frame)
    }

    fn frame(&mut self, clip: &Clip, frame: u32, positions: &[[f64; 3]]) -> Result<(), WriteError> {
        whole::write(clip.dir.join(FRAMES.name(frame)), |file| self.piece(file, clip, positions))?;
        Ok(())
    }

    fn finish(self: Box<Self>, clip: &Clip, frames: u32) -> Result<Vec<PathBuf>, WriteError> {
        // The run may have been longer before it was resumed.
        FRAMES.remove(&clip.dir, frames);
        let entry = |frame| json!({ "name": FRAMES.name(frame), "time": f64::from(frame) / clip.frame_rate });
        let files: Vec<_> = (self.begins(clip)..frames).map(entry).collect();
        let series = json!({ "file-series-version": "1.0", "files": files });
        Ok(vec![whole::write(clip.dir.join("cloth.vtp.series"), |file| writeln!(file, "{series:#}"))?])
    }
}

impl Vtp {
    fn piece(&self, file: &mut impl Write, clip: &Clip, positions: &[[f64; 3]]) -> io::Result<()> {
        let bytes = positions.as_flattened().iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
        write!(
            file,
            r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<Piece NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}">
<Points>
{}</Points>
<Polys>
{}</Polys>
</Piece>
</PolyData>
</VTKFile>
"#,
            positions.len(),
            clip.triangles.len(),
            array("Float32", "Points", 3, bytes),
            self.polygons
        )
    }
}

/// An XML array element: the number of bytes and the bytes, encoded together.
fn array(kind: &str, name: &str, components: u32, bytes: Vec<u8>) -> String {
    let mut block = (bytes.len() as u64).to_le_bytes().to_vec();
    block.extend(bytes);
    let text = base64(&block);
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">\n{text}\n</DataArray>\n"
    )
}

/// Base64 with padding [RFC 4648].
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, k| bits << 8 | usize::from(*group.get(k).unwrap_or(&0)));
        let digit = |k: usize| if k <= group.len() { DIGITS[bits >> (18 - 6 * k) & 63] } else { b'=' };
        text.extend((0..4).map(|k| char::from(digit(k))));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::tests::export;
    use super::base64;
    use serde_json::Value;
    use std::fs;
    use std::path::Path;

    fn series(dir: &Path) -> Vec<(String, f64)> {
        let text = fs::read(dir.join("cloth.vtp.series")).unwrap();
        let json: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["file-series-version"], "1.0");
        let entry = |file: &Value| (file["name"].as_str().unwrap().into(), file["time"].as_f64().unwrap());
        json["files"].as_array().unwrap().iter().map(entry).collect()
    }

    #[test]
    fn base64_of_the_rfc() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(texts, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }

    #[test]
    fn lists_all_frames_with_their_times() {
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), Format::Vtp, 0, 2).flush().unwrap();
        export(dir.path(), Format::Vtp, 2, 3).finish().unwrap();
        let files = series(dir.path());
        assert_eq!(files.iter().map(|(_, time)| *time).collect::<Vec<_>>(), [0.0, 0.04, 0.08]);
        assert!(files.iter().all(|(name, _)| dir.path().join(name).exists()));
    }

    #[test]
    fn writes_polydata() {
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), Format::Vtp, 5, 6).finish().unwrap();
        assert_eq!(series(dir.path()), [("vtp/cloth_00005.vtp".into(), 0.2)]);
        let text = fs::read_to_string(dir.path().join("vtp/cloth_00005.vtp")).unwrap();
        assert!(text.contains("NumberOfPoints=\"4\"") && text.contains("NumberOfPolys=\"2\""));
        // The number of bytes (24, as 64 bits), then the indices 0 1 2 0 2 3.
        let connectivity = [24, 0, 0, 1, 2, 0, 2, 3].map(u32::to_le_bytes).concat();
        assert!(text.contains(&base64(&connectivity)));
    }
}
