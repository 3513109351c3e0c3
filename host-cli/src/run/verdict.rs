//! The verdict on a run, and the warnings of its end: signs that the result is wrong, although the run reached its end.

use muslin_core::scene::SceneDesc;
use muslin_core::warning::{self, Code, Run};

use super::words::{self, Known};
use crate::device::StepDetector;
use crate::pool::Pool;
use crate::record::Record;
use crate::summary::Summary;
use crate::warning::Warning;

impl Summary {
    /// Adds the warnings and decides the verdict.
    pub fn judge(&mut self, record: &Record, scene: &SceneDesc, pool: &Pool) {
        let audited = record.crossings.is_some_and(|(count, _)| count > 0);
        let reached_the_end = self.divergence.is_none();
        let substeps = self.error_control.as_ref().map_or([0; 2], |control| [control.accepted, control.exceeding]);
        let run = Run {
            balance: &record.balance,
            by_method: self.energy_balance.method,
            contacts: [self.contacts.proximity, self.contacts.impacts],
            mass: self.mass_kg,
            vertices: self.vertices,
            size: self.size_m.into_iter().fold(0.0, f64::max),
            time: self.simulated_s,
            steps: self.steps,
            stretch: self.stretch.max_of_all_frames,
            rounding: record.rounding,
            unconverged: self.work.unconverged,
            substeps,
        };
        let found = warning::of_run(scene, &run).into_iter().flatten();
        // A run that diverged says so itself.
        let found: Vec<_> = found.filter(|one| reached_the_end || one.code == Code::Exceeding).collect();
        let known = Known {
            is_at_rest: self.at_rest == Some(true),
            has_appeared: found.iter().any(|one| one.code == Code::Energy),
        };
        self.warnings.extend(found.iter().map(|one| words::of(one, scene, known)));
        let doubt = self.warnings.iter().find(|one| one.is_doubtful).map(|one| one.text.clone());
        (self.verdict, self.doubt) = match (reached_the_end, audited, doubt) {
            (false, _, _) => ("diverged", None),
            (true, true, _) => ("intersecting", None),
            (true, false, Some(doubt)) => ("doubtful", Some(doubt)),
            (true, false, None) => ("ok", None),
        };
        self.warnings.extend(self.audit_gap());
        self.warnings.extend(pool.detector().map(StepDetector::warnings).unwrap_or_default());
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
