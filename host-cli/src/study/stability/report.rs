//! What the maps say in numbers and words.

use std::f64::consts::TAU;

use muslin_core::integrate::stability::Mode;
use serde::Serialize;

use crate::study::Study;
use crate::units::time;

use super::cell::{Subject, Verdict};
use super::map::Ground;

/// Measured over theory, below which theory leaves something out.
const EARLY: f64 = 0.9;

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// As scenes spell it.
    pub method: &'static str,
    /// Newton iterations in a step, at most.
    pub newton: u32,
    /// The method and, where there are several, its Newton iterations.
    #[serde(skip)]
    pub name: String,
    /// s.
    pub step: f64,
    /// Times the scene's stiffness.
    pub stiffness_scale: f64,
    /// Times the scene's damping.
    pub damping_scale: f64,
    /// The longest step that theory allows here, s: 0 where every step gains energy, none where every
    /// step is stable.
    pub theory: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// How it went.
    pub verdict: Verdict,
    /// What went wrong.
    pub why: Option<String>,
}

impl Row {
    /// Whether it is of a subject.
    pub fn is_of(&self, subject: Subject) -> bool {
        self.method == subject.method.name() && self.newton == subject.newton
    }

    /// Whether theory foretold how it went; none where it says nothing.
    fn is_foretold(&self) -> Option<bool> {
        let theory = self.theory.filter(|&theory| theory > 0.0 && self.verdict != Verdict::NotRun)?;
        Some((self.step <= theory) == (self.verdict == Verdict::Fine))
    }
}

/// The longest step of a method on the scene itself.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    /// As scenes spell it.
    pub method: &'static str,
    /// Newton iterations in a step, at most.
    pub newton: u32,
    /// The method and, where there are several, its Newton iterations.
    #[serde(skip)]
    pub name: String,
    /// Runs on the scene itself; none where nothing limits the method or nothing was left of the budget.
    pub runs: usize,
    /// The longest step below which every run was fine, s; none where none was.
    pub measured: Option<f64>,
    /// The shortest step of the map that was not, s.
    pub failed: Option<f64>,
    /// How that one went.
    pub failed_by: Option<Verdict>,
    /// What theory allows, s.
    pub theory: Option<f64>,
    /// Measured over theory; none where the budget did not do to measure it.
    pub ratio: Option<f64>,
}

/// What is scaled along a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// All stiffnesses.
    Stiffness,
    /// All dampings, as parts of the stiffness.
    Damping,
}

impl Axis {
    /// The scale of a row along it, if the row is on this map.
    pub fn of(self, row: &Row) -> Option<f64> {
        let (own, other) = match self {
            Self::Stiffness => (row.stiffness_scale, row.damping_scale),
            Self::Damping => (row.damping_scale, row.stiffness_scale),
        };
        (other == 1.0).then_some(own)
    }

    /// As pictures call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
        }
    }
}

/// `stability --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Map {
    /// Its name.
    pub scene: String,
    /// Frequency of the stiffest mode at the scene's start, Hz.
    pub fastest_mode_hz: f64,
    /// Its damping, of critical.
    pub damping_ratio: f64,
    /// All runs, in f32.
    pub rows: Vec<Row>,
    /// The longest steps on the scene itself.
    pub limits: Vec<Limit>,
    /// Runs of which theory says how they go, and of these how many went so.
    pub foretold: [usize; 2],
    /// What the study took, s.
    pub study_s: f64,
}

/// Puts it together.
pub fn summarise(study: &Study<'_>, grounds: &[Ground], rows: Vec<Row>, limits: Vec<Limit>) -> Map {
    let Mode { stiffness, damping } = grounds[0].modes[0];
    let omega = stiffness.sqrt();
    let foretold: Vec<_> = rows.iter().filter_map(Row::is_foretold).collect();
    Map {
        scene: study.scene.desc.name.clone(),
        fastest_mode_hz: omega / TAU,
        damping_ratio: if omega > 0.0 { 0.5 * damping / omega } else { 0.0 },
        foretold: [foretold.len(), foretold.iter().filter(|&&right| right).count()],
        rows,
        limits,
        study_s: study.seconds(),
    }
}

impl Map {
    /// The maps that there are.
    pub fn axes(&self) -> Vec<Axis> {
        let damped = self.rows.iter().any(|row| row.damping_scale != 1.0);
        [Axis::Stiffness].into_iter().chain(damped.then_some(Axis::Damping)).collect()
    }

    /// Runs for which nothing was left of the budget.
    pub fn missing(&self) -> usize {
        self.rows.iter().filter(|row| row.verdict == Verdict::NotRun).count()
    }

    /// For people.
    pub fn lines(&self) -> String {
        let [asked, right] = self.foretold;
        let mut lines = vec![
            format!(
                "{}: the fastest mode at its start has {:.0} Hz and {:.2} of critical damping",
                self.scene, self.fastest_mode_hz, self.damping_ratio
            ),
            "explicit methods are watched for 1000 steps, implicit ones for 200 or to the scene's end".into(),
            String::new(),
            "longest step                     theory     measured   measured/theory   of the map".into(),
        ];
        lines.extend(self.limits.iter().map(limit_line));
        for axis in self.axes() {
            lines.extend(self.scale_lines(axis));
        }
        lines.push(String::new());
        lines.extend(self.limits.iter().filter_map(early));
        lines.push(format!("of {asked} runs near a limit of theory {right} went as it says"));
        if self.missing() > 0 {
            lines.push(format!("{} runs are missing: the budget was used up", self.missing()));
        }
        lines.join("\n")
    }

    /// The longest fine step of each subject by scale.
    fn scale_lines(&self, axis: Axis) -> Vec<String> {
        let mut scales: Vec<_> = self.rows.iter().filter_map(|row| axis.of(row)).collect();
        scales.sort_by(f64::total_cmp);
        scales.dedup();
        let head: String = scales.iter().map(|scale| format!("{:>11}", format!("x {scale}"))).collect();
        let title = format!("fine up to, by {}", axis.name());
        let lines = self.limits.iter().map(|limit| {
            let cells: String =
                scales.iter().map(|&scale| format!("{:>11}", self.longest(limit, axis, scale))).collect();
            format!("{:<28}{cells}", limit.name)
        });
        [String::new(), format!("{title:<28}{head}")].into_iter().chain(lines).collect()
    }

    /// The longest step of the map below which a subject is fine.
    fn longest(&self, limit: &Limit, axis: Axis, scale: f64) -> String {
        let rows = self.rows.iter().filter(|row| row.name == limit.name && axis.of(row) == Some(scale));
        let fine = rows.take_while(|row| row.verdict == Verdict::Fine).last();
        fine.map_or_else(|| "-".into(), |row| time(row.step))
    }
}

/// Why a method failed by much shorter steps than the fastest mode asks for.
fn early(limit: &Limit) -> Option<String> {
    let early = limit.ratio.is_some_and(|ratio| ratio < EARLY);
    early.then(|| {
        format!(
            "{} fails early: slower modes are damped less than the fastest, or the cloth stiffens as it is drawn",
            limit.name
        )
    })
}

fn limit_line(limit: &Limit) -> String {
    let theory = match limit.theory {
        Some(0.0) => "none".into(),
        Some(theory) => time(theory),
        None => "any".into(),
    };
    let measured = match (limit.measured, limit.failed) {
        (Some(measured), Some(_)) if limit.theory.is_none_or(|t| t == 0.0) || limit.ratio.is_some() => time(measured),
        (Some(measured), _) => format!("> {}", time(measured)),
        (None, Some(_)) => "none".into(),
        (None, None) => "not run".into(),
    };
    let then = match limit.failed.zip(limit.failed_by) {
        Some((step, Verdict::GaveUp)) => format!("the solver gave up by {}", time(step)),
        Some((step, verdict)) => format!("{} by {}", verdict.name(), time(step)),
        None => String::new(),
    };
    let ratio = limit.ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}"));
    format!("{:<28}{theory:>11}{measured:>13}   {ratio:<15}   {then}", limit.name).trim_end().into()
}
