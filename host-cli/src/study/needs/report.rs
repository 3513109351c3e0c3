//! The report of `muslin needs`: numbers and text.

use serde::Serialize;

use crate::study::Study;
use crate::study::distance::Measure;
use crate::study::median::median;
use crate::study::variant::in_words;
use crate::units::{length, time};

use super::row::{Change, Counts, Row, Verdict, own_error};
use super::trial::{Baseline, Trial, why_not};
use super::words::{extent, list, moved};

/// Terms of the scene that the step hides: each alone changes less than a finer run does.
#[derive(Clone, Debug, Serialize)]
pub struct Hidden {
    /// Names of the terms, without those that are parts of other hidden terms.
    pub terms: Vec<&'static str>,
    /// Those of `terms` that move nothing at all.
    pub still: Vec<&'static str>,
    /// Other hidden terms: they are parts of `terms` and are switched off with them.
    pub parts: Vec<&'static str>,
    /// Result of switching them all off together; `None` if there are no hidden terms.
    pub without_them: Option<Row>,
}

/// The report, `needs --json`. Lengths are in metres.
#[derive(Clone, Debug, Serialize)]
pub struct Needs {
    /// Name of the scene.
    pub scene: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Number of vertices of all cloths.
    pub vertices: usize,
    /// Name as in a scene file; it runs in single precision.
    pub method: &'static str,
    /// Step of the study, s: it fits 20 equal parts of the time; with an allowed error the longest one.
    pub step: f64,
    /// Step that `muslin run` takes, s: it fits the frames; with an allowed error the longest one.
    pub run_step: f64,
    /// Allowed error of a step, m; `None`: all steps have the same length.
    pub allowed_error: Option<f64>,
    /// The compared quantity: positions, or with contact the outline.
    pub measure: Measure,
    /// The change of the run that `step_error` measures, in words.
    pub finer: &'static str,
    /// The change by a finer run; `None` if that run did not reach its end.
    pub step_error: Option<Change>,
    /// Why `step_error` is missing.
    pub step_error_why: Option<String>,
    /// Median computing time of the unchanged scene's steps, s.
    pub wall_s: f64,
    /// Work of the unchanged scene.
    pub counts: Counts,
    /// The processor, of which one thread is used; a note if costs are counted.
    pub machine: String,
    /// First the terms without which the scene diverges, then the others by their change, last those that the
    /// budget did not allow.
    pub rows: Vec<Row>,
    /// Terms that the step hides.
    pub hidden: Hidden,
    /// Sentence about the hidden terms and their cost.
    pub conclusion: String,
    /// Cost of the study, s.
    pub study_s: f64,
}

/// Creates the report.
pub fn of(study: &Study<'_>, baseline: &Baseline, trials: &[Trial], hidden: Hidden) -> Needs {
    let mut rows: Vec<_> = trials.iter().map(|trial| Row::of(baseline, trial)).collect();
    rows.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    Needs {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        vertices: baseline.masses.len(),
        method: baseline.variant.method.name(),
        step: baseline.variant.step(&study.scene),
        run_step: study.scene.desc.timing().step,
        measure: baseline.measure,
        allowed_error: baseline.variant.error,
        finer: baseline.variant.shorter_steps_in_words(),
        step_error: own_error(baseline),
        step_error_why: why_not(&baseline.finer),
        wall_s: wall_as_it_is(baseline, trials),
        counts: Counts::of(&baseline.run.report),
        machine: study.machine(),
        conclusion: conclusion(&hidden, baseline),
        rows,
        hidden,
        study_s: study.seconds(),
    }
}

/// Sort key of a row; larger values come first.
fn rank(row: &Row) -> f64 {
    match row.verdict {
        Verdict::Diverged => f64::INFINITY,
        Verdict::Ok => row.change_rms.unwrap_or(0.0),
        Verdict::Unfinished => -1.0,
    }
}

/// Median time of all runs of the unchanged scene, s.
fn wall_as_it_is(baseline: &Baseline, trials: &[Trial]) -> f64 {
    let repeats = trials.iter().flat_map(|trial| &trial.walls).map(|[as_is, _]| *as_is);
    median(repeats.chain([baseline.run.wall]).collect())
}

/// Sentence about the terms that the step hides and their common cost.
fn conclusion(hidden: &Hidden, baseline: &Baseline) -> String {
    let (what, finer) = (moved(baseline.measure), baseline.variant.shorter_steps_in_words());
    match (hidden.terms.as_slice(), &hidden.without_them) {
        ([], _) if own_error(baseline).is_none() => {
            format!("How far {finer} moves the {what} is not known, so no term can be judged as too small")
        }
        ([_], _) => called(hidden, what),
        ([_, ..], Some(row)) => format!("{}; {}", called(hidden, what), without_them(row, what, finer)),
        _ => format!("No modelled term that was run to the end moves the {what} by less than {finer} does"),
    }
}

/// Names the hidden terms, and those that move nothing at all.
fn called(hidden: &Hidden, what: &str) -> String {
    let still = hidden.still.as_slice();
    let moving: Vec<_> = hidden.terms.iter().copied().filter(|term| !still.contains(term)).collect();
    let verb = if still.len() == 1 { "does" } else { "do" };
    let still = (!still.is_empty()).then(|| format!("{} {verb} not move the {what}", list(still)));
    let alone = if hidden.terms.len() == 1 { " alone" } else { "" };
    let moving = (!moving.is_empty()).then(|| format!("hidden by the step's own error: {}{alone}", list(&moving)));
    let parts = (!hidden.parts.is_empty()).then(|| format!("{} would be left out too", list(&hidden.parts)));
    capital(&[still, moving, parts].into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Sentence about the run without all hidden terms.
fn without_them(row: &Row, what: &str, finer: &str) -> String {
    let change = row.change_rms.zip(row.change_max).zip(row.change_end);
    let Some(((rms, max), end)) = change else { return row.sentence.clone() };
    let moves = extent(Change { rms, max, end }, row.positions_rms);
    let more = if row.exceeds_step == Some(true) { format!(", more than {finer} does,") } else { String::new() };
    let takes = row.cost_range.zip(row.cost_fraction).map(|([least, most], cost)| {
        let [cost, least, most] = [cost, most, least].map(|cost| 100.0 * (1.0 - cost));
        let known = if row.repeats == 1 { "timed once".into() } else { format!("{least:.0} to {most:.0} %") };
        format!(" and the run takes {cost:.0} % of the time ({known})")
    });
    format!("without them all the {what} moves by {moves}{more}{}", takes.unwrap_or_default())
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// If rounding changes more than this part of the change by a finer run, the motion is no longer determined.
const UNSTABLE: f64 = 0.1;

impl Needs {
    /// A warning if rounding alone changes much.
    fn chance(&self) -> Option<String> {
        let rounding = self.rows.iter().find(|row| row.precision == "f64")?.change_rms?;
        let own = self.step_error?.rms;
        (rounding > UNSTABLE * own).then(|| {
            let (rounding, what) = (length(rounding), moved(self.measure));
            format!("Rounding alone moves the {what} by {rounding}: a change of this size may be chance")
        })
    }

    /// The report as text.
    pub fn lines(&self) -> String {
        let what = moved(self.measure);
        let stride = in_words(self.step, self.allowed_error);
        let mut lines = vec![format!(
            "{}: {} s of {} vertices, {} f32 with {stride}, computed in {}",
            self.scene,
            self.duration_s,
            self.vertices,
            self.method,
            time(self.wall_s)
        )];
        lines.push(match (&self.step_error, &self.step_error_why) {
            (Some(own), _) => format!(
                "{} moves the {what} by {}: a term that moves it by less cannot be judged",
                capital(self.finer),
                extent(*own, None)
            ),
            (None, why) => format!("{} {}", capital(self.finer), why.as_deref().unwrap_or("is not known")),
        });
        if (self.step / self.run_step - 1.0).abs() > 1e-6 {
            let (taken, own) = (time(self.step), time(self.run_step));
            lines.push(format!("Steps fit into 20 equal parts of the time: {taken}, where muslin run takes {own}"));
        }
        lines.extend(self.chance());
        lines.push(String::new());
        lines.extend(self.rows.iter().map(|row| capital(&row.sentence)));
        lines.extend([String::new(), self.conclusion.clone(), String::new()]);
        lines.push(format!(
            "{:<30}{:>12}{:>15}{:>14}{:>12}",
            "run", "evaluations", "CG iterations", "candidates", "time"
        ));
        lines.push(counted("as it is", Some(self.counts), Some(self.wall_s)));
        // A single hidden term is in the table already.
        let together = self.hidden.without_them.iter().filter(|_| self.hidden.terms.len() > 1);
        lines.extend(self.rows.iter().chain(together).map(|row| counted(&row.run, row.counts, row.wall_s)));
        lines.join("\n")
    }
}

/// One line of the table: force evaluations, CG iterations, candidates and time.
fn counted(run: &str, counts: Option<Counts>, wall: Option<f64>) -> String {
    let column = |count: fn(&Counts) -> u64| counts.as_ref().map_or_else(|| "-".into(), |c| count(c).to_string());
    format!(
        "{run:<30}{:>12}{:>15}{:>14}{:>12}",
        column(|c| c.force_evaluations),
        column(|c| c.cg_iterations),
        column(|c| c.candidates),
        wall.map_or_else(|| "-".into(), time)
    )
}
