//! The rest shape: triangles laid flat, and the lengths, angles and areas derived from them; from the mesh as
//! it stands or from texture coordinates.

use std::f64::consts::PI;

use glam::{DMat2, DVec2, DVec3};
use harness::kit::double as kit;
use harness::rng::Rng;
use harness::states::{many, triangle};
use harness::worst::{Worst, norm};
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::mesh::rest::{self, RestSource, RestTriangle, flat_span};
use muslin_core_f64::scene::{BuiltScene, Content};

use super::{cloth, scene};

const ROUNDING: f64 = 1e-14;

/// dx/du and dx/dv of a triangle, computed from its weights.
fn gradient(rest: &RestTriangle, x: [DVec3; 3]) -> [DVec3; 2] {
    let ([pj, pk, qj, qk], d1, d2) = (rest.weights(), x[1] - x[0], x[2] - x[0]);
    [d1 * pj + d2 * pk, d1 * qj + d2 * qk]
}

/// Tests both windings.
#[test]
fn weights_of_a_rest_triangle_reproduce_the_identity() {
    let mut worst = Worst::new("gradient of the rest shape against the identity", 1e-13);
    for (i, s) in many(101, 200, triangle).iter().enumerate() {
        let [a, b, c] = s.part.rest;
        for corners in [[a, b, c], [a, c, b]] {
            let got = gradient(&RestTriangle { corners }, corners.map(|x| x.extend(0.0)));
            worst.vectors(1.0, &got, &[DVec3::X, DVec3::Y], || s.place(i));
        }
    }
    worst.check();
}

/// One triangle in space with texture coordinates.
fn patch(x: [DVec3; 3], uv: Option<[DVec2; 3]>) -> TriMesh {
    TriMesh {
        positions: x.map(|x| x.to_array()).into(),
        triangles: vec![[0, 1, 2]],
        uvs: uv.iter().flatten().map(|uv| uv.to_array()).collect(),
        uv_triangles: uv.iter().map(|_| [0, 1, 2]).collect(),
        stitches: Vec::new(),
    }
}

#[test]
fn the_shape_as_it_stands_is_laid_flat_without_strain() {
    let mut worst = Worst::new("F^T F of a mesh as it stands against the identity", 1e-12);
    for (i, s) in many(102, 50, triangle).iter().enumerate() {
        for uv in [None, Some(s.part.rest)] {
            let rest = rest::triangles(&patch(s.x, uv), RestSource::Shape, 1.0).expect("a good mesh")[0];
            let [wu, wv] = gradient(&rest, s.x);
            worst.compare(1.0, &[wu.length(), wv.length(), wu.dot(wv)], &[1.0, 1.0, 0.0], || s.place(i));
        }
    }
    worst.check();
}

#[test]
fn the_warp_runs_along_u_where_there_are_texture_coordinates() {
    let mut worst = Worst::new("direction of the warp against that of growing u", 1e-12);
    for (i, s) in many(103, 50, triangle).iter().enumerate() {
        let along_u = gradient(&RestTriangle { corners: s.part.rest }, s.x)[0].normalize();
        let rest = rest::triangles(&patch(s.x, Some(s.part.rest)), RestSource::Shape, 1.0).expect("a good mesh")[0];
        worst.vectors(1.0, &gradient(&rest, s.x)[..1], &[along_u], || s.place(i));
    }
    worst.check();
}

/// The warp runs along z in triangles that face x: those with more than 0.8 of the squared normal along x.
#[test]
fn the_warp_runs_along_x_where_there_are_none() {
    let mut worst = Worst::new("direction of the warp against the projected axis", 1e-12);
    for (i, s) in many(104, 50, triangle).iter().enumerate() {
        let normal = (s.x[1] - s.x[0]).cross(s.x[2] - s.x[0]).normalize();
        let axis = if normal.x * normal.x > 0.8 { DVec3::Z } else { DVec3::X };
        let projected = axis.reject_from_normalized(normal).normalize();
        let rest = rest::triangles(&patch(s.x, None), RestSource::Shape, 1.0).expect("a good mesh")[0];
        worst.vectors(1.0, &gradient(&rest, s.x)[..1], &[projected], || s.place(i));
    }
    worst.check();
}

const MEMBRANE: &str = r#"
    stretch = { model = "membrane", stiffness = 90.0, weft = 40.0 }
    shear = { stiffness = 20.0 }
    bend = { model = "hinge", rigidity = 1.0 }"#;
const SPRINGS: &str = r#"
    stretch = { model = "spring", stiffness = 90.0 }
    bend = { model = "spring", stiffness = 5.0 }"#;

fn forces(built: &BuiltScene, x: &[DVec3]) -> Vec<DVec3> {
    kit::forces(&built.model.view(), &built.particles.masses, x, &vec![DVec3::ZERO; x.len()])
}

#[test]
fn a_flat_sheet_rests_alike_by_shape_and_by_texture() {
    let (mut worst, rng) = (Worst::new("forces with rest = uv against rest = shape", 1e-12), &mut Rng::new(105));
    for pattern in ["equilateral", "diagonal", "alternating"] {
        for material in [MEMBRANE, SPRINGS] {
            let grid = format!("grid = {{ size = [0.9, 0.7], cells = [4, 3], pattern = \"{pattern}\" }}\n{material}");
            let [shape, uv] = ["shape", "uv"].map(|rest| cloth(&format!("rest = \"{rest}\"\n{grid}")));
            let x: Vec<_> = kit::positions(&shape).iter().map(|&x| x + rng.cube(0.05)).collect();
            let want = forces(&shape, &x);
            worst.vectors(norm(&want), &forces(&uv, &x), &want, || grid.clone());
        }
    }
    worst.check();
}

#[test]
fn every_generator_starts_without_strain() {
    let mut worst = Worst::new("forces of a sheet as it stands, of 90 N/m x 0.1 m", 1e-13);
    let sheets = [
        "grid = { size = [0.9, 0.7], cells = [4, 3] }",
        "grid = { size = [0.9, 0.7], cells = [4, 3], pattern = \"diagonal\" }\nscale = 3.0",
        "tube = { radius = 0.2, height = 0.6, cells = [9, 5] }\nrotation = [30.0, 40.0, 50.0]",
        "disc = { radius = 0.5, hole = 0.1, rings = 4 }\nposition = [1.0, 2.0, 3.0]",
    ];
    for sheet in sheets {
        for material in [MEMBRANE, SPRINGS] {
            let built = cloth(&format!("{sheet}\n{material}"));
            let force = forces(&built, &kit::positions(&built));
            worst.vectors(9.0, &force, &vec![DVec3::ZERO; force.len()], || format!("{sheet}\n{material}"));
        }
    }
    worst.check();
}

/// Edges and row heights equal those of the unrolled tube, not those of the tube itself.
#[test]
fn a_tube_cut_from_a_flat_pattern_has_the_pattern_s_lengths() {
    let (radius, row, around) = (0.2, 0.15, 9.0);
    let built =
        cloth(&format!("rest = \"uv\"\ntube = {{ radius = {radius}, height = 0.6, cells = [9, 4] }}\n{MEMBRANE}"));
    let chord = 2.0 * radius * (PI / around).sin();
    let x = kit::positions(&built);
    let mut worst = Worst::new("rest lengths of a tube against its pattern", ROUNDING);
    for (&[a, b], &length) in built.edges.iter().zip(&built.rest_lengths) {
        let within_a_row = (x[a as usize].y - x[b as usize].y).abs() < 0.5 * row;
        let want = if within_a_row { chord } else { row.hypot(0.5 * chord) };
        worst.compare(chord, &[length], &[want], || format!("edge {a} {b}"));
    }
    worst.check();
    let angles = built.model.view().hinges.expect("hinges").rest_angles;
    assert!(angles.iter().all(|&angle| angle == 0.0), "rest angles of a flat pattern: {angles:?}");
}

#[test]
fn sizes_scale_the_mesh_or_its_pattern() {
    let mut worst = Worst::new("rest lengths and mass of a scaled sheet", ROUNDING);
    let grid = "grid = { size = [0.9, 0.7], cells = [4, 3] }";
    let [plain, scaled, pattern] =
        ["", "scale = 3.0\n", "rest = \"uv\"\nuv_scale = 3.0\n"].map(|line| cloth(&format!("{line}{grid}")));
    for larger in [&scaled, &pattern] {
        for (i, (got, want)) in larger.rest_lengths.iter().zip(&plain.rest_lengths).enumerate() {
            worst.compare(1.0, &[*got], &[3.0 * want], || format!("length {i}"));
        }
        for (i, (got, want)) in larger.particles.masses.iter().zip(&plain.particles.masses).enumerate() {
            worst.compare(1.0, &[*got], &[9.0 * want], || format!("mass {i}"));
        }
    }
    worst.check();
}

/// Two triangles whose common edge is longer in one of them; its rest length is the mean.
#[test]
fn an_edge_of_two_lengths_rests_at_their_mean() {
    let mesh = TriMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, -1.0]],
        triangles: vec![[0, 1, 2], [0, 3, 1]],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 0.0], [6.0, 1.0], [5.0, 1.5]],
        uv_triangles: vec![[0, 1, 2], [3, 4, 5]],
        stitches: Vec::new(),
    };
    // Edge 0-1 has length 1 in the first triangle and 1.5 in the second.
    let built = kit::build_with(&scene("mesh = \"m\"\nrest = \"uv\""), &[("m".into(), Content::Mesh(mesh))]);
    let shared = built.edges.iter().position(|&[a, b]| a.max(b) == 1).expect("the common edge");
    assert_eq!(built.rest_lengths[shared], 1.25, "of all {:?}", built.rest_lengths);
}

#[test]
fn a_flat_span_is_the_distance_of_the_far_corners() {
    let (mut worst, rng) = (Worst::new("span of a hinge laid flat", 1e-13), &mut Rng::new(106));
    for i in 0..1000 {
        let [a, b] = [DVec2::ZERO, DVec2::X * rng.between(0.5, 2.0)];
        let [c, d] = [1.0, -1.0].map(|side| DVec2::new(rng.between(-2.0, 3.0), side * rng.between(0.1, 2.0)));
        let area = |far: DVec2| DMat2::from_cols(b, far).determinant().abs() / 2.0;
        let sides = [c, d].map(|far| [far.distance(a), far.distance(b)]);
        let span = flat_span(b.x, [area(c), area(d)], sides);
        worst.compare(c.distance(d), &[span], &[c.distance(d)], || format!("hinge {i}: {b}, {c}, {d}"));
    }
    worst.check();
}

/// A mesh whose triangles are wound at random has the same forces.
#[test]
fn winding_does_not_matter() {
    let (mut worst, rng) = (Worst::new("forces of a rewound tube", 1e-12), &mut Rng::new(107));
    let tube = cloth("tube = { radius = 0.2, height = 0.6, cells = [9, 5] }");
    let mut mesh = TriMesh {
        positions: tube.particles.positions.iter().map(|x| x.to_array()).collect(),
        triangles: tube.triangles.clone(),
        ..TriMesh::default()
    };
    let x: Vec<_> = kit::positions(&tube).iter().map(|&x| x + rng.cube(0.02)).collect();
    let build = |mesh: &TriMesh| {
        kit::build_with(&scene(&format!("mesh = \"m\"\n{MEMBRANE}")), &[("m".into(), Content::Mesh(mesh.clone()))])
    };
    let want = forces(&build(&mesh), &x);
    for round in 0..20 {
        for triangle in &mut mesh.triangles {
            if rng.bits() % 2 == 0 {
                triangle.swap(1, 2);
            }
        }
        worst.vectors(norm(&want), &forces(&build(&mesh), &x), &want, || format!("round {round}"));
    }
    worst.check();
}

/// Rotates about x, then y, then z, by exact quarter turns; then translates.
#[test]
fn a_sheet_is_rotated_and_then_moved() {
    let sheet =
        |lines: &str| kit::positions(&cloth(&format!("grid = {{ size = [2.0, 4.0], cells = [1, 1] }}\n{lines}")));
    assert_eq!(sheet("")[0], DVec3::new(-1.0, 0.0, -2.0), "corner 0");
    // x: (-1, 2, 0); y: (0, 2, 1); z: (-2, 0, 1).
    let turned = sheet("rotation = [90.0, 90.0, 90.0]\nposition = [10.0, 20.0, 30.0]");
    assert_eq!(turned[0], DVec3::new(8.0, 20.0, 31.0), "corner 0 turned about x, y, z and moved");
    let tilted = sheet("rotation = [0.0, 0.0, 30.0]");
    let want = DVec3::new(-(3.0_f64.sqrt()) / 2.0, -0.5, -2.0);
    assert!((tilted[0] - want).length() < 1e-15, "corner 0 turned by 30 degrees: {}, expected {want}", tilted[0]);
}
