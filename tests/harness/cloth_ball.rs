//! Two frames of a cloth that falls over a ball, from `shared/data`: binary PLY, vertices of
//! three floats, faces of three integers.

use std::path::Path;

/// Both frames.
#[derive(Debug)]
pub struct ClothBall {
    /// Positions in each frame.
    pub frames: [Vec<[f32; 3]>; 2],
    /// The same triangles in both frames.
    pub triangles: Vec<[u32; 3]>,
}

/// The two frames; prints a note and returns `None` if the files are absent and `MUSLIN_REQUIRE_DATA` is not 1.
pub fn load() -> Option<ClothBall> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/cloth-ball"));
    if !folder.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
        eprintln!("skipped: {} is absent", folder.display());
        return None;
    }
    let [(first, triangles), (second, _)] = ["cloth_ball92.ply", "cloth_ball93.ply"].map(|name| {
        let path = folder.join(name);
        read(&std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
    });
    Some(ClothBall { frames: [first, second], triangles })
}

fn read(file: &[u8]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    const END: &[u8] = b"end_header\n";
    let end = file.windows(END.len()).position(|w| w == END).expect("a PLY header") + END.len();
    let header = String::from_utf8_lossy(&file[..end]);
    let count = |key: &str| -> usize {
        let line = header.lines().find_map(|line| line.strip_prefix(key)).expect("an element");
        line.trim().parse().expect("a count")
    };
    let (vertices, faces) = (count("element vertex"), count("element face"));
    let (points, lists) = file[end..].split_at(12 * vertices);
    let word = |bytes: &[u8], k: usize| -> [u8; 4] { std::array::from_fn(|i| bytes[4 * k + i]) };
    let point = |b: &[u8]| std::array::from_fn(|k| f32::from_be_bytes(word(b, k)));
    let face = |b: &[u8]| std::array::from_fn(|k| u32::from_be_bytes(word(&b[1..], k)));
    (points.chunks_exact(12).map(point).collect(), lists.chunks_exact(13).take(faces).map(face).collect())
}
