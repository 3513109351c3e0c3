//! The longest stable step of each method, measured on the scene itself, and whether it stays stable until the
//! scene's end.

use crate::failure::Failure;
use crate::study::Study;

use super::cell::{self, Subject, Verdict, judge};
use super::map::{Ground, run_cell};
use super::report::{Limit, Row, Whole};
use super::share::Share;

/// Relative accuracy of the limit of explicit methods: it takes 8 runs.
const CLOSE: f64 = 0.002;

/// Where a step fails before the scene's end, each next try is shorter by this factor; there are at most `TRIES`
/// tries.
const SHORTER: f64 = 0.95;
const TRIES: i32 = 10;

/// The limits of all subjects on the scene itself, from its rows and from runs between them. They take half of the
/// remaining budget; the other half is for the scaled scenes.
pub fn measure(study: &Study<'_>, subjects: &[Subject], ground: &Ground, rows: &[Row]) -> Result<Vec<Limit>, Failure> {
    let limit = |(place, &subject): (usize, &Subject)| {
        let own = rows.iter().filter(|row| row.is_fixed() && row.is_of(subject) && row.verdict != Verdict::NotRun);
        limit(&Share::one_of(2 * (subjects.len() - place), study), subject, ground, &own.collect::<Vec<_>>())
    };
    subjects.iter().enumerate().map(limit).collect()
}

fn limit(share: &Share<'_, '_>, subject: Subject, ground: &Ground, rows: &[&Row]) -> Result<Limit, Failure> {
    let fine = rows.iter().take_while(|row| row.verdict == Verdict::Fine).count();
    let (longest, failed) = (rows[..fine].last(), rows.get(fine));
    let mut measured = longest.map(|row| row.step);
    let again = rows[fine..].iter().find(|row| row.verdict == Verdict::Fine);
    let theory = ground.theory(subject.method);
    let mut ratio = None;
    if let (Some(fine), Some(failed), Some(theory)) = (measured, failed, theory.filter(|&theory| theory > 0.0)) {
        let (low, high) = bisect(share, subject, ground, fine, failed.step)?;
        measured = Some(low);
        // There is no ratio if the time ended before the limit was accurate enough.
        ratio = (high <= (1.0 + CLOSE) * low).then_some(low / theory);
    }
    let duration = share.study.scene.desc.duration;
    let cost = longest.map_or(0.0, |row| row.wall / row.steps as f64);
    Ok(Limit {
        method: subject.method.name(),
        newton: subject.newton,
        name: subject.name(),
        runs: rows.len(),
        measured,
        watched: measured.map(|step| step * cell::watched(duration, step, subject.method) as f64),
        whole: measured.map(|step| to_the_end(share, subject, ground, step, cost)).transpose()?,
        failed: failed.map(|row| row.step),
        failed_by: failed.map(|row| row.verdict),
        fine_again: again.map(|row| row.step),
        theory,
        ratio,
    })
}

/// Narrows the interval of steps in which a subject begins to fail.
fn bisect(
    share: &Share<'_, '_>,
    subject: Subject,
    ground: &Ground,
    mut low: f64,
    mut high: f64,
) -> Result<(f64, f64), Failure> {
    while high > (1.0 + CLOSE) * low && !share.left().is_zero() {
        let middle = (low * high).sqrt();
        match run_cell(share, subject, ground, middle, None)?.verdict {
            Verdict::Fine => low = middle,
            Verdict::NotRun => break,
            _ => high = middle,
        }
    }
    Ok((low, high))
}

/// Runs a step to the scene's end if the map did not, and where it fails, shorter ones. A run that would take more
/// than the time left is not begun; `cost` is the time for one step, s.
fn to_the_end(
    share: &Share<'_, '_>,
    subject: Subject,
    ground: &Ground,
    step: f64,
    cost: f64,
) -> Result<Whole, Failure> {
    let duration = share.study.scene.desc.duration;
    let steps = cell::whole(duration, step);
    if cell::watched(duration, step, subject.method) >= steps {
        return Ok(Whole { steps, held: duration, verdict: Verdict::Fine, lasting: Some(step) });
    }
    let mut first = None;
    for tried in (0..TRIES).map(|k| step * SHORTER.powi(k)) {
        let steps = cell::whole(duration, tried);
        if cost * steps as f64 > share.left().as_secs_f64() {
            break;
        }
        share.study.say(&format!("{}, step {} to the scene's end", subject.name(), crate::units::time(tried)));
        let run = cell::fly(share, subject, ground, (tried, steps), None, ground.energy)?;
        let (verdict, held) = (judge(&run).0, (run.report.steps as f64 * tried).min(duration));
        let whole = first.get_or_insert(Whole { steps, held, verdict, lasting: None });
        match verdict {
            Verdict::Fine => {
                whole.lasting = Some(tried);
                break;
            }
            Verdict::NotRun => break,
            _ => {}
        }
    }
    Ok(first.unwrap_or(Whole { steps, held: 0.0, verdict: Verdict::NotRun, lasting: None }))
}
