//! The torture set with contact on: crumpled, flattened, stretched, folded, wrung, funnelled, heavy on light,
//! stiff on soft, slivers, fast capsules. From seeded starts without crossings, the exact audit finds no
//! crossing after any step, and no vertex is inside a collider.
//!
//! Run: `cargo test -p muslin-tests --test torture`. The long form prints a table:
//! `cargo test -p muslin-tests --test torture -- --ignored --nocapture long_form`.

mod numbers;

use harness::both_precisions;
use harness::torture::{SCENES, Scene};

/// Number of seeds in CI and in the long form.
const SEEDS: [u64; 2] = [10, 100];

both_precisions! {
    use super::{SCENES, Scene};
    use glam::DVec3;
    use muslin::dispatch::Serial;
    use muslin::real::{to_f64, vec3};
    use muslin::simulation::Simulation;
    use harness::rng::Rng;

    /// Results of the runs of a scene.
    #[derive(Debug, Default)]
    pub struct Row {
        pub runs: u64,
        pub rejected: u64,
        pub failsafe: u64,
        pub stretch: f64,
        pub crossings: usize,
        /// Depth inside a collider with a volume, m: crossings do not cover round colliders.
        pub depth: f64,
        /// The first seed and step with a crossing, or the first run that diverged.
        pub first: Option<String>,
    }

    /// Runs a scene, whose steps may be taken in halves or not.
    fn run(scene: &Scene, halving: bool, seed: u64, row: &mut Row) {
        let mut desc = kit::scene(&(scene.text)());
        desc.contact.as_mut().expect("it has contact").halving = halving;
        let mut sim = Simulation::new(&desc, &[]).expect("it builds");
        let mut rng = Rng::new(seed);
        let mut start: Vec<DVec3> = sim.positions().iter().map(|&x| to_f64(x).into()).collect();
        (scene.start)(&mut start, &mut rng);
        for (x, start) in sim.state_mut().0.iter_mut().zip(start) {
            *x = vec3(start.into());
        }
        assert_eq!(sim.crossings(&Serial), 0, "{}, seed {seed}: choose a start without crossings", scene.name);
        row.runs += 1;
        for step in 1..=scene.steps {
            if let Err(diverged) = sim.take_step() {
                row.first.get_or_insert(format!("seed {seed}: {diverged}"));
                break;
            }
            let (crossings, depth) = (sim.crossings(&Serial), sim.penetration().map_or(0.0, f64::from));
            row.crossings += crossings;
            row.depth = row.depth.max(depth);
            row.stretch = row.stretch.max(sim.stretch().max);
            if crossings > 0 || depth > 0.0 {
                let what = format!("{crossings} crossings, {depth} m inside");
                row.first.get_or_insert(format!("seed {seed}: {what} after step {step}, {:?}", sim.contact_statistics()));
                break;
            }
        }
        row.rejected += sim.contact_statistics().rejected;
        row.failsafe += sim.contact_statistics().failsafe;
    }

    pub fn torture(scene: &Scene, halving: bool, seeds: u64) -> Row {
        let mut row = Row::default();
        (0..seeds).for_each(|seed| run(scene, halving, seed, &mut row));
        row
    }

    pub fn check(name: &str) {
        let scene = SCENES.iter().find(|scene| scene.name == name).expect("the scene is in the table");
        let row = torture(scene, true, super::SEEDS[0]);
        println!("{} {name}: {row:?}", muslin::real::NAME);
        assert!(row.first.is_none(), "{} {name}: {}", muslin::real::NAME, row.first.unwrap_or_default());
    }

    /// Steps that are never divided hold vertices back instead. Nothing passes through anything all the same, and only
    /// cloth that starts stretched a thousandfold may need more than that.
    #[test]
    #[ignore = "slow"]
    fn steps_that_are_not_divided() {
        let mut failsafe = 0;
        for scene in SCENES {
            let row = torture(scene, false, 3);
            let name = format!("{} {}", muslin::real::NAME, scene.name);
            println!("{name}: {row:?}");
            assert_eq!((row.crossings, row.depth, row.rejected), (0, 0.0, 0), "{name}: {:?}", row.first);
            assert!(row.first.is_none() || scene.name == "stretched", "{name}: {:?}", row.first);
            failsafe += row.failsafe;
        }
        assert!(failsafe > 0, "no scene needs the last resort: take harder ones");
    }
}

macro_rules! scenes {
    ($($name:ident),*) => {
        mod in_single {
            $(#[test]
            #[ignore = "slow"]
            fn $name() { super::single::check(stringify!($name)); })*
        }
        mod in_double {
            $(#[test]
            #[ignore = "slow"]
            fn $name() { super::double::check(stringify!($name)); })*
        }

        #[test]
        fn every_scene_is_here() {
            let names: Vec<_> = SCENES.iter().map(|scene| scene.name).collect();
            assert_eq!(names, [$(stringify!($name)),*], "give the new scene a test");
        }
    };
}

scenes!(crumpled, line, plane, stretched, folded, wrung, funnel, masses, stiffnesses, slivers, capsules, pressed);

#[test]
#[ignore = "a command of its own"]
fn long_form_of_100_seeds() {
    println!(
        "{:24} {:>5} {:>9} {:>9} {:>10} {:>10} {:>8}",
        "scene", "runs", "rejected", "fail-safe", "stretch", "crossings", "depth"
    );
    let mut wrong = Vec::new();
    for scene in SCENES {
        macro_rules! line {
            ($precision:ident) => {
                let row = $precision::torture(scene, true, SEEDS[1]);
                let name = format!("{} {}", scene.name, stringify!($precision));
                println!(
                    "{name:24} {:5} {:9} {:9} {:10.3} {:10} {:8}",
                    row.runs, row.rejected, row.failsafe, row.stretch, row.crossings, row.depth
                );
                wrong.extend(row.first.map(|first| format!("{name}: {first}")));
            };
        }
        line!(single);
        line!(double);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
