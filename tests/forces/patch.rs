//! Patch tests, in both precisions: an affine map of a membrane stores the energy A psi(F) and exerts no force
//! at interior vertices, for every pattern of the generators and every mesh. Springs pass on their regular
//! lattices.

use glam::DVec3;
use harness::both_precisions;
use harness::rng::Rng;

/// Grids and their areas, m^2, with odd and even numbers of cells; equilateral rows end in half
/// triangles. Cells are 1/8 m, so that positions are exact in f32.
const GRIDS: [(&str, f64); 7] = [
    (r#"grid = { size = [0.625, 0.5], cells = [5, 4], pattern = "equilateral" }"#, 0.3125),
    (r#"grid = { size = [0.5, 0.625], cells = [4, 5], pattern = "equilateral" }"#, 0.3125),
    (r#"grid = { size = [0.625, 0.5], cells = [5, 4], pattern = "diagonal" }"#, 0.3125),
    (r#"grid = { size = [0.625, 0.5], cells = [5, 4], pattern = "alternating" }"#, 0.3125),
    (r#"grid = { size = [0.5, 0.625], cells = [4, 5], pattern = "alternating" }"#, 0.3125),
    ("grid = { size = [0.5, 0.5], cells = [4, 4] }\nrest = \"uv\"", 0.25),
    ("grid = { size = [0.125, 0.125], cells = [1, 1] }", 0.015_625),
];

/// Discs and their areas: a polygon of 24 corners, and one with a hole of 12 corners.
const DISCS: [(&str, f64); 2] = [
    ("disc = { radius = 0.4, rings = 4 }", 0.16 * 3.105_828_541_230_249),
    ("disc = { radius = 0.4, hole = 0.2, rings = 2 }", 0.16 * 3.105_828_541_230_249 - 0.04 * 3.0),
];

/// Columns of a random affine map and its offset: stretch and compression by up to 2, shear, any position;
/// rounded to multiples of 1/64.
fn affine(rng: &mut Rng) -> [DVec3; 3] {
    let (turn, shear) = (rng.rotation(), rng.between(-0.8, 0.8));
    let (warp, weft) = (rng.magnitude(0.5, 2.0), rng.magnitude(0.5, 2.0));
    let columns = [turn * DVec3::new(warp, 0.0, 0.0), turn * DVec3::new(shear, 0.0, weft), rng.cube(0.5)];
    columns.map(|x| (x * 64.0).round() / 64.0)
}

both_precisions! {
    use glam::DVec3;
    use muslin::scene::BuiltScene;
    use harness::rng::Rng;
    use harness::topology::border;
    use harness::worst::Worst;

    use super::{DISCS, GRIDS, affine};

    /// Relative to the largest force.
    const INTERIOR: f64 = kit::bound(2e-6, 1e-13);
    /// Corners of a disc are rounded in f32: 3e-8 m on cells of 0.1 m, at strains of at least 0.1.
    const DISC_INTERIOR: f64 = kit::bound(1e-5, 1e-13);
    const ENERGY: f64 = kit::bound(2e-6, 1e-13);

    const MEMBRANE: &str = r#"
        stretch = { model = "membrane", stiffness = 900.0, weft = 600.0 }
        shear = { stiffness = 300.0 }"#;
    const SPRINGS: &str = r#"
        stretch = { model = "spring", stiffness = 900.0 }"#;

    fn scene(sheet: &str, material: &str) -> BuiltScene {
        kit::build(&format!("name = \"patch\"\nduration = 0\n[[cloth]]\n{sheet}\ndensity = 1.0{material}"))
    }

    /// The positions under an affine map, and a description for messages.
    fn mapped(sheet: &str, built: &BuiltScene, [wu, wv, offset]: [DVec3; 3]) -> (Vec<DVec3>, String) {
        let x = kit::positions(built).iter().map(|x| offset + wu * x.x + wv * x.z).collect();
        (x, format!("{sheet} under wu {wu}, wv {wv}"))
    }

    #[test]
    fn an_affine_membrane_stores_its_energy_density_times_area() {
        let (mut worst, rng) = (Worst::new("energy of an affine map against A psi", ENERGY), &mut Rng::new(71));
        for (sheet, area) in GRIDS.into_iter().chain(DISCS) {
            let built = scene(sheet, MEMBRANE);
            for map in std::iter::repeat_with(|| affine(rng)).take(20) {
                let (x, place) = mapped(sheet, &built, map);
                let energy = kit::energies(&built.model.view(), &built.particles.masses, &x);
                let ([wu, wv, _], square) = (map, |x: f64| x * x);
                let stretch = area * 0.5 * (900.0 * square(wu.length() - 1.0) + 600.0 * square(wv.length() - 1.0));
                let shear = area * 0.5 * 300.0 * square(wu.dot(wv));
                worst.compare(stretch + shear, &[energy.stretch, energy.shear], &[stretch, shear], || place.clone());
            }
        }
        worst.check();
    }

    /// `inside` selects the vertices whose force must be zero.
    fn pulls_nowhere(sheet: &str, material: &str, worst: &mut Worst, inside: impl Fn(&BuiltScene) -> Vec<bool>) {
        let (built, rng) = (scene(sheet, material), &mut Rng::new(72));
        let inside = inside(&built);
        for map in std::iter::repeat_with(|| affine(rng)).take(20) {
            let (x, place) = mapped(sheet, &built, map);
            let still = vec![DVec3::ZERO; x.len()];
            let f = kit::forces(&built.model.view(), &built.particles.masses, &x, &still);
            let largest = f.iter().map(|f| f.length()).fold(0.0, f64::max);
            for (vertex, &f) in f.iter().enumerate().filter(|(vertex, _)| inside[*vertex]) {
                worst.vectors(largest, &[f], &[DVec3::ZERO], || format!("vertex {vertex} of {place}"));
            }
        }
    }

    fn off_the_border(built: &BuiltScene) -> Vec<bool> {
        border(&built.triangles, built.particles.masses.len()).iter().map(|border| !border).collect()
    }

    #[test]
    fn an_affine_membrane_pulls_at_no_interior_vertex() {
        let mut worst = Worst::new("interior force of a grid under an affine map", INTERIOR);
        GRIDS.iter().for_each(|(sheet, _)| pulls_nowhere(sheet, MEMBRANE, &mut worst, off_the_border));
        worst.check();
    }

    #[test]
    fn an_affine_disc_pulls_at_no_interior_vertex() {
        let mut worst = Worst::new("interior force of a disc under an affine map", DISC_INTERIOR);
        DISCS.iter().for_each(|(sheet, _)| pulls_nowhere(sheet, MEMBRANE, &mut worst, off_the_border));
        worst.check();
    }

    /// Tests vertices at least two cells from the border, where the lattice is regular: springs have no area
    /// weights.
    #[test]
    fn an_affine_spring_lattice_pulls_at_no_interior_vertex() {
        let mut worst = Worst::new("interior force of springs under an affine map", INTERIOR);
        for pattern in ["equilateral", "diagonal", "alternating"] {
            let sheet = format!("grid = {{ size = [1.0, 1.0], cells = [8, 8], pattern = \"{pattern}\" }}");
            pulls_nowhere(&sheet, SPRINGS, &mut worst, |built| {
                kit::positions(built).iter().map(|x| x.abs().max_element() < 0.3).collect()
            });
        }
        worst.check();
    }
}
