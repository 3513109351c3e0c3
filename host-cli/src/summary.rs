//! `summary.json`: the summary of a run.

use muslin_core::balance::Balance;
use muslin_core::work_done::WorkDone;
use serde::Serialize;

use crate::device::StageTime;
use crate::engine::Report;
use crate::units::{length, mass};
use crate::warning::Warning;

/// The documented keys in their order, and a few more.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub tool: &'static str,
    pub version: &'static str,
    pub scene: String,
    pub precision: &'static str,
    pub backend: &'static str,
    pub adapter: Option<String>,
    pub threads: usize,
    pub size_m: [f64; 3],
    pub mass_kg: f64,
    pub pinned: usize,
    pub vertices: usize,
    pub triangles: usize,
    pub method: &'static str,
    pub step_s: f64,
    pub frames: u64,
    pub steps: u64,
    pub rejected_steps: u64,
    /// Null without a largest error.
    pub error_control: Option<ErrorControl>,
    pub simulated_s: f64,
    /// Whether the run ended at rest; null in a scene without `until_rest`.
    pub at_rest: Option<bool>,
    /// Largest speed in the last frame; null in a scene without `until_rest`.
    pub fastest_m_per_s: Option<f64>,
    /// Wall time of the steps that this process took.
    pub wall_s: f64,
    /// The speed below which the run ends, if the scene has one, m/s.
    #[serde(skip)]
    pub until_rest: Option<f64>,
    /// Steps before this process resumed the run.
    #[serde(skip)]
    pub begun: u64,
    pub verdict: &'static str,
    /// Why the verdict is doubtful; otherwise null.
    pub doubt: Option<String>,
    pub warnings: Vec<Warning>,
    pub divergence: Option<String>,
    pub stage_ms: StageMs,
    /// Mean time per step of each stage on the device; null without a device or without device clocks.
    pub gpu_stage_ms: Option<Vec<StageTime>>,
    pub stretch: Stretch,
    pub energy: Energy,
    pub energy_balance: EnergyBalance,
    pub momentum: [f64; 3],
    pub contacts: Contacts,
    pub frames_audited: u64,
    /// Null unless every frame was audited.
    pub intersections: Option<u64>,
    pub intersections_frame: Option<u64>,
    /// Crossings of the state that the scene describes; null without contact and audit.
    pub intersections_at_start: Option<u64>,
    /// Number of these crossings that were untangled before the first step; null without contact.
    pub intersections_untangled: Option<u64>,
    pub penetration_m: Option<f64>,
    pub work: Work,
    pub state_hash: String,
}

/// The substeps of a run with a largest error, totals.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorControl {
    /// The largest error that the scene allows, m.
    pub error_m: f64,
    pub accepted: u64,
    /// Taken back because their error was too large.
    pub taken_back: u64,
    /// Accepted although their error was too large, because they were the shortest.
    pub exceeding: u64,
    pub shortest_s: f64,
}

/// Mean times per step, ms, over the steps of this process.
#[derive(Clone, Debug, Serialize)]
pub struct StageMs {
    pub predict: f64,
    pub broad_phase: f64,
    pub narrow_phase: f64,
    pub response: f64,
    pub output: f64,
}

/// Ratio of edge length to rest length: largest and mean of the final state, and largest of all frames of the
/// run, including those before a checkpoint.
#[derive(Clone, Debug, Serialize)]
pub struct Stretch {
    pub max: f64,
    pub mean: f64,
    pub max_of_all_frames: f64,
}

/// Energies of the final state, J.
#[derive(Clone, Debug, Serialize)]
pub struct Energy {
    pub kinetic: f64,
    pub stretch: f64,
    pub shear: f64,
    pub bend: f64,
    pub seam: f64,
    pub gravity: f64,
}

/// Where the energy of the run came from, J.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyBalance {
    /// Work done on the cloth by pins, colliders, wind, and gravity and loads that change, from the start to the end.
    pub pins: f64,
    pub colliders: f64,
    pub wind: f64,
    pub gravity: f64,
    /// Work of moving overlapping surfaces apart.
    pub separation: f64,
    /// Work of friction and impacts; negative.
    pub contacts: f64,
    /// Energy that the method added from the start to the end, or took if it is negative; null if what damping
    /// took is not known.
    pub method: Option<f64>,
    /// Largest growth of the energy without this work: it comes from errors.
    pub appeared: f64,
    /// Largest energy that moved, to compare with.
    pub moved: f64,
}

impl EnergyBalance {
    /// The balance of a run. `method` is the energy that the method added, if it is known.
    pub fn new(balance: &Balance, method: Option<f64>) -> Self {
        let WorkDone { pins, colliders, wind, gravity, separation, contacts, .. } = balance.work;
        let (appeared, moved) = (balance.appeared, balance.moved());
        Self { pins, colliders, wind, gravity, separation, contacts, method, appeared, moved }
    }
}

/// Totals of the run, including the steps before a checkpoint; zero without contact.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Contacts {
    pub candidates: u64,
    pub proximity: u64,
    pub impacts: u64,
    pub zones: u64,
    pub failsafe: u64,
}

/// Totals of the run; they do not depend on the machine.
#[derive(Clone, Debug, Serialize)]
pub struct Work {
    pub force_evaluations: u64,
    pub cg_iterations: u64,
    pub newton_iterations: u64,
    pub negative_curvature: u64,
    pub unconverged: u64,
    /// Bytes that this work streams, without contact.
    pub streamed_bytes: u64,
}

impl From<&Report> for Contacts {
    fn from(report: &Report) -> Self {
        let [candidates, proximity, impacts, zones, failsafe, _] = report.contacts;
        Self { candidates, proximity, impacts, zones, failsafe }
    }
}

impl From<&Report> for Energy {
    fn from(report: &Report) -> Self {
        let [kinetic, stretch, shear, bend, seam, gravity] = report.energy;
        Self { kinetic, stretch, shear, bend, seam, gravity }
    }
}

impl From<&Report> for Work {
    fn from(report: &Report) -> Self {
        Self {
            force_evaluations: report.force_evaluations,
            cg_iterations: report.cg_iterations,
            newton_iterations: report.newton_iterations,
            negative_curvature: report.negative_curvature,
            unconverged: report.unconverged,
            streamed_bytes: report.streamed_bytes,
        }
    }
}

/// A stretch as the elongation in per cent of the rest length.
pub fn percent(stretch: f64) -> String {
    // A value that rounds to zero is printed without a sign.
    match 1e2 * (stretch - 1.0) {
        percent if percent.abs() < 0.005 => "0.00 %".to_owned(),
        percent if percent.abs() < 1e3 => format!("{percent:.2} %"),
        percent => format!("{percent:.1e} %"),
    }
}

impl Summary {
    /// The summary as text for a person.
    pub fn lines(&self) -> String {
        let StageMs { predict, broad_phase, narrow_phase, response, output } = self.stage_ms;
        let per_step = predict + broad_phase + narrow_phase + response + output;
        let [x, y, z] = self.size_m.map(length);
        let part = match self.begun {
            0 => String::new(),
            _ => format!(" for the {} steps since it was resumed", self.steps - self.begun),
        };
        let mut text = format!(
            "{}: {} vertices, {} triangles, {x} x {y} x {z}, {}, {} pinned\n\
             {:.3} s in {} steps of {:.4} ms by {} in {}: {:.2} s of wall time{part}, {per_step:.3} ms per step\n\
             stretch {} at most in any frame, {} at the end, {} on average at the end\n\
             work {} force evaluations, {} Newton iterations, {} CG iterations\n\
             state {}",
            self.scene,
            self.vertices,
            self.triangles,
            mass(self.mass_kg),
            self.pinned,
            self.simulated_s,
            self.steps,
            1e3 * self.step_s,
            self.method,
            self.precision,
            self.wall_s,
            percent(self.stretch.max_of_all_frames),
            percent(self.stretch.max),
            percent(self.stretch.mean),
            self.work.force_evaluations,
            self.work.newton_iterations,
            self.work.cg_iterations,
            self.state_hash,
        );
        if let Some(ErrorControl { error_m, accepted, taken_back, shortest_s, .. }) = &self.error_control {
            text += &format!(
                "\nerror control to {} mm in a step: {accepted} substeps accepted, {taken_back} taken back, the shortest \
                 {:.3} ms",
                (1e3 * error_m) as f32,
                1e3 * shortest_s
            );
        }
        match (self.at_rest, self.fastest_m_per_s, self.until_rest) {
            (Some(false), Some(fastest), Some(asked)) => {
                text += &format!(
                    "\nit did not come to rest before the end: {fastest:.2e} m/s at most in the last frame, and \
                     until_rest is {asked:?} m/s"
                );
            }
            (Some(true), ..) => text += "\nit came to rest, and the run ended",
            _ => {}
        }
        text += &self.contact_lines();
        text + &format!("\nverdict {}", self.verdict)
    }

    /// The device that found candidates and, if it has a clock, its time; empty without a device.
    fn gpu_line(&self) -> String {
        let Some(name) = &self.adapter else { return String::new() };
        let times = self.gpu_stage_ms.iter().flatten();
        let Some(longest) = times.clone().max_by(|a, b| a.ms.total_cmp(&b.ms)) else {
            return format!("\n{name} found the candidates");
        };
        let sum: f64 = times.map(|time| time.ms).sum();
        format!("\n{name}: {sum:.3} ms per step by its own clock, most of it in {}: {:.3}", longest.stage, longest.ms)
    }

    /// The results of contact and of the audit; empty without contact and audit.
    fn contact_lines(&self) -> String {
        let Contacts { candidates, proximity, impacts, zones, failsafe } = self.contacts;
        let StageMs { predict, broad_phase, narrow_phase, response, .. } = self.stage_ms;
        let mut text = String::new();
        if broad_phase > 0.0 {
            let a_step = |count: u64| count as f64 / self.steps.max(1) as f64;
            let one_in = match proximity {
                0 => String::new(),
                _ => format!(", one in {:.0}", candidates as f64 / proximity as f64),
            };
            text += &format!(
                "\ncontact {:.0} pairs tested per step, {:.0} of them nearer than the thickness{one_in}\nms per step: \
                 {predict:.3} forces and solve, {broad_phase:.3} broad phase, {narrow_phase:.3} narrow phase, {response:.3} \
                 response\nimpacts {impacts} in total, {zones} impact zones, {} steps rejected, {failsafe} motions \
                 limited",
                a_step(candidates),
                a_step(proximity),
                self.rejected_steps,
            );
            text += &self.gpu_line();
        }
        if let Some(depth) = self.penetration_m {
            text += &format!("\npenetration of colliders {:.3} mm at most", 1e3 * depth);
        }
        if let Some(count) = self.intersections {
            let worst = self.intersections_frame.map(|frame| format!(", in frame {frame}")).unwrap_or_default();
            text += &format!("\naudit {count} intersections in the worst frame{worst}");
        }
        if let (Some(_), Some(count @ 1..)) = (self.intersections, self.intersections_at_start) {
            text += &format!("; it starts with {count} intersections");
        }
        if let Some(count @ 1..) = self.intersections_untangled {
            text += &format!("\nstart {count} intersections untangled");
        }
        text
    }
}
