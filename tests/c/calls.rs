//! The C interface, called from Rust: it takes the steps of a simulation, refuses bad pointers, and gives reasons.
//!
//! Run: `cargo test -p muslin-c --test c_calls`, or under Miri:
//! `MIRIFLAGS=-Zmiri-disable-isolation cargo +nightly miri test -p muslin-c --test c_calls --target
//! riscv64gc-unknown-linux-gnu`: libm has assembly for x86, which Miri does not run.

use std::ffi::CStr;
use std::hint::black_box;
use std::ptr::{null, null_mut};
use std::time::Instant;

use muslin::*;
use muslin_core::cooked::{Room, cook};
use muslin_core::dispatch::Serial;
use muslin_core::error::LiveError;
use muslin_core::kinematic::Pose;
use muslin_core::live::Live as _;
use muslin_core::mesh::TriMesh;
use muslin_core::scene::{Content, Resource};
use muslin_core::simulation::Simulation;

/// Bytes that begin at a multiple of 32.
#[repr(align(32))]
#[derive(Clone, Copy)]
struct Block([u8; 32]);

struct Memory(Vec<Block>);

impl Memory {
    fn new(length: usize) -> Self {
        Self(vec![Block([0xA5; 32]); length.div_ceil(32)])
    }

    fn of(bytes: &[u8]) -> Self {
        let blocks = bytes.chunks(32).map(|part| {
            let mut block = Block([0; 32]);
            block.0[..part.len()].copy_from_slice(part);
            block
        });
        Self(blocks.collect())
    }

    fn start(&mut self) -> *mut u8 {
        self.0.as_mut_ptr().cast()
    }
}

/// A sheet of so many cells above a ball and a table.
fn simulation(cells: u32) -> Simulation {
    let text = format!(
        r#"
        name = "ball"
        duration = 1.0
        gravity = [0, -9.81, 0]
        integrator = {{ step = 0.005 }}
        contact = {{ thickness = 0.004, friction = 0.3 }}
        drag = {{ wind = {{ velocity = [0, 0, 0], normal = 0.2, tangential = 0.02 }} }}
        [[collider]]
        shape = "sphere"
        center = [0, -0.106, 0]
        radius = 0.1
        [[collider]]
        shape = "mesh"
        file = "table"
        [[cloth]]
        grid = {{ size = [0.3, 0.3], cells = [{cells}, {cells}] }}
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 500.0, damping = 0.001 }}
        bend = {{ model = "hinge", rigidity = 1e-5 }}
        "#
    );
    let table = TriMesh {
        positions: vec![[-0.4, -0.4, -0.4], [0.4, -0.4, -0.4], [0.4, -0.4, 0.4], [-0.4, -0.4, 0.4]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
        ..TriMesh::default()
    };
    let resources: [Resource; 1] = [("table".into(), Content::Mesh(table))];
    let mut sim = Simulation::new(&toml::from_str(&text).expect("it is valid"), &resources).expect("it builds");
    sim.measure_reactions();
    sim
}

const ROOM: Room =
    Room { pairs: 4_000, contacts: 500, hands: 2, forces: 2, deforms: true, impulses: true, is_lean: false };

/// An opened scene with its memory.
struct Opened {
    scene: Memory,
    memory: Memory,
    cloth: *mut MuslinCloth,
}

fn open(block: &[u8]) -> Result<Opened, MuslinStatus> {
    let (mut scene, mut needed, mut cloth) = (Memory::of(block), 0, null_mut());
    // SAFETY: the pointers name these bytes and this number.
    let status = unsafe { muslin_required_bytes(scene.start(), block.len(), &mut needed) };
    let mut memory = Memory::new(needed);
    if status == MuslinStatus::Ok {
        // SAFETY: the memory lives as long as the handle.
        let status = unsafe { muslin_open(scene.start(), block.len(), memory.start(), needed, &mut cloth) };
        if status == MuslinStatus::Ok {
            return Ok(Opened { scene, memory, cloth });
        }
        assert!(cloth.is_null());
        return Err(status);
    }
    Err(status)
}

fn words(status: MuslinStatus) -> String {
    // SAFETY: it is a constant text with a final zero.
    unsafe { CStr::from_ptr(muslin_message(status as i32)) }.to_string_lossy().into_owned()
}

fn error(cloth: *const MuslinCloth) -> String {
    let mut text = [0_u8; 200];
    // SAFETY: the text has this length.
    let length = unsafe { muslin_error(cloth, text.as_mut_ptr().cast(), text.len()) };
    String::from_utf8_lossy(&text[..length.min(text.len() - 1)]).into_owned()
}

/// Steps of a test: few under Miri, which is slow.
const STEPS: u32 = if cfg!(miri) { 2 } else { 30 };
const CELLS: u32 = if cfg!(miri) { 3 } else { 8 };

#[test]
fn the_calls_do_what_a_simulation_does() {
    let mut own = simulation(CELLS);
    let Opened { cloth, scene: _scene, memory: _memory } = open(&cook(&own, ROOM)).expect("it opens");
    let step = f64::from(own.step_length());
    let ok = MuslinStatus::Ok;
    let pose =
        |n: u32| MuslinPose { position: [0.0, -0.106 + 1e-4 * f64::from(n), 0.0], rotation: [0.0, 0.0, 0.0, 1.0] };
    let corners = [[-0.4, -0.41, -0.4], [0.4, -0.4, -0.4], [0.4, -0.4, 0.4], [-0.4, -0.4, 0.4]];
    // SAFETY: the handle is open, and all pointers name numbers of this test.
    unsafe {
        assert_eq!(muslin_step_length(cloth), step);
        assert_eq!(muslin_collider_count(cloth), 2);
        let mut snapshot = vec![0; muslin_snapshot_bytes(cloth)];
        for n in 1..=STEPS {
            let (to, place) = (pose(n), [-0.15, 0.001 * f64::from(n), -0.15]);
            assert_eq!(muslin_move_collider(cloth, 0, &to, step), ok);
            own.move_collider(0, to.into(), step).expect("it moves");
            assert_eq!(muslin_move_to(cloth, 0, place.as_ptr(), step), ok);
            own.move_to(0, place, step).expect("it moves");
            if n == 2 {
                assert_eq!(muslin_set_gravity(cloth, [0.0, -9.0, 0.1].as_ptr()), ok);
                assert_eq!(muslin_set_wind(cloth, [1.0, 0.0, 0.0].as_ptr()), ok);
                assert_eq!(muslin_set_force(cloth, 5, [0.0, 0.001, 0.0].as_ptr()), ok);
                assert_eq!(muslin_push(cloth, 6, [0.0, 1e-5, 0.0].as_ptr()), ok);
                assert_eq!(muslin_attach(cloth, 7, 0), ok);
                assert_eq!(muslin_deform_collider(cloth, 1, corners.as_ptr().cast(), 4, step), ok);
                own.set_gravity([0.0, -9.0, 0.1]).expect("it is finite");
                own.set_wind([1.0, 0.0, 0.0]).expect("it has wind");
                own.set_force(5, [0.0, 0.001, 0.0]).expect("it exists");
                own.push(6, [0.0, 1e-5, 0.0]).expect("it exists");
                own.attach(7, 0).expect("it exists");
                own.deform_collider(1, &corners, step).expect("it is a mesh");
                assert_eq!(muslin_snapshot(cloth, snapshot.as_mut_ptr(), snapshot.len()), ok);
            }
            if n == 5 {
                let by = MuslinPose { position: [1.0, 0.5, 0.0], rotation: [0.0, 0.0, 0.0, 1.0] };
                assert_eq!(muslin_teleport(cloth, &by, [0, 1].as_ptr(), 2), MuslinStatus::Ok);
                own.teleport(by.into(), &[0, 1]).expect("it is free there");
                let back = MuslinPose { position: [-1.0, -0.5, 0.0], ..by };
                assert_eq!(muslin_teleport(cloth, &back, [0, 1].as_ptr(), 2), MuslinStatus::Ok);
                own.teleport(back.into(), &[0, 1]).expect("it is free there");
            }
            let mut report = MuslinReport::default();
            assert_eq!(muslin_step(cloth, null(), &mut report), ok, "step {n}: {}", error(cloth));
            own.step(&Serial).expect("it steps");
            let mut count = 0;
            let positions = muslin_positions(cloth, &mut count);
            assert_eq!(
                std::slice::from_raw_parts(positions, 3 * count),
                own.positions().iter().flat_map(|x| x.to_array()).collect::<Vec<_>>(),
                "step {n}"
            );
            let velocities = muslin_velocities(cloth, &mut count);
            assert_eq!(
                std::slice::from_raw_parts(velocities, 3 * count),
                own.velocities().iter().flat_map(|x| x.to_array()).collect::<Vec<_>>(),
                "step {n}"
            );
            let mut touches = vec![std::mem::zeroed::<MuslinTouch>(); 200];
            assert_eq!(muslin_touches(cloth, touches.as_mut_ptr(), touches.len(), &mut count), ok);
            assert_eq!((count, report.contacts as usize), (own.touches().count(), own.touches().count()));
            assert!(own.touches().zip(&touches).all(|(own, it)| own.force == it.force && own.vertices == it.vertices));
            let mut impulse = std::mem::zeroed::<MuslinImpulse>();
            assert_eq!(muslin_take_impulse(cloth, 0, &mut impulse), ok);
            assert_eq!(impulse, own.take_impulse(0).expect("it is measured").into());
        }
        assert_eq!((muslin_steps(cloth), muslin_time(cloth)), (STEPS.into(), own.time()));
        let mut at = std::mem::zeroed::<MuslinPoint>();
        assert_eq!(muslin_point(cloth, 3, [0.2, 0.3, 0.5].as_ptr(), &mut at), ok);
        assert_eq!(at.position, own.point(3, [0.2, 0.3, 0.5]).expect("it exists").position);
        let mut hit = MuslinHit::default();
        assert_eq!(muslin_hit(cloth, [0.01, 1.0, 0.02].as_ptr(), [0.0, -1.0, 0.0].as_ptr(), &mut hit), ok);
        assert_eq!(
            Some(hit.distance),
            own.hit([0.01, 1.0, 0.02], [0.0, -1.0, 0.0]).expect("it is finite").map(|hit| hit.distance)
        );
        let mut now = pose(0);
        assert_eq!(muslin_collider_pose(cloth, 0, &mut now), ok);
        assert_eq!(Pose::from(now), own.collider_pose(0).expect("it exists"));
        let mut count = 0;
        let normals = muslin_normals(cloth, &mut count);
        let normals = std::slice::from_raw_parts(normals, 3 * count).as_chunks::<3>().0;
        assert!(normals.iter().all(|[x, y, z]| (x * x + y * y + z * z - 1.0).abs() < 1e-5));
        assert_eq!(muslin_release(cloth, 0), ok);
        let hash = muslin_hash(cloth);
        assert_eq!(muslin_go_back(cloth, snapshot.as_ptr(), snapshot.len()), ok);
        assert!(muslin_hash(cloth) != hash && muslin_steps(cloth) == 1);
        snapshot[100] ^= 1;
        assert_eq!(muslin_go_back(cloth, snapshot.as_ptr(), snapshot.len()), MuslinStatus::OtherScene);
    }
}

#[test]
fn a_step_over_its_budget_leaves_the_state_as_it_was() {
    let own = simulation(CELLS);
    let Opened { cloth, scene: _scene, memory: _memory } = open(&cook(&own, ROOM)).expect("it opens");
    // SAFETY: the handle is open, and all pointers name numbers of this test.
    unsafe {
        let mut free = MuslinReport::default();
        for _ in 0..STEPS {
            assert_eq!(muslin_step(cloth, null(), &mut free), MuslinStatus::Ok);
        }
        assert!(free.iterations > 1, "{free:?}");
        let mut snapshot = vec![0; muslin_snapshot_bytes(cloth)];
        assert_eq!(muslin_snapshot(cloth, snapshot.as_mut_ptr(), snapshot.len()), MuslinStatus::Ok);
        assert_eq!(muslin_step(cloth, null(), &mut free), MuslinStatus::Ok);
        let after = muslin_hash(cloth);
        assert_eq!(muslin_go_back(cloth, snapshot.as_ptr(), snapshot.len()), MuslinStatus::Ok);
        let before = muslin_hash(cloth);
        let mut spent = MuslinReport::default();
        let small = MuslinBudget { iterations: free.iterations / 2, candidates: u32::MAX };
        assert_eq!(muslin_step(cloth, &small, &mut spent), MuslinStatus::OverBudget);
        assert_eq!((muslin_hash(cloth), spent.iterations), (before, free.iterations / 2 + 1));
        assert!(error(cloth).contains("given up"), "{}", error(cloth));
        if free.candidates > 0 {
            let few = MuslinBudget { iterations: u32::MAX, candidates: free.candidates - 1 };
            assert_eq!(muslin_step(cloth, &few, null_mut()), MuslinStatus::OverBudget);
        }
        let enough = MuslinBudget { iterations: free.iterations, candidates: free.candidates };
        assert_eq!(muslin_step(cloth, &enough, null_mut()), MuslinStatus::Ok);
        assert_eq!(muslin_hash(cloth), after);
    }
}

#[test]
fn a_step_that_lacks_room_says_how_much() {
    let own = simulation(CELLS);
    let Opened { cloth, scene: _scene, memory: _memory } =
        open(&cook(&own, Room { pairs: 1, contacts: 1, ..ROOM })).expect("it opens");
    let mut report = MuslinReport::default();
    // SAFETY: the handle is open.
    let status =
        unsafe { (0..100).map(|_| muslin_step(cloth, null(), &mut report)).find(|&it| it != MuslinStatus::Ok) };
    assert_eq!(status, Some(MuslinStatus::NoRoom));
    assert!(report.candidates_needed > 1 || report.contacts_needed > 1, "{report:?}");
    assert!(error(cloth).contains("needs room"), "{}", error(cloth));
}

#[test]
fn bad_pointers_and_blocks_are_refused() {
    let good = cook(&simulation(3), ROOM);
    // SAFETY: null pointers are allowed everywhere.
    unsafe {
        let mut number = 0;
        assert_eq!(muslin_required_bytes(null(), 0, &mut number), MuslinStatus::NullPointer);
        assert_eq!(muslin_open(null(), 0, null_mut(), 0, null_mut()), MuslinStatus::NullPointer);
        assert_eq!(muslin_step(null_mut(), null(), null_mut()), MuslinStatus::NullPointer);
        number = 7;
        assert!(muslin_positions(null(), &mut number).is_null() && number == 0);
        assert_eq!(muslin_snapshot_bytes(null()), 0);
        assert_eq!(muslin_error(null(), null_mut(), 0), 0);
    }
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut block = good.clone();
        change(&mut block);
        open(&block).err().expect("it is bad")
    };
    assert_eq!(refused(&|block| block[0] ^= 1), MuslinStatus::NotCooked);
    assert_eq!(refused(&|block| block.truncate(200)), MuslinStatus::Truncated);
    assert_eq!(refused(&|block| block[500] ^= 1), MuslinStatus::Checksum);
    assert_eq!(refused(&|block| block[40] ^= 1), MuslinStatus::Checksum, "the number of vertices is another");
    let mut opened = open(&good).expect("it opens");
    let (length, mut cloth) = (good.len(), null_mut());
    // SAFETY: the pointers name these bytes; the shifted ones are shorter.
    unsafe {
        let (scene, memory) = (opened.scene.start(), opened.memory.start());
        assert_eq!(muslin_open(scene, length, memory.add(1), 64, &mut cloth), MuslinStatus::Alignment);
        assert_eq!(muslin_open(scene, length, memory, 64, &mut cloth), MuslinStatus::Memory);
        // Bytes that are not a handle.
        let mut other = Memory::new(size_of::<MuslinCloth>());
        assert_eq!(muslin_step(other.start().cast(), null(), null_mut()), MuslinStatus::BadHandle);
    }
}

/// Structs and columns lie at their alignment; numbers may lie anywhere.
#[test]
fn null_and_misaligned_pointers_are_refused() {
    let block = cook(&simulation(3), ROOM);
    let Opened { cloth, mut scene, memory: _memory } = open(&block).expect("it opens");
    let (mut bytes, pose) = ([0_u64; 64], MuslinPose { position: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] });
    let odd = bytes.as_mut_ptr().cast::<u8>().wrapping_add(1);
    let (numbers, mut number) = ([0.3_f64; 3], 0);
    let (weights, ray) = (numbers.as_ptr(), numbers.as_ptr());
    // SAFETY: the handle is open, and pointers that are refused are not followed.
    unsafe {
        let state = || (muslin_hash(cloth), muslin_steps(cloth));
        let before = state();
        for bad in [null_mut(), odd] {
            let statuses = [
                muslin_required_bytes(scene.start(), block.len(), bad.cast()),
                muslin_open(scene.start(), block.len(), scene.start(), 0, bad.cast()),
                muslin_move_collider(cloth, 0, bad.cast(), 0.005),
                muslin_take_impulse(cloth, 0, bad.cast()),
                muslin_deform_collider(cloth, 1, bad.cast(), 4, 0.005),
                muslin_teleport(cloth, bad.cast(), null(), 0),
                muslin_teleport(cloth, &pose, bad.cast(), 1),
                muslin_collider_pose(cloth, 0, bad.cast()),
                muslin_origin(cloth, bad.cast()),
                muslin_point(cloth, 0, weights, bad.cast()),
                muslin_hit(cloth, ray, ray, bad.cast()),
                muslin_touches(cloth, null_mut(), 0, bad.cast()),
            ];
            assert_eq!(statuses, [MuslinStatus::NullPointer; 12]);
        }
        let statuses = [
            muslin_step(cloth, odd.cast(), null_mut()),
            muslin_step(cloth, null(), odd.cast()),
            muslin_move_to(cloth, 0, null(), 0.005),
            muslin_set_gravity(cloth, null()),
            muslin_set_wind(cloth, null()),
            muslin_set_force(cloth, 0, null()),
            muslin_push(cloth, 0, null()),
            muslin_point(cloth, 0, null(), odd.cast()),
            muslin_hit(cloth, ray, null(), odd.cast()),
            muslin_snapshot(cloth, null_mut(), 0),
            muslin_go_back(cloth, null(), 8),
        ];
        assert_eq!(statuses, [MuslinStatus::NullPointer; 11]);
        assert_eq!(state(), before);
        assert!(!muslin_positions(cloth, odd.cast()).is_null(), "the number is not written");
        assert_eq!(muslin_touches(cloth, null_mut(), 0, &mut number), MuslinStatus::Ok);
    }
    assert_eq!(bytes, [0; 64], "nothing is written");
}

#[test]
fn a_call_that_is_refused_leaves_the_bytes_of_the_caller() {
    let good = cook(&simulation(3), ROOM);
    let Opened { cloth, scene: _scene, mut memory } = open(&good).expect("it opens");
    // SAFETY: the handle is open, and the pointers name these bytes.
    unsafe {
        let size = muslin_snapshot_bytes(cloth);
        let mut kept = vec![7; size + 9];
        assert_eq!(muslin_snapshot(cloth, kept.as_mut_ptr(), size + 9), MuslinStatus::Ok);
        assert_eq!(kept[size..], [7; 9], "bytes beyond the snapshot");
        let whole = kept.clone();
        assert_eq!(muslin_snapshot(cloth, kept.as_mut_ptr(), size - 1), MuslinStatus::Memory);
        assert_eq!(muslin_snapshot(null_mut(), kept.as_mut_ptr(), size), MuslinStatus::NullPointer);
        assert!(kept == whole, "a refused call has changed the snapshot");
        let mut bad = Memory::of(&good);
        *bad.start().add(500) ^= 1;
        let (length, room, hash) = (good.len(), 32 * memory.0.len(), muslin_hash(cloth));
        let (mut other, mut good) = (null_mut(), Memory::of(&good));
        assert_eq!(muslin_open(bad.start(), length, memory.start(), room, &mut other), MuslinStatus::Checksum);
        assert_eq!(muslin_open(good.start(), length, memory.start(), room - 32, &mut other), MuslinStatus::Memory);
        assert_eq!(muslin_hash(cloth), hash, "the cloth in the memory is as before");
        assert_eq!(muslin_go_back(cloth, kept.as_ptr(), size), MuslinStatus::Ok);
    }
}

#[test]
fn every_refusal_has_words() {
    let own = simulation(CELLS);
    let Opened { cloth, scene: _scene, memory: _memory } = open(&cook(&own, ROOM)).expect("it opens");
    // SAFETY: the handle is open.
    unsafe {
        assert_eq!(muslin_attach(cloth, 9_999, 0), MuslinStatus::NoVertex);
        assert_eq!(
            error(cloth),
            LiveError::NoVertex { vertex: 9_999, count: own.positions().len() as u32 }.to_string()
        );
        let mut short = [1_u8; 6];
        assert!(muslin_error(cloth, short.as_mut_ptr().cast(), 6) > 6);
        assert_eq!(short, *b"there\0");
        assert_eq!(muslin_move_to(cloth, 0, [f64::NAN; 3].as_ptr(), 0.0), MuslinStatus::NotFinite);
        assert_eq!(muslin_move_to(cloth, 0, null(), 0.0), MuslinStatus::NullPointer);
    }
    let mut all: Vec<_> = MuslinStatus::ALL.iter().map(|&status| words(status)).collect();
    assert!(all.iter().all(|text| text.len() > 5));
    all.sort();
    all.dedup();
    assert_eq!(all.len(), MuslinStatus::ALL.len(), "each has words of its own");
}

/// Calls of the interface take less than a hundredth of a step of 1,000 vertices. Prints the times.
#[test]
#[ignore = "a command of its own"]
fn long_form_time_of_calls() {
    let own = simulation(30);
    let Opened { cloth, scene: _scene, memory: _memory } =
        open(&cook(&own, Room { pairs: 60_000, contacts: 6_000, ..ROOM })).expect("it opens");
    // SAFETY: the handle is open, and all pointers name numbers of this test.
    unsafe {
        let mut vertices = 0;
        muslin_positions(cloth, &mut vertices);
        let mut count = 0;
        let time = |calls: u32, act: &mut dyn FnMut()| {
            let start = Instant::now();
            (0..calls).for_each(|_| act());
            start.elapsed().as_secs_f64() / f64::from(calls)
        };
        let step = time(100, &mut || assert_eq!(muslin_step(cloth, null(), null_mut()), MuslinStatus::Ok));
        println!("{vertices} vertices: a step takes {:.1} us", step * 1e6);
        let pose = MuslinPose { position: [0.0, -0.106, 0.0], rotation: [0.0, 0.0, 0.0, 1.0] };
        let mut out = std::mem::zeroed::<MuslinImpulse>();
        let mut point = std::mem::zeroed::<MuslinPoint>();
        let mut hit = MuslinHit::default();
        let mut touches = vec![std::mem::zeroed::<MuslinTouch>(); 500];
        let mut calls: [(&str, &mut dyn FnMut()); 9] = [
            ("positions", &mut || _ = black_box(muslin_positions(cloth, null_mut()))),
            ("normals", &mut || _ = black_box(muslin_normals(cloth, null_mut()))),
            ("move_collider", &mut || _ = muslin_move_collider(cloth, 0, &pose, 0.005)),
            ("take_impulse", &mut || _ = muslin_take_impulse(cloth, 0, &mut out)),
            ("move_to", &mut || _ = muslin_move_to(cloth, 0, [-0.15, 0.0, -0.15].as_ptr(), 0.005)),
            ("push", &mut || _ = muslin_push(cloth, 9, [0.0; 3].as_ptr())),
            ("point", &mut || _ = muslin_point(cloth, 3, [0.3; 3].as_ptr(), &mut point)),
            ("hit", &mut || _ = muslin_hit(cloth, [0.0, 1.0, 0.0].as_ptr(), [0.0, -1.0, 0.0].as_ptr(), &mut hit)),
            ("touches", &mut || _ = muslin_touches(cloth, touches.as_mut_ptr(), 500, &mut count)),
        ];
        for (name, call) in &mut calls {
            let taken = time(1_000, call);
            println!("{name:>14}: {:8.3} us, {:.3} % of a step", taken * 1e6, 100.0 * taken / step);
        }
    }
}
