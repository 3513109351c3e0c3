//! Stitches, from pairs of vertices and from files, become the columns of one seam term.

use harness::kit::double as kit;
use harness::worst::Worst;
use muslin_core_f64::mesh::{Stitch, TriMesh};
use muslin_core_f64::scene::{BuiltScene, Content};

use super::scene;

/// Two cloths of four vertices each. The second is sewn by a pair, and by a file with one stitch to a point of
/// an edge.
fn sewn() -> BuiltScene {
    let square = "grid = { size = [1.0, 1.0], cells = [1, 1], pattern = \"diagonal\" }";
    let seams = "seam = [{ pairs = [[0, 3]], stiffness = 10.0 }, { file = \"s\", stiffness = 20.0, damping = 0.5 }]";
    let stitches = vec![Stitch { a: 1, edge: [2, 3], weight: 0.25 }];
    let text = scene(&format!("{square}\n[[cloth]]\ndensity = 1.0\n{square}\n{seams}"));
    kit::build_with(&text, &[("s".into(), Content::Mesh(TriMesh { stitches, ..TriMesh::default() }))])
}

#[test]
fn stitches_become_columns() {
    let built = sewn();
    let seams = built.model.view().seams.expect("seams");
    // Vertex numbers are shifted by the four vertices of the first cloth; a pair is a stitch to an edge without
    // length.
    assert_eq!(seams.vertices, [[4, 7, 7], [5, 6, 7]]);
    assert_eq!(seams.weights, [0.0, 0.25]);
    assert_eq!(seams.stiffness, [10.0, 20.0]);
    assert_eq!(seams.damping, [0.0, 10.0], "seconds times stiffness");
}

#[test]
fn a_stitch_stores_half_its_stiffness_times_the_gap_squared() {
    let built = sewn();
    let x = kit::positions(&built);
    let gaps = [x[7] - x[4], x[6] * 0.75 + x[7] * 0.25 - x[5]];
    let want = 0.5 * (10.0 * gaps[0].length_squared() + 20.0 * gaps[1].length_squared());
    let got = kit::energies(&built.model.view(), &built.particles.masses, &x).seam;
    let mut worst = Worst::new("energy of two stitches", 1e-15);
    worst.compare(want, &[got], &[want], || format!("gaps {gaps:?}"));
    worst.check();
}
