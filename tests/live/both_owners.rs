//! Any sequence of calls does the same to a simulation and to the cooked cloth of its scene.

use harness::both_precisions;

both_precisions! {
    use std::fmt::Debug;

    use glam::{DQuat, DVec3};
    use harness::aligned::Aligned;
    use harness::rng::Rng;
    use harness::steps::Steps;
    use muslin::cooked::{Cloth, Room, cook, required_bytes};
    use muslin::dispatch::Serial;
    use muslin::kinematic::Pose;
    use muslin::live::Live;
    use muslin::simulation::{Cause, Simulation};

    const TABLE: &str = "[[collider]]\nshape = \"mesh\"\nfile = \"table\"";
    const WIND: &str = "drag = { wind = { velocity = [0.5, 0, 0], normal = 0.2, tangential = 0.02 } }";
    const LOAD: &str = "load = [{ select = { edge = \"left\" }, force = [0.0, 0.0, 0.01] }]\npin = [{ select = { corners = [0, 1] } }]";

    fn simulation(method: &str) -> Simulation {
        let text = crate::ball("", TABLE).replace("density = 0.2", &format!("density = 0.2\n{LOAD}"));
        let text = text.replace("step = 0.005,", &format!("step = 0.005, method = \"{method}\","));
        let text = text.replace("contact =", &format!("{WIND}\ncontact ="));
        let positions = vec![[-0.4, -0.4, -0.4], [0.4, -0.4, -0.4], [0.4, -0.4, 0.4], [-0.4, -0.4, 0.4]];
        let mesh = harness::belt::Mesh { positions, uvs: Vec::new(), triangles: vec![[0, 2, 1], [0, 3, 2]] };
        kit::simulation(&text, &[kit::resource("table", mesh)])
    }

    fn words(result: impl Debug) -> String {
        format!("{result:?}")
    }

    /// A random call; a few name vertices or colliders that do not exist.
    fn call(host: &mut impl Live, rng: &mut Rng) -> String {
        let vertex = (rng.bits() % 190) as u32;
        let collider = rng.pick(&[0, 0, 0, 1, 1, 2]);
        let small = rng.cube(0.02);
        let seconds = rng.pick(&[0.005, 0.005, 0.02, 1e-9]);
        let turn = DQuat::from_axis_angle(rng.direction(), rng.between(0.0, 0.1));
        match rng.bits() % 16 {
            0 | 1 => {
                let pose = host.collider_pose(collider).unwrap_or(Pose::IDENTITY);
                let to = Pose { position: pose.position + small, rotation: turn * pose.rotation };
                words((pose, host.move_collider(collider, to, seconds)))
            }
            2 => words(host.take_impulse(collider)),
            3 => {
                let to = [[-0.4, -0.41, -0.4], [0.4, -0.4, -0.4], [0.4, -0.4, 0.4], [-0.4, -0.4, 0.4]];
                words(host.deform_collider(collider, &to.map(|x| (DVec3::from(x) + small).into()), seconds))
            }
            4 => words(host.switch_off(collider)),
            5 | 6 => words(host.switch_on(collider)),
            7 => words(host.point(vertex, [0.0; 3]).and_then(|at| {
                host.move_to(vertex, (DVec3::from(at.position) + small).into(), seconds)
            })),
            8 => words(host.attach(vertex, collider)),
            9 | 10 => words(host.release(vertex)),
            11 => words((host.set_gravity((DVec3::NEG_Y * 9.81 + small).into()), host.set_wind((small * 50.0).into()))),
            12 => words(host.set_force(vertex, (small * rng.pick(&[0.0, 1.0])).into())),
            13 => words(host.push(vertex, (small * 1e-3).into())),
            14 => {
                let by = Pose { position: small * 10.0, rotation: turn };
                words(host.teleport(by, rng.pick(&[&[0, 1], &[0], &[], &[0, 1, 2]])))
            }
            _ => {
                let hit = host.hit([0.05, 1.0, 0.02], (DVec3::NEG_Y + small).into());
                words((hit, host.touches().collect::<Vec<_>>(), host.point(vertex, [0.2, 0.3, 0.5])))
            }
        }
    }

    /// How many calls of the sequence of a seed were carried out.
    fn compare(seed: u64, method: &str, impulses: bool) -> usize {
        let mut owned = simulation(method);
        if impulses {
            owned.measure_reactions();
        }
        let room = Room { pairs: 20_000, contacts: 20_000, hands: 64, forces: 64, deforms: true, impulses };
        let mut block = Aligned::new(&cook(&simulation(method), room));
        let mut memory = Aligned::filled(required_bytes(block.all()).expect("it is cooked"), 0xA5);
        let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
        let (mut rng, mut done) = (Rng::new(seed), 0);
        let mut kept = (owned.snapshot(), vec![0; cloth.snapshot_bytes()]);
        cloth.snapshot(&mut kept.1).expect("it has room");
        for n in 0..40 {
            for _ in 0..rng.bits() % 3 {
                let before = rng.clone();
                let [own, cooked] = [call(&mut owned, &mut rng), call(&mut cloth, &mut before.clone())];
                assert_eq!(own, cooked, "{} {method}, seed {seed}, step {n}", muslin::real::NAME);
                done += usize::from(!own.contains("Err"));
            }
            match rng.bits() % 12 {
                0 => {
                    kept.0 = owned.snapshot();
                    cloth.snapshot(&mut kept.1).expect("it has room");
                }
                1 => assert_eq!([owned.go_back(&kept.0), cloth.go_back(&kept.1)], [Ok(()); 2]),
                _ => {}
            }
            let taken = [owned.take_step(), cloth.step(&Serial)];
            // A wild motion may need more room than any program would give it.
            if taken[1].is_err_and(|failed| matches!(failed.cause, Cause::Short { .. })) {
                return done;
            }
            assert_eq!(taken[0], taken[1], "{} {method}, seed {seed}, step {n}", muslin::real::NAME);
            assert!(owned.positions() == cloth.positions(), "{} {method}, seed {seed}, step {n}", muslin::real::NAME);
            assert!(owned.velocities() == cloth.velocities(), "{} {method}, seed {seed}, step {n}", muslin::real::NAME);
        }
        done
    }

    #[test]
    fn any_calls_do_the_same_to_both_owners() {
        let mut done = 0;
        for seed in 0..12 {
            let method = ["backward-euler", "bdf2", "implicit-midpoint"][seed as usize % 3];
            done += compare(seed, method, seed % 2 == 0);
        }
        assert!(done > 200, "only {done} calls were carried out");
    }
}
