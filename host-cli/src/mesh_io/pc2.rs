//! Point Cache 2: the positions of all vertices in each sample. A header of 32 bytes (magic, version, points,
//! start, rate, samples) comes first, then all samples, little-endian f32.

use std::path::Path;

use muslin_core::scene::PointCache;

use super::MeshFileError;
use crate::limits;

const MAGIC: &[u8] = b"POINTCACHE2\0";
const HEADER_BYTES: usize = 32;
const POINT_BYTES: u128 = 12;

/// An error in a point cache.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Pc2Error {
    /// The magic bytes are wrong.
    #[error("it does not begin with POINTCACHE2; it is not a PC2 point cache")]
    Magic,
    /// The file ends within the header.
    #[error("it has {0} bytes, not even a header; it is truncated; get a complete copy")]
    Header(usize),
    /// Only version 1 exists.
    #[error("its version is {0}; only version 1 is known")]
    Version(i32),
    /// A count is zero or negative.
    #[error("it has {points} points and {samples} samples; both must be 1 or more")]
    Empty {
        /// Points of each sample in the header.
        points: i32,
        /// Number of samples in the header.
        samples: i32,
    },
    /// The start or the rate is not finite, or the rate is not positive.
    #[error(
        "it starts at {start} with a sample every {rate} frames; the rate must be positive and both must be finite"
    )]
    Time {
        /// Time of the first sample, in frames.
        start: f32,
        /// Time between samples, in frames.
        rate: f32,
    },
    /// The file is shorter or longer than its header says.
    #[error("it has {found} bytes, but {samples} samples of {points} points make {expected}; get a complete copy")]
    Size {
        /// Points of each sample in the header.
        points: i32,
        /// Number of samples in the header.
        samples: i32,
        /// Expected size in bytes, header included.
        expected: u128,
        /// Actual size in bytes, header included.
        found: usize,
    },
    /// A position is NaN or infinite.
    #[error("sample {sample} has no finite position for point {point} (the first is 0)")]
    NotFinite {
        /// Counted from 0.
        sample: usize,
        /// Counted from 0.
        point: usize,
    },
}

/// Loads the point cache in `path`.
pub fn load(path: &Path) -> Result<PointCache, MeshFileError> {
    let owned = || path.to_path_buf();
    let bytes = limits::read(path, limits::DATA).map_err(|cause| MeshFileError::Read { path: owned(), cause })?;
    parse(&bytes).map_err(|cause| MeshFileError::Pc2 { path: owned(), cause })
}

/// Reads the bytes of a point cache.
pub fn parse(bytes: &[u8]) -> Result<PointCache, Pc2Error> {
    let begins = bytes.starts_with(&MAGIC[..MAGIC.len().min(bytes.len())]);
    let (header, body) = match bytes.split_first_chunk::<HEADER_BYTES>() {
        _ if !begins => return Err(Pc2Error::Magic),
        None => return Err(Pc2Error::Header(bytes.len())),
        Some(parts) => parts,
    };
    let (words, _) = header[MAGIC.len()..].as_chunks::<4>();
    let [version, points, samples] = [0, 1, 4].map(|k| i32::from_le_bytes(words[k]));
    let [start, rate] = [2, 3].map(|k| f32::from_le_bytes(words[k]));
    if version != 1 {
        return Err(Pc2Error::Version(version));
    }
    let (Ok(points_each @ 1..), Ok(1..)) = (usize::try_from(points), usize::try_from(samples)) else {
        return Err(Pc2Error::Empty { points, samples });
    };
    if !start.is_finite() || !rate.is_finite() || rate <= 0.0 {
        return Err(Pc2Error::Time { start, rate });
    }
    let expected = HEADER_BYTES as u128 + points as u128 * samples as u128 * POINT_BYTES;
    if bytes.len() as u128 != expected {
        return Err(Pc2Error::Size { points, samples, expected, found: bytes.len() });
    }
    let point = |bytes: &[u8; 12]| [0, 4, 8].map(|k| f32::from_le_bytes([0, 1, 2, 3].map(|b| bytes[k + b])));
    let positions: Vec<[f32; 3]> = body.as_chunks::<12>().0.iter().map(point).collect();
    match positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(k) => Err(Pc2Error::NotFinite { sample: k / points_each, point: k % points_each }),
        None => Ok(PointCache { points: points as u32, positions }),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::tests::data;
    use super::*;

    /// A file with two samples of three points, whose coordinates count up.
    fn file() -> Vec<u8> {
        let mut bytes = b"POINTCACHE2\0".to_vec();
        bytes.extend([1_i32, 3].map(i32::to_le_bytes).as_flattened());
        bytes.extend([5_f32, 0.5].map(f32::to_le_bytes).as_flattened());
        bytes.extend(2_i32.to_le_bytes());
        (0..18_u8).for_each(|x| bytes.extend(f32::from(x).to_le_bytes()));
        bytes
    }

    /// The file with a word changed.
    fn with(place: usize, word: [u8; 4]) -> Vec<u8> {
        let mut bytes = file();
        bytes[place..place + 4].copy_from_slice(&word);
        bytes
    }

    fn message(bytes: &[u8]) -> String {
        parse(bytes).unwrap_err().to_string()
    }

    #[test]
    fn reads_header_and_samples() {
        let cache = parse(&file()).unwrap();
        assert_eq!((cache.points, cache.frames()), (3, 2));
        assert_eq!(cache.positions[..3], [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0]]);
        assert_eq!(cache.positions[3..], [[9.0, 10.0, 11.0], [12.0, 13.0, 14.0], [15.0, 16.0, 17.0]]);
    }

    #[test]
    fn says_what_is_wrong() {
        assert!(message(b"v 0 0 0\n").contains("does not begin with POINTCACHE2"));
        assert!(message(&with(8, *b"E3\0\0")).contains("does not begin with POINTCACHE2"));
        assert!(message(b"").contains("0 bytes, not even a header"));
        assert!(message(&file()[..31]).contains("31 bytes, not even a header"));
        assert!(message(&with(12, 2_i32.to_le_bytes())).contains("version is 2"));
        assert!(message(&with(16, 0_i32.to_le_bytes())).contains("0 points and 2 samples"));
        assert!(message(&with(28, 0_i32.to_le_bytes())).contains("3 points and 0 samples"));
        assert!(message(&with(28, (-1_i32).to_le_bytes())).contains("3 points and -1 samples"));
        assert!(message(&with(20, f32::NAN.to_le_bytes())).contains("starts at NaN"));
        assert!(message(&with(24, 0_f32.to_le_bytes())).contains("every 0 frames"));
        assert!(message(&file()[..103]).contains("103 bytes, but 2 samples of 3 points make 104"));
        assert!(message(&[file(), vec![0]].concat()).contains("105 bytes"));
        let infinite = f32::INFINITY.to_le_bytes();
        assert!(message(&with(32 + 12 * 5 + 8, infinite)).contains("sample 1 has no finite position for point 2 "));
    }

    #[test]
    fn a_false_count_reserves_nothing() {
        let mut bytes = with(16, i32::MAX.to_le_bytes());
        bytes[28..32].copy_from_slice(&i32::MAX.to_le_bytes());
        assert!(message(&bytes).contains("make 55340232169589047340"), "{}", message(&bytes));
    }

    #[test]
    fn survives_damage() {
        for place in 0..file().len() {
            assert!(parse(&file()[..place]).is_err());
            for byte in [0, 1, 0x7f, 0x80, 0xff] {
                let mut damaged = file();
                damaged[place] = byte;
                let _ = parse(&damaged);
            }
        }
    }

    #[test]
    fn names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bad.pc2");
        assert!(load(&path).unwrap_err().to_string().starts_with("cannot read "));
        fs::write(&path, "solid").unwrap();
        assert!(load(&path).unwrap_err().to_string().contains("bad.pc2: it does not begin"));
    }

    #[test]
    fn reads_the_kick() {
        let Some(path) = data("garment/body_kick.pc2") else { return };
        let cache = load(&path).unwrap();
        assert_eq!((cache.points, cache.frames()), (12_811, 121));
    }
}
