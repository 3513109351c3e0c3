//! The audit of random soups equals brute force over all pairs: with sewn vertices, passive triangles, isolated
//! points and edges, and on lattices where most features touch.

use harness::crumpled;
use harness::rng::Rng;
use muslin_core::broad_phase::IS_FACE;

use crate::surface::Columns;

/// Triangles of random vertices, some of them degenerate: points and edges, which are not faces.
fn soup(rng: &mut Rng, vertices: u32, triangles: usize) -> Columns {
    let mut vertex = |not: &[u32]| loop {
        let vertex = (rng.bits() % u64::from(vertices)) as u32;
        if !not.contains(&vertex) {
            return vertex;
        }
    };
    let corners: Vec<[u32; 3]> = (0..triangles)
        .map(|t| {
            let a = vertex(&[]);
            let b = if t % 9 == 7 { a } else { vertex(&[a]) };
            [a, b, if t % 9 >= 7 { b } else { vertex(&[a, b]) }]
        })
        .collect();
    let pairs: Vec<_> = (0..vertices / 8).map(|_| [vertex(&[]), vertex(&[])]).collect();
    let mut columns = Columns::new(&corners).sewn(&pairs, vertices as usize);
    for triangle in (0..triangles).filter(|t| t % 9 >= 7) {
        columns.owned[triangle] = 0;
    }
    columns.first_passive = (rng.bits() % (triangles as u64 + 1)) as u32;
    columns
}

/// Whether two vertices are equal or sewn together.
fn joined(columns: &Columns, a: u32, b: u32) -> bool {
    let row = columns.offsets[a as usize] as usize..columns.offsets[a as usize + 1] as usize;
    a == b || columns.others[row].contains(&b)
}

/// The faces that have the edge as a side; empty for a degenerate edge.
fn owners(columns: &Columns, [a, b]: [u32; 2]) -> Vec<u32> {
    let has = |t: &u32| {
        let corners = columns.triangles[*t as usize];
        a != b && columns.owned[*t as usize] == IS_FACE && corners.contains(&a) && corners.contains(&b)
    };
    (0..columns.triangles.len() as u32).filter(has).collect()
}

/// The crossings and the pairs of triangles, found by applying the definition to all pairs.
fn brute_force(columns: &Columns, meet: impl Fn([u32; 2], [u32; 3]) -> bool) -> [Vec<[u32; 2]>; 2] {
    let [mut crossings, mut pairs] = [Vec::new(), Vec::new()];
    for (edge, &ends) in columns.edges.iter().enumerate() {
        let owners = owners(columns, ends);
        let moving = owners.iter().any(|&t| t < columns.first_passive);
        for (triangle, &corners) in columns.triangles.iter().enumerate() {
            let near = ends.iter().any(|&a| corners.iter().any(|&b| joined(columns, a, b)));
            let counted = !owners.is_empty() && columns.owned[triangle] == IS_FACE && !near;
            let [edge, triangle] = [edge as u32, triangle as u32];
            if counted && (moving || triangle < columns.first_passive) && meet(ends, corners) {
                crossings.push([edge, triangle]);
                pairs.extend(owners.iter().map(|&owner| [owner.min(triangle), owner.max(triangle)]));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    [crossings, pairs]
}

harness::both_precisions! {
    use muslin::audit;
    use muslin::dispatch::Serial;
    use muslin::geometry::intersect::{edge_meets_triangle, triangles_meet};
    use muslin::real::{Vec3, vec3};
    use harness::rng::Rng;
    use harness::threads::Uneven;

    use super::{brute_force, crumpled, soup};
    use crate::surface::{Columns, surface};

    /// Random points in a box, or on the lattice in it.
    fn points(rng: &mut Rng, count: u32, size: [f64; 3], lattice: bool) -> Vec<Vec3> {
        let mut coordinate = |k: usize| {
            let x = rng.between(0.0, size[k]);
            if lattice { x.floor() } else { x }
        };
        (0..count).map(|_| vec3([0, 1, 2].map(&mut coordinate))).collect()
    }

    /// Compares the audit with brute force, on one thread and on several; returns the number of crossings.
    #[track_caller]
    fn equals_brute_force(what: &str, columns: &Columns, positions: &[Vec3]) -> usize {
        let at = |v: u32| positions[v as usize];
        let meet = |edge: [u32; 2], triangle: [u32; 3]| edge_meets_triangle(edge.map(at), triangle.map(at));
        let [crossings, pairs] = brute_force(columns, meet);
        let surface = surface!(muslin, columns);
        let found = audit::crossings(&surface, positions, &Serial);
        let differ = (0..found.len().max(crossings.len())).find(|&k| found.get(k) != crossings.get(k));
        if let Some(k) = differ {
            panic!("{what}, crossing {k}: found {:?}, by force {:?}", found.get(k), crossings.get(k));
        }
        assert_eq!(audit::crossings(&surface, positions, &Uneven::new(3)), crossings, "{what}, on threads");
        assert_eq!(audit::count(&surface, positions, &Uneven::new(5)), crossings.len(), "{what}");
        assert_eq!(audit::triangle_pairs(&surface, &found), pairs, "{what}");
        crossings.len()
    }

    #[test]
    fn soups_equal_brute_force() {
        let rng = &mut Rng::new(321);
        for round in 0..60 {
            let vertices = rng.pick(&[4, 12, 40, 120]);
            let columns = soup(rng, vertices, vertices as usize);
            let size = rng.pick(&[[3.0, 3.0, 9.0], [9.0, 3.0, 1.0], [2.0, 9.0, 2.0], [0.0, 0.0, 0.0]]);
            let positions = points(rng, vertices, size, round % 2 == 0);
            equals_brute_force(&format!("round {round}"), &columns, &positions);
        }
    }

    /// A crumpled sheet in six shapes: as generated, shaken until it passes through itself, on a lattice, in a
    /// plane, on a line, and with one vertex moved a thousand times farther out.
    #[test]
    fn sheets_equal_brute_force() {
        let (mesh, rng) = (crumpled::sheet(24), &mut Rng::new(323));
        let columns = Columns::new(&mesh.triangles).sewn(&[], mesh.positions.len());
        let shaken: Vec<_> = mesh.positions.iter().map(|&x| x + rng.cube(1.0)).collect();
        let mut drawn_out = shaken.clone();
        drawn_out[300] *= 1000.0;
        let shapes = [
            ("as it is made", mesh.positions.clone(), 0),
            ("shaken", shaken.clone(), 100),
            ("on a lattice", shaken.iter().map(|x| x.round()).collect(), 1000),
            ("in a plane", shaken.iter().map(|x| x.with_y(0.0)).collect(), 10_000),
            ("on a line", shaken.iter().map(|x| x.with_y(0.0).with_z(1.0)).collect(), 100_000),
            ("drawn out", drawn_out, 100),
        ];
        for (what, shape, least) in shapes {
            let positions: Vec<Vec3> = shape.iter().map(|x| vec3(x.to_array())).collect();
            let found = equals_brute_force(what, &columns, &positions);
            println!("{what}: {found} crossings");
            assert!(found >= least, "{what}: {found}");
        }
    }

    /// For triangles without neighbours, the pairs are exactly the triangles that intersect.
    #[test]
    fn pairs_are_the_triangles_that_meet() {
        let rng = &mut Rng::new(322);
        for lattice in [false, true] {
            let triangles: Vec<[u32; 3]> = (0..90).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let positions = points(rng, 270, [4.0; 3], lattice);
            let columns = Columns::new(&triangles);
            let surface = surface!(muslin, columns);
            let pairs = audit::triangle_pairs(&surface, &audit::crossings(&surface, &positions, &Serial));
            let corners = |t: u32| triangles[t as usize].map(|v| positions[v as usize]);
            let all = (0..90).flat_map(|a| (a + 1..90).map(move |b| [a, b]));
            let meet: Vec<_> = all.filter(|&[a, b]| triangles_meet(corners(a), corners(b))).collect();
            assert_eq!(pairs, meet);
            assert!(meet.len() > 100, "{}", meet.len());
        }
    }

    #[test]
    fn nothing_is_free_of_crossings() {
        let columns = Columns::new(&[]);
        assert_eq!(audit::crossings(&surface!(muslin, columns), &[], &Serial), [[0; 2]; 0]);
        assert_eq!(audit::triangle_pairs(&surface!(muslin, columns), &[]), [[0; 2]; 0]);
    }
}
