//! The longest step that each method bore, measured on the scene itself.

use crate::failure::Failure;
use crate::study::Study;

use super::cell::{Subject, Verdict};
use super::map::{Ground, run_cell};
use super::report::{Limit, Row};

/// How closely the limit of explicit methods is told, of itself: 8 runs.
const CLOSE: f64 = 0.002;

/// The limits of all subjects on the scene itself, from its rows and runs between them.
pub fn measure(study: &Study<'_>, subjects: &[Subject], ground: &Ground, rows: &[Row]) -> Result<Vec<Limit>, Failure> {
    let limit = |&subject: &Subject| {
        let own = rows.iter().filter(|row| row.is_of(subject) && row.verdict != Verdict::NotRun);
        let own: Vec<_> = own.collect();
        let (mut measured, failed) = bounds(&own);
        let theory = ground.theory(subject.method);
        if let (Some(fine), Some(failed), Some(_)) = (measured, failed, theory.filter(|&theory| theory > 0.0)) {
            measured = Some(bisect(study, subject, ground, fine, failed)?);
        }
        let ratio = measured.zip(theory).filter(|(_, theory)| *theory > 0.0).map(|(m, theory)| m / theory);
        let name = subject.name();
        Ok(Limit { method: subject.method.name(), newton: subject.newton, name, measured, failed, theory, ratio })
    };
    subjects.iter().map(limit).collect()
}

/// The longest step below which all are fine, and the next, s.
fn bounds(rows: &[&Row]) -> (Option<f64>, Option<f64>) {
    let fine = rows.iter().take_while(|row| row.verdict == Verdict::Fine).count();
    (rows[..fine].last().map(|row| row.step), rows.get(fine).map(|row| row.step))
}

fn bisect(study: &Study<'_>, subject: Subject, ground: &Ground, fine: f64, failed: f64) -> Result<f64, Failure> {
    let (mut low, mut high) = (fine, failed);
    while high > (1.0 + CLOSE) * low && !study.left().is_zero() {
        let middle = (low * high).sqrt();
        match run_cell(study, subject, ground, middle)?.verdict {
            Verdict::Fine => low = middle,
            _ => high = middle,
        }
    }
    Ok(low)
}
