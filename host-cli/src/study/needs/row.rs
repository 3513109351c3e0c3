//! The result of a trial, in numbers.

use serde::Serialize;

use crate::engine::Report;
use crate::study::distance::Measure;
use crate::study::median::{median, sorted};
use crate::study::terms::VariantKind;
use crate::study::trajectory::{Ending, Trajectory};

use super::trial::{Baseline, Trial, why_not};
use super::words;

/// Distance of a run from the unchanged scene, m.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Change {
    /// Root mean square over all samples: of the positions, weighted by mass, or of the outline.
    pub rms: f64,
    /// The largest distance at any sample.
    pub max: f64,
    /// Root mean square at the end.
    pub end: f64,
}

impl Change {
    /// The change of a run that reached its end.
    pub fn of(baseline: &Baseline, run: &Trajectory, measure: Measure) -> Self {
        let all = measure.between(run, &baseline.run, &baseline.masses);
        let end = measure.at_end(run, &baseline.run, &baseline.masses);
        Self { rms: all.rms, max: all.max, end: end.rms }
    }
}

/// Work that does not depend on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Number of candidates.
    pub candidates: u64,
    /// Number of contacts.
    pub contacts: u64,
    /// Steps and half steps that were rejected.
    pub rejected_steps: u64,
}

impl Counts {
    /// The counts of a whole run.
    pub fn of(report: &Report) -> Self {
        let [candidates, contacts, .., rejected_steps] = report.contacts;
        Self {
            force_evaluations: report.force_evaluations,
            cg_iterations: report.cg_iterations,
            matrix_products: report.matrix_products,
            candidates,
            contacts,
            rejected_steps,
        }
    }
}

/// The cost of a term, as parts of the time of the unchanged scene.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Time with the term minus time without it; the median of the pairs.
    pub fraction: f64,
    /// The smallest and the largest cost in the middle half of the pairs; with up to three pairs, of all pairs.
    pub range: [f64; 2],
    /// Number of pairs.
    pub repeats: usize,
    /// The smallest and the largest cost of all pairs; with eight or more pairs, without the outermost on each
    /// side.
    pub spread: [f64; 2],
}

impl Cost {
    /// The cost from pairs of times of the unchanged scene and of the trial, s; `None` without pairs.
    fn of(walls: &[[f64; 2]], kind: VariantKind) -> Option<Self> {
        let sign = if kind == VariantKind::Added { -1.0 } else { 1.0 };
        let fractions = sorted(walls.iter().map(|[as_is, trial]| sign * (as_is - trial) / as_is).collect());
        let outer = walls.len() / 4;
        let range = [*fractions.get(outer)?, *fractions.iter().rev().nth(outer)?];
        let stray = walls.len() / 8;
        let spread = [*fractions.get(stray)?, *fractions.iter().rev().nth(stray)?];
        Some(Self { fraction: median(fractions), range, repeats: walls.len(), spread })
    }

    /// Whether the cost differs significantly from zero: all pairs within `spread` agree in sign. By chance five
    /// pairs agree once in 16 times, and at least eight of nine once in 26 times.
    pub fn is_clear(&self) -> bool {
        self.spread[0] > 0.0 || self.spread[1] < 0.0
    }

    /// The sizes to report, in ascending order: the median, or the range if the pairs differ by more than the
    /// median.
    pub fn reported_sizes(&self) -> Vec<f64> {
        let [least, most] = self.range;
        if most - least <= self.fraction.abs() {
            return vec![self.fraction.abs()];
        }
        vec![least.abs().min(most.abs()), least.abs().max(most.abs())]
    }
}

/// How a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It reached its end.
    Ok,
    /// It failed: the scene does not run with this change.
    Diverged,
    /// The budget did not allow it.
    Unfinished,
}

impl Verdict {
    fn of(run: Option<&Trajectory>) -> Self {
        match run.map(|run| &run.ending) {
            Some(Ending::Complete) => Self::Ok,
            Some(Ending::Diverged(_) | Ending::Grown) => Self::Diverged,
            Some(Ending::OutOfTime) | None => Self::Unfinished,
        }
    }
}

/// A term, its change and its cost.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The term.
    pub term: &'static str,
    /// Whether the term is switched off, simplified or added.
    pub kind: VariantKind,
    /// The changed scene, in words after a comma.
    pub run: String,
    /// f32 or f64.
    pub precision: &'static str,
    /// How the run ended.
    pub verdict: Verdict,
    /// RMS change, m; `None` if the run did not reach its end.
    pub change_rms: Option<f64>,
    /// The largest change of any vertex, or in any direction, at any sample, m.
    pub change_max: Option<f64>,
    /// RMS change at the end, m.
    pub change_end: Option<f64>,
    /// RMS change of the positions, m, where the change is of the outline.
    pub positions_rms: Option<f64>,
    /// Whether it changes more than a finer run does; `None` if one of the two is not known.
    pub exceeds_step: Option<bool>,
    /// Time with the term minus time without it, as a part of the time of the unchanged scene.
    pub cost_fraction: Option<f64>,
    /// The smallest and the largest cost in the middle half of the pairs of runs.
    pub cost_range: Option<[f64; 2]>,
    /// Whether all counts equal the counts of the unchanged scene; `None` if the run did not reach its end.
    pub same_counts: Option<bool>,
    /// Number of timed pairs of runs.
    pub repeats: usize,
    /// Median computing time of the steps, s.
    pub wall_s: Option<f64>,
    /// Work of the run.
    pub counts: Option<Counts>,
    /// The result as a sentence.
    pub sentence: String,
    /// Why there is no change to report.
    pub why: Option<String>,
}

impl Row {
    /// The result of a trial.
    pub fn of(baseline: &Baseline, trial: &Trial) -> Self {
        let term = &trial.term;
        let change = trial.complete().map(|run| Change::of(baseline, run, baseline.measure));
        let vertices = trial.complete().filter(|_| baseline.measure == Measure::Outline);
        let own = own_error(baseline);
        let exceeds_step = change.zip(own).map(|(change, own)| change.rms > own.rms);
        let cost = Cost::of(&trial.walls, term.kind);
        let walls: Vec<_> = trial.walls.iter().map(|[_, wall]| *wall).collect();
        let late = || Some("is not run: the budget is used up".into());
        let mut row = Self {
            term: term.name,
            kind: term.kind,
            run: term.run.clone(),
            precision: term.precision.name(),
            verdict: Verdict::of(trial.run.as_ref()),
            change_rms: change.map(|change| change.rms),
            change_max: change.map(|change| change.max),
            change_end: change.map(|change| change.end),
            positions_rms: vertices.map(|run| Change::of(baseline, run, Measure::Positions).rms),
            exceeds_step,
            cost_fraction: cost.map(|cost| cost.fraction),
            cost_range: cost.map(|cost| cost.range),
            same_counts: trial.complete().map(|run| Counts::of(&run.report) == Counts::of(&baseline.run.report)),
            repeats: trial.walls.len(),
            wall_s: (!walls.is_empty()).then(|| median(walls)),
            counts: trial.complete().map(|run| Counts::of(&run.report)),
            sentence: String::new(),
            why: trial.run.as_ref().map_or_else(late, why_not),
        };
        row.sentence = words::sentence(&row, &term.subject, change, cost, baseline);
        row
    }
}

/// The change by a finer run; `None` if that run did not reach its end.
pub fn own_error(baseline: &Baseline) -> Option<Change> {
    why_not(&baseline.finer).is_none().then(|| Change::of(baseline, &baseline.finer, baseline.measure))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_is_the_median_of_pairs_and_what_is_added_costs_the_more() {
        let walls = [[1.0, 0.5], [2.0, 1.2], [4.0, 2.8], [1.0, 9.0], [1.0, 0.1]];
        let cost = Cost::of(&walls, VariantKind::Off).unwrap();
        assert!((cost.fraction - 0.4).abs() < 1e-12, "{cost:?}");
        assert!((cost.range[0] - 0.3).abs() < 1e-12 && (cost.range[1] - 0.5).abs() < 1e-12, "{cost:?}");
        assert!(!cost.is_clear(), "one of five pairs is on the other side");
        let clear = |walls: &[[f64; 2]]| Cost::of(walls, VariantKind::Off).unwrap().is_clear();
        assert!(clear(&[[1.0, 0.9]; 5]) && clear(&[[1.0, 1.2]; 5]) && !clear(&[[1.0, 1.0]; 5]));
        let with_one_odd = |count: usize| [vec![[1.0, 0.9]; count - 1], vec![[1.0, 1.1]]].concat();
        assert!(clear(&with_one_odd(9)) && !clear(&with_one_odd(7)));
        let added = Cost::of(&walls, VariantKind::Added).unwrap();
        assert!((added.fraction + 0.4).abs() < 1e-12 && (added.range[0] + 0.5).abs() < 1e-12, "{added:?}");
        assert!(Cost::of(&[], VariantKind::Off).is_none());
    }
}
