//! The cheapest runs again with another solver: looser, or with another number of Newton iterations.

use toml::Value;

use crate::failure::Failure;
use crate::study::Study;
use crate::study::terms::{CONVERGED, Edit};
use crate::study::variant::Variant;

use super::report::Row;
use super::weigh::{Yardstick, weigh_changed};
use super::winners::front;

/// Runs the implicit runs that no cheaper implicit run equals in error with each other solver, cheapest first, until
/// the study has run for `end` seconds.
pub fn of(study: &Study<'_>, yardstick: &Yardstick<'_>, rows: &[Row], end: f64) -> Result<Vec<Row>, Failure> {
    let mut varied = Vec::new();
    let implicit: Vec<_> = rows.iter().filter(|row| row.variant.method.is_implicit()).cloned().collect();
    for row in front(&implicit, yardstick.least()) {
        for (words, variant, edits) in solvers(study, row.variant) {
            let left = end - study.seconds();
            if left <= 0.0 {
                return Ok(varied);
            }
            let scene = study.scene.changed(&edits)?;
            if let Some(row) = weigh_changed(study, yardstick, &scene, &variant, left)? {
                varied.push(Row { solver: Some(words), ..row });
            }
        }
    }
    Ok(varied)
}

/// The variant with each other solver, and the edits of the scene for it. Under error control the tolerance follows the
/// allowed error, so only the number of Newton iterations varies.
fn solvers(study: &Study<'_>, variant: Variant) -> Vec<(&'static str, Variant, Vec<Edit>)> {
    let newton = |iterations: u32| vec![("integrator.newton".into(), Some(Value::Integer(iterations.into())))];
    let mut solvers = match study.scene.desc.integrator.newton {
        1 => vec![("Newton to convergence", variant, newton(CONVERGED))],
        _ => vec![("one Newton iteration", variant, newton(1))],
    };
    if variant.error.is_none() {
        let loose = |words, looser| (words, Variant { looser, ..variant }, Vec::new());
        let loose = [loose("10 times as loose", 10.0), loose("100 times as loose", 100.0)];
        solvers.extend(loose.into_iter().filter(|(_, variant, _)| variant.is_as_loose_as_asked(&study.scene)));
    }
    solvers
}
