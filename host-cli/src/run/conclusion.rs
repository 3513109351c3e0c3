//! The conclusion of a run: its summary, and the message on crossings.

use std::time::Duration;

use muslin_core::warning;

use super::course::{Course, Ending};
use super::start;
use super::words::{self, Known};
use crate::args::Backend;
use crate::pool::Pool;
use crate::scene_file::SceneFile;
use crate::summary::{EnergyBalance, ErrorControl, StageMs, Stretch, Summary};
use crate::warning::Warning;

impl Course {
    /// The message on crossings; `None` if the audit found no crossing in any frame.
    pub fn intersecting(&self, scene: &SceneFile) -> Option<String> {
        let record = self.record();
        let (count, frame) = record.crossings.filter(|&(count, _)| count > 0)?;
        let untangled = record.start.untangled.unwrap_or(0);
        let start = record.start.crossings.filter(|&count| count > untangled);
        let advice = match (start, &scene.desc.contact) {
            (Some(start), None) => {
                format!("the scene starts with {start} intersections: separate the surfaces in the start state")
            }
            (Some(start), Some(_)) => {
                let left = start - untangled;
                format!(
                    "of {start} intersections at the start {left} could not be untangled: separate these surfaces in \
                     the start state"
                )
            }
            (None, None) => "the scene has no [contact]".into(),
            (None, Some(_)) => "take a smaller integrator.step or a larger contact.thickness".into(),
        };
        let seconds = frame as f64 / scene.desc.frame_rate;
        Some(format!("intersecting: {count} intersections in the worst frame, {frame}, at {seconds:.3} s; {advice}"))
    }

    /// The summary of the run.
    pub fn summary(&self, scene: &SceneFile, ending: &Ending, pool: &Pool, wall: Duration) -> Summary {
        let report = self.engine.report();
        let steps = self.steps - self.begun;
        let per_step = |total: Duration| 1e3 * total.as_secs_f64() / (steps.max(1) as f64);
        let [broad_phase, narrow_phase, response] = self.contact.map(per_step);
        let predict = per_step(self.stepping.saturating_sub(self.contact.iter().sum()));
        let divergence = match ending {
            Ending::Diverged(divergence) => Some(divergence.in_words(&scene.desc)),
            _ => None,
        };
        let record = self.record();
        let is_method_known =
            warning::is_method_known(&scene.desc, self.engine.dissipates(), record.measures_reactions);
        let by_method = is_method_known.then(|| record.balance.by_method(&report.energy));
        let mut summary = Summary {
            tool: "muslin",
            version: env!("CARGO_PKG_VERSION"),
            scene: scene.desc.name.clone(),
            precision: self.precision.name(),
            backend: pool.detector().map_or(Backend::Cpu, |_| Backend::Gpu).name(),
            adapter: pool.detector().map(|detector| detector.name()),
            threads: pool.threads(),
            size_m: record.size,
            mass_kg: self.engine.mass(),
            pinned: self.engine.pins().len(),
            vertices: self.positions.len(),
            triangles: self.engine.triangles().len(),
            method: scene.desc.integrator.method.name(),
            step_s: self.timing.step,
            frames: self.frames,
            steps: self.steps,
            rejected_steps: report.contacts[5],
            error_control: scene.desc.integrator.error().map(|error_m| {
                let [accepted, taken_back, exceeding, halvings] = report.substeps;
                let shortest_s = self.timing.step / 2f64.powi(halvings as i32);
                ErrorControl { error_m, accepted, taken_back, exceeding, shortest_s }
            }),
            simulated_s: self.time(),
            at_rest: self.is_at_rest(),
            fastest_m_per_s: self.timing.until_rest.map(|_| record.fastest),
            wall_s: wall.as_secs_f64(),
            until_rest: self.timing.until_rest,
            begun: self.begun,
            verdict: "ok",
            doubt: None,
            warnings: self.warnings.clone(),
            divergence,
            gpu_stage_ms: pool.detector().and_then(|detector| detector.stage_times(steps)),
            stage_ms: StageMs { predict, broad_phase, narrow_phase, response, output: per_step(self.output) },
            stretch: Stretch {
                max: report.stretch[0],
                mean: report.stretch[1],
                max_of_all_frames: record.stretch.max(report.stretch[0]),
            },
            energy: (&report).into(),
            energy_balance: EnergyBalance::new(&record.balance, by_method),
            momentum: report.momentum,
            contacts: (&report).into(),
            frames_audited: record.audited,
            intersections: record.crossings.map(|(count, _)| count).filter(|_| record.audited == self.frames),
            intersections_frame: record.crossings.filter(|&(count, _)| count > 0).map(|(_, frame)| frame),
            intersections_at_start: record.start.crossings,
            intersections_untangled: record.start.untangled,
            penetration_m: record.penetration,
            work: (&report).into(),
            state_hash: format!("fnv1a:{:016x}", self.chain),
        };
        summary.warnings.extend(self.masses(scene, ending));
        summary.judge(&record, &scene.desc, pool);
        summary
    }

    /// The warning that the steps of error control were so long, in the mean, that single precision lost masses.
    fn masses(&self, scene: &SceneFile, ending: &Ending) -> Option<Warning> {
        if !self.needs_modes || !matches!(ending, Ending::Complete) {
            return None;
        }
        let Some(modes) = &self.modes else { return Some(start::unchecked(self.positions.len(), self.precision)) };
        let step = self.engine.report().time / self.engine.substeps().max(1) as f64;
        let size = self.record().size.into_iter().fold(0.0, f64::max);
        warning::masses(modes, &scene.desc, size, self.engine.mass(), step)
            .map(|one| words::of(&one, &scene.desc, Known::default()))
    }
}
