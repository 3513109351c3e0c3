//! Real meshes of `shared/data`, read by simple parsers.

use std::fs;
use std::path::{Path, PathBuf};

use muslin_core::mesh::{Stitch, TriMesh};

/// A file of `shared/data`. If it is absent and `MUSLIN_REQUIRE_DATA` is not 1, prints a note and returns
/// `None`.
pub fn path(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
        eprintln!("skipped: {} is absent", path.display());
        return None;
    }
    Some(path)
}

/// Vertices, triangles and stitches of an OBJ file.
pub fn obj(name: &str) -> Option<TriMesh> {
    let text = fs::read_to_string(path(name)?).expect("the mesh can be read");
    let mut mesh = TriMesh::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let number = |k: usize| words[k].parse::<f64>().expect("a number");
        let index = |k: usize| words[k].split('/').next().and_then(|word| word.parse::<u32>().ok()).expect("an index");
        match words.first() {
            Some(&"v") => mesh.positions.push([number(1), number(2), number(3)]),
            Some(&"f") => mesh.triangles.push([index(1) - 1, index(2) - 1, index(3) - 1]),
            Some(&"stitch") => {
                mesh.stitches.push(Stitch { a: index(1), edge: [index(2), index(3)], weight: number(4) });
            }
            _ => {}
        }
    }
    Some(mesh)
}

/// A big-endian PLY file with three floats per vertex, and triangles: the format of the cloth on a ball.
pub fn ply(name: &str) -> Option<TriMesh> {
    let bytes = fs::read(path(name)?).expect("the mesh can be read");
    let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let count = |element: &str| -> usize {
        let line = header.lines().find_map(|line| line.strip_prefix(element)).expect("the element");
        line.trim().parse().expect("its count")
    };
    let (vertices, faces) = bytes[end..].split_at(12 * count("element vertex"));
    let word = |bytes: &[u8], k: usize| u32::from_be_bytes(bytes[k..k + 4].try_into().expect("four bytes"));
    let float = |bytes: &[u8], k: usize| f64::from(f32::from_bits(word(bytes, k)));
    Some(TriMesh {
        positions: vertices.chunks_exact(12).map(|v| [0, 4, 8].map(|k| float(v, k))).collect(),
        triangles: faces.chunks_exact(13).map(|f| [1, 5, 9].map(|k| word(f, k))).collect(),
        ..TriMesh::default()
    })
}

/// The positions in one frame of a point cache.
pub fn pc2(name: &str, frame: usize) -> Option<Vec<[f64; 3]>> {
    let bytes = fs::read(path(name)?).expect("the cache can be read");
    let float = |k: usize| f32::from_le_bytes(bytes[k..k + 4].try_into().expect("four bytes"));
    let points = float(16).to_bits() as usize;
    let start = 32 + 12 * points * frame;
    Some((0..points).map(|v| [0, 4, 8].map(|k| f64::from(float(start + 12 * v + k)))).collect())
}
