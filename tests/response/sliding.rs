//! Friction between surfaces that are made of triangles: a sheet slides over them as over a plane,
//! whatever edges they have and however long the step.
//!
//! Run: `cargo test -p muslin-tests --test response sliding`; with `-- --nocapture` it
//! prints how far.

use glam::DVec3;

use super::CLOTH;
use harness::both_precisions;

const GRAVITY: f64 = 9.81;
/// Tangent of the slope; gravity leans instead of what is slid on.
const SLOPE: f64 = 0.5;
/// How far friction may be from the cone, as the coupled solve leaves it.
const SLACK: f64 = 0.05;
/// Of the floor's mesh, its edges askew to the slide.
const FLOOR_CELLS: usize = 20;

/// What a sheet lies on: its name, the height of the sheet and the scene's sections.
const BELOW: [(&str, f64, &str); 4] = [
    ("plane", 0.0041, "[[collider]]\nshape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n"),
    ("box", 0.0041, "[[collider]]\nshape = \"box\"\ncenter = [0, -0.1, 0]\nhalf = [1, 0.1, 1]\n"),
    ("mesh", 0.0041, "[[collider]]\nshape = \"mesh\"\nfile = \"floor\"\n"),
    ("sheet", 0.0081, "[[collider]]\nshape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nfriction = 2.0\n"),
];

/// The lower of two sheets; the plane holds it.
const LOWER: &str = "[[cloth]]\ngrid = { size = [0.9, 0.5], cells = [22, 11] }\nposition = [0.2, 0.004, 0.0]\n";

fn lying(below: &str, height: f64, sections: &str, friction: f64, integrator: &str) -> String {
    let level = GRAVITY / (1.0 + SLOPE * SLOPE).sqrt();
    let lower = if below == "sheet" { format!("{LOWER}{CLOTH}") } else { String::new() };
    format!(
        r#"
        name = "sliding"
        duration = 0.4
        frame_rate = 10
        gravity = [{:?}, {:?}, 0.0]
        [contact]
        thickness = 0.004
        friction = {friction:?}
        {integrator}
        [[cloth]]
        grid = {{ size = [0.3, 0.3], cells = [8, 9] }}
        position = [-0.013, {height:?}, 0.0613]
        rotation = [0, 17, 0]
        {CLOTH}
        {lower}
        {sections}
        "#,
        SLOPE * level,
        -level
    )
}

/// Corners and triangles of a square of 2 m.
fn floor() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let place = |k: usize| 2.0 * k as f64 / FLOOR_CELLS as f64 - 1.0;
    let side = FLOOR_CELLS + 1;
    let corners = (0..side * side).map(|v| [place(v % side), 0.0, place(v / side)]).collect();
    let mut triangles = vec![];
    for cell in (0..FLOOR_CELLS * side).filter(|cell| cell % side < FLOOR_CELLS) {
        let [a, b, c, d] = [cell, cell + 1, cell + side, cell + side + 1].map(|v| v as u32);
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    (corners, triangles)
}

fn mean_x(places: &[DVec3]) -> f64 {
    places.iter().map(|x| x.x).sum::<f64>() / places.len() as f64
}

both_precisions! {
    use super::{BELOW, GRAVITY, SLACK, SLOPE, floor, lying, mean_x};
    use muslin::dispatch::Serial;
    use muslin::mesh::TriMesh;
    use muslin::scene::Content;

    /// How far the sheet goes in 0.4 s, m.
    fn slide((below, height, sections): (&str, f64, &str), friction: f64, integrator: &str) -> f64 {
        let text = lying(below, height, sections, friction, integrator);
        let (positions, triangles) = floor();
        let floor = TriMesh { positions, triangles, ..TriMesh::default() };
        let mut sim = kit::simulation(&text, &[("floor".into(), Content::Mesh(floor))]);
        let start = mean_x(&kit::places(&sim, 0));
        kit::run(&mut sim, 0.4, |sim| assert_eq!(sim.crossings(&Serial), 0, "{below}: crossings"));
        mean_x(&kit::places(&sim, 0)) - start
    }

    #[test]
    #[ignore = "slow"]
    fn a_sheet_slides_over_edges_as_over_a_plane() {
        for below in BELOW {
            for friction in [0.0, 0.3] {
                for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
                    for step in [0.01, 0.005, 0.0025] {
                        let integrator = format!("[integrator]\nmethod = \"{method}\"\nstep = {step:?}");
                        let went = slide(below, friction, &integrator);
                        // Backward Euler goes by t (t + h) / 2, and so does every method after contact.
                        let way = |mu: f64, t: f64| 0.5 * GRAVITY * (SLOPE - mu) / (1.0 + SLOPE * SLOPE).sqrt() * 0.4 * t;
                        let least = 0.99 * way((1.0 + SLACK) * friction, 0.4);
                        let most = 1.01 * way((1.0 - SLACK) * friction, 0.4 + step);
                        let what = format!("{} {method}, h {step}, {}, mu {friction}", muslin::real::NAME, below.0);
                        println!("{what}: {went:.4} m, expected {least:.4} to {most:.4}");
                        assert!(went >= least && went <= most, "{what}: {went} m, expected {least} to {most}");
                    }
                }
            }
        }
    }
}
