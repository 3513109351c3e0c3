//! Meshes that cannot be cloth: exit code 2, a message that says which part, nothing written.

use crate::kit::{Place, TINY};

/// The tiny scene with the mesh of a file and no pins.
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
    refuses("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 2\n", &["triangle 0", "vertex 1 twice"]);
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
