//! Effective properties of sheets of hinges and of bending springs: rigidity by direction, Poisson's ratio, and
//! known defects of the models.

use glam::DVec3;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::scene::{BuiltScene, Content};

use super::check::Check;
use super::lab::{self, Miss};
use super::lattice::ROW;

/// Description in the report.
pub const ABOUT: &str = "rigidity of a bent sheet over the one asked for; what is not 1 the pattern cannot do, \
                         however fine: take the equilateral one. Bending springs have no rigidity when flat";

/// D(phi)/D for curvature along phi in steps of 15 degrees, from x towards z; the diagonal is at 45 degrees.
const DIRECTIONS: [(&str, [f64; 12]); 3] = [
    ("equilateral", [1.0; 12]),
    ("alternating", [1.0, 1.125, 1.375, 1.5, 1.375, 1.125, 1.0, 1.125, 1.375, 1.5, 1.375, 1.125]),
    ("diagonal", [1.0, 1.75, 2.616, 3.0, 2.616, 1.75, 1.0, 0.75, 0.884, 1.0, 0.884, 0.75]),
];

/// Relative tolerance: the table has four digits.
const TABLE: f64 = 5e-3;

/// Rigidity, N m.
const RIGIDITY: f64 = 3.0;

/// Curvature, 1/m: so small, with cells of 1 m, that angles equal their sines.
const CURVATURE: f64 = 1e-4;

/// All checks.
pub fn checks() -> Vec<Check> {
    let directions = DIRECTIONS.into_iter().flat_map(|(pattern, table)| {
        table.into_iter().enumerate().map(move |(step, factor)| {
            let degrees = 15 * step;
            let (sine, cosine) = (degrees as f64).to_radians().sin_cos();
            let bent = move |x: f64, z: f64| 0.5 * (cosine * x + sine * z).powi(2);
            let name = format!("{pattern} hinges, bent along {degrees} degrees");
            Check::relative(name, factor, TABLE, move |_| rigidity(pattern, bent))
        })
    });
    let sphere = |x: f64, z: f64| 0.5 * (x * x + z * z);
    let saddle = |x: f64, z: f64| 0.5 * (x * x - z * z);
    let twist = |x: f64, z: f64| x * z;
    // D/2 (2 + 2 nu) and D/2 (2 - 2 nu).
    let shapes = [
        Check::relative("equilateral hinges on a sphere", 4.0 / 3.0, 1e-6, move |_| rigidity("equilateral", sphere)),
        Check::relative("equilateral hinges on a saddle", 8.0 / 3.0, 1e-6, move |_| rigidity("equilateral", saddle)),
        Check::relative("equilateral hinges on a twist", 8.0 / 3.0, 1e-6, move |_| rigidity("equilateral", twist)),
        Check::relative("equilateral hinges, Poisson's ratio", -1.0 / 3.0, 1e-6, move |_| {
            let [sphere, saddle] = [rigidity("equilateral", sphere)?, rigidity("equilateral", saddle)?];
            Ok((sphere - saddle) / (sphere + saddle))
        }),
    ];
    directions.chain(shapes).chain(springs()).collect()
}

/// Checks of the predicted defect of bending springs: E = k l^2 theta^4 / 32 across two edges of length l.
fn springs() -> [Check; 2] {
    const STIFFNESS: f64 = 50.0;
    const HEIGHT: f64 = 0.4;
    let predicted = |angle: f64| STIFFNESS * HEIGHT * HEIGHT * angle.powi(4) / 32.0;
    let stored = |angle: f64| folded(HEIGHT, angle, &format!("{{ model = \"spring\", stiffness = {STIFFNESS:?} }}"));
    // The next term of the series is theta^2 / 24 of the first one.
    let energy = Check::relative("bending spring folded by 0.1, energy", predicted(0.1), 5e-4, move |_| stored(0.1));
    let power = Check::absolute("bending spring, power of the angle; of a sheet it is 2", 4.0, 2e-3, move |_| {
        Ok((stored(0.1)? / stored(0.05)?).log2())
    });
    [energy.in_unit("J"), power]
}

/// A sheet of 8x8 cells with edges of 1 m.
fn sheet(pattern: &str) -> Result<BuiltScene, Miss> {
    let row = if pattern == "equilateral" { ROW } else { 1.0 };
    let text = format!(
        "name = \"sheet\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n\
         grid = {{ size = [8.0, {:?}], cells = [8, 8], pattern = \"{pattern}\" }}\n\
         bend = {{ model = \"hinge\", rigidity = {RIGIDITY:?} }}",
        8.0 * row
    );
    lab::columns(&text, &[])
}

/// Energy of the hinges over the energy of a plate, which is D/2 per area at unit curvature. `height` is the
/// displacement of the sheet; both energies are over one period of the pattern in its middle.
fn rigidity(pattern: &str, height: impl Fn(f64, f64) -> f64) -> Result<f64, Miss> {
    let built = sheet(pattern)?;
    let rest = &built.particles.positions;
    let hinges = built.model.view().hinges.ok_or_else(|| Miss::Why("the sheet has no hinges".into()))?;
    let period = match pattern {
        "equilateral" => [1.0, 2.0 * ROW],
        "alternating" => [2.0, 2.0],
        _ => [1.0, 1.0],
    };
    // Midpoints of edges lie on quarters of cells, and therefore never on a border of this period.
    let within = |x: DVec3| [x.x, x.z].iter().zip(period).all(|(&x, period)| (0.1..0.1 + period).contains(&x));
    let bent: Vec<_> = rest.iter().map(|x| DVec3::new(x.x, CURVATURE * height(x.x, x.z), x.z)).collect();
    let energies = hinges.vertices.iter().enumerate().filter_map(|(hinge, corners)| {
        let [a, b, ..] = corners.map(|corner| rest[corner as usize]);
        let energy = || hinges.energy(hinge, &corners.map(|corner| bent[corner as usize])).bend;
        within((a + b) / 2.0).then(energy)
    });
    let plate = 0.5 * RIGIDITY * CURVATURE * CURVATURE * period[0] * period[1];
    Ok(energies.sum::<f64>() / plate)
}

/// Two triangles with a common edge; the second one is turned about it by an angle.
fn rhombus(height: f64, angle: f64) -> [DVec3; 4] {
    let (sine, cosine) = angle.sin_cos();
    let turned = DVec3::new(0.0, height * sine, -height * cosine);
    [DVec3::X * -0.5, DVec3::X * 0.5, DVec3::Z * height, turned]
}

/// Bending energy of a rhombus that is flat at rest, J.
fn folded(height: f64, angle: f64, bend: &str) -> Result<f64, Miss> {
    let mesh = TriMesh {
        positions: rhombus(height, 0.0).map(|x| x.to_array()).into(),
        triangles: vec![[0, 1, 2], [0, 3, 1]],
        ..TriMesh::default()
    };
    let text = format!("name = \"fold\"\nduration = 0\n[[cloth]]\nmesh = \"fold\"\ndensity = 1.0\nbend = {bend}");
    let mut sim = lab::simulation(&text, &[("fold".into(), Content::Mesh(mesh))])?;
    sim.state_mut().0.copy_from_slice(&rhombus(height, angle));
    Ok(sim.energy().bend)
}
