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
        let mut ratio = None;
        if let (Some(fine), Some(failed), Some(theory)) = (measured, failed, theory.filter(|&theory| theory > 0.0)) {
            let (low, high) = bisect(study, subject, ground, fine, failed.step)?;
            measured = Some(low);
            // Not where the time was up before it was known.
            ratio = (high <= (1.0 + CLOSE) * low).then_some(low / theory);
        }
        let (method, newton, name) = (subject.method.name(), subject.newton, subject.name());
        let (failed, failed_by) = (failed.map(|row| row.step), failed.map(|row| row.verdict));
        Ok(Limit { method, newton, name, runs: own.len(), measured, failed, failed_by, theory, ratio })
    };
    subjects.iter().map(limit).collect()
}

/// The longest step below which all are fine, s, and the next.
fn bounds<'a>(rows: &[&'a Row]) -> (Option<f64>, Option<&'a Row>) {
    let fine = rows.iter().take_while(|row| row.verdict == Verdict::Fine).count();
    (rows[..fine].last().map(|row| row.step), rows.get(fine).copied())
}

/// Narrows the steps between which a subject begins to fail.
fn bisect(
    study: &Study<'_>,
    subject: Subject,
    ground: &Ground,
    mut low: f64,
    mut high: f64,
) -> Result<(f64, f64), Failure> {
    while high > (1.0 + CLOSE) * low && !study.left().is_zero() {
        let middle = (low * high).sqrt();
        match run_cell(study, subject, ground, middle)?.verdict {
            Verdict::Fine => low = middle,
            Verdict::NotRun => break,
            _ => high = middle,
        }
    }
    Ok((low, high))
}
