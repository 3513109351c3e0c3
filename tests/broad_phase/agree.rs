//! All methods report the same pairs, each once, for every input.

use glam::DVec3;
use harness::crumpled;
use harness::rng::Rng;

use super::methods::{Found, METHODS, all};
use harness::case::{Case, random, single};

/// Checks that all methods agree; returns their pairs.
fn agree(case: &Case) -> Found {
    let expected = all(METHODS[0].1, case).sorted();
    for pairs in [&expected.vertex_triangle, &expected.edge_edge] {
        assert!(pairs.windows(2).all(|w| w[0] != w[1]), "{}: {} repeats a pair", case.name, METHODS[0].0);
    }
    for (name, method) in &METHODS[1..] {
        let found = all(*method, case).sorted();
        compare(case, name, "vertex-triangle", &found.vertex_triangle, &expected.vertex_triangle);
        compare(case, name, "edge-edge", &found.edge_edge, &expected.edge_edge);
    }
    expected
}

fn compare(case: &Case, name: &str, kind: &str, found: &[[u32; 2]], expected: &[[u32; 2]]) {
    if found == expected {
        return;
    }
    let missed: Vec<_> = expected.iter().filter(|pair| found.binary_search(pair).is_err()).take(5).collect();
    let extra: Vec<_> = found.iter().filter(|pair| expected.binary_search(pair).is_err()).take(5).collect();
    let twice: Vec<_> = found.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).take(5).collect();
    let counts = (found.len(), expected.len());
    panic!(
        "{}: {name}, {kind}, found and expected {counts:?}: missed {missed:?}, extra {extra:?}, twice {twice:?}",
        case.name
    );
}

/// Also checks that the case has pairs, so that the comparison is not empty.
fn agree_on_some(case: &Case) {
    let [vertex_triangle, edge_edge] = agree(case).counts;
    assert!(vertex_triangle > 10 && edge_edge > 10, "{}: only {vertex_triangle} and {edge_edge}", case.name);
}

#[test]
fn random_soups_of_every_size() {
    for count in [0, 1, 2, 3, 5, 31, 32, 33, 34, 63, 64, 65, 100, 300, 1000] {
        for crowd in [0.3, 1.0, 3.0] {
            let (rng, half) = (&mut Rng::new(count as u64), (count as f64).cbrt() / crowd);
            let corners = random(rng, count, half, |rng| rng.between(0.3, 1.0));
            agree(&Case::soup(&format!("{count} triangles in a cube of half the side {half}"), &corners, 0.0));
        }
    }
}

#[test]
fn a_large_soup() {
    let corners = random(&mut Rng::new(1), 5000, 12.0, |rng| rng.between(0.3, 1.0));
    agree_on_some(&Case::soup("5,000 triangles", &corners, 0.0));
    let scattered = corners.iter().zip(0..).map(|(t, i)| t.map(|x| x + 60.0 * DVec3::splat((i % 9) as f64)));
    agree_on_some(&Case::soup("5,000 triangles in many cells", &scattered.collect::<Vec<_>>(), 0.1));
}

#[test]
fn a_crumpled_sheet() {
    let mesh = crumpled::sheet(30);
    for inflation in [0.0, 0.025, 0.25] {
        agree_on_some(&Case::new("crumpled sheet", &mesh.positions, &mesh.triangles, inflation));
    }
}

/// Corners lie on planes between cells, and boxes touch without a gap.
#[test]
fn integer_corners() {
    for seed in 0..5 {
        let rng = &mut Rng::new(seed);
        let triangle = |_| {
            let corner = rng.cube(6.0).round();
            std::array::from_fn(|_| corner + rng.cube(1.0).round())
        };
        let corners: Vec<_> = (0..400).map(triangle).collect();
        agree_on_some(&Case::soup("integer corners", &corners, 0.0));
    }
}

/// Every position occurs again in other triangles; some triangles have the same vertices.
#[test]
fn duplicates() {
    let corners = random(&mut Rng::new(2), 100, 3.0, |_| 1.0);
    let mut case = Case::soup("every triangle three times", &corners.repeat(3), 0.0);
    agree_on_some(&case);
    let twice: Vec<_> = case.triangles.iter().map(|t| [t[1], t[2], t[0]]).collect();
    case.triangles.extend(twice);
    agree_on_some(&case);
}

#[test]
fn without_area_or_extent() {
    let rng = &mut Rng::new(3);
    let mut corners = random(rng, 300, 2.0, |_| 1.0);
    for (i, [a, b, c]) in corners.iter_mut().enumerate() {
        match i % 3 {
            0 => *c = (*a + *b) / 2.0,
            1 => (*b, *c) = (*a, *a),
            _ => *c = *b,
        }
    }
    agree_on_some(&Case::soup("lines and points", &corners, 0.05));
    agree_on_some(&Case::soup("all in one point", &[[DVec3::splat(0.7); 3]; 60], 0.0));
    let axes: [(&str, DVec3); 3] = [("flat", DVec3::new(1.0, 1.0, 0.0)), ("a line", DVec3::X), ("upright", DVec3::Z)];
    for (name, axes) in axes {
        let corners: Vec<_> = random(rng, 300, 8.0, |_| 0.5).iter().map(|t| t.map(|x| x * axes)).collect();
        agree_on_some(&Case::soup(name, &corners, 0.0));
    }
}

#[test]
fn huge_beside_tiny() {
    let rng = &mut Rng::new(4);
    let corners = random(rng, 700, 2.0, |rng| rng.magnitude(1e-4, 3.0));
    agree_on_some(&Case::soup("every magnitude", &corners, 0.0));
    let many = random(rng, 700, 1e-3, |rng| rng.magnitude(1e-9, 1e3));
    agree_on_some(&Case::soup("more magnitudes than levels", &many, 0.0));
    for large in [1, 20, 40, 400] {
        let mut corners = random(rng, 600, 2.0, |_| 0.1);
        corners.extend(random(rng, large, 2.0, |rng| rng.between(1.0, 2.0)));
        corners.extend(random(rng, 1, 2.0, |_| 100.0));
        agree_on_some(&Case::soup(&format!("{large} large ones"), &corners, 0.0));
        corners.reverse();
        agree_on_some(&Case::soup(&format!("{large} large ones first"), &corners, 0.0));
    }
}

#[test]
fn far_away() {
    let corners = random(&mut Rng::new(5), 500, 4.0, |_| 1.0);
    for offset in [1e3, 1e5, 1e7] {
        let shifted: Vec<_> = corners.iter().map(|t| t.map(|x| x + DVec3::new(offset, -offset, offset))).collect();
        agree_on_some(&Case::soup(&format!("{offset} m from the origin"), &shifted, 0.0));
    }
    for offset in [1e4, 1e9, 1e37] {
        let mut split = corners.clone();
        split.iter_mut().step_by(9).flatten().for_each(|x| *x += DVec3::new(0.0, offset, -offset));
        agree_on_some(&Case::soup(&format!("a piece {offset} m away"), &split, 0.0));
    }
    for scale in [1e-30, 1e-6, 1e6, 1e30] {
        let scaled: Vec<_> = corners.iter().map(|t| t.map(|x| x * scale)).collect();
        agree_on_some(&Case::soup(&format!("scaled by {scale}"), &scaled, 0.0));
    }
}

#[test]
fn no_numbers_and_no_bounds() {
    let corners = random(&mut Rng::new(6), 300, 3.0, |_| 1.0);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 3e38, -3e38];
    for (low, high) in bad.iter().flat_map(|a| bad.map(|b| (*a, b))) {
        let mut case = Case::soup(&format!("some boxes from {low} to {high}"), &corners, 0.01);
        for (i, b) in case.boxes.iter_mut().enumerate().filter(|(i, _)| i % 40 == 3) {
            (b[0][i % 3], b[1][i % 3]) = (low, high);
        }
        agree_on_some(&case);
        let mesh = crumpled::sheet(12);
        let mut case = Case { name: case.name, ..Case::new("", &mesh.positions, &mesh.triangles, 0.1) };
        case.boxes[40] = [DVec3::splat(low), DVec3::splat(high)];
        case.boxes[80][0].y = low;
        agree_on_some(&case);
    }
    let mut none = Case::soup("only NaN", &corners, 0.0);
    none.boxes.fill([DVec3::NAN; 2]);
    assert_eq!(agree(&none).counts, [0, 0]);
}

#[test]
fn passive_triangles() {
    let rng = &mut Rng::new(7);
    let [cloth, body] = [crumpled::sheet(12), crumpled::sheet(9)];
    let cloth = Case::new("cloth", &cloth.positions, &cloth.triangles, 0.2);
    let turn = rng.rotation();
    let positions: Vec<_> = body.positions.iter().map(|&x| single(turn * x)).collect();
    let mut both = cloth.clone().against(&Case::new("body", &positions, &body.triangles, 0.3));
    let [with, _] = agree(&both).counts;
    both.without_own_contact = true;
    agree_on_some(&both);
    let [without, _] = agree(&both).counts;
    assert!(with > without, "own contact adds to {without}: {with}");
    both.first_passive = Some(0);
    assert_eq!(agree(&both).counts, [0, 0], "passive triangles pair with nothing passive");
}

#[test]
fn sewn_features() {
    let mesh = crumpled::sheet(14);
    let mut case = Case::new("sewn", &mesh.positions, &mesh.triangles, 0.25);
    let free = agree(&case).counts;
    let rng = &mut Rng::new(8);
    let vertices = mesh.positions.len() as u64;
    case.sewn = (0..150).map(|_| [(rng.bits() % vertices) as u32, (rng.bits() % vertices) as u32]).collect();
    // Adjacent layers of the meander, which nearly touch.
    case.sewn.extend((0..15).map(|j| [15 * j, 15 * j + 3]));
    let sewn = agree(&case).counts;
    assert!(sewn[0] < free[0] && sewn[1] < free[1], "sewing takes away: {free:?} to {sewn:?}");
}

/// Colliders that are points and lines with a radius, together with faces.
#[test]
fn lone_points_and_edges() {
    for passive in [false, true] {
        let mesh = crumpled::sheet(12);
        let cloth = Case::new("cloth", &mesh.positions, &mesh.triangles, 0.05);
        let points: Vec<_> = mesh.positions.iter().step_by(2).map(|&x| x + DVec3::new(0.1, 0.2, 0.0)).collect();
        let lone: Vec<_> = (0..points.len() as u32)
            .map(|v| match v % 3 {
                0 => [v; 3],
                1 => [v - 1, v, v],
                _ => [v, v - 1, v],
            })
            .collect();
        let mut case = cloth.against(&Case::new("lone", &points, &lone, 0.4));
        case.name = format!("lone points and edges, passive: {passive}");
        case.first_passive = case.first_passive.filter(|_| passive);
        agree_on_some(&case);
    }
    let points: Vec<_> =
        (0..1000).map(|i| DVec3::new((i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64)).collect();
    let lone: Vec<_> = (0..1000).map(|v| [v; 3]).collect();
    assert_eq!(agree(&Case::new("points on a lattice", &points, &lone, 0.0)).counts, [0, 0]);
}
