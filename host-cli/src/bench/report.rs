//! The report that `muslin bench` prints.

use serde::Serialize;

use super::candidates;

/// All measurements.
#[derive(Serialize)]
pub struct Report {
    pub machine: Machine,
    pub scenes: Vec<SceneReport>,
    /// Crumpled sheets; empty if they were not requested.
    pub candidates: Vec<candidates::Row>,
}

#[derive(Serialize)]
pub struct Machine {
    pub cpu: String,
    pub threads: usize,
    pub copy_gb_per_s: f64,
}

#[derive(Serialize)]
pub struct SceneReport {
    pub scene: String,
    pub method: &'static str,
    pub particles: usize,
    pub bytes_per_particle: f64,
    pub steps: u64,
    /// Simulated time from the start of the scene to the last step, s.
    pub simulated_s: f64,
    pub ms_per_step: f64,
    pub ms_per_frame: f64,
    pub particles_per_s: f64,
    pub largest_stretch: f64,
    pub cg_iterations_per_step: f64,
    /// Null in a scene without contact.
    pub contact: Option<ContactReport>,
    pub stages: Vec<StageReport>,
}

/// Counts of contact, and the speed of its stages.
#[derive(Serialize)]
pub struct ContactReport {
    pub candidates_per_step: f64,
    pub contacts_per_step: f64,
    /// Per second of the broad phase.
    pub candidates_per_s: f64,
    /// Per second of narrow phase and response.
    pub contacts_per_s: f64,
    pub candidates_per_contact: Option<f64>,
    pub impacts: u64,
    pub zones: u64,
    pub rejected_steps: u64,
}

#[derive(Serialize)]
pub struct StageReport {
    pub stage: String,
    pub ms_per_step: f64,
    pub particles_per_s: f64,
    /// Counted, not measured; zero for the stages of contact, whose traffic depends on the contacts.
    pub traffic_bytes_per_particle: f64,
    pub gb_per_s: f64,
    /// Ratio of `gb_per_s` to the bandwidth of a copy.
    pub of_copy_speed: f64,
}

impl Report {
    /// The report as a table for a person.
    pub fn table(&self) -> String {
        let Machine { cpu, threads, copy_gb_per_s } = &self.machine;
        let mut text = format!("{cpu}, {threads} thread(s), copies {copy_gb_per_s:.1} GB/s (read + written)\n");
        self.scenes.iter().for_each(|scene| text += &scene.table());
        if !self.candidates.is_empty() {
            text += &candidates::table(&self.candidates);
        }
        text.trim_end().into()
    }
}

impl SceneReport {
    fn table(&self) -> String {
        let mut text = format!(
            "\n{}: {} particles, {}, {:.0} bytes per particle\n\
             {:.3} ms per step over the first {:.2} s ({} steps), {:.2} ms per frame, {:.1} CG iterations per step, \
             largest stretch {:.2} %\n",
            self.scene,
            self.particles,
            self.method,
            self.bytes_per_particle,
            self.ms_per_step,
            self.simulated_s,
            self.steps,
            self.ms_per_frame,
            self.cg_iterations_per_step,
            1e2 * (self.largest_stretch - 1.0),
        );
        if let Some(contact) = &self.contact {
            text += &contact.lines();
        }
        text += &format!(
            "{:36}{:>10}{:>14}{:>12}{:>9}{:>9}\n",
            "stage", "ms/step", "particles/s", "bytes/part.", "GB/s", "of copy"
        );
        self.stages.iter().for_each(|stage| text += &stage.line());
        text
    }
}

impl ContactReport {
    fn lines(&self) -> String {
        let ratio = self.candidates_per_contact.map_or("no contacts".into(), |ratio| format!("{ratio:.1} to 1"));
        format!(
            "{:.0} candidates per step ({:.3e}/s), {:.0} contacts ({:.3e}/s), {ratio}; \
             {} impacts, {} zones, {} steps rejected\n",
            self.candidates_per_step,
            self.candidates_per_s,
            self.contacts_per_step,
            self.contacts_per_s,
            self.impacts,
            self.zones,
            self.rejected_steps,
        )
    }
}

impl StageReport {
    fn line(&self) -> String {
        let mut line = format!("{:36}{:>10.4}{:>14.3e}", self.stage, self.ms_per_step, self.particles_per_s);
        if self.traffic_bytes_per_particle > 0.0 {
            let Self { traffic_bytes_per_particle, gb_per_s, of_copy_speed, .. } = self;
            line += &format!("{traffic_bytes_per_particle:>12.0}{gb_per_s:>9.1}{of_copy_speed:>9.2}");
        }
        line + "\n"
    }
}
