//! Golden hashes of every built-in scene, and of the firmware's scene: `scene precision hash ...`, one line each, in
//! `goldens.txt`, with a hash for the start and for every step. They hold on every machine and in every build profile:
//! `check -- --all` runs this suite in the test profile, without optimisation, for size, and in the release profile.
//! `tests/browser/goldens.test.mjs` and `firmware` compare the lines in single precision.
//!
//! Run: `cargo test -p muslin-tests --test goldens`. `MUSLIN_BLESS=1` rewrites `goldens.txt` from the current results of
//! the core. A failure names the first step whose state differs.

use std::fs;
use std::path::PathBuf;

/// Steps of scenes without contact. A hash covers all earlier steps.
const STEPS: usize = 20;
/// Steps of scenes with contact: until surfaces touch, and so many steps more. Without optimisation more would take minutes.
const AFTER_CONTACT: usize = 1;
/// Steps of scenes whose surfaces touch later.
const WITHOUT_CONTACT: usize = 10;
/// Scenes whose surfaces touch, at least.
const TOUCHING: usize = 7;

/// The scene of the firmware, and its steps: `firmware` compares the last hash of its line.
const FIRMWARE: (&str, &str, usize) = ("cortex-m", include_str!("../core/examples/cortex-m/scene.toml"), 40);

macro_rules! lines {
    ($name:ident, $muslin:ident, $kit:ident) => {
        /// The line of every scene.
        fn $name() -> Vec<String> {
            use harness::kit::$kit as kit;
            let line = |(name, text, steps): (&str, &str, Option<usize>)| {
                let mut sim = $muslin::simulation::Simulation::new(&kit::scene(text), &[]).expect("a valid scene");
                let mut hash = $muslin::diagnostics::StateHash::default();
                hash.add(sim.positions(), sim.velocities());
                let mut line = format!("{name} {} {:016x}", $muslin::real::NAME, hash.0);
                let mut left = steps.unwrap_or(if sim.scene().contact.is_some() { WITHOUT_CONTACT } else { STEPS });
                while left > 0 {
                    let touched = sim.contact_statistics().proximity > 0;
                    sim.take_step().unwrap_or_else(|error| panic!("{name} {error}"));
                    hash.add(sim.positions(), sim.velocities());
                    line += &format!(" {:016x}", hash.0);
                    let touches = sim.contact_statistics().proximity > 0;
                    left = if steps.is_none() && touches && !touched { AFTER_CONTACT } else { left - 1 };
                }
                (line, sim.contact_statistics().proximity > 0)
            };
            let built_in = $muslin::scene::BUILT_IN.iter().map(|&(name, text)| (name, text, None));
            let (name, text, steps) = FIRMWARE;
            let (lines, touched): (Vec<_>, Vec<_>) = built_in.chain([(name, text, Some(steps))]).map(line).unzip();
            assert!(touched.iter().filter(|&&touches| touches).count() >= TOUCHING, "too few touch: {touched:?}");
            lines
        }
    };
}

lines!(single, muslin_core, single);
lines!(double, muslin_core_f64, double);

/// Describes the difference and the first step at which it occurs.
fn difference(got: &str, goldens: &str) -> Option<String> {
    let fields: Vec<_> = got.split(' ').collect();
    let name = fields[..2].join(" ");
    let golden = goldens.lines().find(|line| line.split(' ').take(2).eq(fields[..2].iter().copied()));
    let Some(golden) = golden else { return Some(format!("{name} has no golden line")) };
    let known: Vec<_> = golden.split(' ').collect();
    let first = fields.iter().zip(&known).position(|(field, known)| field != known);
    let first = first.or((fields.len() != known.len()).then_some(fields.len().min(known.len())));
    // The third field is the hash of the start.
    let place = |field: usize| if field == 2 { "its start".into() } else { format!("step {}", field - 2) };
    first.map(|field| format!("{name} differs first after {}", place(field)))
}

#[test]
fn every_step_has_its_golden_hash() {
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
