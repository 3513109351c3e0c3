//! The unchanged scene and the trials of its terms. Both are run in pairs, so that both see the same load on the
//! machine.

use std::time::Duration;

use crate::args::Precision;
use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::distance::Measure;
use crate::study::terms::Term;
use crate::study::trajectory::{Ending, Limits, Trajectory, fly_of};
use crate::study::variant::Variant;

/// Number of pairs: nine if the trial's runs together take less than `SHORT`, s, otherwise five. Fewer than five
/// could easily agree in sign by chance.
const REPEATS: [usize; 2] = [5, 9];
const SHORT: f64 = 1.0;

/// Time kept for the last trial, which switches off several terms at once, as a multiple of the time of the
/// unchanged scene.
const KEPT: u32 = 10;

/// The unchanged scene, which all trials are compared with.
pub struct Baseline {
    /// The scene's own method and step, or allowed error of a step, in single precision.
    pub variant: Variant,
    /// The run of the unchanged scene.
    pub run: Trajectory,
    /// The run with half the step, or with half the longest step and a smaller allowed error.
    pub finer: Trajectory,
    /// The quantity that is compared.
    pub measure: Measure,
    /// Masses of the vertices, kg.
    pub masses: Vec<f64>,
    /// Mean rest length of the edges of each cloth, m.
    pub mean_edges: Vec<f64>,
}

impl Baseline {
    /// Runs the unchanged scene, also finer.
    pub fn fly(study: &Study<'_>) -> Result<Self, Failure> {
        let engine = study.engine(&study.scene, Precision::F32)?;
        let desc = &study.scene.desc;
        let variant = Variant::as_written(&study.scene);
        let by_finer = format!("by {}", variant.shorter_steps_in_words());
        Ok(Self {
            run: complete(study, fly(study, &study.scene, &variant, "as it is")?)?,
            finer: fly(study, &study.scene, &variant.with_shorter_steps(), &by_finer)?,
            variant,
            measure: if desc.contact.is_some() { Measure::Outline } else { Measure::Positions },
            masses: engine.masses(),
            mean_edges: engine.mean_edges(),
        })
    }
}

/// Runs a variant until its end or the end of the budget.
fn fly(study: &Study<'_>, scene: &SceneFile, variant: &Variant, what: &str) -> Result<Trajectory, Failure> {
    study.say(what);
    fly_of(study, scene, variant, Limits { wall: study.left(), energy: f64::INFINITY })
}

/// Returns a complete run, or an error that says why there is nothing to compare with.
fn complete(study: &Study<'_>, run: Trajectory) -> Result<Trajectory, Failure> {
    let scene = &study.scene.desc.name;
    match why_not(&run) {
        None => Ok(run),
        Some(_) if run.ending == Ending::OutOfTime => Err(Failure::Diverged(format!(
            "{scene} takes longer than {} s; take a shorter --duration, a coarser cloth by --set, or a larger --budget",
            study.arguments.budget
        ))),
        Some(why) => Err(Failure::Diverged(format!(
            "{scene} as it is {why}; there is nothing to compare with: take a smaller {} or a shorter --duration",
            if study.scene.desc.integrator.error().is_some() { "integrator.error" } else { "integrator.step" }
        ))),
    }
}

/// How an incomplete run ended, as the end of a sentence; `None` for a complete run.
pub fn why_not(run: &Trajectory) -> Option<String> {
    let time = run.report.time;
    match &run.ending {
        Ending::Complete => None,
        Ending::Diverged(what) => Some(format!("fails at {time:.3} s: {what}")),
        Ending::Grown => Some(format!("fails before {time:.3} s: its energy is not a number")),
        Ending::OutOfTime => Some("does not reach the end within the budget".into()),
    }
}

/// A term and the results of its runs.
pub struct Trial {
    /// The term.
    pub term: Term,
    /// The first run; `None` if there was no time to begin it.
    pub run: Option<Trajectory>,
    /// Computing times of the unchanged scene and of the trial, in pairs, s.
    pub walls: Vec<[f64; 2]>,
}

impl Trial {
    /// A trial that has not been run yet.
    pub fn new(term: Term) -> Self {
        Self { term, run: None, walls: Vec::new() }
    }

    /// The run, if it reached its end.
    pub fn complete(&self) -> Option<&Trajectory> {
        self.run.as_ref().filter(|run| run.ending == Ending::Complete)
    }

    /// Whether its time has been measured often enough.
    fn is_timed(&self, study: &Study<'_>) -> bool {
        let taken: f64 = self.walls.iter().map(|[_, wall]| wall).sum();
        self.walls.len() >= study.repeats(REPEATS[usize::from(taken < SHORT)])
    }

    /// Runs the trial and the unchanged scene once each. The order alternates, so that neither has an advantage.
    fn pair(&mut self, study: &Study<'_>, baseline: &Baseline) -> Result<(), Failure> {
        let scene = study.scene.changed(&self.term.edits)?;
        let variant = Variant { precision: self.term.precision, ..baseline.variant };
        let fly_as_it_is = || fly(study, &study.scene, &baseline.variant, "as it is");
        let fly_trial = || fly(study, &scene, &variant, &self.term.run);
        let [as_is, run] = match self.walls.len().is_multiple_of(2) {
            true => [fly_as_it_is()?, fly_trial()?],
            false => {
                let run = fly_trial()?;
                [fly_as_it_is()?, run]
            }
        };
        if as_is.ending == Ending::Complete && run.ending == Ending::Complete {
            self.walls.push([as_is.wall, run.wall]);
        }
        // A repeat that ran out of time gives no information.
        self.run.get_or_insert(run);
        Ok(())
    }
}

/// Runs all trials once. Then, round after round while there is time, repeats those whose time has not been
/// measured often enough.
pub fn run(study: &Study<'_>, baseline: &Baseline, trials: &mut [Trial]) -> Result<(), Failure> {
    let kept = Duration::from_secs_f64(baseline.run.wall) * KEPT;
    for round in 0..REPEATS[1] {
        for trial in &mut *trials {
            let wanted = match round {
                0 => !study.left().is_zero(),
                _ => trial.complete().is_some() && !trial.is_timed(study) && study.left() > kept,
            };
            if wanted {
                trial.pair(study, baseline)?;
            }
        }
    }
    Ok(())
}
