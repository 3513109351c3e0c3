//! Sequences of live calls to a simulation and to the cooked cloth of its scene.

/// A sheet falls on a ball, a box that moves by keys, and a capsule; below is a table that is a mesh, and a floor.
const SCENE: &str = r#"
name = "ball"
duration = 1.0
frame_rate = 100
gravity = [0, -9.81, 0]
integrator = { step = 0.005, method = "backward-euler", tolerance = 1e-10 }
contact = { thickness = 0.004, friction = 0.3 }
drag = { wind = { velocity = [0.5, 0, 0], normal = 0.2, tangential = 0.02 } }
[[collider]]
shape = "sphere"
center = [0, -0.12, 0]
radius = 0.1
[[collider]]
shape = "mesh"
file = "table"
[[collider]]
shape = "box"
center = [0.3, -0.2, 0]
half = [0.05, 0.05, 0.05]
motion = { keys = [[0.0, 0, 0, 0], [0.1, 0, 0.05, 0]] }
[[collider]]
shape = "capsule"
a = [-0.3, -0.2, -0.1]
b = [-0.3, -0.2, 0.1]
radius = 0.03
[[collider]]
shape = "plane"
point = [0, -1, 0]
normal = [0, 1, 0]
[[cloth]]
grid = { size = [0.5, 0.5], cells = [12, 12] }
density = 0.2
stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
shear = { stiffness = 300.0 }
bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
load = [{ select = { edge = "left" }, force = [0.0, 0.0, 0.01] }]
pin = [{ select = { corners = [0, 1] } }]
"#;

macro_rules! calls {
    ($name:ident, $muslin:ident, $doc:literal) => {
        #[doc = $doc]
        pub mod $name {
            use std::fmt::Debug;

            use glam::{DQuat, DVec3};
            use $muslin::cooked::{Cloth, Room, cook, required_bytes};
            use $muslin::dispatch::{Limited, Serial};
            use $muslin::kinematic::Pose;
            use $muslin::live::Live;
            use $muslin::simulation::{Cause, Simulation};

            use $crate::aligned::Aligned;
            use $crate::cooked::mend_snapshot;
            use $crate::kit::$name as kit;
            use $crate::rng::Rng;

            fn simulation(method: &str, cells: u32) -> Simulation {
                let text =
                    super::SCENE.replace("backward-euler", method).replace("[12, 12]", &format!("[{cells}, {cells}]"));
                let positions = vec![[-0.4, -0.4, -0.4], [0.4, -0.4, -0.4], [0.4, -0.4, 0.4], [-0.4, -0.4, 0.4]];
                let mesh = $crate::belt::Mesh { positions, uvs: Vec::new(), triangles: vec![[0, 2, 1], [0, 3, 2]] };
                kit::simulation(&text, &[kit::resource("table", mesh)])
            }

            fn words(result: impl Debug) -> String {
                format!("{result:?}")
            }

            /// A random call; a few name vertices or colliders that do not exist.
            fn call(host: &mut impl Live, vertices: u64, rng: &mut Rng<'_>) -> String {
                let vertex = (rng.bits() % (vertices + 5)) as u32;
                let collider = rng.pick(&[0, 0, 0, 1, 1, 2, 2, 3, 4, 5]);
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
                    7 => words(
                        host.point(vertex, [0.0; 3])
                            .and_then(|at| host.move_to(vertex, (DVec3::from(at.position) + small).into(), seconds)),
                    ),
                    8 => words(host.attach(vertex, collider)),
                    9 | 10 => words(host.release(vertex)),
                    11 => words((
                        host.set_gravity((DVec3::NEG_Y * 9.81 + small).into()),
                        host.set_wind((small * 50.0).into()),
                    )),
                    12 => words(host.set_force(vertex, (small * rng.pick(&[0.0, 1.0])).into())),
                    13 => words(host.push(vertex, (small * 1e-3).into())),
                    14 => {
                        let by = Pose { position: small * 10.0, rotation: turn };
                        words(host.teleport(by, rng.pick(&[&[0, 1], &[0], &[], &[0, 1, 2, 3], &[0, 1, 2, 3, 4], &[9]])))
                    }
                    _ => {
                        let hit = host.hit([0.05, 1.0, 0.02], (DVec3::NEG_Y + small).into());
                        words((hit, host.touches().collect::<Vec<_>>(), host.point(vertex, [0.2, 0.3, 0.5])))
                    }
                }
            }

            /// Makes the same random calls to both, takes the same steps, and compares. The sheet has so many cells along a
            /// side. Returns how many calls were carried out.
            pub fn play(rng: &mut Rng<'_>, cells: u32, steps: u32) -> usize {
                let method = rng.pick(&["backward-euler", "bdf2", "implicit-midpoint"]);
                let impulses = rng.pick(&[false, true]);
                let mut owned = simulation(method, cells);
                if impulses {
                    owned.measure_reactions();
                }
                let is_lean = rng.pick(&[false, false, true]);
                let (hands, forces) = (64, 64);
                let room = Room { pairs: 20_000, contacts: 20_000, hands, forces, deforms: true, impulses, is_lean };
                let mut block = Aligned::new(&cook(&simulation(method, cells), room));
                let mut memory = Aligned::filled(required_bytes(block.all()).expect("it is cooked"), 0xA5);
                let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
                let mut kept = (owned.snapshot(), vec![0; cloth.snapshot_bytes()]);
                cloth.snapshot(&mut kept.1).expect("it has room");
                let count = owned.positions().len() as u64;
                let (name, mut done) = ($muslin::real::NAME, 0);
                for n in 0..steps {
                    for _ in 0..rng.bits() % 3 {
                        let mut before = rng.clone();
                        let [own, cooked] = [call(&mut owned, count, rng), call(&mut cloth, count, &mut before)];
                        assert_eq!(own, cooked, "{name} {method}, step {n}");
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
                    let taken = [owned.step(&Serial), cloth.step(&Serial)];
                    // A wild motion may need more room than any program would give it.
                    if taken[1].is_err_and(|failed| matches!(failed.cause, Cause::Short { .. })) {
                        break;
                    }
                    assert_eq!(taken[0], taken[1], "{name} {method}, step {n}");
                    assert!(owned.positions() == cloth.positions(), "{name} {method}, step {n}");
                    assert!(owned.velocities() == cloth.velocities(), "{name} {method}, step {n}");
                }
                damage(rng, &mut cloth, &mut kept.1);
                done
            }

            /// A snapshot with wrong numbers is refused, or steps from it end.
            fn damage(rng: &mut Rng<'_>, cloth: &mut Cloth<'_>, snapshot: &mut [u8]) {
                for _ in 0..3 {
                    let at = 8 + (rng.bits() % (snapshot.len() as u64 - 12)) as usize;
                    let word = rng.pick(&[0, 1, 3, u32::MAX, 0x7fc0_0000]);
                    snapshot[at..at + 4].copy_from_slice(&word.to_le_bytes());
                }
                mend_snapshot(snapshot);
                if cloth.go_back(snapshot).is_ok() {
                    for _ in 0..2 {
                        _ = cloth.step(&Limited::new(&Serial, 500, 100_000));
                    }
                }
            }
        }
    };
}

calls!(single, muslin_core, "In f32.");
calls!(double, muslin_core_f64, "In f64.");
