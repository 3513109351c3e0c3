//! What was chosen and why, in numbers and words.

use serde::Serialize;

use crate::bench::cpu_name;
use crate::study::distance::Measure;
use crate::study::variant::Variant;
use crate::units::{length, time};

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
    /// The step of the one that the choice was checked against, s.
    pub check_step: f64,
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
    /// The processor; one thread of it.
    pub machine: String,
    /// All pilot runs but those of the reference, in their order.
    pub considered: Vec<Row>,
}

/// Puts together what was found.
pub fn of(pilot: &Pilot<'_>, checked: &Checked) -> Choice {
    let (study, row) = (pilot.study, &checked.found.row);
    let (reference, _): &(Variant, _) = pilot.reference.best();
    let implicit = row.variant.method.is_implicit();
    Choice {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        vertices: pilot.masses.len(),
        measure: pilot.reference.rule.measure,
        tolerance: pilot.tolerance,
        chosen: Chosen {
            method: row.method,
            precision: row.precision,
            step: row.step,
            solver_tolerance: implicit.then(|| row.variant.tolerance(&checked.found.scene)),
            terms: row.terms.clone(),
        },
        predicted: Figures { error: row.error.unwrap_or(f64::INFINITY), wall_s: row.wall_s },
        measured: Figures { error: checked.error, wall_s: checked.wall },
        pilot_s: study.seconds(),
        reason: reason(pilot, row),
        reference: ReferenceReport {
            method: reference.method.name(),
            step: reference.step(&study.scene),
            self_error: pilot.reference.self_error,
            check_step: checked.step,
        },
        machine: cpu_name(),
        considered: pilot.considered.clone(),
    }
}

/// The cheapest run of a method with all terms, within the tolerance.
fn cheapest<'a>(pilot: &'a Pilot<'_>, is_wanted: impl Fn(&Row) -> bool) -> Option<&'a Row> {
    let rows = pilot.considered.iter().filter(|row| row.meets() && row.terms.is_empty() && is_wanted(row));
    rows.min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
}

/// The choice beside the next, both with all terms.
fn reason(pilot: &Pilot<'_>, row: &Row) -> String {
    let own = cheapest(pilot, |other| other.method == row.method);
    let next = cheapest(pilot, |other| other.method != row.method);
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
        let (c, r) = (&self.chosen, &self.reference);
        let terms = if c.terms.is_empty() { "with all terms".into() } else { c.terms.join(", ") };
        let solver = c.solver_tolerance.map_or_else(String::new, |to| format!(", solver tolerance {to:.1e}"));
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
                "reference: {} f64, step {}; the last halving moved it by {}",
                r.method,
                time(r.step),
                length(r.self_error)
            ),
            String::new(),
            format!("Chosen: {} {} by steps of {}{solver}, {terms}", c.method, c.precision, time(c.step)),
            format!("Why: {}", self.reason),
            format!("Predicted: {} in {}", length(self.predicted.error), time(self.predicted.wall_s)),
            format!(
                "Checked: {} in {}, against the reference by steps of {}",
                length(self.measured.error),
                time(self.measured.wall_s),
                time(r.check_step)
            ),
            format!(
                "Found in {}, {:.0} times what the chosen run takes",
                time(self.pilot_s),
                self.pilot_s / self.measured.wall_s
            ),
            String::new(),
            format!("{:<18}{:<5}{:>11}{:>11}{:>11}  verdict", "method", "", "step", "error", "time"),
        ];
        lines.extend(self.considered.iter().map(line));
        lines.join("\n")
    }
}

/// A line of the table.
fn line(row: &Row) -> String {
    let verdict = match row.verdict {
        Verdict::Meets => "meets it",
        Verdict::Misses => "misses it",
        Verdict::Failed | Verdict::Dear => row.why.as_deref().unwrap_or_default(),
    };
    let terms = if row.terms.is_empty() { String::new() } else { format!(", {}", row.terms.join(", ")) };
    let error = row.error.map_or_else(|| "-".into(), length);
    format!(
        "{:<18}{:<5}{:>11}{error:>11}{:>11}  {verdict}{terms}",
        row.method,
        row.precision,
        time(row.step),
        time(row.wall_s)
    )
}
