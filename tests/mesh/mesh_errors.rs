//! Every way in which a mesh is not a valid cloth, and its error message.

use harness::kit::double as kit;
use muslin_core_f64::error::{MeshError, SceneError};
use muslin_core_f64::mesh::{Stitch, TriMesh, edges};
use muslin_core_f64::scene::{Content, build};

use super::scene;

/// Two triangles of a square, with texture coordinates and a stitch.
fn square() -> TriMesh {
    TriMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]],
        triangles: vec![[0, 2, 1], [1, 2, 3]],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]],
        uv_triangles: vec![[0, 2, 1], [1, 2, 3]],
        stitches: vec![Stitch { a: 0, edge: [1, 3], weight: 0.5 }],
    }
}

fn built(lines: &str, meshes: &[(&str, TriMesh)]) -> Result<(), SceneError> {
    let resources: Vec<_> = meshes.iter().map(|(name, mesh)| ((*name).into(), Content::Mesh(mesh.clone()))).collect();
    build(&kit::scene(&scene(lines)), &resources).map(|_| ())
}

/// A new variant breaks this match: add a test for it here.
const fn has_a_test(error: MeshError) -> bool {
    use MeshError::*;
    match error {
        Empty | VertexOutOfRange { .. } | TextureOutOfRange { .. } | NotFinite { .. } | TextureNotFinite { .. } => true,
        RepeatedVertex { .. } | NoArea { .. } | NonManifoldEdge { .. } | LooseVertex { .. } | Hub { .. } => true,
        NoTextureCoordinates | StateLength { .. } | BadStitch { .. } => true,
    }
}

/// Checks that the square, after `spoil`, is refused with this error and this message.
fn refused(spoil: impl FnOnce(&mut TriMesh), expected: MeshError, words: &str) {
    assert!(has_a_test(expected));
    let mut mesh = square();
    spoil(&mut mesh);
    let error = built("mesh = \"m\"", &[("m", mesh.clone())]).expect_err(words);
    assert_eq!(error, SceneError::Mesh { cloth: 0, error: expected }, "for {mesh:?}");
    assert_eq!(error.to_string(), format!("cloth 0: {words}"));
}

#[test]
fn the_square_itself_is_good() {
    for lines in ["mesh = \"m\"", "mesh = \"m\"\nrest = \"uv\""] {
        assert_eq!(built(lines, &[("m", square())]), Ok(()), "{lines}");
    }
}

#[test]
fn empty() {
    refused(|m| m.triangles.clear(), MeshError::Empty, "the mesh has no triangles");
}

#[test]
fn vertex_out_of_range() {
    refused(
        |m| m.triangles[1] = [1, 2, 4],
        MeshError::VertexOutOfRange { triangle: 1, vertex: 4, vertices: 4 },
        "triangle 1 names vertex 4, but there are only 4 (indices count from 0)",
    );
}

#[test]
fn texture_out_of_range() {
    refused(
        |m| m.uv_triangles[1] = [1, 2, 7],
        MeshError::TextureOutOfRange { triangle: 1, coordinate: 7, coordinates: 4 },
        "triangle 1 names texture coordinate 7, but there are only 4",
    );
}

#[test]
fn not_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let words = "the position of vertex 2 is not a finite number (indices count from 0)";
        refused(|m| m.positions[2][1] = bad, MeshError::NotFinite { vertex: 2 }, words);
        let words = "texture coordinate 3 is not a finite number (indices count from 0)";
        refused(|m| m.uvs[3][0] = bad, MeshError::TextureNotFinite { coordinate: 3 }, words);
    }
}

#[test]
fn repeated_vertex() {
    let expected = MeshError::RepeatedVertex { triangle: 1, vertex: 2 };
    refused(|m| m.triangles[1] = [2, 3, 2], expected, "triangle 1 names vertex 2 twice (indices count from 0)");
}

#[test]
fn no_area() {
    // Collinear, and thinner than the rounding error.
    for bad in [[0.5, 0.0, 0.5], [0.5 + 1e-11, 0.0, 0.5]] {
        refused(
            |m| m.positions[3] = bad,
            MeshError::NoArea { triangle: 1 },
            "triangle 1 has no area at rest (indices count from 0)",
        );
    }
    // A triangle ten thousand times longer than thick is still valid.
    let mut sliver = square();
    sliver.positions[3] = [0.5 + 1e-4, 0.0, 0.5];
    assert_eq!(built("mesh = \"m\"", &[("m", sliver)]), Ok(()), "a sliver of aspect 1e4");
    let mut mesh = square();
    mesh.uvs[3] = [0.5, 0.5];
    let error = built("mesh = \"m\"\nrest = \"uv\"", &[("m", mesh)]);
    assert_eq!(error, Err((0, MeshError::NoArea { triangle: 1 }).into()), "a flat pattern without area");
}

#[test]
fn non_manifold_edge_names_the_edge() {
    let words = "the edge between vertices 1 and 2 belongs to more than two triangles; split the mesh there (indices \
                 count from 0)";
    let third = |m: &mut TriMesh| {
        m.positions.push([0.5, 1.0, 0.5]);
        m.triangles.push([4, 2, 1]);
    };
    refused(third, MeshError::NonManifoldEdge { a: 1, b: 2 }, words);
    let fan = [[0, 1, 2], [0, 1, 3], [4, 0, 1]];
    assert_eq!(edges::build(&fan), Err(MeshError::NonManifoldEdge { a: 0, b: 1 }), "whatever the winding");
}

#[test]
fn loose_vertex() {
    refused(
        |m| m.positions.insert(0, [9.0; 3]),
        MeshError::LooseVertex { vertex: 4, count: 1 },
        "vertex 4 belongs to no triangle and would have no mass; remove it (indices count from 0)",
    );
    refused(
        |m| m.positions.extend([[9.0; 3]; 3]),
        MeshError::LooseVertex { vertex: 4, count: 3 },
        "3 vertices, the first of them 4, belong to no triangle and would have no mass; remove them (indices count \
         from 0)",
    );
}

/// The mesh is a fan about vertex 0.
#[test]
fn hub() {
    let fan = |triangles: u32| {
        let rim = (0..=triangles).map(|i| f64::from(i) * 6.0 / f64::from(triangles));
        let mut positions = vec![[0.0; 3]];
        positions.extend(rim.map(|angle| [angle.cos(), 0.0, angle.sin()]));
        TriMesh { positions, triangles: (1..=triangles).map(|i| [0, i, i + 1]).collect(), ..TriMesh::default() }
    };
    assert_eq!(built("mesh = \"m\"", &[("m", fan(10_000))]), Ok(()), "as many as are allowed");
    let words = "more than 10000 triangles meet at vertex 0; split the mesh there (indices count from 0)";
    refused(|m| *m = fan(10_001), MeshError::Hub { vertex: 0, most: 10_000 }, words);
}

#[test]
fn no_texture_coordinates() {
    let bare = TriMesh { uvs: Vec::new(), uv_triangles: Vec::new(), ..square() };
    let error = built("mesh = \"m\"\nrest = \"uv\"", &[("m", bare)]).expect_err("no texture");
    assert_eq!(error, (0, MeshError::NoTextureCoordinates).into());
    let words = "rest = \"uv\" needs texture coordinates (vt), and the mesh has none; use rest = \"shape\"";
    assert_eq!(error.to_string(), format!("cloth 0: {words}"));
}

#[test]
fn start_states_fit_the_mesh() {
    let lines = "mesh = \"m\"\nstate = \"s\"";
    let mut state = square();
    assert_eq!(built(lines, &[("m", square()), ("s", state.clone())]), Ok(()));
    state.positions[1][2] = f64::NAN;
    let error = built(lines, &[("m", square()), ("s", state.clone())]);
    assert_eq!(error, Err((0, MeshError::NotFinite { vertex: 1 }).into()));
    state.positions.pop();
    let error = built(lines, &[("m", square()), ("s", state)]).expect_err("a vertex is missing");
    assert_eq!(error, (0, MeshError::StateLength { expected: 4, found: 3 }).into());
    assert_eq!(error.to_string(), "cloth 0: the start state has 3 vertices, the mesh has 4");
}

const BAD_STITCHES: [Stitch; 5] = [
    Stitch { a: 4, edge: [0, 1], weight: 0.5 },
    Stitch { a: 0, edge: [1, 4], weight: 0.5 },
    Stitch { a: 0, edge: [1, 3], weight: 1.5 },
    Stitch { a: 0, edge: [1, 3], weight: -0.1 },
    Stitch { a: 0, edge: [1, 3], weight: f64::NAN },
];

#[test]
fn bad_stitch() {
    let words = "stitch 1 names a vertex that does not exist, sews a vertex to itself, or has a weight that is not \
                 between 0 and 1";
    for bad in BAD_STITCHES {
        refused(|m| m.stitches.push(bad), MeshError::BadStitch { stitch: 1 }, words);
    }
}

/// Stitches may come from any file, not only from the mesh's own.
#[test]
fn bad_stitch_of_a_seam_file() {
    let lines = "mesh = \"m\"\nseam = [{ file = \"s\", stiffness = 1.0 }]";
    assert_eq!(built(lines, &[("m", square()), ("s", square())]), Ok(()));
    for bad in BAD_STITCHES {
        let seams = TriMesh { stitches: vec![bad], ..TriMesh::default() };
        let error = built(lines, &[("m", square()), ("s", seams)]);
        assert_eq!(error, Err((0, MeshError::BadStitch { stitch: 0 }).into()), "{bad:?}");
    }
    let error = built("mesh = \"m\"\nseam = [{ pairs = [[0, 4]], stiffness = 1.0 }]", &[("m", square())]);
    assert_eq!(error, Err((0, MeshError::BadStitch { stitch: 0 }).into()), "a pair out of range");
}
