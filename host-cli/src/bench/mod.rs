//! `muslin bench`: measures each stage on this machine, and compares its memory traffic per second with the
//! bandwidth of a plain copy.

mod candidates;
mod copy;
mod crumpled;
mod report;

use std::time::{Duration, Instant};

use muslin_core::response::ContactStatistics;
use muslin_core::simulation::Simulation;
use muslin_core::stage::Stage;
use muslin_core::traffic;

use crate::args::BenchArguments;
use crate::failure::{Failure, print_data, print_json, print_note};
use crate::limits;
use crate::pool::Pool;
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;
use report::{ContactReport, Machine, Report, SceneReport, StageReport};

/// Wall time after which the measurement of a scene ends early.
const LONGEST: Duration = Duration::from_secs(4);

/// Steps before the clocks start: caches fill, pages are mapped.
const WARM_UP: u64 = 3;

/// The standard scenes: explicit springs with 10k to 1M particles, then implicit scenes, three of them with
/// contact, then crumpled sheets.
const SPRINGS: [(&str, u32); 3] = [("springs-10k", 100), ("springs-100k", 315), ("springs-1m", 1000)];
const IMPLICIT: [&str; 6] = ["hanging", "swing", "flag", "ball", "stack", "fold"];
const CRUMPLED: &str = "crumpled";

/// Measures the scenes and prints a table or JSON.
pub fn bench(arguments: &BenchArguments) -> Result<(), Failure> {
    let pool =
        Pool::new(Some(arguments.threads)).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let copy = copy::bandwidth();
    let machine = Machine { cpu: cpu_name(), threads: pool.threads(), copy_gb_per_s: copy / 1e9 };
    let mut report = Report { machine, scenes: Vec::new(), candidates: Vec::new() };
    let sheets = arguments.scenes.is_empty() || arguments.scenes.iter().any(|name| name == CRUMPLED);
    for scene in scenes(&arguments.scenes)? {
        print_note(&format!("measuring {} ...", scene.desc.name));
        report.scenes.push(pool.install(|| measure(&scene, &pool, copy))?);
    }
    if sheets {
        print_note("measuring crumpled sheets ...");
        report.candidates = pool.install(|| candidates::measure(&pool));
    }
    match arguments.json {
        true => print_json(&report),
        false => print_data(&report.table()),
    }
}

fn scenes(names: &[String]) -> Result<Vec<SceneFile>, Failure> {
    if !names.is_empty() {
        let scenes = names.iter().filter(|name| *name != CRUMPLED);
        return scenes.map(|name| scene_file::load(name, &[])).collect();
    }
    let springs = SPRINGS.iter().map(|&(name, cells)| scene_file::from_text(name, springs_scene(name, cells)));
    springs.chain(IMPLICIT.iter().map(|name| scene_file::load(name, &[]))).collect()
}

/// A hanging sheet of springs. Its stiffness decreases with its masses, so that one step length suits every
/// resolution.
fn springs_scene(name: &str, cells: u32) -> String {
    let stiffness = 100.0 * (315.0 / f64::from(cells)).powi(2);
    format!(
        "name = \"{name}\"\nduration = 0.1\nframe_rate = 50\ngravity = [0.0, -9.81, 0.0]\n\
         [[cloth]]\ngrid = {{ size = [1.0, 1.0], cells = [{cells}, {cells}] }}\ndensity = 0.2\n\
         stretch = {{ model = \"spring\", stiffness = {stiffness:?} }}\npin = [{{ select = {{ corners = [0, 1] }} }}]\n\
         [integrator]\nmethod = \"symplectic-euler\"\nstep = 0.00005\n"
    )
}

fn measure(scene: &SceneFile, pool: &Pool, copy: f64) -> Result<SceneReport, Failure> {
    limits::check(&scene.desc).map_err(Failure::Usage)?;
    let mut simulation = Simulation::new(&scene.desc, &scene.resources).map_err(|e| Failure::Usage(e.to_string()))?;
    let timing = scene.desc.timing();
    let total = (timing.frames * timing.steps_per_frame).max(WARM_UP + 1);
    let stopwatch = Stopwatch::new(pool);
    let (mut largest_stretch, mut times, mut before, started) =
        (0.0_f64, Vec::new(), ContactStatistics::default(), Instant::now());
    for step in 0..total {
        if step == WARM_UP {
            stopwatch.reset();
            before = simulation.contact_statistics();
        }
        let clock = Instant::now();
        simulation.step(&stopwatch).map_err(|diverged| Failure::Diverged(diverged.to_string()))?;
        stopwatch.pause();
        if step >= WARM_UP {
            times.push(clock.elapsed().as_secs_f64());
        }
        largest_stretch = largest_stretch.max(simulation.stretch().max);
        if started.elapsed() > LONGEST && step > WARM_UP {
            break;
        }
    }
    let steps = times.len() as u64;
    let mean = times.iter().sum::<f64>() / steps as f64;
    let particles = simulation.positions().len();
    let work = simulation.statistics();
    let all_steps = (steps + WARM_UP) as f64;
    let per_step = |stage: Stage| match stage {
        Stage::Solve => work.cg_iterations as f64 / all_steps,
        Stage::Force(_) => work.force_evaluations as f64 / all_steps,
        _ => 1.0,
    };
    let stages = stopwatch.times().into_iter().map(|(stage, time)| {
        let seconds = time.as_secs_f64() / steps as f64;
        let bytes = traffic::bytes(stage, &simulation.model(), simulation.sizes()) as f64 * per_step(stage);
        StageReport {
            stage: stage_name(stage),
            ms_per_step: 1e3 * seconds,
            particles_per_s: particles as f64 / seconds,
            traffic_bytes_per_particle: bytes / particles as f64,
            gb_per_s: bytes / seconds / 1e9,
            of_copy_speed: bytes / seconds / copy,
        }
    });
    let mut stages: Vec<_> = stages.collect();
    let traffic: f64 = stages.iter().map(|s| s.traffic_bytes_per_particle).sum();
    stages.push(StageReport {
        stage: "all".into(),
        ms_per_step: 1e3 * mean,
        particles_per_s: particles as f64 / mean,
        traffic_bytes_per_particle: traffic,
        gb_per_s: traffic * particles as f64 / mean / 1e9,
        of_copy_speed: traffic * particles as f64 / mean / copy,
    });
    Ok(SceneReport {
        scene: scene.desc.name.clone(),
        method: scene.desc.integrator.method.name(),
        particles,
        bytes_per_particle: simulation.bytes() as f64 / particles as f64,
        steps,
        simulated_s: simulation.time(),
        ms_per_step: 1e3 * mean,
        ms_per_frame: 1e3 * mean * timing.steps_per_frame as f64,
        particles_per_s: particles as f64 / mean,
        largest_stretch,
        cg_iterations_per_step: work.cg_iterations as f64 / all_steps,
        contact: simulation.contact().map(|_| contact(before, simulation.contact_statistics(), steps, &stopwatch)),
        stages,
    })
}

fn contact(
    before: ContactStatistics,
    after: ContactStatistics,
    steps: u64,
    stopwatch: &Stopwatch<'_>,
) -> ContactReport {
    let (candidates, contacts) = (after.candidates - before.candidates, after.proximity - before.proximity);
    let seconds = |stage| stopwatch.time(stage).as_secs_f64();
    ContactReport {
        candidates_per_step: candidates as f64 / steps as f64,
        contacts_per_step: contacts as f64 / steps as f64,
        candidates_per_s: candidates as f64 / seconds(Stage::BroadPhase),
        contacts_per_s: contacts as f64 / (seconds(Stage::NarrowPhase) + seconds(Stage::Response)),
        candidates_per_contact: (contacts > 0).then(|| candidates as f64 / contacts as f64),
        impacts: after.impacts - before.impacts,
        zones: after.zones - before.zones,
        rejected_steps: after.rejected - before.rejected,
    }
}

fn stage_name(stage: Stage) -> String {
    match stage {
        Stage::Force(term) => format!("force {}", term.name()),
        Stage::Jacobian(term) => format!("jacobian {}", term.name()),
        Stage::Solve => "solve".into(),
        Stage::BroadPhase => "broad phase".into(),
        Stage::NarrowPhase => "narrow phase".into(),
        Stage::Response => "response".into(),
        Stage::Integrate => "integrate".into(),
    }
}

/// Model name of the processor.
pub fn cpu_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|line| line.starts_with("model name")).and_then(|line| line.split(": ").nth(1));
    model.unwrap_or(std::env::consts::ARCH).into()
}
