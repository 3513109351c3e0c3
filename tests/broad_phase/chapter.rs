//! Two intersecting triangles that the usual form of the rule misses: spheres without the factor of sqrt(2),
//! cells of one and a half diameters, and a test only in cells that are the home of one of the two.

use glam::DVec3;
use harness::rng::Rng;

use super::methods::{METHODS, all};
use harness::case::{Case, random};

const CROSSING: [[DVec3; 3]; 2] = [
    [
        DVec3::new(3.616396103, 2.636396103, 1.5),
        DVec3::new(2.661801948, 1.681801948, 2.393028555),
        DVec3::new(2.661801948, 1.681801948, 0.606971445),
    ],
    [
        DVec3::new(3.363603897, 2.383603897, 1.5),
        DVec3::new(3.686731505, 3.969664599, 1.5),
        DVec3::new(4.949664599, 2.706731504, 1.5),
    ],
];

/// The largest radius is 1.
const CELL: f64 = 3.0;

fn sphere(corners: &[DVec3; 3]) -> (DVec3, f64) {
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    (center, corners.iter().map(|x| x.distance(center)).fold(0.0, f64::max))
}

/// The cells that a sphere touches, and whether each one is its home cell.
fn cells(center: DVec3, radius: f64) -> Vec<(DVec3, bool)> {
    let home = (center / CELL).floor();
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| home + DVec3::new(x, y, z))));
    let gap = |cell: DVec3| (center - center.clamp(cell * CELL, (cell + 1.0) * CELL)).length();
    all.filter(|&cell| gap(cell) <= radius).map(|cell| (cell, cell == home)).collect()
}

fn tests_of_the_pair(factor: f64) -> usize {
    let [a, b] = CROSSING.map(|corners| sphere(&corners)).map(|(center, radius)| cells(center, factor * radius));
    let meets = |&&(cell, home): &&(DVec3, bool)| b.iter().any(|&(other, own)| other == cell && (home || own));
    a.iter().filter(meets).count()
}

#[test]
fn the_literal_rule_misses_a_crossing() {
    assert_eq!(tests_of_the_pair(1.0), 0, "no common cell is anyone's home");
    assert!(tests_of_the_pair(2.0_f64.sqrt()) > 0, "with the factor there is one");
}

/// Tests the pair alone, and beside enough others that triangles are sorted into cells, for several cell
/// origins.
#[test]
fn all_methods_find_it() {
    for (name, method) in METHODS {
        for others in [0, 100] {
            for seed in 0..20 {
                let rng = &mut Rng::new(seed);
                let mut corners = CROSSING.to_vec();
                corners.extend(random(rng, others, 9.0, |_| 0.5).iter().map(|t| t.map(|x| x + DVec3::X * 30.0)));
                let found = all(method, &Case::soup("crossing", &corners, 0.0));
                let between = found.edge_edge.iter().filter(|&&[a, b]| a < 3 && (3..6).contains(&b)).count();
                assert!(between > 0, "{name} misses the crossing beside {others} others, seed {seed}");
            }
        }
    }
}
