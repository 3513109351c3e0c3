//! Too little room for candidates or constraints is counted and grown, and changes no bit.
//!
//! Run: `cargo test -p muslin-tests --test response capacity`.

use harness::both_precisions;

/// A thick sheet that falls over a moving capsule onto a plane: starts free of contacts.
const FALLING: &str = r#"
    name = "falling"
    duration = 1.0
    frame_rate = 100
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [14, 14] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 50.0 }
    shear = { stiffness = 10.0 }
    bend = { model = "hinge", rigidity = 1e-7 }
    [contact]
    thickness = 0.012
    friction = 0.3
    [[collider]]
    shape = "plane"
    point = [0, -0.1, 0]
    normal = [0, 1, 0]
    [[collider]]
    shape = "capsule"
    a = [0, -0.06, -0.2]
    b = [0, -0.06, 0.2]
    radius = 0.03
    motion = { keys = [[0.0, 0, 0, 0], [0.2, 0.05, 0, 0]] }
    [integrator]
    step = 0.005
"#;

both_precisions! {
    use super::FALLING;
    use muslin::broad_phase::Counts;
    use muslin::contact::{ContactRoom, ContactScratch, ContactScratchColumns, Prediction};
    use muslin::diagnostics::StateHash;
    use muslin::dispatch::Serial;
    use muslin::integrate::{IntegratorStatistics, Method, Scheme, StepInput};
    use muslin::real::{Real, Vec3, vec3};
    use muslin::refusal::{Cause, Obstacle};
    use muslin::response::{self, Outcome, Settings, ContactStatistics};
    use muslin::scene::BuiltScene;
    use muslin::scratch::ScratchColumns;
    use muslin::simulation::Simulation;
    use muslin::step::{self, History, StepContact, Work};
    use muslin::detection;
    use harness::rng::Rng;

    /// Where a step ends that begins with so much room, how many constraints it has, and how often
    /// it was short of room.
    fn end_with_room(room: usize) -> (Vec<Vec3>, ContactStatistics, u32) {
        let built = kit::build(FALLING);
        let touching = built.contact.as_ref().expect("the scene has contact");
        let model = touching.view();
        let mut rng = Rng::new(5);
        let from = &built.particles.positions;
        let to: Vec<Vec3> = from.iter().map(|&x| x * 0.7 as Real + vec3(rng.cube(0.01).into())).collect();
        let mut columns = ContactScratchColumns::build(&model, room);
        detection::place(&model, [0.0, 0.005], from, &to, &mut columns.view());
        detection::sweep(&model, 0.5, &mut columns.view());
        let (mut short, mut contact_statistics) = (0, ContactStatistics::default());
        let counts = detection::detect(&model, &mut columns.view(), &Serial).expect("nothing stops the search");
        if columns.grow_pairs(counts) {
            short += 1;
            assert_eq!(detection::detect(&model, &mut columns.view(), &Serial), Some(counts), "counts depend on the room");
        }
        let displacements: Vec<_> = to.iter().zip(from).map(|(to, from)| *to - *from).collect();
        let prediction = Prediction { positions: &to, displacements: &displacements, low: &[] };
        let settings = Settings { step: 0.005, hold: false };
        loop {
            match response::respond(&model, &prediction, &mut columns.view(), settings, &mut contact_statistics, &Serial) {
                Err(needed) => assert!(columns.grow_constraints(needed), "no memory"),
                Ok(Outcome::Free) => break,
                other => panic!("with room for {room}: {other:?}"),
            }
            short += 1;
        }
        (columns.view().end.to_vec(), contact_statistics, short)
    }

    #[test]
    fn a_step_ends_alike_whatever_the_room() {
        let (want, contact_statistics, short) = end_with_room(1_000_000);
        assert_eq!(short, 0, "there is room for a million");
        for room in [0, 1, 10, 100, 1000] {
            let (end, found, short) = end_with_room(room);
            println!("{}: with room for {room} grown {short} times, {found:?}", muslin::real::NAME);
            assert!(short > 0, "room for {room} should be too little for {contact_statistics:?}");
            assert_eq!(found, contact_statistics, "with room for {room} contacts are lost or found twice");
            assert_eq!(end, want, "with room for {room} the step ends elsewhere");
        }
    }

    /// More room than there is memory for: the columns say so and stay as they are.
    #[test]
    fn columns_do_not_grow_beyond_the_memory() {
        let built = kit::build(FALLING);
        let touching = built.contact.expect("the scene has contact");
        let mut columns = ContactScratchColumns::build(&touching.view(), 10);
        let bytes = columns.bytes();
        let too_many = 1 << 60;
        let counts = Counts { vertex_triangle: too_many, edge_edge: 0 };
        assert!(!columns.grow_pairs(counts), "there is no memory for 2^60 candidates");
        assert!(!columns.columns().has_room(counts) && columns.bytes() == bytes, "the columns have changed");
        assert!(!columns.grow_constraints(too_many), "there is no memory for 2^60 constraints");
        assert_eq!(columns.bytes(), bytes, "the columns have changed");
    }

    /// The hash of a run, and bytes before and after.
    fn hash(sim: &mut muslin::simulation::Simulation) -> (StateHash, [usize; 2]) {
        let (before, mut hash) = (sim.bytes(), StateHash::default());
        kit::run(sim, 0.2, |sim| hash.add(sim.positions(), sim.velocities()));
        (hash, [before, sim.bytes()])
    }

    /// The second run has the room that the first has made.
    #[test]
    fn a_run_that_grows_ends_as_one_that_has_room() {
        let mut sim = kit::simulation(FALLING, &[]);
        let start = sim.clone();
        let (grown, bytes) = hash(&mut sim);
        assert!(bytes[1] > bytes[0], "nothing had to grow: {bytes:?} bytes, {:?}", sim.contact_statistics());
        let counted = (IntegratorStatistics::default(), ContactStatistics::default());
        assert!(sim.restore(&start.state(), counted.0, counted.1), "a simulation restores its own start");
        let (roomy, bytes) = hash(&mut sim);
        assert_eq!(bytes[0], bytes[1], "the same run needs more room the second time");
        assert_eq!(grown, roomy, "with and without growth the hashes differ");
    }

    /// Columns that do not grow, as those of a host without a heap.
    struct Fixed(ContactScratchColumns);

    impl ContactRoom for Fixed {
        fn columns(&mut self) -> ContactScratch<'_> {
            self.0.view()
        }
        fn grow_pairs(&mut self, _: Counts) -> bool {
            false
        }
        fn grow_constraints(&mut self, _: usize) -> bool {
            false
        }
    }

    /// The falling sheet with a method.
    fn falling(method: Method) -> Simulation {
        let scheme = Scheme { method, ..*kit::simulation(FALLING, &[]).scheme() };
        Simulation::from_columns(kit::build(FALLING), scheme, 0.005)
    }

    /// Drives steps of the falling sheet with columns for so many candidates and constraints. Calls `see` after each
    /// step, until one fails.
    fn drive(
        method: Method,
        [pairs, constraints]: [usize; 2],
        steps: u32,
        mut see: impl FnMut(&BuiltScene),
    ) -> Result<(), Obstacle> {
        let sim = falling(method);
        let (mut built, scheme, length) = (kit::build(FALLING), *sim.scheme(), sim.step_length());
        let mut scratch = ScratchColumns::build(&built, &scheme);
        let model = built.contact.clone().expect("the scene has contact");
        let model = model.view();
        let mut columns = Fixed(ContactScratchColumns::build(&model, 0));
        columns.0.grow_pairs(Counts { vertex_triangle: pairs, edge_edge: pairs });
        columns.0.grow_constraints(constraints);
        let (mut statistics, mut contact_statistics) = (IntegratorStatistics::default(), ContactStatistics::default());
        let mut history = History::Start;
        for n in 0..steps {
            let mut particles = built.particles.view();
            let input = StepInput {
                model: built.model.view(),
                pins: &built.pins.view(),
                masses: particles.masses,
                inverse_masses: particles.inverse_masses,
                time: f64::from(n) * f64::from(length),
                step: length,
                scheme: &scheme,
                follows_contact: false,
                limit: None,
                has_contact: true,
                dispatch: &Serial,
            };
            let contact = Some(StepContact { model: &model, columns: &mut columns, hold: false });
            let work = Work { integrator: &mut statistics, contact: &mut contact_statistics, searched: &mut 0, done: None };
            step::take(&input, &mut particles, &mut scratch.view(), contact, &mut history, work)?;
            see(&built);
        }
        assert!(contact_statistics.proximity > 1000, "nothing touches: {contact_statistics:?}");
        Ok(())
    }

    /// Contact ends the history of BDF2, and is followed by a step of backward Euler: the driver knows it, not the
    /// host.
    #[test]
    fn a_host_without_a_heap_takes_the_same_steps() {
        for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
            let (mut sim, mut steps, mut corrected) = (falling(method), 0, [0; 2]);
            let driven = drive(method, [100_000, 10_000], 60, |built| {
                sim.take_step().expect("the sheet falls");
                steps += 1;
                corrected[usize::from(sim.state().after_contact)] += 1;
                let same = built.particles.positions == sim.positions() && built.particles.velocities == sim.velocities();
                assert!(same, "{} {method:?}: step {steps} differs from that of `Simulation`", muslin::real::NAME);
            });
            assert_eq!(driven, Ok(()), "{method:?} after {steps} steps");
            assert_eq!(sim.contact_statistics().rejected, 0, "{method:?}: the host takes no halves");
            assert!(corrected.iter().all(|&count| count > 5), "{method:?}: {corrected:?} steps free and corrected");
        }
    }

    #[test]
    fn a_host_without_room_learns_what_it_lacks() {
        // First too few candidates and too few constraints, then as many as the step asks for.
        let (mut room, mut lacked) = ([10, 1], [false; 2]);
        while let Err(obstacle) = drive(Method::BackwardEuler, room, 60, |_| ()) {
            let Cause::Short { pairs, constraints } = obstacle.cause else { panic!("{obstacle:?}") };
            for (k, needed) in [pairs, constraints].into_iter().enumerate() {
                assert!(needed == 0 || needed > room[k], "with room for {room:?}: {obstacle:?}");
                room[k] = room[k].max(needed);
                lacked[k] |= needed > 0;
            }
        }
        assert_eq!(lacked, [true; 2], "candidates and constraints lacked room");
    }
}
