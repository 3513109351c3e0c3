//! The report of `muslin choose`: numbers and text.

use serde::Serialize;

use crate::failure::Failure;
use crate::study::distance::Measure;
use crate::study::partial::SoFar;
use crate::study::variant::{Variant, in_words};
use crate::summary::percent;
use crate::units::{apart, length, time};

use super::check::Checked;
use super::pilot::Pilot;
use super::row::{Row, Verdict};

/// Head of the table of runs.
const HEAD: &str = "method                            step   solver        error    stretch       time  verdict";

/// How to run the scene.
#[derive(Clone, Debug, Serialize)]
pub struct Chosen {
    /// Name as in a scene file.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// Step, s; with an allowed error the longest one.
    pub step: f64,
    /// Step that `muslin run` takes, s: it may be shorter, to fit the frames; with an allowed error the longest one.
    pub run_step: f64,
    /// Allowed error of a step, m; `None`: all steps have the same length.
    pub allowed_error: Option<f64>,
    /// Tolerance of the solver; `None` for explicit methods and where it follows the allowed error.
    pub solver_tolerance: Option<f64>,
    /// Terms that are left out or simplified, in words.
    pub terms: Vec<String>,
}

/// An error, m, and a time, s.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Figures {
    /// RMS error, m.
    pub error: f64,
    /// Computing time, s.
    pub wall_s: f64,
}

/// The reference that errors are measured against.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceReport {
    /// Name as in a scene file; it runs in double precision.
    pub method: &'static str,
    /// Step, s.
    pub step: f64,
    /// Change by the last halving of its step, m.
    pub self_error: f64,
    /// Whether `self_error` is only an upper bound, because the change is below rounding.
    pub is_bound: bool,
    /// Step of the reference of the check, s.
    pub check_step: f64,
}

/// The run of another method that is nearest to the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    /// Name as in a scene file.
    pub method: &'static str,
    /// Its step, or the allowed error of a step, in words.
    pub stride: String,
    /// RMS distance from the reference, m.
    pub error: f64,
}

/// The report, `choose --json`. Errors are in metres.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// Name of the scene.
    pub scene: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Number of vertices of all cloths.
    pub vertices: usize,
    /// The compared quantity: positions, or with contact the outline.
    pub measure: Measure,
    /// RMS error that is allowed, m.
    pub tolerance: f64,
    /// The choice.
    pub chosen: Chosen,
    /// Prediction from the pilot runs.
    pub predicted: Figures,
    /// Result of the check.
    pub measured: Figures,
    /// Cost of the search and the check, s.
    pub pilot_s: f64,
    /// Why this method was chosen.
    pub reason: String,
    /// The reference that errors are measured against.
    pub reference: ReferenceReport,
    /// With contact no theory says that methods converge to the same drape, so this shows how near another method
    /// comes. `None` without contact, or if no other method reached its end.
    pub nearest_other: Option<Nearest>,
    /// Longest step that is tried, s: the scene takes at least 20 steps and at least one per frame.
    pub longest_step: f64,
    /// The processor, of which one thread is used; a note if costs are counted.
    pub machine: String,
    /// All pilot runs except the runs of the reference, in their order.
    pub considered: Vec<Row>,
}

/// The report of an interrupted search.
#[derive(Debug, Serialize)]
struct Unchecked<'a> {
    scene: &'a str,
    tolerance: f64,
    /// The cheapest run so far that meets the tolerance.
    cheapest: Option<&'a Row>,
    considered: &'a [Row],
}

/// The results when the search is interrupted: all pilot runs, and the cheapest that meets the tolerance.
pub fn so_far(pilot: &Pilot<'_>) -> Result<SoFar, Failure> {
    let (tolerance, cheapest, considered) = (pilot.tolerance, pilot.cheapest(), &pilot.considered[..]);
    let scene = &pilot.study.scene.desc.name;
    let best = cheapest.map_or_else(
        || "no run meets it yet".into(),
        |row| format!("{} meets it in {} and is the cheapest so far; it is not checked", row.name(), time(row.wall_s)),
    );
    let mut lines = vec![format!("{scene}: tolerance {}; {best}", length(tolerance)), HEAD.into()];
    lines.extend(considered.iter().map(|row| line(row, tolerance)));
    SoFar::new(None, &Unchecked { scene, tolerance, cheapest, considered }, lines.join("\n"))
}

/// Creates the report.
pub fn of(pilot: &Pilot<'_>, checked: &Checked) -> Result<Choice, Failure> {
    let (study, row) = (pilot.study, &checked.found.row);
    let (reference, _): &(Variant, _) = pilot.reference.best();
    let longest = Variant::fixed(row.variant.method, row.variant.precision, pilot.fewest_steps());
    Ok(Choice {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        vertices: pilot.masses.len(),
        measure: pilot.reference.rule.measure,
        tolerance: pilot.tolerance,
        chosen: Chosen {
            method: row.method,
            precision: row.precision,
            step: row.step,
            allowed_error: row.allowed_error,
            run_step: row.variant.chosen(&checked.found.scene)?.desc.timing().step,
            solver_tolerance: row.solver_tolerance,
            terms: row.terms.clone(),
        },
        predicted: Figures { error: row.error.unwrap_or(checked.error), wall_s: row.wall_s },
        measured: Figures { error: checked.error, wall_s: checked.wall },
        pilot_s: study.seconds(),
        reason: reason(pilot, row),
        reference: ReferenceReport {
            method: reference.method.name(),
            step: reference.step(&study.scene),
            self_error: pilot.reference.self_error,
            is_bound: is_bound(pilot),
            check_step: checked.step,
        },
        nearest_other: nearest_other(pilot),
        longest_step: longest.step(&study.scene),
        machine: study.machine(),
        considered: pilot.considered.clone(),
    })
}

/// Whether the last halving moved the reference by less than its reported own error.
fn is_bound(pilot: &Pilot<'_>) -> bool {
    let reference = &pilot.reference;
    let [.., (_, coarse), (_, fine)] = reference.runs.as_slice() else { return false };
    pilot.error(fine, coarse) < reference.self_error
}

/// The run of another method, with all terms, that is nearest to the reference; `None` without contact.
fn nearest_other(pilot: &Pilot<'_>) -> Option<Nearest> {
    let rule = pilot.reference.rule;
    let others = pilot.considered.iter().filter(|row| row.terms.is_empty() && row.variant.method != rule.method);
    let told = others.filter_map(|row| Some(Nearest { method: row.method, stride: row.stride(), error: row.error? }));
    let nearest = told.min_by(|a, b| a.error.total_cmp(&b.error));
    nearest.filter(|_| rule.measure == Measure::Outline)
}

/// Compares the choice with the next best method, both with all terms.
fn reason(pilot: &Pilot<'_>, row: &Row) -> String {
    let whole = |other: &Row| other.terms.is_empty();
    let own = pilot.cheapest_of(|other| whole(other) && other.method == row.method);
    let next = pilot.cheapest_of(|other| whole(other) && other.method != row.method);
    match own.zip(next) {
        Some((own, next)) => format!(
            "{} takes {} and the next, {}, {:.2} times that",
            own.name(),
            time(own.wall_s),
            next.name(),
            next.wall_s / own.wall_s
        ),
        None => format!(
            "only {} meets the tolerance; no other method does within twice its time and its share of the budget",
            row.name()
        ),
    }
}

impl Choice {
    /// The report as text.
    pub fn lines(&self) -> String {
        let mut lines = self.asked();
        lines.push(String::new());
        lines.extend(self.answered());
        lines.push(String::new());
        lines.push(HEAD.into());
        lines.extend(self.considered.iter().map(|row| line(row, self.tolerance)));
        lines.join("\n")
    }

    /// The scene, the tolerance and the reference.
    fn asked(&self) -> Vec<String> {
        let r = &self.reference;
        let mut lines = vec![
            format!(
                "{}: {} s of {} vertices; tolerance {}, RMS over 20 moments of the {}",
                self.scene,
                self.duration_s,
                self.vertices,
                length(self.tolerance),
                self.measure.name()
            ),
            format!(
                "reference: {} f64, step {}; the last halving moved it by {}{}",
                r.method,
                time(r.step),
                if r.is_bound { "less than " } else { "" },
                length(r.self_error)
            ),
        ];
        if self.measure == Measure::Outline {
            let nearest = self.nearest_other.as_ref().map_or_else(
                || "no other method reached the end".into(),
                |n| format!("the nearest other method, {} with {}, is {} from it", n.method, n.stride, length(n.error)),
            );
            lines.push(format!("With contact, {} confirms its own reference only: {nearest}", r.method));
        }
        lines.push(format!(
            "Steps fit into 20 equal parts of the time: steps longer than {} are not tried",
            time(self.longest_step)
        ));
        lines
    }

    /// The choice, the reason for it, its error and the cost of the search.
    fn answered(&self) -> Vec<String> {
        let c = &self.chosen;
        let terms = if c.terms.is_empty() { "with all terms".into() } else { c.terms.join(", ") };
        let solver = c.solver_tolerance.map_or_else(String::new, |to| format!(", solver tolerance {to:.1e}"));
        let stride = in_words(c.step, c.allowed_error);
        let mut lines = vec![format!("Chosen: {} {} with {stride}{solver}, {terms}", c.method, c.precision)];
        if c.allowed_error.is_none() && is_cut(c.run_step, c.step) {
            lines.push(format!(
                "A frame is not a whole number of these steps: muslin run takes steps of {}",
                time(c.run_step)
            ));
        }
        lines.extend([
            format!("Why: {}", self.reason),
            format!("Predicted: {} in {}", length(self.predicted.error), time(self.predicted.wall_s)),
            format!(
                "Checked: {} in {}, against a reference with steps of {}",
                length(self.measured.error),
                time(self.measured.wall_s),
                time(self.reference.check_step)
            ),
            format!(
                "The search took {}, {:.0} times as long as the chosen run",
                time(self.pilot_s),
                self.pilot_s / self.measured.wall_s
            ),
        ]);
        lines
    }
}

/// Whether a step is shorter than another by more than rounding.
pub fn is_cut(taken: f64, step: f64) -> bool {
    taken < (1.0 - 1e-6) * step
}

/// One line of the table.
fn line(row: &Row, tolerance: f64) -> String {
    let why = || row.why.clone().unwrap_or_default();
    // The time of a run that fails is the cost of no result.
    let (verdict, wall) = match row.verdict {
        Verdict::Meets if row.is_allowed(tolerance) => ("meets it".into(), time(row.wall_s)),
        Verdict::Meets => ("meets it; not proposed, because it allows a step a larger error".into(), time(row.wall_s)),
        Verdict::Misses => ("misses it".into(), time(row.wall_s)),
        Verdict::Failed => (format!("diverged: {}", why()), "-".into()),
        Verdict::Dear => (why(), time(row.wall_s)),
    };
    let terms = if row.terms.is_empty() { String::new() } else { format!(", {}", row.terms.join(", ")) };
    let solver = row.solver_tolerance.map_or_else(String::new, |to| format!("{to:.0e}"));
    let told = |error| apart(error, tolerance)[0].clone();
    let error = row.error.map_or_else(|| "-".into(), told);
    let stretch = row.stretch.map_or_else(|| "-".into(), percent);
    let written = if row.as_written { ", the scene as written" } else { "" };
    format!(
        "{:<18}{:<5}{:>15}{solver:>9}{error:>13}{stretch:>11}{wall:>11}  {verdict}{written}{terms}",
        row.method,
        row.precision,
        row.stride(),
    )
}
