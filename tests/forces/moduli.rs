//! Macroscopic properties of springs and hinges, in f64: elastic moduli of the spring lattice, energy of a
//! fold, and energy of bending springs, whose bending modulus is zero when flat. `muslin validate` tests sheets
//! of hinges.

use glam::DVec3;
use harness::kit::double as kit;
use harness::worst::Worst;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::scene::{BuiltScene, Content};

/// Height of a row of equilateral triangles, divided by the edge.
const ROW: f64 = 0.866_025_403_784_438_6;

/// A sheet of equilateral triangles with edges of 1 m.
fn sheet(material: &str) -> BuiltScene {
    kit::build(&format!(
        "name = \"sheet\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n\
         grid = {{ size = [8.0, {:?}], cells = [8, 8], pattern = \"equilateral\" }}\n{material}",
        8.0 * ROW
    ))
}

/// Energy density of an isotropic sheet whose Young's modulus times thickness is 1, for the strains xx, zz, xz.
fn plane_stress(poisson: f64, [xx, zz, xz]: [f64; 3]) -> f64 {
    let sum = xx + zz;
    0.5 / (1.0 - poisson * poisson) * (sum * sum - 2.0 * (1.0 - poisson) * (xx * zz - xz * xz))
}

/// Energy per area of the springs at the middle vertex of a sheet with edges of 1 m, for the strains xx, zz,
/// xz. Half of each spring is attributed to the vertex.
fn spring_energy_density(built: &BuiltScene, [xx, zz, xz]: [f64; 3]) -> f64 {
    let rest = kit::positions(built);
    let springs = built.model.view().stretch_springs.expect("springs");
    let middle = (0..rest.len()).min_by(|&a, &b| rest[a].length().total_cmp(&rest[b].length())).expect("vertices");
    let ends = springs.offsets[middle] as usize..springs.offsets[middle + 1] as usize;
    let energy = |sign: f64| {
        let stored = ends.clone().map(|at| {
            let d = rest[springs.others[at] as usize] - rest[middle];
            let strained = d + sign * DVec3::new(xx * d.x + xz * d.z, 0.0, xz * d.x + zz * d.z);
            let stretched = strained.length() - springs.rest[at];
            0.5 * springs.stiffness[at] * stretched * stretched
        });
        stored.sum::<f64>() / 2.0 / ROW
    };
    // The mean over the strain and its opposite cancels the cubic term.
    0.5 * (energy(1.0) + energy(-1.0))
}

/// Strains: along x, along z, isotropic, shear, uniaxial with free contraction, mixed.
const STRAINS: [[f64; 3]; 6] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0 / 3.0, 0.0], [0.3, -0.7, 0.4]];

fn assert_isotropic(built: &BuiltScene, young: f64) {
    const STRAIN: f64 = 1e-4;
    // The bound is relative to the square of the strain.
    let mut worst = Worst::new("energy density against an isotropic sheet, Poisson's ratio 1/3", 1e-7);
    for strain in STRAINS {
        let got = spring_energy_density(built, strain.map(|e| e * STRAIN)) / (STRAIN * STRAIN);
        let want = young * plane_stress(1.0 / 3.0, strain);
        worst.compare(want, &[got], &[want], || format!("strain {strain:?}"));
    }
    worst.check();
}

#[test]
fn equilateral_springs_have_the_young_s_modulus_that_is_asked_for() {
    let material = r#"stretch = { model = "spring", stiffness = 250.0 }"#;
    assert_isotropic(&sheet(material), 250.0);
}

/// A lattice of springs of stiffness k has the modulus 2 k / sqrt(3).
#[test]
fn per_spring_stiffness_is_each_spring_s_own() {
    let material = r#"stretch = { model = "spring", stiffness = 250.0, per_spring = true }"#;
    let built = sheet(material);
    let springs = built.model.view().stretch_springs.expect("springs");
    assert!(springs.stiffness.iter().all(|&k| k == 250.0), "stiffness of every spring: {:?}", springs.stiffness);
    assert_isotropic(&built, 250.0 / ROW);
}

/// Holds for every mesh, also with half triangles and border edges: each triangle adds stiffness x area /
/// length^2 to each of its sides.
#[test]
fn springs_resist_growth_in_area_alike_on_every_mesh() {
    const GROWTH: f64 = 0.2;
    let mut worst = Worst::new("energy of springs under uniform growth against 3/2 stiffness area growth^2", 1e-13);
    for mesh in [
        r#"grid = { size = [0.7, 0.5], cells = [5, 3] }"#,
        r#"grid = { size = [0.7, 0.5], cells = [5, 3], pattern = "alternating" }"#,
        "disc = { radius = 0.5, hole = 0.1, rings = 3 }",
        "tube = { radius = 0.2, height = 0.6, cells = [7, 4] }",
    ] {
        let stretch = r#"stretch = { model = "spring", stiffness = 250.0 }"#;
        let built = kit::build(&format!("name = \"grown\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n{mesh}\n{stretch}"));
        let masses = &built.particles.masses;
        let grown: Vec<_> = kit::positions(&built).iter().map(|x| x * (1.0 + GROWTH)).collect();
        // At 1 kg/m^2 the mass is the area.
        let want = 1.5 * 250.0 * masses.iter().sum::<f64>() * GROWTH * GROWTH;
        worst.compare(want, &[kit::energies(&built.model.view(), masses, &grown).stretch], &[want], || mesh.into());
    }
    worst.check();
}

/// Two triangles of the given height over a common edge; the second is rotated about the edge by an angle.
fn rhombus(height: f64, angle: f64) -> [DVec3; 4] {
    let (sin, cos) = angle.sin_cos();
    let fold = DVec3::new(0.0, height * sin, -height * cos);
    [DVec3::X * -0.5, DVec3::X * 0.5, DVec3::Z * height, fold]
}

fn build_rhombus(height: f64, bend: &str) -> BuiltScene {
    let mesh = TriMesh {
        positions: rhombus(height, 0.0).map(|x| x.to_array()).into(),
        triangles: vec![[0, 1, 2], [0, 3, 1]],
        ..TriMesh::default()
    };
    let scene = format!("name = \"fold\"\nduration = 0\n[[cloth]]\nmesh = \"fold\"\ndensity = 1.0\nbend = {bend}");
    kit::build_with(&scene, &[("fold".into(), Content::Mesh(mesh))])
}

/// Accurate to the last digit of the angle, on both sides and past 90 degrees.
#[test]
fn a_fold_stores_half_its_stiffness_times_the_angle_squared() {
    let mut worst = Worst::new("energy of a fold against ke theta^2 / 2", 1e-14);
    let built = build_rhombus(0.4, r#"{ model = "hinge", rigidity = 3.0 }"#);
    let hinges = built.model.view().hinges.expect("a hinge");
    // D |e|^2 / (A1 + A2).
    let stiffness = 3.0 / 0.4;
    for degrees in (-175..=175).step_by(5) {
        let angle = f64::from(degrees).to_radians();
        let x = rhombus(0.4, angle);
        worst.compare(stiffness, &[hinges.angle(0, &x)], &[angle], || format!("angle at {degrees} degrees"));
        let want = 0.5 * stiffness * angle * angle;
        worst.compare(stiffness, &[hinges.energy(0, &x).bend], &[want], || format!("energy at {degrees} degrees"));
    }
    worst.check();
}

/// The spring spans two collinear heights l: E = 2 k l^2 (1 - cos(theta / 2))^2 = k l^2 theta^4 / 32 + ...
#[test]
fn a_bending_spring_has_no_modulus_when_flat() {
    let (height, stiffness) = (0.4, 50.0);
    let built = build_rhombus(height, r#"{ model = "spring", stiffness = 50.0 }"#);
    let energy = |angle: f64| kit::energies(&built.model.view(), &built.particles.masses, &rhombus(height, angle)).bend;
    let mut worst = Worst::new("energy of a bending spring", 1e-12);
    for angle in [-2.5, -1.0, 0.3, 1.0, 2.0, 3.0_f64] {
        let want = 2.0 * stiffness * (height * (1.0 - (0.5 * angle).cos())).powi(2);
        worst.compare(stiffness * height * height, &[energy(angle)], &[want], || format!("angle {angle}"));
    }
    worst.check();
    // The next term of the series is theta^2 / 24 times the first term.
    let mut worst = Worst::new("energy of a bending spring against k l^2 theta^4 / 32", 0.0005);
    for angle in [-0.1, 0.05, 0.1_f64] {
        let want = stiffness * height * height * angle.powi(4) / 32.0;
        worst.compare(want, &[energy(angle)], &[want], || format!("angle {angle}"));
    }
    worst.check();
}
