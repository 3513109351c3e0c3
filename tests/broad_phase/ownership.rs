//! Every feature is owned by exactly one triangle, and no triangle owns many features.

use harness::crumpled;
use muslin_core::broad_phase::{IS_FACE, OWNS_EDGE, OWNS_VERTEX};
use muslin_core::mesh::SurfaceColumns;
use muslin_core::mesh::edges::NONE;

/// Checks that every vertex of a triangle and every edge has exactly one owner.
fn check(vertices: usize, triangles: &[[u32; 3]]) -> SurfaceColumns {
    let surface = SurfaceColumns::build(vertices, triangles, &[]);
    let mut owners_of_vertices = vec![0; vertices];
    let mut owners_of_edges = vec![0; surface.edges.len()];
    for (t, &owned) in surface.owned.iter().enumerate() {
        let (corners, sides) = (surface.triangles[t], surface.triangle_edges[t]);
        for k in 0..3 {
            let mut ends = [corners[k], corners[(k + 1) % 3]];
            ends.sort_unstable();
            assert_eq!(sides[k] == NONE, ends[0] == ends[1], "side {k} of {corners:?}");
            if sides[k] != NONE {
                assert_eq!(surface.edges[sides[k] as usize], ends, "side {k} of {corners:?}");
            }
            owners_of_vertices[corners[k] as usize] += usize::from(owned & OWNS_VERTEX << k != 0);
            if owned & OWNS_EDGE << k != 0 {
                owners_of_edges[sides[k] as usize] += 1;
            }
        }
        let [a, b, c] = corners;
        assert_eq!(owned & IS_FACE != 0, a != b && b != c && c != a, "{corners:?}");
    }
    assert!(surface.edges.is_sorted_by(|a, b| a < b), "edges ascend and are unique");
    assert!(owners_of_edges.iter().all(|&owners| owners == 1), "owners of edges: {owners_of_edges:?}");
    for (vertex, &owners) in owners_of_vertices.iter().enumerate() {
        let used = triangles.as_flattened().contains(&(vertex as u32));
        assert_eq!(owners, usize::from(used), "owners of vertex {vertex}");
    }
    surface
}

#[test]
fn a_sheet_is_balanced() {
    let mesh = crumpled::sheet(30);
    let surface = check(mesh.positions.len(), &mesh.triangles);
    let many = |bit: u8, limit| surface.owned.iter().filter(|&owned| (owned & (bit * 7)).count_ones() > limit).count();
    assert_eq!(many(OWNS_VERTEX, 1), 0, "of {} triangles own more than a vertex", surface.owned.len());
    let many_edges = many(OWNS_EDGE, 2);
    assert!(many_edges * 20 < surface.owned.len(), "{many_edges} of {} own three edges", surface.owned.len());
}

#[test]
fn any_triangles_at_all() {
    check(0, &[]);
    check(7, &[[0, 1, 2], [2, 1, 0], [0, 1, 2], [0, 1, 3], [1, 0, 4]]);
    let lone = check(8, &[[0, 0, 0], [1, 2, 2], [3, 3, 4], [5, 6, 5], [5, 6, 6], [1, 2, 5]]);
    assert_eq!(lone.triangle_edges[0], [NONE; 3]);
    assert_eq!(lone.edges.len(), 5, "{:?}", lone.edges);
}

#[test]
fn sewing_goes_both_ways() {
    let surface = SurfaceColumns::build(9, &[[0, 1, 2]], &[[0, 3], [3, 5], [3, 0], [8, 0]]);
    let sewn = surface.view().sewn;
    for [a, b] in [[0, 3], [3, 0], [5, 3], [0, 8], [8, 0]] {
        assert!(sewn.joins(a, b), "{a} and {b}");
    }
    for [a, b] in [[0, 5], [1, 2], [8, 3], [8, 8]] {
        assert!(!sewn.joins(a, b), "{a} and {b}");
    }
}
