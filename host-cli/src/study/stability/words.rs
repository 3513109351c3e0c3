//! The report of `muslin stability` as text.

use muslin_core::integrate::Method;

use crate::units::{significant, time, time_between};

use super::cell::{EXPLICIT_STEPS, IMPLICIT_STEPS, Verdict};
use super::report::{Axis, Limit, Map, Row, Whole};

/// If the measured limit is below this part of the theoretical limit, a remark says that theory does not predict it.
const EARLY: f64 = 0.9;

/// Marks behind a cell of the table.
const FINE_AGAIN: char = '*';
const NOT_ALL: char = '?';

impl Map {
    /// The report as text.
    pub fn lines(&self) -> String {
        let [asked, right] = self.foretold;
        let mut lines = vec![
            format!(
                "{}: the fastest mode at its start has {:.0} Hz and {:.2} of critical damping",
                self.scene, self.fastest_mode_hz, self.damping_ratio
            ),
            format!(
                "a run takes {EXPLICIT_STEPS} steps of an explicit method, or {IMPLICIT_STEPS} of an implicit one at \
                 most; then the longest stable"
            ),
            "step of each method runs to the scene's end; where it fails, the step is shortened by 5 % until a run \
             holds"
                .into(),
            String::new(),
            format!(
                "{:<28}{:>11}{:>17}{:>9}{:>10}   to the end, {}",
                "longest step",
                "theory",
                "measured",
                "/theory",
                "watched",
                time(self.duration_s)
            ),
        ];
        lines.extend(self.limits.iter().map(limit_line));
        lines.extend(self.axes().into_iter().flat_map(|axis| self.scale_lines(axis)));
        lines.extend(self.controlled.first().and_then(bounds));
        lines.push(String::new());
        lines.extend(self.limits.iter().filter_map(first_failure));
        lines.extend(self.limits.iter().filter_map(early));
        lines.extend(self.limits.iter().filter_map(gains));
        lines.push(format!("of {asked} runs near a theoretical limit, {right} agree with it"));
        if self.missing() > 0 {
            lines.push(format!("{} runs are missing: the budget was used up", self.missing()));
        }
        lines.join("\n")
    }

    /// Tables by scale: the steps with which each subject begins to fail, and its substeps under error control.
    fn scale_lines(&self, axis: Axis) -> Vec<String> {
        let mut lines = self.table("fails from", axis, |limit, scale| Some(self.begins(limit, axis, scale)));
        let notes = [(FINE_AGAIN, "and longer steps are fine again"), (NOT_ALL, "longer steps were not run")];
        let notes = notes.into_iter().filter(|(mark, _)| lines.iter().any(|line| line.contains(*mark)));
        let notes: Vec<_> = notes.map(|(mark, what)| format!("{mark} {what}")).collect();
        lines.extend(notes);
        if !self.controlled.is_empty() {
            lines.extend(self.table("error control", axis, |limit, scale| self.substeps(limit, axis, scale)));
        }
        lines
    }

    /// Table of the subjects that have cells, by scale.
    fn table(&self, what: &str, axis: Axis, cell: impl Fn(&Limit, f64) -> Option<String>) -> Vec<String> {
        let mut scales: Vec<_> = self.rows.iter().filter_map(|row| axis.of(row)).collect();
        scales.sort_by(f64::total_cmp);
        scales.dedup();
        let head: String = scales.iter().map(|scale| format!("{:>17}", format!("x {scale}"))).collect();
        let title = format!("{what}, by {}", axis.name());
        let line = |limit: &Limit| {
            let cells = scales.iter().map(|&scale| Some(format!("{:>17}", cell(limit, scale)?)));
            Some(format!("{:<28}{}", limit.name, cells.collect::<Option<String>>()?))
        };
        let lines = self.limits.iter().filter_map(line);
        [String::new(), format!("{title:<28}{head}")].into_iter().chain(lines).collect()
    }

    /// The substeps of a subject under error control, or the class of its run if that is not fine; `None` for explicit
    /// methods.
    fn substeps(&self, limit: &Limit, axis: Axis, scale: f64) -> Option<String> {
        let row = self.controlled.iter().find(|row| row.name == limit.name && axis.of(row) == Some(scale))?;
        let control = row.control.as_ref()?;
        Some(match row.verdict {
            Verdict::Fine => format!("{}, {}", significant(control.mean, 2), significant(control.shortest, 2)),
            Verdict::NotRun => "-".into(),
            verdict => verdict.name().into(),
        })
    }

    /// The steps of the map between which a subject begins to fail.
    fn begins(&self, limit: &Limit, axis: Axis, scale: f64) -> String {
        let all = || self.rows.iter().filter(|row| row.name == limit.name && axis.of(row) == Some(scale));
        let rows: Vec<&Row> = all().filter(|row| row.verdict != Verdict::NotRun).collect();
        let fine = rows.iter().take_while(|row| row.verdict == Verdict::Fine).count();
        let between = between(rows[..fine].last().map(|row| row.step), rows.get(fine).map(|row| row.step));
        let again = rows[fine..].iter().any(|row| row.verdict == Verdict::Fine);
        let not_all = (1..all().count()).contains(&rows.len()) && fine == rows.len();
        let marks = [(again, FINE_AGAIN), (not_all, NOT_ALL)].into_iter().filter(|mark| mark.0).map(|mark| mark.1);
        between.chars().chain(marks).collect()
    }
}

/// Explains the tables of error control and names the bounds of its runs.
fn bounds(row: &Row) -> Option<String> {
    let (error, longest) = (1e3 * row.control.as_ref()?.error, significant(row.step, 2));
    Some(format!(
        "error control: mean and shortest step, by errors of at most {error} mm and steps of at most {longest}"
    ))
}

/// The range from a step that is fine to one that is not.
fn between(fine: Option<f64>, failed: Option<f64>) -> String {
    match (fine, failed) {
        (Some(fine), Some(failed)) => time_between(fine, failed),
        (Some(fine), None) => format!("> {}", significant(fine, 2)),
        (None, Some(failed)) => format!("< {}", significant(failed, 2)),
        (None, None) => "-".into(),
    }
}

fn limit_line(limit: &Limit) -> String {
    let theory = match limit.theory {
        Some(0.0) => "none".into(),
        Some(theory) => significant(theory, 4),
        None => "any".into(),
    };
    let measured = match (limit.measured, limit.ratio) {
        (Some(measured), Some(_)) => significant(measured, 4),
        _ if limit.runs == 0 => "not run".into(),
        // "< 18 us" would read as if shorter steps were stable.
        (None, _) => limit.failed.map_or_else(|| "-".into(), |failed| format!("fails by {}", significant(failed, 2))),
        (measured, _) => between(measured, limit.failed),
    };
    let ratio = limit.ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}"));
    let watched = limit.watched.map_or_else(String::new, |watched| significant(watched, 2));
    let whole =
        limit.whole.as_ref().zip(limit.measured).map_or_else(String::new, |(whole, step)| to_the_end(whole, step));
    format!("{:<28}{theory:>11}{measured:>17}{ratio:>9}{watched:>10}   {whole}", limit.name).trim_end().into()
}

/// The result of a step over the whole scene.
fn to_the_end(whole: &Whole, step: f64) -> String {
    let lasting = match whole.lasting {
        Some(lasting) => format!("{} holds", significant(lasting, 3)),
        None => "no stable step was found".into(),
    };
    match whole.verdict {
        Verdict::Fine => "holds".into(),
        Verdict::NotRun if whole.held > 0.0 => {
            format!("stable to {} when its time was used up", significant(whole.held, 2))
        }
        Verdict::NotRun => format!("not watched: {} steps", whole.steps),
        Verdict::GaveUp => format!("the solver gave up; {lasting}"),
        verdict => {
            format!("{} at {} by {}; {lasting}", verdict.name(), significant(whole.held, 2), significant(step, 3))
        }
    }
}

/// The first failure of a subject on the map.
fn first_failure(limit: &Limit) -> Option<String> {
    let (step, verdict) = limit.failed.zip(limit.failed_by)?;
    let what = match verdict {
        Verdict::GaveUp => "the solver gave up",
        verdict => verdict.name(),
    };
    let again = limit.fine_again.map_or_else(String::new, |again| format!(", fine again by {}", significant(again, 2)));
    Some(format!("{}: {what} by {}{again}", limit.name, significant(step, 2)))
}

/// Remark on a method that fails with much shorter steps than the fastest mode predicts.
fn early(limit: &Limit) -> Option<String> {
    let early = limit.ratio.is_some_and(|ratio| ratio < EARLY);
    early.then(|| {
        format!(
            "{} fails early: slower modes are damped less than the fastest, or the cloth stiffens when it is stretched",
            limit.name
        )
    })
}

/// Remark on a method whose measured limit is no step to take: it gains energy with every step, in modes that nothing
/// damps. At the start these are all modes of undamped cloth. Later they are the modes of damped cloth that stand
/// across its tension: damping acts along the threads.
fn gains(limit: &Limit) -> Option<String> {
    let name = &limit.name;
    let at_start = limit.runs > 0 && limit.theory == Some(0.0);
    let fails = |whole: &Whole| whole.lasting.is_none() && matches!(whole.verdict, Verdict::Growth | Verdict::Diverged);
    let is_unstable_undamped = [Method::ExplicitEuler, Method::Midpoint].map(Method::name).contains(&limit.method);
    let later = is_unstable_undamped && limit.whole.as_ref().is_some_and(fails);
    match (at_start, later) {
        (true, _) => Some(format!(
            "{name} gains energy with every step, because nothing damps the cloth: with the steps above it gains less \
             than tenfold in 1000 steps, which is not stable; take symplectic-euler"
        )),
        (false, true) => Some(format!(
            "{name}: no step is advised, because none that was tried holds to the end; damping does not act across \
             the tension of the cloth, and {name} gains energy there with every step; take symplectic-euler"
        )),
        (false, false) => None,
    }
}
