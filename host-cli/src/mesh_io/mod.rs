//! Reading meshes from files: Wavefront OBJ and Stanford PLY, and their motion from point caches.
//! Vertex order is kept exactly.

mod kind;
mod obj;
pub mod pc2;
mod ply;
mod polygon;

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use muslin_core::mesh::TriMesh;

use crate::limits;

pub use obj::ObjError;
pub use pc2::Pc2Error;
pub use ply::PlyError;

/// The known formats, for error messages.
const READ: &str = "meshes are read from Wavefront OBJ (.obj) and Stanford PLY (.ply)";

/// Why a mesh file could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileError {
    /// The file could not be opened or read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// The file name ends in neither `.obj` nor `.ply`.
    #[error("{}: unknown mesh format; {READ}: give a file that ends in .obj or .ply", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file is of another kind than its name says.
    #[error("{}: this is {kind}, though it ends in .{ending}; {READ}", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// The actual kind.
        kind: &'static str,
        /// How its name ends.
        ending: &'static str,
    },
    /// The OBJ text is malformed.
    #[error("{}: {cause}", path.display())]
    Obj {
        /// The file.
        path: PathBuf,
        /// The place and the problem.
        cause: ObjError,
    },
    /// The PLY file is malformed.
    #[error("{}: {cause}", path.display())]
    Ply {
        /// The file.
        path: PathBuf,
        /// The place and the problem.
        cause: PlyError,
    },
    /// The point cache is malformed.
    #[error("{}: {cause}", path.display())]
    Pc2 {
        /// The file.
        path: PathBuf,
        /// The problem.
        cause: Pc2Error,
    },
}

/// Reads a mesh in the format OBJ.
pub fn parse_obj(bytes: &[u8]) -> Result<TriMesh, ObjError> {
    obj::parse(&String::from_utf8_lossy(bytes))
}

/// Reads a mesh in the format PLY.
pub fn parse_ply(bytes: &[u8]) -> Result<TriMesh, PlyError> {
    ply::parse(bytes)
}

/// Loads the mesh in `path`, in the format that its extension names (`obj` or `ply`, any case).
pub fn load(path: &Path) -> Result<TriMesh, MeshFileError> {
    let owned = || path.to_path_buf();
    let read = || limits::read(path, limits::DATA).map_err(|cause| MeshFileError::Read { path: owned(), cause });
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let other = |kind: Option<&'static str>, ending: &'static str| {
        kind.map_or(Ok(()), |kind| Err(MeshFileError::Kind { path: owned(), kind, ending }))
    };
    match extension.as_deref() {
        Some("obj") => {
            let bytes = read()?;
            other(kind::not_obj(&bytes), "obj")?;
            parse_obj(&bytes).map_err(|cause| MeshFileError::Obj { path: owned(), cause })
        }
        Some("ply") => {
            let bytes = read()?;
            other(kind::not_ply(&bytes), "ply")?;
            parse_ply(&bytes).map_err(|cause| MeshFileError::Ply { path: owned(), cause })
        }
        _ => Err(MeshFileError::UnknownFormat { path: owned() }),
    }
}

/// A note on the vertices of a mesh that belong to no triangle; `None` if every vertex belongs to one.
pub fn loose_note(mesh: &dyn Display, count: usize) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("{mesh}: 1 vertex belongs to no triangle and touches nothing")),
        _ => Some(format!("{mesh}: {count} vertices belong to no triangle and touch nothing")),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A file in `shared/data`. If it is absent and not required, prints a note and returns `None`.
    pub fn data(name: &str) -> Option<PathBuf> {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")).join(name);
        if !path.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
            eprintln!("skipped: {} is absent", path.display());
            return None;
        }
        Some(path)
    }

    fn mesh(name: &str) -> Option<TriMesh> {
        Some(load(&data(name)?).unwrap())
    }

    #[test]
    fn reads_the_dress_pattern() {
        let Some(dress) = mesh("garment/dress.obj") else { return };
        assert_eq!((dress.positions.len(), dress.triangles.len(), dress.stitches.len()), (15_656, 29_456, 851));
        assert!(dress.has_uvs());
        assert_eq!(dress.check(), Ok(()));
        assert_eq!(dress.positions[0], [1.892435e-2, -8.321909e-2, 4.124258e-1]);
        assert_eq!(dress.stitches[0].edge, [37, 704]);
    }

    #[test]
    fn reads_the_body() {
        let Some(body) = mesh("garment/body.obj") else { return };
        assert_eq!((body.positions.len(), body.triangles.len()), (12_811, 25_472));
        assert_eq!(body.triangles[0], [0, 1, 2]);
        assert_eq!(body.check(), Ok(()));
    }

    #[test]
    fn reads_the_cloth_on_a_ball() {
        let Some(cloth) = mesh("cloth-ball/cloth_ball92.ply") else { return };
        assert_eq!((cloth.positions.len(), cloth.triangles.len()), (46_598, 92_230));
        assert_eq!(cloth.check(), Ok(()));
    }

    #[test]
    fn chooses_by_extension_and_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.OBJ");
        fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(load(&path).unwrap().triangles, [[0, 1, 2]]);

        let message = |name: &str| load(&folder.path().join(name)).unwrap_err().to_string();
        assert!(message("a.stl").contains(".obj or .ply"));
        assert!(message("none").contains(".obj or .ply"));
        assert!(message("none.ply").starts_with("cannot read ") && message("none.ply").contains("none.ply"));
        fs::write(folder.path().join("bad.obj"), "\nv 1 x 0\n").unwrap();
        assert!(message("bad.obj").contains("bad.obj: line 2: "));
    }
}
