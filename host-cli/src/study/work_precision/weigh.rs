//! One run of the chart: its error and its cost.

use std::time::Duration;

use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::distance;
use crate::study::median::median;
use crate::study::reference::{BLOWN_UP, Reference};
use crate::study::trajectory::{Ending, Limits, Trajectory, fly, fly_of};
use crate::study::variant::Variant;

use super::report::Row;

/// Runs shorter than `SHORT`, s, are made `REPEATS` times, and the median time counts.
const SHORT: f64 = 1.0;
const REPEATS: usize = 3;

/// RMS error, as a part of the diagonal, from which on a run has lost the reference completely.
const LOST: f64 = 0.5;

/// The reference and the scales that runs are measured by.
pub struct Yardstick<'a> {
    /// The reference and the coarser runs before it.
    pub reference: &'a Reference,
    /// Masses of the vertices, kg.
    pub masses: &'a [f64],
    /// Diagonal of the cloth's bounding box, m.
    pub diagonal: f64,
    /// The shortest step that is run, s.
    pub finest: f64,
}

impl Yardstick<'_> {
    /// The smallest error that the reference resolves, as a part of the diagonal.
    pub fn least(&self) -> f64 {
        self.reference.least() / self.diagonal
    }

    /// RMS and largest distance between two runs, as parts of the diagonal.
    pub fn parts(&self, a: &Trajectory, b: &Trajectory) -> [f64; 2] {
        let off = self.reference.rule.measure.between(a, b, self.masses);
        [off.rms, off.max].map(|m| m / self.diagonal)
    }

    /// Limits of a run with `left` seconds.
    pub fn limits(&self, left: f64) -> Limits {
        Limits { wall: Duration::from_secs_f64(left.max(0.0)), energy: BLOWN_UP * self.liveliest() }
    }

    /// The largest kinetic and elastic energy of the reference, J.
    fn liveliest(&self) -> f64 {
        self.reference.liveliest(self.masses.iter().sum())
    }
}

/// Runs a variant of the study's scene, several times if it is short; takes it from the reference if it was run there.
/// `None` if it takes, or is `expected` to take, more than the time left, s.
pub fn weigh(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    variant: &Variant,
    left: f64,
    expected: f64,
) -> Result<Option<Row>, Failure> {
    let known = yardstick.reference.runs.iter().chain(&yardstick.reference.failed).find(|(known, _)| known == variant);
    let run = match known {
        Some((_, run)) => yardstick.limits(left).judge(run.clone()),
        None if left <= expected => return Ok(None),
        None => fly(study, variant, yardstick.limits(left))?,
    };
    timed(study, yardstick, &study.scene, variant, run, left)
}

/// Runs a variant of a changed scene. `None` if it takes more than the time left, s.
pub fn weigh_changed(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    scene: &SceneFile,
    variant: &Variant,
    left: f64,
) -> Result<Option<Row>, Failure> {
    study.say(&variant.name(scene));
    let run = fly_of(study, scene, variant, yardstick.limits(left))?;
    timed(study, yardstick, scene, variant, run, left)
}

/// Repeats a short run to time it.
fn timed(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    scene: &SceneFile,
    variant: &Variant,
    run: Trajectory,
    left: f64,
) -> Result<Option<Row>, Failure> {
    if run.ending == Ending::OutOfTime {
        return Ok(None);
    }
    let mut walls = vec![run.wall];
    while run.ending == Ending::Complete && run.wall < SHORT && walls.len() < study.repeats(REPEATS) {
        let repeat = fly_of(study, scene, variant, yardstick.limits(left))?;
        // A repeat that ran out of time gives no time.
        if repeat.ending != Ending::Complete {
            break;
        }
        walls.push(repeat.wall);
    }
    Ok(Some(row(yardstick, scene, variant, &run, walls)))
}

fn row(yardstick: &Yardstick<'_>, scene: &SceneFile, variant: &Variant, run: &Trajectory, walls: Vec<f64>) -> Row {
    let reference = &yardstick.reference.best().1;
    let complete = run.ending == Ending::Complete;
    let error = complete.then(|| yardstick.parts(run, reference));
    let stable = error.is_some_and(|[rms, _]| rms < LOST);
    let least = yardstick.least();
    let resolved = error.filter(|[rms, _]| stable && *rms >= least);
    let why = match &run.ending {
        Ending::Complete if resolved.is_some() => None,
        Ending::Complete if stable => Some(format!("below {least:.1e}, the resolution of the reference")),
        Ending::Complete => Some("lost: it no longer resembles the reference".into()),
        Ending::Diverged(what) => Some(what.clone()),
        Ending::Grown => Some(format!("its energy grew to {BLOWN_UP} times the largest energy of the reference")),
        Ending::OutOfTime => Some("it took too long".into()),
    };
    let substeps = run.report.substeps[0].max(1);
    Row {
        method: variant.method.name(),
        precision: variant.precision.name(),
        step: variant.error.map_or_else(|| variant.step(scene), |_| run.report.time / substeps as f64),
        allowed_error_m: variant.error,
        tolerance: variant.tolerance(scene),
        solver: None,
        error_rms: resolved.map(|[rms, _]| rms),
        error_max: resolved.map(|[_, max]| max),
        energy_drift: stable.then(|| distance::energy_drift(run, reference) / yardstick.liveliest()),
        stretch: stable.then_some(run.stretch),
        penetration_m: run.penetration.filter(|_| stable),
        repeats: walls.len(),
        wall_s: median(walls),
        steps: substeps,
        force_evaluations: run.report.force_evaluations,
        cg_iterations: run.report.cg_iterations,
        matrix_products: run.report.matrix_products,
        stable,
        why,
        variant: *variant,
    }
}
