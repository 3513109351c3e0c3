//! What was chosen and why, in numbers and words.

use serde::Serialize;

use crate::failure::Failure;
use crate::study::distance::Measure;
use crate::study::variant::Variant;
use crate::units::{apart, length, time};

use super::check::Checked;
use super::pilot::Pilot;
use super::row::{Row, Verdict};

/// How to run the scene.
#[derive(Clone, Debug, Serialize)]
pub struct Chosen {
    /// As scenes spell it.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// s.
    pub step: f64,
    /// That which `muslin run` takes, s: frames may cut it.
    pub run_step: f64,
    /// None of explicit methods.
    pub solver_tolerance: Option<f64>,
    /// Terms left out or put simpler, in words.
    pub terms: Vec<String>,
}

/// An error, m, and a time, s.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Figures {
    /// RMS, m.
    pub error: f64,
    /// s.
    pub wall_s: f64,
}

/// What errors are measured against.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceReport {
    /// As scenes spell it; in double precision.
    pub method: &'static str,
    /// s.
    pub step: f64,
    /// What the last halving of its step moved it by, m.
    pub self_error: f64,
    /// Whether that is only a bound: less is rounding.
    pub is_bound: bool,
    /// The step of the one that the choice was checked against, s.
    pub check_step: f64,
}

/// The run of another method than the reference's that is nearest to it.
#[derive(Clone, Debug, Serialize)]
pub struct Nearest {
    /// As scenes spell it.
    pub method: &'static str,
    /// s.
    pub step: f64,
    /// RMS, m.
    pub error: f64,
}

/// `choose --json`. Errors are metres.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// Its name.
    pub scene: String,
    /// Simulated, s.
    pub duration_s: f64,
    /// Of all cloths.
    pub vertices: usize,
    /// What an error is of: positions, or with contact the outline.
    pub measure: Measure,
    /// RMS, m.
    pub tolerance: f64,
    /// The choice.
    pub chosen: Chosen,
    /// By the pilot runs.
    pub predicted: Figures,
    /// By the check.
    pub measured: Figures,
    /// What it took to find and check, s.
    pub pilot_s: f64,
    /// Why.
    pub reason: String,
    /// What errors are measured against.
    pub reference: ReferenceReport,
    /// With contact no theory says that another method comes to the same drape: how near one comes;
    /// none without contact, or where no other came to its end.
    pub nearest_other: Option<Nearest>,
    /// Steps fit into 20 equal parts of the time: none longer is tried, s.
    pub longest_step: f64,
    /// The processor; one thread of it.
    pub machine: String,
    /// All pilot runs but those of the reference, in their order.
    pub considered: Vec<Row>,
}

/// Puts together what was found.
pub fn of(pilot: &Pilot<'_>, checked: &Checked) -> Result<Choice, Failure> {
    let (study, row) = (pilot.study, &checked.found.row);
    let (reference, _): &(Variant, _) = pilot.reference.best();
    let implicit = row.variant.method.is_implicit();
    let longest = Variant { steps: pilot.fewest_steps(), ..row.variant };
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
            run_step: row.variant.chosen(&checked.found.scene)?.desc.timing().step,
            solver_tolerance: implicit.then(|| row.variant.tolerance(&checked.found.scene)),
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

/// Whether the last halving moved the reference by less than it is said to.
fn is_bound(pilot: &Pilot<'_>) -> bool {
    let reference = &pilot.reference;
    let [.., (_, coarse), (_, fine)] = reference.runs.as_slice() else { return false };
    pilot.error(fine, coarse) < reference.self_error
}

/// The nearest to the reference with all terms of another method, with contact.
fn nearest_other(pilot: &Pilot<'_>) -> Option<Nearest> {
    let rule = pilot.reference.rule;
    let others = pilot.considered.iter().filter(|row| row.terms.is_empty() && row.variant.method != rule.method);
    let told = others.filter_map(|row| Some(Nearest { method: row.method, step: row.step, error: row.error? }));
    let nearest = told.min_by(|a, b| a.error.total_cmp(&b.error));
    nearest.filter(|_| rule.measure == Measure::Outline)
}

/// The choice beside the next, both with all terms.
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
            "{} alone meets the tolerance; no other does in twice its time and its share of the budget",
            row.name()
        ),
    }
}

impl Choice {
    /// For people.
    pub fn lines(&self) -> String {
        let mut lines = self.asked();
        lines.push(String::new());
        lines.extend(self.answered());
        lines.push(String::new());
        lines.push(format!("{:<18}{:<5}{:>11}{:>13}{:>11}  verdict", "method", "", "step", "error", "time"));
        lines.extend(self.considered.iter().map(|row| line(row, self.tolerance)));
        lines.join("\n")
    }

    /// What was asked for, and what it is measured by.
    fn asked(&self) -> Vec<String> {
        let r = &self.reference;
        let mut lines = vec![
            format!(
                "{}: {} s of {} vertices; asked for {}, RMS over 20 moments of the {}",
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
                || "no other method came to the end here".into(),
                |n| format!("the nearest of another, {} by {}, is {} from it", n.method, time(n.step), length(n.error)),
            );
            lines.push(format!("With contact that is the word of {} alone: {nearest}", r.method));
        }
        lines.push(format!(
            "Steps fit into 20 equal parts of the time: none longer than {} is tried",
            time(self.longest_step)
        ));
        lines
    }

    /// The choice, why, how far it is off and what it cost to find.
    fn answered(&self) -> Vec<String> {
        let c = &self.chosen;
        let terms = if c.terms.is_empty() { "with all terms".into() } else { c.terms.join(", ") };
        let solver = c.solver_tolerance.map_or_else(String::new, |to| format!(", solver tolerance {to:.1e}"));
        let mut lines =
            vec![format!("Chosen: {} {} by steps of {}{solver}, {terms}", c.method, c.precision, time(c.step))];
        if is_cut(c.run_step, c.step) {
            lines.push(format!("Frames cut these: muslin run takes steps of {}", time(c.run_step)));
        }
        lines.extend([
            format!("Why: {}", self.reason),
            format!("Predicted: {} in {}", length(self.predicted.error), time(self.predicted.wall_s)),
            format!(
                "Checked: {} in {}, against the reference by steps of {}",
                length(self.measured.error),
                time(self.measured.wall_s),
                time(self.reference.check_step)
            ),
            format!(
                "Found in {}, {:.0} times what the chosen run takes",
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

/// A line of the table.
fn line(row: &Row, tolerance: f64) -> String {
    let verdict = match row.verdict {
        Verdict::Meets => "meets it",
        Verdict::Misses => "misses it",
        Verdict::Failed | Verdict::Dear => row.why.as_deref().unwrap_or_default(),
    };
    let terms = if row.terms.is_empty() { String::new() } else { format!(", {}", row.terms.join(", ")) };
    let told = |error| apart(error, tolerance)[0].clone();
    let error = row.error.map_or_else(|| "-".into(), told);
    format!(
        "{:<18}{:<5}{:>11}{error:>13}{:>11}  {verdict}{terms}",
        row.method,
        row.precision,
        time(row.step),
        time(row.wall_s)
    )
}
