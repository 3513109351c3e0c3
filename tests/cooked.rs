//! Cooked scenes: the cloth that lies in a block of bytes takes the steps of the owned one, bit for bit, and a bad block
//! is refused.
//!
//! Run: `cargo test --release -p muslin-tests --test cooked`.

use harness::both_precisions;

both_precisions! {
    use harness::aligned::Aligned;
    use harness::cooked::mend;
    use harness::rng::Rng;
    use muslin::cooked::{self, Cloth, CookedError, Room, cook};
    use muslin::dispatch::Serial;
    use muslin::error::{LiveError, SceneError};
    use muslin::live::Live as _;
    use muslin::integrate::{Method, Preconditioner};
    use muslin::real::{Sum, Vec3};
    use muslin::response::ContactStatistics;
    use muslin::scene::{BUILT_IN, IntegratorDesc, SceneDesc};
    use muslin::simulation::{Cause, Simulation};
    use std::time::Instant;

    const EMPTY: Room =
        Room { pairs: 0, contacts: 0, hands: 0, forces: 0, deforms: false, impulses: false, is_lean: false };
    const ROOM: Room = Room { pairs: 20_000, contacts: 4_000, hands: 2, ..EMPTY };

    fn coarse(name: &str, change: impl FnOnce(&mut SceneDesc)) -> Simulation {
        let (_, text) = BUILT_IN.iter().find(|(known, _)| *known == name).expect("it is built in");
        let mut scene = kit::scene(text);
        for grid in scene.cloth.iter_mut().flat_map(|cloth| &mut cloth.grid) {
            grid.cells = grid.cells.map(|cells| (cells / 4).max(2));
        }
        change(&mut scene);
        Simulation::new(&scene, &[]).expect("it builds")
    }

    /// Takes the same steps; returns how often a step was halved at most.
    fn compare(what: &str, owned: Simulation, steps: u32) -> u64 {
        compare_in(what, owned.clone(), steps, Room { is_lean: true, ..ROOM });
        compare_in(what, owned, steps, ROOM)
    }

    fn compare_in(what: &str, mut owned: Simulation, steps: u32, room: Room) -> u64 {
        let mut block = Aligned::new(&cook(&owned, room));
        let needed = cooked::required_bytes(block.all()).expect("it is cooked");
        let mut memory = Aligned::filled(needed, 0xA5);
        let mut cloth = Cloth::open(block.all(), memory.all()).unwrap_or_else(|error| panic!("{what}: {error}"));
        for n in 0..steps {
            let taken = [owned.take_step(), cloth.step(&Serial)];
            assert!(taken.iter().all(Result::is_ok), "{} {what}, step {n}: {taken:?}", muslin::real::NAME);
            assert_eq!(owned.positions(), cloth.positions(), "{} {what}, step {n}", muslin::real::NAME);
            assert_eq!(owned.velocities(), cloth.velocities(), "{} {what}, step {n}", muslin::real::NAME);
        }
        assert_eq!(owned.statistics(), cloth.statistics(), "{what}");
        // Without room for the motion of triangles, the response tests a few candidates more.
        let tested = |it: ContactStatistics| if room.is_lean { ContactStatistics { candidates: 0, ..it } } else { it };
        assert_eq!(tested(owned.contact_statistics()), tested(cloth.contact_statistics()), "{what}");
        assert_eq!(owned.estimated_error(), cloth.estimated_error(), "{what}");
        owned.statistics().most_halvings
    }

    #[test]
    fn a_cooked_cloth_takes_the_steps_of_the_owned_one() {
        for (name, steps) in [("flag", 30), ("ball", 40), ("twist", 30), ("stack", 20), ("skirt", 10), ("swing", 30)] {
            compare(name, coarse(name, |_| ()), steps);
        }
    }

    /// Without halving, a cloth needs no copy of its state, and takes the same steps all the same.
    #[test]
    fn steps_that_are_not_divided_are_the_same() {
        let of = |halving| {
            coarse("ball", |scene| {
                scene.integrator = IntegratorDesc { step: Some(0.01), ..Default::default() };
                scene.contact.as_mut().expect("it has contact").halving = halving;
            })
        };
        assert_eq!(compare("undivided", of(false), 40), 0);
        let [with, without] = [true, false].map(|halving| {
            cooked::required_bytes(&cook(&of(halving), ROOM)).expect("it is cooked")
        });
        let state = 4 * size_of::<Vec3>() * of(true).positions().len();
        assert!(with >= without + state, "{with} {without}");
        let controlled = text(7, "backward-euler", false, -0.2, false).replace("step = 0.005, ", "");
        let refused = Simulation::new(&kit::scene(&controlled), &[]).err();
        assert_eq!(refused, Some(SceneError::ErrorWithoutHalving));
    }

    #[test]
    fn every_method_takes_the_same_steps() {
        for method in Method::ALL {
            let step = if method.is_implicit() { 0.002 } else { 2e-5 };
            for (newton, preconditioner) in [(1, Preconditioner::TwoLevel), (3, Preconditioner::BlockJacobi)] {
                let sim = coarse("ball", |scene| {
                    scene.integrator.method = method;
                    (scene.integrator.step, scene.integrator.error) = (Some(step), None);
                    (scene.integrator.newton, scene.integrator.preconditioner) = (newton, preconditioner);
                });
                compare(method.name(), sim, 20);
            }
        }
    }

    /// Vertices that the host moves, attaches and lets go.
    #[test]
    fn hands_lead_a_cooked_cloth_as_the_owned_one() {
        for method in [Method::BackwardEuler, Method::Bdf2] {
            let mut owned = coarse("ball", |scene| {
                scene.integrator.method = method;
                (scene.integrator.step, scene.integrator.error) = (Some(0.002), None);
            });
            let mut block = Aligned::new(&cook(&owned, ROOM));
            let mut memory = Aligned::filled(cooked::required_bytes(block.all()).expect("it is cooked"), 0);
            let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
            let [a, b] = [20, 31];
            let start = owned.places_in_world().nth(a as usize).expect("it exists");
            for n in 0..30 {
                let place = [start[0], start[1] + 0.0005 * f64::from(n), start[2]];
                let done = match n {
                    0..12 => [owned.move_to(a, place, 0.002), cloth.move_to(a, place, 0.002)],
                    12 => [owned.attach(b, 0), cloth.attach(b, 0)],
                    13 => [owned.move_to(999, place, 1.0), cloth.move_to(999, place, 1.0)],
                    14 => [owned.attach(b, 9), cloth.attach(b, 9)],
                    _ => [Ok(()); 2],
                };
                assert_eq!(done[0], done[1], "step {n}");
                if n == 20 {
                    assert_eq!(cloth.move_to(40, place, 1.0), Err(LiveError::NoSlot), "both slots are taken");
                    assert_eq!([owned.release(a), cloth.release(a)], [true; 2]);
                    assert_eq!([owned.release(a), cloth.release(a)], [false; 2]);
                }
                assert_eq!([owned.take_step(), cloth.step(&Serial)], [Ok(()); 2], "step {n}");
                assert_eq!(owned.positions(), cloth.positions(), "{} step {n}", method.name());
            }
        }
    }

    /// A cooked cloth measures nothing, whatever the simulation does that is cooked.
    #[test]
    fn a_simulation_that_measures_work_is_cooked_without() {
        for method in [Method::SymplecticEuler, Method::Rk4, Method::BackwardEuler] {
            let mut sim = coarse("ball", |scene| {
                scene.integrator.method = method;
                let step = if method.is_implicit() { 0.002 } else { 2e-5 };
                (scene.integrator.step, scene.integrator.error) = (Some(step), None);
            });
            sim.measure_reactions();
            compare(method.name(), sim, 5);
        }
    }

    /// A ball that is shot through a sheet makes substeps, and pins begin and end.
    #[test]
    fn substeps_and_pins_that_begin_and_end_are_the_same() {
        let text = |integrator: &str| {
            format!(
                r#"
                duration = 1.0
                frame_rate = 50
                gravity = [0, -9.81, 0]
                contact = {{ thickness = 0.002, friction = 0.3 }}
                integrator = {{ {integrator} }}
                [[cloth]]
                grid = {{ size = [0.4, 0.4], cells = [8, 8] }}
                density = 0.2
                stretch = {{ model = "membrane", stiffness = 500.0 }}
                bend = {{ model = "hinge", rigidity = 1e-5 }}
                pin = [
                    {{ select = {{ edge = "left" }}, until = 0.1, motion = {{ keys = [[0, 0, 0, 0], [1, 0.2, 0, 0]] }} }},
                    {{ select = {{ edge = "right" }}, from = 0.05, motion = {{ turn = {{ axis = [0, 1, 0], rate = 2 }} }} }},
                ]
                load = [{{ select = {{ vertices = [30] }}, force = [0, 0.01, 0] }}]
                [[collider]]
                shape = "box"
                center = [0, -0.2, 0]
                half = [0.05, 0.05, 0.05]
                motion = {{ keys = [[0, 0, 0, 0], [0.1, 0, 0, 0], [0.15, 0, 0.5, 0]], turn = {{ axis = [1, 0, 0], rate = 9 }} }}
                "#
            )
        };
        let mut halvings = 0;
        for integrator in ["step = 0.02", "error = 0.0005", "method = \"bdf2\", error = 0.001"] {
            let sim = kit::simulation(&text(integrator), &[]);
            halvings += compare(integrator, sim, 12);
        }
        assert!(halvings > 0, "no step was divided");
    }

    /// A snapshot knows the triangles and the colliders that it belongs to. Materials and rest shapes may differ.
    #[test]
    fn a_snapshot_of_other_colliders_is_refused() {
        let text = |half: f64, stiffness: f64| {
            let scene = text(5, "backward-euler", false, -5.0, true).replace("stiffness = 50", &format!("stiffness = {stiffness}"));
            let walls = format!("[[collider]]\nshape = \"box\"\ncenter = [0, -1, 0]\nhalf = [{half}, 0.1, 0.2]\n");
            Aligned::new(&cook(&kit::simulation(&(scene + &walls), &[]), ROOM))
        };
        let mut blocks = [text(0.3, 50.0), text(0.3, 90.0), text(0.4, 50.0)];
        let mut memories = blocks.each_mut().map(|block| {
            Aligned::filled(cooked::required_bytes(block.all()).expect("it is cooked"), 0)
        });
        let [first, soft, wide] = &mut blocks;
        let [a, b, c] = &mut memories;
        let mut cloth = Cloth::open(first.all(), a.all()).expect("it opens");
        let mut kept = vec![0; cloth.snapshot_bytes()];
        cloth.snapshot(&mut kept).expect("it has room");
        let mut other = Cloth::open(soft.all(), b.all()).expect("it opens");
        assert_eq!(other.go_back(&kept), Ok(()), "another stiffness");
        let mut other = Cloth::open(wide.all(), c.all()).expect("it opens");
        assert_eq!(other.go_back(&kept), Err(muslin::error::LiveError::OtherScene), "a wider box");
    }

    /// In a step with too little room, nothing changes, and the error says how much is needed.
    #[test]
    fn a_step_that_lacks_room_says_how_much() {
        let mut owned = coarse("ball", |_| ());
        let small = Room { pairs: 3_000, contacts: 20, ..Room::default() };
        let mut block = Aligned::new(&cook(&owned, small));
        let mut memory = Aligned::filled(cooked::required_bytes(block.all()).expect("it is cooked"), 0);
        let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
        let failed = loop {
            owned.take_step().expect("it has room");
            match cloth.step(&Serial) {
                Ok(()) => assert_eq!(owned.positions(), cloth.positions()),
                Err(failed) => break failed,
            }
        };
        let (before, steps) = (cloth.positions().to_vec(), cloth.steps());
        assert_eq!(cloth.step(&Serial), Err(failed));
        assert_eq!((cloth.positions(), cloth.steps()), (&before[..], steps));
        let Cause::Short { pairs, constraints } = failed.cause else { panic!("{failed}") };
        assert!(pairs > small.pairs || constraints > small.contacts, "{failed}");
        assert!(steps > 3, "it fails in step {steps} already: {failed}");
    }

    /// Prints the time of a step of a cooked cloth over that of the owned one, taken in turns.
    #[test]
    #[ignore = "a measurement, not a check"]
    fn long_form_speed() {
        for (name, steps) in [("swing", 300), ("flag", 200), ("ball", 150)] {
            let mut owned = coarse(name, |_| ());
            let room = Room { pairs: 200_000, contacts: 20_000, hands: 2, ..Room::default() };
            let mut block = Aligned::new(&cook(&owned, room));
            let mut memory = Aligned::filled(cooked::required_bytes(block.all()).expect("it is cooked"), 0);
            let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
            let mut ratios = Vec::new();
            for step in 0..steps {
                let seconds = |take: &mut dyn FnMut()| {
                    let start = Instant::now();
                    take();
                    start.elapsed().as_secs_f64()
                };
                let own = &mut || owned.step(&Serial).expect("it steps");
                let cooked = &mut || cloth.step(&Serial).expect("it steps");
                // Each goes first in every other step.
                let [own, cooked] = if step % 2 == 0 {
                    [seconds(own), seconds(cooked)]
                } else {
                    let cooked = seconds(cooked);
                    [seconds(own), cooked]
                };
                ratios.push(cooked / own);
            }
            ratios.sort_by(f64::total_cmp);
            println!("{} {name}: {:.3} (median of {steps} steps)", muslin::real::NAME, ratios[ratios.len() / 2]);
        }
    }

    /// Springs and hinges over a ball, as a microcontroller may have them.
    fn small(cells: u32, method: &str, own_contact: bool, height: f64) -> Simulation {
        Simulation::new(&kit::scene(&text(cells, method, own_contact, height, true)), &[]).expect("it builds")
    }

    fn text(cells: u32, method: &str, own_contact: bool, height: f64, halving: bool) -> String {
        // The damping of the hinges limits the steps of explicit methods, by the square of the edges.
        let step = if method == "symplectic-euler" { 0.0245 / f64::from(cells * cells) } else { 0.005 };
        format!(
            r#"
            name = "small"
            duration = 1.0
            gravity = [0, -9.81, 0]
            integrator = {{ step = {step}, method = "{method}" }}
            contact = {{ thickness = 0.01, friction = 0.3, self = {own_contact}, halving = {halving} }}
            [[collider]]
            shape = "sphere"
            center = [0, {height}, 0]
            radius = 0.15
            [[cloth]]
            grid = {{ size = [0.5, 0.5], cells = [{cells}, {cells}], pattern = "diagonal" }}
            density = 0.2
            stretch = {{ model = "spring", stiffness = 50.0, damping = 0.01 }}
            bend = {{ model = "hinge", rigidity = 1e-5, damping = 0.0001 }}
            "#
        )
    }

    /// The block and the memory of a small scene that falls for half a second, bytes. The cooked cloth takes the same steps.
    fn needs(scene: &str, is_lean: bool) -> [usize; 2] {
        let start = Simulation::new(&kit::scene(scene), &[]).expect("it builds");
        let mut run = start.clone();
        run.measure_room(is_lean);
        let steps = (0.5 / Sum::from(start.step_length())).ceil() as usize;
        (0..steps).for_each(|_| run.take_step().expect("it steps"));
        let [pairs, contacts] = run.room();
        let mut block = Aligned::new(&cook(&start, Room { pairs, contacts, is_lean, ..EMPTY }));
        let needed = cooked::required_bytes(block.all()).expect("it is cooked");
        let mut memory = Aligned::filled(needed, 0xA5);
        let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
        (0..steps).for_each(|_| cloth.step(&Serial).expect("it has room"));
        assert_eq!(cloth.positions(), run.positions(), "{scene}");
        assert!(run.stretch().max < 1.5, "it flew apart: {scene}");
        assert!(run.contact_statistics().proximity > 0, "it touches nothing: {scene}");
        [block.all().len(), needed]
    }

    /// The first searches find nothing, and the pairs that they find last.
    #[test]
    fn a_lean_cloth_meets_what_is_far_away_at_first() {
        for method in ["symplectic-euler", "backward-euler"] {
            let sim = small(6, method, false, -0.2);
            let steps = if method == "symplectic-euler" { 500 } else { 50 };
            compare_in(method, sim.clone(), steps, Room { is_lean: true, ..ROOM });
            let mut run = sim;
            (0..steps).for_each(|_| run.take_step().expect("it steps"));
            assert!(run.contact_statistics().proximity > 0, "{method}: it meets the ball");
        }
    }

    /// Without self-contact, only colliders with edges need room for pairs of edges.
    #[test]
    fn edges_of_a_capsule_have_room() {
        let capsule = "[[collider]]\nshape = \"capsule\"\na = [-0.1, -0.17, 0]\nb = [0.1, -0.17, 0.02]\nradius = 0.15";
        let mut scene = kit::scene(&format!("{}{capsule}", text(7, "symplectic-euler", false, -5.0, true)));
        scene.collider.remove(0);
        let mut sim = Simulation::new(&scene, &[]).expect("it builds");
        compare_in("capsule", sim.clone(), 400, ROOM);
        (0..400).for_each(|_| sim.take_step().expect("it steps"));
        assert!(sim.contact_statistics().proximity > 0, "it meets the capsule");
    }

    #[test]
    fn a_cloth_of_16_by_16_vertices_needs_64_kilobytes_and_twice_as_much_in_double() {
        let [_, memory] = needs(include_str!("../core/examples/cortex-m/explicit.toml"), true);
        println!("{}: {memory} bytes", muslin::real::NAME);
        assert!(memory < 16_000 * size_of::<muslin::real::Real>(), "{memory} bytes");
    }

    #[test]
    #[ignore = "a command of its own"]
    fn long_form_memory() {
        for cells in [7, 15] {
            for (method, own_contact) in
                [("symplectic-euler", false), ("symplectic-euler", true), ("backward-euler", true)]
            {
                let scene = |halving| text(cells, method, own_contact, -0.16, halving);
                let [plain, lean, least] = [(false, true), (true, true), (true, false)]
                    .map(|(is_lean, halving)| needs(&scene(halving), is_lean));
                let n = cells + 1;
                // For the firmware, which counts instructions.
                let touches = if own_contact { "self" } else { "sphere" };
                let file = format!("{}/../target/{n}-{method}-{touches}.toml", env!("CARGO_MANIFEST_DIR"));
                std::fs::write(file, scene(true)).expect("target can be written");
                println!(
                    "{}: {n} x {n}, {method}, self-contact {own_contact}: block {}, memory {}, lean {}, not halved {}",
                    muslin::real::NAME, plain[0], plain[1], lean[1], least[1]
                );
            }
        }
    }

    fn refused(block: &[u8], memory: usize) -> Option<CookedError> {
        let (mut block, mut memory) = (Aligned::new(block), Aligned::filled(memory, 0));
        Cloth::open(block.all(), memory.all()).err()
    }

    #[test]
    fn a_block_that_is_damaged_is_refused() {
        let good = cook(&coarse("ball", |_| ()), Room { pairs: 100, contacts: 10, hands: 1, ..Room::default() });
        let needed = cooked::required_bytes(&good).expect("it is cooked");
        assert_eq!(refused(&good, needed), None);
        assert_eq!(refused(&good, needed - 1), Some(CookedError::Memory { needed }));
        assert_eq!(refused(&good[..good.len() - 8], needed), Some(CookedError::Truncated));
        assert_eq!(refused(&good[..7], needed), Some(CookedError::NotCooked));
        assert_eq!(refused(b"", needed), Some(CookedError::NotCooked));
        let changed = |at: usize| {
            let mut bad = good.clone();
            bad[at] ^= 1;
            refused(&bad, needed)
        };
        assert_eq!(changed(0), Some(CookedError::NotCooked));
        assert!(matches!(changed(8), Some(CookedError::Version(_))));
        assert_eq!(changed(12), Some(CookedError::Precision));
        assert_eq!(changed(16), Some(CookedError::Truncated));
        // The header, and then some of the columns.
        for at in (24..64).chain((64..good.len()).step_by(good.len() / 500)) {
            assert_eq!(changed(at), Some(CookedError::Checksum), "byte {at}");
        }
        let (mut block, mut memory) = (Aligned::new(&good), Aligned::filled(needed + 8, 0));
        let shifted = &mut memory.all()[8..];
        assert_eq!(Cloth::open(block.all(), shifted).err(), Some(CookedError::Alignment));
    }

    #[test]
    fn a_step_without_a_length_is_refused() {
        // Behind the header and the origin.
        const STEP: usize = 64 + 24;
        let good = cook(&coarse("ball", |_| ()), Room { pairs: 100, contacts: 10, ..Room::default() });
        let needed = cooked::required_bytes(&good).expect("it is cooked");
        let in_single: &[f64] = if size_of::<muslin::real::Real>() == 4 { &[1e-300, 1e300] } else { &[] };
        for &step in [0.0, -0.01, f64::NAN, f64::INFINITY].iter().chain(in_single) {
            let mut bad = good.clone();
            bad[STEP..STEP + 8].copy_from_slice(&step.to_le_bytes());
            mend(&mut bad);
            assert_eq!(refused(&bad, needed), Some(CookedError::Malformed), "{step}");
        }
    }

    /// Blocks with a right checksum and wrong numbers: they are refused, or their steps end, but nothing panics.
    #[test]
    fn wrong_numbers_never_panic() {
        wrong_numbers(0..200);
    }

    #[test]
    #[ignore = "takes minutes"]
    fn long_form_wrong_numbers() {
        wrong_numbers(200..30_000);
    }

    fn wrong_numbers(seeds: core::ops::Range<u64>) {
        let (mut refused, count) = (0, seeds.end - seeds.start);
        for (seed, name) in seeds.zip(["ball", "flag", "twist"].into_iter().cycle()) {
            let good = cook(&coarse(name, |_| ()), Room { pairs: 3_000, contacts: 500, hands: 1, ..Room::default() });
            let mut random = Rng::new(seed);
            let mut bad = good.clone();
            for _ in 0..=random.bits() % 3 {
                let word_at = |at: usize| u32::from_le_bytes(bad[at..at + 4].try_into().expect("four"));
                let mut places = (0..200).map(|_| 64 + 4 * (random.bits() as usize % ((good.len() - 64) / 4)));
                // Every other time a small number: an index or a length.
                let first = places.next().expect("there are many");
                let at = if seed % 2 == 0 { first } else { places.find(|&at| word_at(at) < 10_000).unwrap_or(first) };
                let word = match random.bits() % 4 {
                    0 => 0,
                    1 => u32::MAX,
                    2 => random.bits() as u32,
                    _ => word_at(at) ^ 1 << (random.bits() % 32),
                };
                bad[at..at + 4].copy_from_slice(&word.to_le_bytes());
            }
            mend(&mut bad);
            let needed = cooked::required_bytes(&bad).expect("the header is good");
            let (mut block, mut memory) = (Aligned::new(&bad), Aligned::filled(needed, 0));
            match Cloth::open(block.all(), memory.all()) {
                Ok(mut cloth) => _ = (0..3).try_for_each(|_| cloth.step(&Serial)),
                Err(_) => refused += 1,
            }
        }
        println!("{refused} of {count} blocks were refused");
        assert!(refused > count / 10, "{refused} of {count} blocks were refused");
    }
}
