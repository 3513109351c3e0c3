//! Recognises the kind of a file by its bytes: its name may be wrong.

/// First bytes of files that users may pass as meshes by mistake.
const BEGINNINGS: [(&[u8], &str); 13] = [
    (b"ply\n", "a PLY file"),
    (b"ply\r", "a PLY file"),
    (b"solid ", "an STL file"),
    (b"Kaydara FBX", "an FBX file"),
    (b"; FBX", "an FBX file"),
    (b"glTF", "a glTF file"),
    (b"#usda", "a USD file"),
    (b"PXR-USDC", "a USD file"),
    (b"POINTCACHE2", "a PC2 point cache"),
    (b"BLENDER", "a Blender file"),
    (b"Ogawa", "an Alembic file"),
    (b"PK\x03\x04", "a zip archive"),
    (b"\x1f\x8b", "a gzip archive"),
];

/// The kind of a file that cannot be a Wavefront OBJ file; `None` if it may be one.
pub fn not_obj(bytes: &[u8]) -> Option<&'static str> {
    let begun = BEGINNINGS.iter().find(|(beginning, _)| bytes.starts_with(beginning)).map(|(_, kind)| *kind);
    begun
        .or_else(|| is_binary_stl(bytes).then_some("an STL file"))
        .or_else(|| bytes.contains(&0).then_some("a binary file"))
}

/// The kind of a file that cannot be a Stanford PLY file. `None` if it may be one, and for text of an unknown
/// kind: the parser's message about its first line says more.
pub fn not_ply(bytes: &[u8]) -> Option<&'static str> {
    not_obj(bytes).filter(|_| !bytes.starts_with(b"ply"))
}

/// Whether this is a binary STL file. The format has no magic bytes, so only the length can show it.
fn is_binary_stl(bytes: &[u8]) -> bool {
    const HEADER_BYTES: usize = 80;
    const TRIANGLE_BYTES: u64 = 50;
    let count = bytes.get(HEADER_BYTES..).and_then(|rest| rest.first_chunk()).map(|&count| u32::from_le_bytes(count));
    let length = |count: u32| HEADER_BYTES as u64 + 4 + TRIANGLE_BYTES * u64::from(count);
    count.is_some_and(|count| length(count) == bytes.len() as u64)
}
