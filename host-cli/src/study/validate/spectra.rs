//! Growth of a sheet's largest eigenvalue under refinement: bending eventually dominates.

use muslin_core_f64::integrate::Jacobian;
use muslin_core_f64::spectrum::Tangent;

use super::check::Check;
use super::lab::{self, Lab, Miss};

/// Description in the report.
pub const ABOUT: &str = "the largest eigenvalue of flat sheets of 6, 12 and 24 cells: the power of the number of cells by \
                         which it grows, the one farther off";

/// Term, material and power of the number of cells: the eigenvalue of stretch grows as the square, the eigenvalue
/// of bending as the fourth power.
const TERMS: [(&str, &str, f64); 3] = [
    ("hinges", r#"bend = { model = "hinge", rigidity = 1e-3 }"#, 4.0),
    ("membrane", r#"stretch = { model = "membrane", stiffness = 100.0 }"#, 2.0),
    ("springs", r#"stretch = { model = "spring", stiffness = 100.0 }"#, 2.0),
];

/// All checks.
pub fn checks() -> Vec<Check> {
    let each = TERMS.into_iter().map(|(name, material, power)| {
        Check::absolute(format!("{name}, power of the cells"), power, 0.01, move |lab| growth(lab, material, power))
    });
    each.collect()
}

fn growth(lab: &Lab, material: &str, power: f64) -> Result<f64, Miss> {
    let [coarse, middle, fine] = [6, 12, 24].map(|cells| largest(lab, material, cells));
    let middle = middle?;
    let [first, second] = [middle / coarse?, fine? / middle].map(f64::log2);
    Ok(if (first - power).abs() > (second - power).abs() { first } else { second })
}

/// Largest eigenvalue of a free sheet whose border looks the same at every size, 1/s^2.
fn largest(lab: &Lab, material: &str, cells: u32) -> Result<f64, Miss> {
    let depth = 0.75f64.sqrt() * 0.4;
    let text = format!(
        "name = \"refined\"\nduration = 1.0\n[[cloth]]\ngrid = {{ size = [0.4, {depth}], cells = [{cells}, {cells}] }}\n\
         density = 0.2\n{material}"
    );
    let built = lab::columns(&text, &[])?;
    Ok(Tangent::of(&built, 1.0, 0.0, Jacobian::Projected, lab).fastest_mode(1e-12, 100_000, lab).0)
}
