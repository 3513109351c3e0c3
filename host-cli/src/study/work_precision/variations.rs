//! The cheapest runs again with another solver: looser, or with another number of Newton iterations.

use toml::Value;

use crate::failure::Failure;
use crate::study::Study;
use crate::study::terms::{CONVERGED, Edit};
use crate::study::variant::Variant;

use super::report::Row;
use super::weigh::{Yardstick, weigh_changed};
use super::winners::front;

/// Runs every implicit run on the front with each other solver, cheapest first, until the study has run for `end`
/// seconds.
pub fn of(study: &Study<'_>, yardstick: &Yardstick<'_>, rows: &[Row], end: f64) -> Result<Vec<Row>, Failure> {
    let mut varied = Vec::new();
    let on_front = front(rows, yardstick.least()).into_iter().filter(|row| row.variant.method.is_implicit());
    for row in on_front {
        for (words, edit) in solvers(study, &row.variant) {
            let left = end - study.seconds();
            if left <= 0.0 {
                return Ok(varied);
            }
            let scene = study.scene.changed(&[edit])?;
            if let Some(row) = weigh_changed(study, yardstick, &scene, &row.variant, left)? {
                varied.push(Row { solver: Some(words), ..row });
            }
        }
    }
    Ok(varied)
}

/// The other solvers of a variant and the edit of the scene that gives each. Under error control the tolerance follows
/// the allowed error, so only the number of Newton iterations varies.
fn solvers(study: &Study<'_>, variant: &Variant) -> Vec<(&'static str, Edit)> {
    let integrator = &study.scene.desc.integrator;
    let loose = |factor: f64| ("integrator.tolerance".into(), Some(Value::Float(factor * integrator.residual())));
    let newton = |iterations: u32| ("integrator.newton".into(), Some(Value::Integer(iterations.into())));
    let mut solvers = match integrator.newton {
        1 => vec![("Newton to convergence", newton(CONVERGED))],
        _ => vec![("one Newton iteration", newton(1))],
    };
    if variant.error.is_none() {
        solvers.extend([("10 times as loose", loose(10.0)), ("100 times as loose", loose(100.0))]);
    }
    solvers
}
