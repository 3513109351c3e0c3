//! Golden hashes of every built-in scene: `scene precision step:hash ...`, one line each, in
//! `goldens.txt`. They hold on every machine and in every build profile: `check -- --all` runs this suite in the test
//! profile, in a profile without optimisation and in the release profile.
//!
//! Run: `cargo test -p muslin-tests --test goldens`. `MUSLIN_BLESS=1` rewrites `goldens.txt` from the current results of
//! the core. A failure names the first step whose state differs.

use std::fs;
use std::path::PathBuf;

/// Steps after which the line records the hash; it covers all earlier steps.
const CHECKPOINTS: [u64; 7] = [1, 2, 3, 5, 7, 10, 20];
/// Steps of scenes with contact: without optimisation more would take minutes.
const STEPS_WITH_CONTACT: u64 = 7;

macro_rules! lines {
    ($name:ident, $muslin:ident, $kit:ident) => {
        /// The line of every built-in scene.
        fn $name() -> Vec<String> {
            use harness::kit::$kit as kit;
            let line = |&(name, text): &(&str, &str)| {
                let mut sim = $muslin::simulation::Simulation::new(&kit::scene(text), &[]).expect("a valid scene");
                let mut hash = $muslin::diagnostics::StateHash::default();
                let mut line = format!("{name} {}", $muslin::real::NAME);
                let all = CHECKPOINTS[CHECKPOINTS.len() - 1];
                for step in 1..=if sim.scene().contact.is_some() { STEPS_WITH_CONTACT } else { all } {
                    sim.take_step().unwrap_or_else(|error| panic!("{name} {error}"));
                    hash.add(sim.positions(), sim.velocities());
                    if CHECKPOINTS.contains(&step) {
                        line += &format!(" {step}:{:016x}", hash.0);
                    }
                }
                line
            };
            $muslin::scene::BUILT_IN.iter().map(line).collect()
        }
    };
}

lines!(single, muslin_core, single);
lines!(double, muslin_core_f64, double);

/// Describes the difference and the first checkpoint at which it occurs.
fn difference(got: &str, goldens: &str) -> Option<String> {
    let fields: Vec<_> = got.split(' ').collect();
    let golden = goldens.lines().find(|line| line.split(' ').take(2).eq(fields[..2].iter().copied()));
    let Some(golden) = golden else { return Some(format!("{} {} has no golden line", fields[0], fields[1])) };
    let known: Vec<_> = golden.split(' ').collect();
    let first = fields.iter().position(|field| !known.contains(field))?;
    let step = |field: &str| field.split(':').next().unwrap_or_default().to_owned();
    let before = if first > 2 { step(fields[first - 1]) } else { "0".into() };
    Some(format!("{} {} agrees up to step {before} and differs at step {}", fields[0], fields[1], step(fields[first])))
}

#[test]
fn built_in_scenes_have_their_golden_hashes() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("goldens.txt");
    let lines: Vec<_> = std::thread::scope(|scope| {
        let runs = [scope.spawn(single), scope.spawn(double)];
        runs.into_iter().flat_map(|run| run.join().expect("the scenes run")).collect()
    });
    if std::env::var_os("MUSLIN_BLESS").is_some() {
        fs::write(&path, lines.join("\n") + "\n").expect("goldens.txt can be written");
        return;
    }
    let goldens = fs::read_to_string(&path).unwrap_or_default();
    let wrong: Vec<_> = lines.iter().filter_map(|line| difference(line, &goldens).map(|what| (what, line))).collect();
    let message: String = wrong.iter().map(|(what, line)| format!("\n{what}; the line is now\n{line}\n")).collect();
    assert!(
        wrong.is_empty(),
        "{message}\nto accept all of them: MUSLIN_BLESS=1 cargo test -p muslin-tests --test goldens"
    );
}
