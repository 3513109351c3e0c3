//! The triangles of the generators, compared with brute force and closed forms.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use glam::DVec3;
use harness::kit::double as kit;
use harness::topology::{border_sides, sides};
use muslin_core_f64::mesh::edges::{self, NONE};
use muslin_core_f64::mesh::hinges;
use muslin_core_f64::scene::BuiltScene;

use super::cloth;

/// A sheet and its expected properties.
struct Generated {
    text: String,
    /// Vertices and triangles.
    counts: [usize; 2],
    /// Vertices - edges + triangles: 1 for a disc, 0 for a ring.
    euler: i64,
    area: f64,
    /// Length of the border.
    border: f64,
}

/// Every grid pattern with 1 to 5 cells in each direction.
fn grids() -> Vec<Generated> {
    let cells = (1..=5).flat_map(|x| (1..=5).map(move |z| [x, z]));
    let patterns = ["diagonal", "alternating", "equilateral"];
    cells.flat_map(|cells| patterns.map(|pattern| grid(cells, pattern))).collect()
}

fn grid(cells @ [nx, nz]: [usize; 2], pattern: &str) -> Generated {
    // Equilateral: every second row has one vertex more, every strip has half a triangle more at each end.
    let counts = match pattern {
        "equilateral" => [(nx + 1) * (nz + 1) + nz.div_ceil(2), (2 * nx + 1) * nz],
        _ => [(nx + 1) * (nz + 1), 2 * nx * nz],
    };
    let text = format!("grid = {{ size = [1.3, 0.7], cells = {cells:?}, pattern = \"{pattern}\" }}");
    Generated { text, counts, euler: 1, area: 1.3 * 0.7, border: 2.0 * (1.3 + 0.7) }
}

fn tubes() -> Vec<Generated> {
    let cells = [[3, 1], [3, 2], [4, 1], [7, 5], [12, 4]];
    let tube = |[around, along]: [usize; 2]| {
        let (radius, height) = (0.2, 0.6);
        let border = 2.0 * around as f64 * 2.0 * radius * (PI / around as f64).sin();
        // Triangles stand on chords of a ring; their apex on the next ring is half a cell further round.
        let sagitta = radius * (1.0 - (PI / around as f64).cos());
        let slant = (height / along as f64).hypot(sagitta);
        Generated {
            text: format!("tube = {{ radius = {radius}, height = {height}, cells = [{around}, {along}] }}"),
            counts: [around * (along + 1), 2 * around * along],
            euler: 0,
            area: border / 2.0 * slant * along as f64,
            border,
        }
    };
    cells.map(tube).into()
}

fn discs() -> Vec<Generated> {
    // Rings have 6, 12, 18, ... vertices; areas and borders are those of their polygons.
    let corners = |n: usize, radius: f64| {
        let half = PI / n as f64;
        [n as f64 * radius * radius * half.sin() * half.cos(), 2.0 * n as f64 * radius * half.sin()]
    };
    let full = |rings: usize| {
        let [area, border] = corners(6 * rings, 0.5);
        let counts = [1 + 3 * rings * (rings + 1), 6 * rings * rings];
        Generated { text: format!("disc = {{ radius = 0.5, rings = {rings} }}"), counts, euler: 1, area, border }
    };
    let mut discs: Vec<_> = [1, 2, 3, 8].map(full).into();
    let ([outer, outside], [inner, inside]) = (corners(24, 0.4), corners(12, 0.2));
    discs.push(Generated {
        text: "disc = { radius = 0.4, hole = 0.2, rings = 2 }".into(),
        counts: [12 + 18 + 24, 12 + 2 * 18 + 24],
        euler: 0,
        area: outer - inner,
        border: outside + inside,
    });
    discs
}

fn all() -> impl Iterator<Item = (BuiltScene, Generated)> {
    let generated = grids().into_iter().chain(tubes()).chain(discs());
    generated.map(|g| (cloth(&format!("{}\nbend = {{ model = \"hinge\", rigidity = 1.0 }}", g.text)), g))
}

#[test]
fn generators_make_as_many_vertices_and_triangles_as_counted() {
    for (built, g) in all() {
        assert_eq!([built.particles.positions.len(), built.triangles.len()], g.counts, "{}", g.text);
    }
}

#[test]
fn edges_are_unique_and_complete() {
    for (built, g) in all() {
        let edges = edges::build(&built.triangles).expect("a manifold");
        let ordered = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let listed: BTreeSet<_> = edges.iter().map(|e| ordered(e.ends)).collect();
        let expected: BTreeSet<_> = sides(&built.triangles).into_keys().map(ordered).collect();
        assert_eq!(listed.len(), edges.len(), "{}: an edge is listed twice", g.text);
        assert_eq!(listed, expected, "{}", g.text);
        assert_eq!(built.edges, edges.iter().map(|e| e.ends).collect::<Vec<_>>(), "{}: the scene's edges", g.text);
        assert_eq!(built.rest_lengths.len(), edges.len(), "{}", g.text);
        for edge in edges {
            for (&t, &opposite) in edge.triangles.iter().zip(&edge.opposite).filter(|(t, _)| **t != NONE) {
                let corners: BTreeSet<_> = built.triangles[t as usize].into();
                let named = BTreeSet::from([edge.ends[0], edge.ends[1], opposite]);
                assert_eq!(corners, named, "{}: triangle {t} of {edge:?}", g.text);
            }
        }
    }
}

#[test]
fn grids_and_discs_have_euler_characteristic_1_rings_0() {
    for (built, g) in all() {
        let [vertices, edges, triangles] =
            [built.particles.positions.len(), built.edges.len(), built.triangles.len()].map(|n| n as i64);
        assert_eq!(vertices - edges + triangles, g.euler, "{}", g.text);
    }
}

#[test]
fn generators_wind_consistently() {
    for (built, g) in all() {
        let twice = sides(&built.triangles).into_iter().find(|(_, count)| *count != 1);
        assert_eq!(twice, None, "{}: a side is traversed twice in one direction", g.text);
    }
}

#[test]
fn every_interior_edge_is_a_hinge_between_its_triangles() {
    for (built, g) in all() {
        let edges = edges::build(&built.triangles).expect("a manifold");
        let interior = edges.len() - border_sides(&built.triangles).len();
        let hinges = hinges::build(&edges);
        assert_eq!(hinges.len(), interior, "{}: hinges", g.text);
        let modelled = built.model.view().hinges.map_or(0, |hinges| hinges.vertices.len());
        assert_eq!(modelled, interior, "{}: hinges of the model", g.text);
        let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
        for ([a, b, c, d], edge) in hinges {
            let [first, second] = edges[edge as usize].triangles.map(|t| built.triangles[t as usize]);
            let fits = turned(first).contains(&[a, b, c]) && turned(second).contains(&[a, d, b]);
            assert!(fits, "{}: hinge {:?} between {first:?} and {second:?}", g.text, [a, b, c, d]);
        }
    }
}

/// Together with the tests of winding and Euler characteristic: no gap and no overlap.
#[test]
fn generators_cover_their_area_within_their_border() {
    for (built, g) in all() {
        let x = kit::positions(&built);
        let area: f64 = built.triangles.iter().map(|t| area(&x, t)).sum();
        assert!((area - g.area).abs() <= 1e-14, "{}: area {area}, expected {}", g.text, g.area);
        let length = |[a, b]: [u32; 2]| x[a as usize].distance(x[b as usize]);
        let border: f64 = border_sides(&built.triangles).into_iter().map(length).sum();
        assert!((border - g.border).abs() <= 1e-14, "{}: border {border}, expected {}", g.text, g.border);
        let mass: f64 = built.particles.masses.iter().sum();
        assert!((mass - g.area).abs() <= 1e-14, "{}: mass {mass} at 1 kg/m^2, expected {}", g.text, g.area);
    }
}

#[test]
fn every_vertex_carries_a_third_of_its_triangles() {
    for (built, g) in all() {
        let (x, mut want) = (kit::positions(&built), vec![0.0; built.particles.masses.len()]);
        for triangle in &built.triangles {
            triangle.iter().for_each(|&v| want[v as usize] += area(&x, triangle) / 3.0);
        }
        for (i, (mass, want)) in built.particles.masses.iter().zip(&want).enumerate() {
            assert!((mass - want).abs() <= 1e-14, "{}: mass {i} is {mass}, expected {want}", g.text);
        }
    }
}

fn area(x: &[DVec3], triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| x[v as usize]);
    (b - a).cross(c - a).length() / 2.0
}

#[test]
fn grids_are_full_rectangles_facing_up() {
    for g in grids() {
        let built = cloth(&g.text);
        let x = kit::positions(&built);
        for vertex in border_sides(&built.triangles).into_iter().flatten() {
            let [u, w] = [x[vertex as usize].x.abs() / 0.65, x[vertex as usize].z.abs() / 0.35];
            assert!((u.max(w) - 1.0).abs() < 1e-15, "{}: vertex {vertex} is on the border, not the outline", g.text);
        }
        for (t, corners) in built.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| x[v as usize]);
            assert!((b - a).cross(c - a).y > 0.0, "{}: triangle {t} faces down", g.text);
        }
    }
}

#[test]
fn the_equilateral_pattern_is_equilateral_but_for_its_ends() {
    let row = 0.75_f64.sqrt();
    let built = cloth(&format!("grid = {{ size = [6.0, {}], cells = [6, 4] }}", 4.0 * row));
    let count = |length: f64| built.rest_lengths.iter().filter(|l| (*l - length).abs() < 1e-14).count();
    // Rows: 3 of 6 edges, 2 of 5; slanted: 4 strips of 12; half edges at both ends of 2 rows; border edges
    // across the rows: 2 per strip.
    assert_eq!(
        [count(1.0), count(0.5), count(row)],
        [3 * 6 + 2 * 5 + 4 * 12, 4, 8],
        "lengths {:?}",
        built.rest_lengths
    );
}
