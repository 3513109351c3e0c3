//! Meshes that are invalid as cloth: exit code 2, a message that names the invalid part, no files written.

use crate::kit::{Place, TINY};

/// A folder with the tiny scene as `scene.toml`, its grid replaced by a mesh file and only vertex 0 pinned.
fn place(file: &str, mesh: &str) -> Place {
    let place = Place::new();
    let scene = TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", &format!("mesh = \"{file}\""));
    place.write("scene.toml", scene.replace("corners = [0, 1]", "vertices = [0]"));
    place.write(file, mesh);
    place
}

#[track_caller]
fn refuses(file: &str, mesh: &str, parts: &[&str]) {
    place(file, mesh).refuses("scene.toml", parts);
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";

#[test]
fn what_is_fine() {
    place("mesh.obj", TRIANGLE).run("scene.toml");
}

#[test]
fn indices() {
    refuses("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 9\n", &["mesh.obj: line 4", "vertex `9`", "define 3"]);
    refuses("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 0 1 2\n", &["mesh.obj: line 4", "vertex `0`"]);
    refuses("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 2\n", &["triangle 0", "vertex 1 twice", "(mesh.obj)"]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 7\n";
    refuses("mesh.ply", ply, &["7"]);
    place("mesh.ply", &ply.replace("0 1 7", "0 1 2")).run("scene.toml");
}

#[test]
fn numbers() {
    refuses("mesh.obj", &TRIANGLE.replace("v 1 0 0", "v 1 nan 0"), &["vertex 1 is not a finite number"]);
    refuses("mesh.obj", &TRIANGLE.replace("v 1 0 0", "v 1 inf 0"), &["vertex 1 is not a finite number"]);
    refuses("mesh.obj", &TRIANGLE.replace("v 1 0 0", "v 1 one 0"), &["mesh.obj: line 2", "`one`"]);
    refuses("mesh.obj", &TRIANGLE.replace("v 0 0 1", "v 2 0 0"), &["triangle 0 has no area"]);
}

#[test]
fn connections() {
    let fan = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 1\nv 0 2 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    refuses("mesh.obj", fan, &["edge between vertices 0 and 1", "more than two triangles"]);
    refuses(
        "mesh.obj",
        &format!("v 5 5 5\n{}", TRIANGLE.replace("1 2 3", "2 3 4")),
        &["vertex 0 belongs to no triangle"],
    );
    refuses(
        "mesh.obj",
        &format!("{TRIANGLE}v 5 5 5\nv 6 6 6\n"),
        &["2 vertices, the first of them 3, belong to no triangle"],
    );
}

/// A collider may have vertices that belong to no triangle, but the run notes them.
#[test]
fn loose_vertices_of_a_collider() {
    let place = place("mesh.obj", TRIANGLE);
    place.write("floor.obj", "v -3 -1 -3\nv 0 9 0\nv 3 -1 -3\nv 1 9 0\nv 0 -1 3\nf 1 5 3\n");
    let collider = "\n[contact]\nthickness = 0.01\n[[collider]]\nshape = \"mesh\"\nfile = \"floor.obj\"\n";
    let scene = String::from_utf8(place.read("scene.toml")).unwrap() + collider;
    place.write("scene.toml", scene);
    let note = "floor.obj: 2 vertices belong to no triangle and touch nothing\n";
    let run = "run scene.toml --out out --preview none";
    assert!(place.muslin(run).expect(0).stderr.contains(note));
    assert_eq!(place.muslin(&format!("{run} --quiet")).expect(0).stderr, note, "a warning, and nothing else");
}

/// A triangle as a binary STL.
fn stl() -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file.extend(1_u32.to_le_bytes());
    let corners = [[0.0, 0.0, 1.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0_f32]];
    file.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    file.extend([0; 2]);
    file
}

#[test]
fn files_of_another_kind() {
    let ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nend_header\n\0\x01";
    let fbx = b"Kaydara FBX Binary  \0\x1a\0";
    let page = b"<!DOCTYPE html>\n<title>Not found</title>\n";
    let stl = stl();
    let solid = b"solid cube\nfacet normal 0 0 1\nendsolid\n";
    for (file, bytes, parts) in [
        ("a.obj", ply.as_slice(), ["this is a PLY file, though it ends in .obj", "Stanford PLY (.ply)"]),
        ("a.obj", &stl, ["this is an STL file", "Wavefront OBJ (.obj)"]),
        ("a.obj", solid, ["this is an STL file", "Wavefront OBJ (.obj)"]),
        ("a.obj", fbx, ["this is an FBX file", "Wavefront OBJ (.obj)"]),
        ("a.obj", b"\x01\x02\0\x03", ["this is a binary file", "Wavefront OBJ (.obj)"]),
        ("a.obj", page, ["no line `v x y z`", "not a Wavefront OBJ"]),
        ("a.ply", fbx, ["this is an FBX file, though it ends in .ply", "Stanford PLY (.ply)"]),
        ("a.ply", &stl, ["this is an STL file", "Stanford PLY (.ply)"]),
        ("a.ply", TRIANGLE.as_bytes(), ["line 1: `v 0 0 0`", "not a PLY header line"]),
        ("a.stl", &stl, ["unknown mesh format", "Wavefront OBJ (.obj) and Stanford PLY (.ply)"]),
        ("a.fbx", fbx, ["unknown mesh format", "Wavefront OBJ (.obj) and Stanford PLY (.ply)"]),
    ] {
        let place = place("mesh.obj", TRIANGLE);
        place.write(file, bytes);
        place.refuses(&format!("scene.toml --set cloth.mesh={file}"), &[&[file], parts.as_slice()].concat());
        let detected = place.muslin(&format!("detect {file} --thickness 0")).expect(2);
        assert!(parts.iter().all(|part| detected.stderr.contains(part)), "{file}: {}", detected.stderr);
    }
}

#[test]
fn texture_coordinates() {
    let place = place("mesh.obj", TRIANGLE);
    place.refuses("scene.toml --set cloth.rest=uv", &["rest = \"uv\"", "texture coordinates (vt)", "has none"]);
}

#[test]
fn nothing_to_read() {
    refuses("mesh.obj", "", &["the mesh has no triangles"]);
    refuses("mesh.obj", "v 0 0 0\n", &["the mesh has no triangles"]);
    refuses("mesh.ply", "", &["mesh.ply: "]);
    refuses("mesh.stl", "solid\n", &["mesh.stl", ".obj or .ply"]);
    let place = place("mesh.obj", TRIANGLE);
    place.refuses("scene.toml --set cloth.mesh=none.obj", &["cannot read none.obj"]);
    place.refuses("scene.toml --set cloth.state=none.obj", &["cannot read none.obj"]);
    place.write("short.obj", "v 0 0 0\n");
    place.refuses("scene.toml --set cloth.state=short.obj", &["the start state has 1 vertices, the mesh has 3"]);
}

#[test]
fn names_are_relative_to_the_scene() {
    let place = place("mesh.obj", TRIANGLE);
    std::fs::create_dir(place.path("elsewhere")).unwrap();
    for file in ["scene.toml", "mesh.obj"] {
        std::fs::rename(place.path(file), place.path("elsewhere").join(file)).unwrap();
    }
    place.run("elsewhere/scene.toml");
}
