//! What a scene gives in both precisions, and whether Muslin says so.
//!
//! Positions come from the core, verdicts and warnings from the command. Both take the same steps.

use std::path::Path;
use std::process::{Command, Stdio};

use glam::DVec3;
use harness::kit::{double, single};
use harness::rng::Rng;
use muslin_core::real::to_f64 as from_single;
use muslin_core_f64::real::to_f64 as from_double;
use serde_json::Value;

use crate::scene::{Scene, scene};

/// Difference of f32 from f64, relative to the size of the cloth, beyond which f32 is off.
const OFF: f64 = 1e-2;

/// Change of the start state, relative to the size of the cloth.
const NUDGE: f64 = 1e-7;

/// Change of the end state by this change of the start, relative to the size of the cloth, beyond which a scene is
/// chaotic: it amplifies ten thousand times.
const CHAOTIC: f64 = 1e-3;

/// How much farther than by one such change f32 may end from f64 in a chaotic scene, because it rounds in every step.
/// Where stiffness does not drown the masses, it ended less than a hundred times as far.
const EXPLAINED: f64 = 100.0;

/// Codes of the warnings that a result may be wrong.
const MAY_BE_WRONG: [&str; 8] =
    ["energy", "stretch", "unconverged", "exceeding", "rounding", "masses", "unstable", "newton"];

/// What a scene shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finding {
    /// f32 is off, and nothing is said.
    Miss,
    /// f32 and f64 agree, f64 is well, and f32 is warned of.
    FalseAlarm,
    /// f32 and f64 agree, f64 is well, and nothing is said.
    Good,
    /// f32 is off, and it is said.
    Caught,
    /// f32 and f64 agree, but f64 is warned of.
    BothDoubtful,
    /// f32 is off, and a small change of the start of f64 explains it: nothing can be judged.
    Chaotic,
    /// f32 is off by less than the steps of f64 are, and nothing is said.
    Coarse,
    /// The scene is refused, with a message.
    Refused,
}

/// The judgement of one seed.
pub struct Case {
    pub seed: u64,
    pub finding: Finding,
    /// Largest difference of f32 from f64, relative to the size of the cloth.
    pub off: f64,
    /// The same relative to the largest motion of a vertex.
    pub off_of_motion: f64,
    /// Verdict and codes of each precision.
    pub said: [Said; 2],
}

/// What the command says of a run.
#[derive(Clone, Debug, Default)]
pub struct Said {
    pub verdict: String,
    pub codes: Vec<String>,
}

impl Said {
    /// The verdict, and the codes that say that the result may be wrong.
    pub fn doubts(&self) -> Vec<&str> {
        let verdict = Some(self.verdict.as_str()).filter(|&verdict| verdict != "ok");
        let codes = self.codes.iter().map(String::as_str).filter(|code| MAY_BE_WRONG.contains(code));
        verdict.into_iter().chain(codes).collect()
    }
}

/// Judges a seed; runs the command in a folder.
pub fn judge(seed: u64, folder: &Path) -> Case {
    let scene = scene(seed);
    let case = |finding, off, off_of_motion, said| Case { seed, finding, off, off_of_motion, said };
    let Some(said) = said(&scene, folder) else {
        return case(Finding::Refused, 0.0, 0.0, <[Said; 2]>::default());
    };
    let [warned, is_ill] = [!said[0].doubts().is_empty(), !said[1].doubts().is_empty()];
    let (start, end) = in_double(&scene, 0.0);
    let (Some(end), Some(got)) = (end, in_single(&scene)) else {
        let finding = if warned { Finding::Caught } else { Finding::Miss };
        return case(finding, f64::INFINITY, f64::INFINITY, said);
    };
    let (difference, motion) = (largest(&got, &end), largest(&start, &end));
    let off = difference / scene.size;
    if off > OFF && is_explained(&scene, &end, difference) {
        return case(Finding::Chaotic, off, difference / motion, said);
    }
    let finding = match (off <= OFF, warned, is_ill) {
        (false, true, _) => Finding::Caught,
        (false, false, _) if is_coarse(&scene, &end, difference) => Finding::Coarse,
        (false, false, _) => Finding::Miss,
        (true, _, true) => Finding::BothDoubtful,
        (true, true, false) => Finding::FalseAlarm,
        (true, false, false) => Finding::Good,
    };
    case(finding, off, difference / motion, said)
}

/// Whether steps of half the length change the end of f64 by more than a difference, m.
fn is_coarse(scene: &Scene, end: &[DVec3], difference: f64) -> bool {
    let finer = in_double(&scene.halved(), 0.0).1;
    finer.is_none_or(|finer| largest(&finer, end) > difference)
}

/// Whether the scene amplifies a change of its start so much that it explains a difference of the end, m.
fn is_explained(scene: &Scene, end: &[DVec3], difference: f64) -> bool {
    let nudged = in_double(scene, NUDGE * scene.size).1;
    nudged.is_none_or(|nudged| {
        let change = largest(&nudged, end);
        change > CHAOTIC * scene.size && difference < EXPLAINED * change
    })
}

/// What the command says in f32 and f64; `None` if it refuses the scene.
fn said(scene: &Scene, folder: &Path) -> Option<[Said; 2]> {
    std::fs::write(folder.join("scene.toml"), &scene.text).unwrap();
    let run = |precision| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_muslin"));
        command.args(["run", "scene.toml", "--out", "out", "--preview", "none", "--export", "none", "--json"]);
        command.args(["--quiet", "--threads", "1", "--precision", precision]).current_dir(folder);
        let output = command.stdin(Stdio::null()).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0 | 3) => {}
            Some(2) if message.contains("far") => return None,
            _ => panic!("{}: {message}\n{}", output.status, scene.text),
        }
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        let codes = summary["warnings"].as_array().unwrap();
        let codes = codes.iter().map(|warning| warning["code"].as_str().unwrap().to_owned()).collect();
        Some(Said { verdict: summary["verdict"].as_str().unwrap().to_owned(), codes })
    };
    Some([run("f32")?, run("f64")?])
}

/// End positions in f32, from the origin of the scene, m; `None` if it diverges.
fn in_single(scene: &Scene) -> Option<Vec<DVec3>> {
    let mut sim = single::simulation(&scene.text, &[]);
    for _ in 0..scene.steps {
        sim.take_step().ok()?;
    }
    Some(sim.positions().iter().map(|&x| from_single(x).into()).collect())
}

/// Start and end positions in f64; the start is changed by up to `nudge`, m.
fn in_double(scene: &Scene, nudge: f64) -> (Vec<DVec3>, Option<Vec<DVec3>>) {
    let mut sim = double::simulation(&scene.text, &[]);
    if nudge > 0.0 {
        let rng = &mut Rng::new(1);
        for x in sim.state_mut().0 {
            *x += muslin_core_f64::real::vec3(rng.cube(nudge).to_array());
        }
    }
    let places = |sim: &muslin_core_f64::simulation::Simulation| {
        sim.positions().iter().map(|&x| from_double(x).into()).collect::<Vec<DVec3>>()
    };
    let start = places(&sim);
    let is_done = (0..scene.steps).all(|_| sim.take_step().is_ok());
    (start, is_done.then(|| places(&sim)))
}

/// The largest distance of two states, m.
fn largest(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, |most, d| if d <= most { most } else { d })
}
