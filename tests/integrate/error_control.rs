//! Error control: the estimate and the true error of a step, the length of substeps, and substeps that are taken back.

use harness::both_precisions;
use harness::kit::double as kit;
use harness::soft::{FALLING, SOFT};
use harness::stiff::STIFF;

/// A sheet falls on a ball and slides off it.
const LANDING: &str = r#"
    name = "landing"
    duration = 0.5
    frame_rate = 60
    gravity = [0.0, -9.81, 0.0]
    integrator = { error = 0.0005 }
    contact = { thickness = 0.006, friction = 0.3 }
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [14, 14], pattern = "alternating" }
    position = [0.05, 0.25, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 500.0, damping = 0.0002 }
    shear = { stiffness = 100.0 }
    bend = { model = "hinge", rigidity = 2e-5, damping = 0.001 }
    [[collider]]
    shape = "sphere"
    center = [0.0, 0.0, 0.0]
    radius = 0.15
"#;

/// A sheet that is held along one edge swings down.
const SWING: &str = r#"
    name = "swing"
    duration = 0.5
    frame_rate = 60
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [10, 10], pattern = "alternating" }
    density = 0.2
    stretch = { model = "membrane", stiffness = 200.0, damping = 0.0002 }
    shear = { stiffness = 50.0 }
    bend = { model = "hinge", rigidity = 1e-4, damping = 0.001 }
    pin = [{ select = { edge = "left" } }]
"#;

/// A stiff sheet that hangs from two corners turns.
const TURNED: &str = r#"
    name = "turned"
    duration = 0.6
    frame_rate = 20
    gravity = [0.3, -9.81, 0.2]
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [12, 14] }
    rotation = [10.0, 5.0, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 2000.0, damping = 0.0005 }
    shear = { stiffness = 400.0 }
    bend = { model = "hinge", rigidity = 2e-5 }
    pin = [{ select = { corners = [0, 1] } }]
"#;

/// The built-in scenes with moving cloth and implicit methods, and how long each runs, s. In `ball`, `fold`, `funnel`,
/// `poncho` and `tablecloth`, cloth lands.
const SCENES: [(&str, f64); 12] = [
    ("ball", 0.6),
    ("cantilever", 0.6),
    ("curtain", 0.6),
    ("flag", 0.6),
    ("fold", 0.6),
    ("funnel", 0.6),
    ("poncho", 0.4),
    ("skirt", 0.4),
    ("stack", 0.3),
    ("swing", 0.6),
    ("tablecloth", 0.4),
    ("twist", 0.6),
];

/// The largest error in these scenes, m.
const ERROR: f64 = 1e-3;

/// Least part of the substeps in which the estimate is within a factor of three, %. Measured: 85. In `curtain` and
/// `twist` the estimate is too small: exact motion amplifies folds that backward Euler damps.
const LEAST_PERCENT: usize = 85;

/// Steps that the true error of a step is measured with.
const FINER: u32 = 8;

both_precisions! {
    use core::ops::Range;

    use super::{ERROR, FINER, LANDING, SOFT, STIFF, SWING, TURNED};
    use muslin::implicit_contact::multiplier::Multiplier;
    use muslin::integrate::{Method, Scheme, Tolerance};
    use muslin::real::{Real, Sum, Vec3};
    use muslin::scene::{BUILT_IN, BuiltScene};
    use muslin::simulation::{Simulation, State};

    /// The state of a simulation, owned.
    #[derive(PartialEq, Debug)]
    struct Owned {
        columns: [Vec<Vec3>; 6],
        multipliers: Vec<Multiplier>,
        last_step: Real,
        halvings: u32,
        after_contact: bool,
    }

    impl Owned {
        fn of(sim: &Simulation) -> Self {
            let State { positions, velocities, low, previous, last_step, halvings, after_contact, multipliers, .. } =
                sim.state();
            let columns = [positions, velocities, low[0], low[1], previous[0], previous[1]].map(<[Vec3]>::to_vec);
            Self { columns, multipliers: multipliers.to_vec(), last_step, halvings, after_contact }
        }

        /// The state after so many steps.
        fn view(&self, steps: u64) -> State<'_> {
            let [positions, velocities, low_positions, low_velocities, previous @ ..] =
                self.columns.each_ref().map(|column| &column[..]);
            let low = [low_positions, low_velocities];
            let Self { multipliers, last_step, halvings, after_contact, .. } = self;
            let (last_step, halvings, after_contact) = (*last_step, *halvings, *after_contact);
            let origin = [0.0; 3];
            State {
                steps,
                origin,
                positions,
                velocities,
                low,
                previous,
                last_step,
                halvings,
                after_contact,
                multipliers,
                anchors: &[],
            }
        }
    }

    /// The distance of two states, in the root mean square, m.
    fn distance(x: &[Vec3], y: &[Vec3]) -> Real {
        let sum: Real = x.iter().zip(y).map(|(x, y)| x.distance_squared(*y)).sum();
        (sum / x.len() as Real).sqrt()
    }

    fn step(sim: &mut Simulation) {
        sim.take_step().expect("a step");
    }

    #[test]
    fn substeps_get_shorter_where_cloth_lands_and_longer_again() {
        let mut sim = kit::simulation(LANDING, &[]);
        let most = sim.scheme().error.expect("a largest error");
        let mut halvings = vec![];
        for n in 0..30 {
            step(&mut sim);
            let error = sim.estimated_error().expect("an estimate");
            assert!(error <= most, "step {n}: the estimated error is {error} m, of {most} m at most");
            halvings.push(sim.state().halvings);
        }
        let (statistics, name) = (sim.statistics(), muslin::real::NAME);
        println!("{name}: {statistics:?}, halvings {halvings:?}");
        let (falling, peak, sliding) = (halvings[5], halvings.iter().copied().max(), halvings[29]);
        assert!(peak > Some(falling) && peak > Some(sliding), "{name}: substeps are halved {halvings:?} times");
        // Substeps may have been shorter within a step than at its end.
        assert!(Some(statistics.most_halvings) >= peak.map(u64::from), "{name}: {statistics:?}");
        assert!(statistics.inaccurate > 0 && statistics.committed > 30, "{name}: {statistics:?}");
    }

    #[test]
    fn a_restored_run_takes_the_same_substeps() {
        for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
            let scene = LANDING.replace("{ error", &format!("{{ method = \"{method}\", error"));
            let mut sim = kit::simulation(&scene, &[]);
            for n in 1..=24 {
                let mut resumed = kit::simulation(&scene, &[]);
                let state = Owned::of(&sim);
                assert!(resumed.restore(&state.view(n - 1), sim.statistics(), sim.contact_statistics()));
                step(&mut sim);
                step(&mut resumed);
                let name = format!("{} {method}, step {n}", muslin::real::NAME);
                assert_eq!(Owned::of(&resumed), Owned::of(&sim), "{name}");
                assert_eq!(resumed.statistics(), sim.statistics(), "{name}");
            }
        }
    }

    #[test]
    fn a_state_with_too_many_halvings_is_refused() {
        let mut sim = kit::simulation(LANDING, &[]);
        step(&mut sim);
        let state = Owned::of(&sim);
        for halvings in [7, 32, u32::MAX] {
            let state = State { halvings, ..state.view(1) };
            assert!(!sim.restore(&state, sim.statistics(), sim.contact_statistics()), "{halvings} halvings");
        }
        assert_eq!(Owned::of(&sim), state);
    }

    /// A smaller error needs more work and gives a smaller distance from a fine run.
    #[test]
    fn a_smaller_error_is_smaller() {
        for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
            let run = |integrator: &str| {
                let integrator = format!("integrator = {{ method = \"{method}\", {integrator} }}");
                let mut sim = kit::simulation(&format!("{integrator}{SWING}"), &[]);
                while sim.time() < 0.2999 {
                    step(&mut sim);
                }
                (sim.positions().to_vec(), sim.statistics().cg_iterations)
            };
            let fine = run("step = 1e-4, tolerance = 1e-6").0;
            let distance = |x: &[Vec3]| distance(x, &fine);
            let runs = ["error = 0.004", "error = 0.0005", "error = 0.00006"].map(run);
            let reached = runs.each_ref().map(|(x, _)| distance(x));
            let work = runs.each_ref().map(|&(_, work)| work);
            let what = format!("{} {method}: distances {reached:?} m, CG iterations {work:?}", muslin::real::NAME);
            println!("{what}");
            assert!(reached.is_sorted_by(|coarse, fine| *fine < 0.85 * coarse), "{what}, of decreasing error");
            assert!(work.is_sorted_by(|coarse, fine| coarse < fine), "{what}, of decreasing error");
        }
    }

    /// The error falls with the number of steps as with fixed ones. It would fall by first order, or not at all, if the
    /// solves left errors of the velocities that add up.
    #[test]
    fn methods_keep_their_order() {
        let run = |integrator: &str| {
            let mut sim = kit::simulation(&format!("integrator = {{ {integrator} }}{SOFT}"), &[]);
            while sim.time() < 0.2999 {
                step(&mut sim);
            }
            (sim.positions().to_vec(), sim.statistics().committed as f64)
        };
        let exact = run("method = \"implicit-midpoint\", step = 2e-4, tolerance = 1e-6").0;
        for (method, newton, order, errors) in [
            ("backward-euler", 1, 1.0, [8e-5, 1e-6]),
            ("implicit-midpoint", 1, 2.0, [1e-5, 3e-7]),
            ("bdf2", 1, 2.0, [1e-5, 3e-7]),
            ("backward-euler", 20, 1.0, [8e-5, 1e-6]),
            ("implicit-midpoint", 20, 2.0, [1e-5, 3e-7]),
            ("bdf2", 20, 2.0, [1e-5, 3e-7]),
        ] {
            let [coarse, fine] = errors.map(|error| {
                let (x, steps) = run(&format!("method = \"{method}\", newton = {newton}, error = {error:e}"));
                (Sum::from(distance(&x, &exact)), steps)
            });
            let measured = (coarse.0 / fine.0).ln() / (fine.1 / coarse.1).ln();
            let what = format!("{} {method}, newton {newton}: {coarse:?} and {fine:?} m by steps", muslin::real::NAME);
            println!("{what}: order {measured:.2}");
            assert!((measured - order).abs() < 0.25, "{what}: order {measured}, not {order}");
        }
    }

    /// Newton's method stops where its corrections add up to less than the tolerance of the velocities. By the residual
    /// it left 5 of 37 steps unconverged here.
    #[test]
    fn newtons_method_stops_where_its_corrections_are_small() {
        let run = |integrator: &str| {
            let mut sim = kit::simulation(&format!("integrator = {{ method = \"bdf2\", {integrator} }}{TURNED}"), &[]);
            while sim.time() < 0.5999 {
                step(&mut sim);
            }
            (sim.positions().to_vec(), sim.statistics())
        };
        let (x, work) = run("error = 0.001, newton = 8");
        let (exact, _) = run("error = 0.001, newton = 50, tolerance = 1e-5");
        let apart = distance(&x, &exact);
        let what = format!("{} of {} steps unconverged, {apart} m", work.unconverged, work.committed);
        println!("{} {what}", muslin::real::NAME);
        assert_eq!(work.unconverged, 0, "{what}");
        // Its part of the error of a step is a fifth.
        assert!(Sum::from(apart) < 0.2 * ERROR * work.committed as Sum, "{what}");
    }

    /// In short steps from rest gravity changes the velocities by less than the solver may leave: by 5 mm/s in a step
    /// of 0.5 ms, where a fifth of the error over 1/60 s is 120 mm/s. The sheet falls nevertheless.
    #[test]
    fn a_sheet_falls_in_short_steps_with_a_large_error() {
        for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
            let falls = |solver: &str| {
                let integrator = format!("integrator = {{ method = \"{method}\", step = 0.0005, {solver} }}");
                let mut sim = kit::simulation(&format!("{integrator}{SWING}"), &[]);
                while sim.time() < 0.1999 {
                    step(&mut sim);
                }
                sim.energy().kinetic
            };
            let [loose, exact] = ["error = 0.01", "tolerance = 1e-5"].map(falls);
            let what = format!("{} {method}: kinetic energy {loose} J, by an exact solver {exact} J", muslin::real::NAME);
            println!("{what}");
            assert!((loose / exact - 1.0).abs() < 0.02, "{what}");
        }
    }

    /// A solve may leave a tenth of the solution, in each step on the same side. That tenth contains no momentum.
    #[test]
    fn a_stiff_sheet_loses_nothing_of_its_fall() {
        let settings = [
            ("backward-euler", "two-level", 1e-4),
            ("implicit-midpoint", "two-level", 1e-4),
            ("bdf2", "two-level", 1e-4),
            ("implicit-midpoint", "block-jacobi", 1e-3),
        ];
        for (method, preconditioner, most) in settings {
            let solver = format!("method = \"{method}\"\npreconditioner = \"{preconditioner}\"");
            let mut sim = kit::simulation(&format!("{STIFF}[integrator]\n{solver}\nerror = 0.001\nstep = 1e-4"), &[]);
            kit::run(&mut sim, 0.05, |_| ());
            let mass: f64 = sim.scene().particles.masses.iter().map(|&mass| Sum::from(mass)).sum();
            let part = -sim.momentum()[1] / mass / (9.81 * 0.05);
            let what = format!("{} {method}, {preconditioner}: {part} of the velocity", muslin::real::NAME);
            println!("{what}");
            assert!((part - 1.0).abs() < most, "{what}");
        }
    }

    /// The same for its rotation about a pinned edge.
    #[test]
    fn a_stiff_sheet_loses_nothing_of_its_swing() {
        let kinetic = |integrator: &str, step: f64| {
            let pin = "pin = [{ select = { edge = \"left\" } }]";
            let text = format!("{STIFF}{pin}\n[integrator]\n{integrator}\nstep = {step:?}");
            let mut sim = kit::simulation(&text, &[]);
            kit::run(&mut sim, 0.05, |_| ());
            sim.energy().kinetic
        };
        let exact = kinetic("method = \"rk4\"", 1e-6);
        let off = kinetic("method = \"implicit-midpoint\"\nerror = 0.001", 1e-4) / exact - 1.0;
        println!("{}: kinetic energy off by {off}", muslin::real::NAME);
        assert!(off.abs() < 0.01, "{}: kinetic energy off by {off}", muslin::real::NAME);
    }

    /// Lengths of substeps, each half of the one before.
    const LEVELS: usize = 7;

    /// Simulations with steps of 1/60 s, 1/120 s and so on, each divided into `parts`.
    fn levels(built: &BuiltScene, scheme: Scheme, parts: u32) -> [Simulation; LEVELS] {
        std::array::from_fn(|level| {
            let step = 1.0 / 60.0 / f64::from(1u32 << level) / f64::from(parts);
            Simulation::from_columns(built.clone(), scheme, step as Real)
        })
    }

    /// Takes substeps by error control, each by the simulation with steps of its length. A substep that is accepted is
    /// seen with the state before it, the number of the step and its level.
    fn drive(built: &BuiltScene, scheme: Scheme, seconds: f64, mut see: impl FnMut(&Owned, u64, usize, &Simulation)) {
        let most = scheme.error.expect("a largest error");
        let mut sims = levels(built, Scheme { error: Some(1e9), ..scheme }, 1);
        let whole = 1u64 << (LEVELS - 1);
        let (mut done, mut level) = (0, 0);
        let mut state = Owned::of(&sims[0]);
        while done < (60.0 * seconds) as u64 * whole {
            let parts = whole >> level;
            let sim = &mut sims[level];
            let view = State { halvings: 0, ..state.view(done / parts) };
            assert!(sim.restore(&view, sim.statistics(), sim.contact_statistics()));
            step(sim);
            let estimate = sim.estimated_error().expect("an estimate");
            if estimate > most && level + 1 < LEVELS {
                level += 1;
                continue;
            }
            see(&state, done / parts, level, sim);
            state = Owned::of(sim);
            done += parts;
            level -= usize::from(estimate < 0.25 * most && level > 0 && done % (2 * parts) == 0);
        }
    }

    /// The simulations of `drive` never go on from a substep that was taken back.
    #[test]
    fn a_substep_that_is_taken_back_leaves_nothing_behind() {
        for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
            let own = *kit::simulation(LANDING, &[]).scheme();
            let (built, scheme) = (kit::build(LANDING), Scheme { method, ..own });
            let mut want = vec![];
            drive(&built, scheme, 0.4, |_, _, _, sim| want = Owned::of(sim).columns[0].clone());
            let mut sim = Simulation::from_columns(built, scheme, (1.0 / 60.0) as Real);
            (0..24).for_each(|_| step(&mut sim));
            assert!(sim.statistics().inaccurate > 0, "{}: none is taken back", method.name());
            assert_eq!(sim.positions(), want, "{} {}", muslin::real::NAME, method.name());
        }
    }

    /// The ratio of the estimated error to the true one, for each substep in a built-in scene.
    pub fn ratios(name: &str, seconds: f64) -> Vec<Real> {
        let (most, mut ratios) = (ERROR as Real, vec![]);
        let text = BUILT_IN.iter().find(|(known, _)| *known == name).expect("a built-in scene").1;
        let (built, own) = (kit::build(text), *kit::simulation(text, &[]).scheme());
        let scheme = Scheme { tolerance: Tolerance::within(most), error: Some(most), ..own };
        let finer = Scheme { tolerance: Tolerance::Residual(1e-4), error: None, ..own };
        let mut fine = levels(&built, finer, FINER);
        drive(&built, scheme, seconds, |before, number, level, sim| {
            let truth = &mut fine[level];
            // The exact motion does not know the method's history.
            let view = before.view(number * u64::from(FINER));
            let view = State { halvings: 0, previous: [&[]; 2], last_step: 0.0, ..view };
            assert!(truth.restore(&view, truth.statistics(), truth.contact_statistics()));
            (0..FINER).for_each(|_| step(truth));
            let cloths = built.cloths.iter().map(|cloth| cloth.vertices.start as usize..cloth.vertices.end as usize);
            let of = |own: Range<usize>| distance(&sim.positions()[own.clone()], &truth.positions()[own]);
            let error = cloths.map(of).fold(0.0, Real::max);
            // Smaller ones are rounding.
            if error > 3e-6 {
                ratios.push(sim.estimated_error().expect("an estimate") / error);
            }
        });
        ratios
    }
}

/// How many substeps of a scene have an estimate within a factor of three of the error, and how many substeps there
/// are.
fn near(name: &str, seconds: f64) -> [usize; 2] {
    let mut ratios = single::ratios(name, seconds);
    if name == "swing" {
        let double: f64 = double::ratios(name, seconds).iter().sum();
        let single: f64 = ratios.iter().map(|&ratio| f64::from(ratio)).sum();
        assert!((single / double - 1.0).abs() < 0.01, "{name}: the ratios add up to {single} in f32, {double} in f64");
    }
    ratios.sort_by(f32::total_cmp);
    let own = ratios.iter().filter(|ratio| (1.0 / 3.0..=3.0).contains(*ratio)).count();
    let [low, median, high] = [1, 10, 19].map(|k| ratios[k * ratios.len() / 20]);
    println!("{name}: {own} of {} substeps within 3; ratio {low:.2}, {median:.2}, {high:.2}", ratios.len());
    [own, ratios.len()]
}

#[test]
#[ignore = "slow"]
fn the_estimate_is_within_a_factor_of_three_in_most_steps() {
    let counts = std::thread::scope(|scope| {
        let scenes = SCENES.map(|(name, seconds)| scope.spawn(move || near(name, seconds)));
        scenes.map(|scene| scene.join().expect("the scene runs"))
    });
    let [near, count] = counts.into_iter().fold([0, 0], |[near, count], [own, of]| [near + own, count + of]);
    println!("all: {near} of {count}");
    let enough = 100 * near >= LEAST_PERCENT * count;
    assert!(enough, "the estimate is within a factor of 3 in {near} of {count} substeps only");
}

/// Preconditioning moves each vertex by its own stiffness, step after step alike: without a first motion of all vertices
/// together the sheet was stretched by 0.9 % after 25 m.
#[test]
fn a_free_sheet_stays_flat_in_a_long_fall() {
    for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
        let mut sim = kit::simulation(&format!("{FALLING}[integrator]\nerror = 0.001\nmethod = \"{method}\"\n"), &[]);
        kit::run(&mut sim, 2.25, |_| ());
        let stretched = sim.stretch().max - 1.0;
        println!("{method}: stretched by {stretched:.1e}");
        assert!(stretched < 1e-9, "{method}: the sheet is stretched by {stretched}");
    }
}

/// A sheet of 10 x 12 cells that hangs along one edge and starts level.
fn level(size: f64, density: f64, position: [f64; 3]) -> String {
    format!(
        "[[cloth]]\ngrid = {{ size = [{size:?}, {size:?}], cells = [10, 12] }}\nposition = {position:?}\n\
         density = {density:?}\nstretch = {{ model = \"membrane\", stiffness = 1000.0, damping = 0.0005 }}\n\
         shear = {{ stiffness = 250.0, damping = 0.0005 }}\nbend = {{ model = \"hinge\", rigidity = 5e-5, \
         damping = 0.001 }}\npin = [{{ select = {{ edge = \"back\" }} }}]\n"
    )
}

/// Solves and errors of each cloth: beside a heavy one, the residual of a light one hardly counts in a sum. It would swing
/// above its pins.
#[test]
fn a_light_sheet_beside_a_heavy_one_moves_as_if_alone() {
    let heights = |other: &str| {
        let own = level(0.2, 0.1, [0.0; 3]);
        let text = format!("duration = 1.0\nframe_rate = 60\ngravity = [0, -9.81, 0]\n{own}{other}");
        let mut sim = kit::simulation(&text, &[]);
        let count = sim.scene().cloths[0].vertices.end as usize;
        let mut heights = Vec::new();
        kit::run(&mut sim, 1.0, |sim| {
            heights.push(sim.positions()[..count].iter().map(|x| x.y).sum::<f64>() / count as f64);
        });
        heights
    };
    let alone = heights("");
    for (size, density) in [(0.4, 0.4), (3.0, 0.4), (0.5, 10.0)] {
        let beside = heights(&level(size, density, [0.0, 0.0, 5.0]));
        let highest = beside.iter().skip(12).copied().fold(f64::NEG_INFINITY, f64::max);
        let expected = alone.iter().skip(12).copied().fold(f64::NEG_INFINITY, f64::max);
        println!("beside {size} m and {density} kg/m^2 up to {highest:.4} m, alone {expected:.4} m");
        assert!((highest - expected).abs() < 0.02, "up to {highest} m, alone {expected} m");
    }
}

/// Cloths that no pin holds fall flat, whatever is beside them and whoever held them.
#[test]
fn free_sheets_stay_flat_in_a_long_fall() {
    let other = "[[cloth]]\ngrid = { size = [1.0, 1.0], cells = [1, 1] }\nposition = [2.0, 0.0, 0.0]\ndensity = 0.2\n";
    for more in [
        format!("{other}pin = [{{ select = {{ border = true }} }}]\n"),
        format!("{other}velocity = [0, 1, 0]\nspin = {{ axis = [0, 1, 0], rate = 1.0 }}\n"),
        "pin = [{ select = { box = [[-9, -9, -9], [9, 9, 9]] }, until = 0.05 }]\n".to_owned(),
        "pin = [{ select = { corners = [0] }, from = 2.4 }]\n".to_owned(),
    ] {
        let mut sim = kit::simulation(&format!("{FALLING}{more}"), &[]);
        let count = sim.scene().cloths[0].vertices.end as usize;
        kit::run(&mut sim, 2.25, |_| ());
        let heights = sim.positions()[..count].iter().map(|x| x.y);
        let span = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
        println!("{more:?}: {span:.1e} m high");
        assert!(span < 1e-4, "{span} m high with {more:?}");
    }
}
