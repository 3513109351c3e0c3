//! The verdict on a run, and the warnings of its end: signs that the result is wrong, although the run reached its end.

use muslin_core::scene::SceneDesc;

use crate::device::StepDetector;
use crate::pool::Pool;
use crate::record::Record;
use crate::summary::{ErrorControl, Summary, percent};
use crate::warning::Warning;

/// Ratio of edge length to rest length beyond which cloth is not stretched.
const TOO_LONG: f64 = 1.3;

/// Energy that may appear by errors, relative to the largest energy that moved. Built-in scenes stay below a tenth, their first
/// tenth of a second below a third; where cloth flies apart it is nearly all of it.
const MOST_APPEARED: f64 = 0.5;

/// Way, relative to the size of the cloth, on which the energy that appeared could have taken a vertex: if it is shorter, the
/// energy did no harm.
const HARMLESS_WAY: f64 = 1e-3;

/// Way on which this energy could have taken all vertices together: if it is longer, rounding is no excuse. A light and stiff
/// sheet in f32, off by 1.5 % of its size, could have gone 4 %.
const HARMFUL_WAY: f64 = 1e-2;

/// Energy by rounding, relative to that of a cloth whose edges are all strained by the rounding of a position. Cloth at rest
/// showed up to 11 times this energy.
const BY_ROUNDING: f64 = 16.0;

/// Part of the steps whose solve may end above the tolerance; a single one may in any run.
const MOST_UNCONVERGED: f64 = 0.05;

/// Largest rounding of positions, relative to the mean length of an edge.
const MOST_ROUNDED: f64 = 0.01;

impl Summary {
    /// Adds the warnings and decides the verdict.
    pub fn judge(&mut self, record: &Record, scene: &SceneDesc, pool: &Pool) {
        let audited = record.crossings.is_some_and(|(count, _)| count > 0);
        let doubts = [self.appeared(record, scene), self.stretched(), self.unconverged(), rounded(record)];
        let reached_the_end = self.divergence.is_none();
        let of_end: Vec<_> = doubts.into_iter().flatten().filter(|_| reached_the_end).collect();
        let doubt = of_end.iter().find(|(is_doubtful, _)| *is_doubtful).map(|(_, warning)| warning.text.clone());
        (self.verdict, self.doubt) = match (reached_the_end, audited, doubt) {
            (false, _, _) => ("diverged", None),
            (true, true, _) => ("intersecting", None),
            (true, false, Some(doubt)) => ("doubtful", Some(doubt)),
            (true, false, None) => ("ok", None),
        };
        self.warnings.extend(of_end.into_iter().map(|(_, warning)| warning));
        self.warnings.extend(self.exceeding());
        self.warnings.extend(self.audit_gap());
        self.warnings.extend(pool.detector().map(StepDetector::warnings).unwrap_or_default());
    }

    /// Advice against errors of the steps.
    fn shorter(&self) -> &'static str {
        match self.error_control {
            Some(_) => "take a smaller integrator.error, or a shorter integrator.step beside it",
            None => "take a smaller integrator.step",
        }
    }

    /// Energy that came from nowhere.
    fn appeared(&self, record: &Record, scene: &SceneDesc) -> Option<(bool, Warning)> {
        let (appeared, moved) = (record.balance.appeared, record.balance.moved());
        (appeared > MOST_APPEARED * moved && self.is_harmful(appeared, record.rounding, scene)).then(|| {
            let text = format!(
                "{appeared:.2e} J of energy appeared from nowhere, {:.0} % of the largest energy that moved ({moved:.2e} J): {}",
                1e2 * appeared / moved,
                self.shorter()
            );
            (true, Warning::new("energy", text))
        })
    }

    /// Whether an energy would take one vertex farther than [`HARMLESS_WAY`], and is either more than rounding gives or would
    /// take all vertices farther than [`HARMFUL_WAY`], each from the start.
    fn is_harmful(&self, energy: f64, rounding: f64, scene: &SceneDesc) -> bool {
        // Squares of the speed of sound in the cloth, m^2/s^2.
        let squares = scene.cloth.iter().filter_map(|cloth| {
            let stretch = cloth.stretch.as_ref()?;
            Some(stretch.stiffness.max(stretch.weft.unwrap_or(0.0)) / cloth.density)
        });
        let rounded = 0.5 * self.mass_kg * squares.fold(0.0, f64::max) * rounding * rounding;
        let speed = (2.0 * energy * self.vertices as f64 / self.mass_kg).sqrt();
        let size = self.size_m.into_iter().fold(0.0, f64::max);
        let way = speed * self.simulated_s / size;
        let of_all = way / (self.vertices as f64).sqrt();
        way > HARMLESS_WAY && (energy > BY_ROUNDING * rounded || of_all > HARMFUL_WAY)
    }

    /// Cloth that is stretched too far. It is no reason for doubt: without energy that appeared, the loads have stretched it.
    fn stretched(&self) -> Option<(bool, Warning)> {
        let most = self.stretch.max_of_all_frames;
        (most > TOO_LONG).then(|| {
            let text = format!(
                "cloth does not stretch by {}: {}, or check density (kg/m^2), stiffness (N/m), the mesh's size (m) and \
                 how far pins and colliders pull it",
                percent(most),
                self.shorter()
            );
            (false, Warning::new("stretch", text))
        })
    }

    /// Solves that ended above their tolerance.
    fn unconverged(&self) -> Option<(bool, Warning)> {
        let count = self.work.unconverged;
        (count > 0).then(|| {
            let solves = if count == 1 { "solve" } else { "solves" };
            let text = format!("{count} {solves} ended above the tolerance: {}", self.shorter());
            let is_often = count > 1 && count as f64 > MOST_UNCONVERGED * self.steps as f64;
            (is_often, Warning::new("unconverged", text))
        })
    }

    /// Substeps with too large an error.
    fn exceeding(&self) -> Option<Warning> {
        let control = self.error_control.as_ref().filter(|control| control.exceeding > 0)?;
        let ErrorControl { exceeding, accepted, error_m, .. } = control;
        let text = format!(
            "{exceeding} of {accepted} substeps exceed integrator.error ({} mm): a substep is at least 1/64 of a step; \
             take a shorter integrator.step, or a larger integrator.error",
            (1e3 * error_m) as f32
        );
        Some(Warning::new("exceeding", text))
    }

    /// An audit that did not see all frames; `None` if it saw all of them, or none was to be audited.
    fn audit_gap(&self) -> Option<Warning> {
        let Self { frames, frames_audited: audited, intersections_frame: worst, .. } = self;
        let found = worst.map_or_else(
            || "without intersections".into(),
            |worst| format!("with intersections, most of them in frame {worst}"),
        );
        let text = format!(
            "{audited} of {frames} frames were audited, {found}: nothing is known about the others; run the scene from \
             its start with --audit"
        );
        (1..*frames).contains(audited).then(|| Warning::new("audit-gap", text))
    }
}

/// Cloth that moved so far that its precision rounds its positions.
fn rounded(record: &Record) -> Option<(bool, Warning)> {
    (record.rounding > MOST_ROUNDED).then(|| {
        let text = format!(
            "the cloth moved so far away that its positions are rounded to {:.1} % of an edge: use --precision f64, or \
             begin nearer to where it goes",
            1e2 * record.rounding
        );
        (true, Warning::new("rounding", text))
    })
}
