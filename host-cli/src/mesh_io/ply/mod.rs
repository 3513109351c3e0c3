//! Stanford PLY (paulbourke.net/dataformats/ply), ascii and binary of either byte order: the positions of element
//! `vertex`, its texture coordinates if it has them, and the polygons of element `face`. Other elements and
//! properties are ignored.

mod body;
mod header;

use muslin_core::mesh::TriMesh;

use super::polygon;
use body::Body;
use header::Element;

/// An error in a PLY file.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum PlyError {
    /// A line of the header is invalid.
    #[error("line {line}: `{text}` is not a PLY header line that can stand here")]
    Header {
        /// Counted from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// The file ends before the header does.
    #[error("the header has no `end_header` line; the file is truncated or is not a PLY file")]
    NoEnd,
    /// The vertices have no position, or the header gives no format.
    #[error("the header has no {0}; export the mesh again with it")]
    Lacks(&'static str),
    /// The body ends too early.
    #[error("the file ends in {element} {item} of {count}; it is truncated; get a complete copy")]
    Truncated {
        /// Name of the element.
        element: String,
        /// Counted from 0.
        item: usize,
        /// Number of items promised in the header.
        count: usize,
    },
    /// A word of an ascii body is not a number, or a list has an impossible length.
    #[error("{element} {item} holds something that is not a number or a list length; the file is damaged")]
    Number {
        /// Name of the element.
        element: String,
        /// Counted from 0.
        item: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but the file has {count} vertices (the first is 0)")]
    OutOfRange {
        /// Counted from 0.
        face: usize,
        /// The index in the file.
        index: f64,
        /// Number of vertices.
        count: usize,
    },
    /// A face of one or two corners.
    #[error("face {face} has {corners} corners; it needs three or more")]
    FewCorners {
        /// Counted from 0.
        face: usize,
        /// Number of corners.
        corners: usize,
    },
}

/// Reads the bytes of a PLY file.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, PlyError> {
    let (format, elements, body) = header::read(bytes)?;
    let mut body = Body::new(format, body);
    let mut mesh = TriMesh::default();
    let mut faces = Vec::new();
    for element in &elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut mesh)?,
            "face" => faces = read_faces(&mut body, element)?,
            _ => body::read(&mut body, element, |_, _| ())?,
        }
    }
    for (face, corners) in faces.iter().enumerate() {
        add_face(&mut mesh, face, corners)?;
    }
    if !mesh.uvs.is_empty() {
        mesh.uv_triangles = mesh.triangles.clone();
    }
    Ok(mesh)
}

fn read_vertices(body: &mut Body, element: &Element, mesh: &mut TriMesh) -> Result<(), PlyError> {
    let place = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(place) else {
        return Err(PlyError::Lacks("x, y and z of `vertex`"));
    };
    let texture = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]]
        .iter()
        .find_map(|names| Some([place(names[0])?, place(names[1])?]));
    let last = element.properties.len() - 1;
    let mut vertex = vec![0.0; element.properties.len()];
    body::read(body, element, |place, values| {
        vertex[place] = values.first().copied().unwrap_or(0.0);
        if place == last {
            mesh.positions.push([vertex[x], vertex[y], vertex[z]]);
            mesh.uvs.extend(texture.map(|[u, v]| [vertex[u], vertex[v]]));
        }
    })
}

fn read_faces(body: &mut Body, element: &Element) -> Result<Vec<Vec<f64>>, PlyError> {
    let corners = element
        .properties
        .iter()
        .position(|p| matches!(p.name.as_str(), "vertex_indices" | "vertex_index") && p.length.is_some())
        .ok_or(PlyError::Lacks("list `vertex_indices` of `face`"))?;
    let mut faces = Vec::new();
    body::read(body, element, |place, values| {
        if place == corners {
            faces.push(values.to_vec());
        }
    })?;
    Ok(faces)
}

fn add_face(mesh: &mut TriMesh, face: usize, corners: &[f64]) -> Result<(), PlyError> {
    if corners.len() < 3 {
        return Err(PlyError::FewCorners { face, corners: corners.len() });
    }
    let count = mesh.positions.len();
    let vertex = |&index: &f64| {
        let good = index >= 0.0 && index < count as f64 && index.fract() == 0.0;
        if good { Ok(index as u32) } else { Err(PlyError::OutOfRange { face, index, count }) }
    };
    let corners = corners.iter().map(vertex).collect::<Result<Vec<u32>, _>>()?;
    let triangles = polygon::triangles(&corners, &mesh.positions);
    mesh.triangles.extend(triangles.iter().map(|triangle| triangle.map(|k| corners[k])));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASCII: &str = "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement skeleton 1\nproperty list uchar float bones
element vertex 4\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\nproperty float s\nproperty float t
element face 2\nproperty list uchar int vertex_indices\nproperty short group\nend_header
2 0.5 0.25\n255 0 0 0 0 0\n0 1 0 0 1 0\n0 1 1e0 0 1 1\n0 0 1 0 0 1\n4 0 1 2 3 7\n3 0 1 3 8\n";

    /// The mesh of `ASCII`, its vertices after its faces.
    fn binary_file(format: &str, order: fn(&mut [u8])) -> Vec<u8> {
        let mut file = format!(
            "ply\nformat {format} 1.0\nelement face 2\nproperty uint8 flag\nproperty list int uint vertex_index
element none 900000000000000000\nelement vertex 4\nproperty list ushort int8 bones\nproperty float x\nproperty int16 y
property float64 z\nend_header\n"
        )
        .into_bytes();
        let mut put = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            order(&mut bytes);
            file.extend(bytes);
        };
        for face in [&[0, 1, 2, 3][..], &[0, 1, 3]] {
            put(&[9]);
            put(&(face.len() as i32).to_le_bytes());
            face.iter().for_each(|v: &u32| put(&v.to_le_bytes()));
        }
        for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1_i16]] {
            put(&2_u16.to_le_bytes());
            put(&[1]);
            put(&[2]);
            put(&f32::from(x).to_le_bytes());
            put(&y.to_le_bytes());
            put(&0_f64.to_le_bytes());
        }
        file
    }

    fn files() -> [Vec<u8>; 3] {
        let little = binary_file("binary_little_endian", |_| ());
        [ASCII.as_bytes().to_vec(), little, binary_file("binary_big_endian", <[u8]>::reverse)]
    }

    fn message(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn reads_all_formats() {
        for file in files() {
            let mesh = parse(&file).unwrap();
            assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
            assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
            assert_eq!(mesh.check(), Ok(()));
        }
    }

    #[test]
    fn reads_texture_coordinates() {
        let mesh = parse(ASCII.as_bytes()).unwrap();
        assert_eq!(mesh.uvs[2], [1.0, 1.0]);
        assert_eq!(mesh.uv_triangles, mesh.triangles);
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        assert!(message("solid x\n").contains("line 1: `solid x`"));
        assert!(message("").contains("not a PLY file"));
        assert!(message("ply\nend_header\n").contains("`format` line"));
        assert!(message("ply\nformat ascii 1.0\nproperty float x\n").contains("line 3: `property float x`"));
        assert!(message("ply\nformat ascii 1.0\nelement vertex -1\n").contains("line 3"));
        assert!(message("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n").contains("x, y and z"));
        assert!(message(&ASCII.replace("4 0 1 2 3", "4 0 1 2 4")).contains("face 0 names vertex 4"));
        assert!(message(&ASCII.replace("4 0 1 2 3", "4 0 1 2 -1")).contains("names vertex -1"));
        assert!(message(&ASCII.replace("3 0 1 3 8", "2 0 1 3")).contains("face 1 has 2 corners"));
        assert!(message(&ASCII.replace("3 0 1 3 8", "-3 0 1 3")).contains("face 1 holds"));
        assert!(message(&ASCII.replace("3 0 1 3 8", "3 0 1 x 8")).contains("face 1 holds"));
        assert!(message(&ASCII.replace("face 2", "face 3")).contains("ends in face 2 of 3"));
        assert!(message(&ASCII.replace("vertex_indices", "corners")).contains("`vertex_indices`"));
    }

    #[test]
    fn a_false_count_reserves_nothing() {
        let huge = message(&ASCII.replace("vertex 4", "vertex 18446744073709551615"));
        assert!(huge.contains("vertex"), "{huge}");
        let mut file = files()[1].clone();
        let end = file.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        file[end + 1..end + 5].copy_from_slice(&i32::MAX.to_le_bytes());
        assert_eq!(parse(&file), Err(PlyError::Truncated { element: "face".into(), item: 0, count: 2 }));
    }

    #[test]
    fn survives_damage() {
        for file in files() {
            for place in 0..file.len() {
                assert!(parse(&file[..place]).is_err() || place + 2 > file.len());
                for byte in [0, 1, b'\n', b' ', b'-', b'9', 0x7f, 0x80, 0xff] {
                    let mut damaged = file.clone();
                    damaged[place] = byte;
                    let _ = parse(&damaged);
                }
            }
        }
    }
}
