//! A step allocates nothing: all columns are allocated when a scene is built, and their size is within the
//! bounds that the manual states.
//!
//! Run: `cargo test -p muslin-tests --test allocation`.

use harness::kit::single as kit;
use muslin_core::integrate::{Method, Preconditioner};
use muslin_core::simulation::Simulation;
use muslin_core::work_done::WorkDone;

/// Every force term in one small scene.
const SCENE: &str = r#"
name = "all terms"
duration = 1.0
gravity = [0.0, -9.81, 0.0]
drag = { linear = 0.1, wind = { velocity = [1.0, 0.0, 2.0], normal = 0.5 } }
integrator = { step = 0.0005 }

[[cloth]]
grid = { size = [0.5, 0.5], cells = [12, 14] }
density = 0.2
stretch = { model = "membrane", stiffness = 100.0, damping = 0.0001 }
shear = { stiffness = 50.0 }
bend = { model = "hinge", rigidity = 1e-5, damping = 0.0001 }
pin = [{ select = { corners = [0, 1] }, motion = { turn = { axis = [0, 1, 0], rate = 1.0 } } }]
seam = [{ pairs = [[0, 5], [3, 9]], stiffness = 1.0 }]

[[cloth]]
grid = { size = [0.5, 0.5], cells = [9, 9], pattern = "alternating" }
position = [0.0, 1.0, 0.0]
density = 0.2
stretch = { model = "spring", stiffness = 100.0 }
bend = { model = "spring", stiffness = 0.1 }
"#;

#[test]
fn a_step_allocates_nothing() {
    for method in Method::ALL {
        for (newton, preconditioner) in [(1, Preconditioner::TwoLevel), (4, Preconditioner::BlockJacobi)] {
            let mut scene = kit::scene(SCENE);
            scene.integrator.method = method;
            scene.integrator.newton = newton;
            scene.integrator.preconditioner = preconditioner;
            let mut cloth = Simulation::new(&scene, &[]).expect("the scene of this test builds");
            cloth.measure_work(WorkDone::default());
            cloth.measure_reactions();
            let counted = allocation_counter::measure(|| {
                for _ in 0..4 {
                    cloth.take_step().expect("the scene of this test stays finite");
                }
            });
            assert_eq!(
                counted.count_total,
                0,
                "{} with {newton} Newton iterations allocated {} times, {} bytes; find the call with a debugger on \
                 the allocator and give its column to Scratch",
                method.name(),
                counted.count_total,
                counted.bytes_total
            );
        }
    }
}

/// A sheet that falls onto a ball, a plane and itself.
const TOUCHING: &str = r#"
name = "touching"
duration = 1.0
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.2, 0.2], cells = [12, 12] }
density = 0.2
stretch = { model = "membrane", stiffness = 50.0 }
shear = { stiffness = 10.0 }
bend = { model = "hinge", rigidity = 1e-6 }

[contact]
thickness = 0.004
friction = 0.3

[[collider]]
shape = "sphere"
center = [0.0, -0.06, 0.0]
radius = 0.05

[[collider]]
shape = "plane"
point = [0.0, -0.08, 0.0]
normal = [0.0, 1.0, 0.0]

[integrator]
step = 0.0004
"#;

/// A second run from the same start needs no more capacity than the first one has allocated.
#[test]
fn a_step_with_contact_allocates_nothing_once_there_is_room() {
    for method in [Method::SymplecticEuler, Method::BackwardEuler, Method::Bdf2] {
        let mut scene = kit::scene(TOUCHING);
        scene.integrator.method = method;
        scene.integrator.step = Some(if method.is_implicit() { 0.005 } else { 0.0004 });
        let mut cloth = Simulation::new(&scene, &[]).expect("the scene of this test builds");
        cloth.measure_work(WorkDone::default());
        cloth.measure_reactions();
        let (start, steps) = (cloth.clone(), (0.25 / scene.timing().step) as u32);
        let run = |cloth: &mut Simulation| {
            (0..steps).for_each(|_| cloth.take_step().expect("the scene of this test stays finite"));
        };
        run(&mut cloth);
        assert!(cloth.contact_statistics().proximity > 1000, "{}: hardly anything touches", method.name());
        assert!(
            cloth.restore(&start.state(), start.statistics(), start.contact_statistics()),
            "a simulation restores its own start"
        );
        let counted = allocation_counter::measure(|| run(&mut cloth));
        assert_eq!(
            counted.count_total,
            0,
            "{} allocated {} times, {} bytes; find the call with a debugger on the allocator and give its column to \
             ContactScratch",
            method.name(),
            counted.count_total,
            counted.bytes_total
        );
    }
}

/// A motion that no step can follow: a pinned edge is moved through the plane.
const REFUSED: (&str, &str) = (
    "bend = { model = \"hinge\", rigidity = 1e-6 }",
    "bend = { model = \"hinge\", rigidity = 1e-6 }\npin = [{ select = { edge = \"left\" }, motion = { keys = [[0, 0, 0, 0], \
     [0.1, 0, -0.2, 0]] } }]",
);

/// A motion that needs halved steps: in one step the ball moves farther than the search distance of the cloth
/// it pushes. At which speed, in m/s, depends on the method.
const SPEEDS: [u32; 6] = [40, 50, 60, 70, 80, 100];

fn fast(speed: u32) -> String {
    let motion = format!("radius = 0.05\nmotion = {{ keys = [[0, 0, 0, 0], [1, 0, {speed}, 0]] }}");
    TOUCHING.replace("thickness = 0.004", "thickness = 0.0001").replace("radius = 0.05", &motion)
}

/// Runs a simulation up to its first step that is taken in halves, and returns its state before that step. Returns
/// `None` if no step is taken in halves or a step fails.
fn before_halves(mut cloth: Simulation) -> Option<Simulation> {
    while cloth.time() < 0.2 {
        let before = cloth.clone();
        cloth.take_step().ok()?;
        if cloth.contact_statistics().rejected > 0 {
            return Some(before);
        }
    }
    None
}

/// A second sheet that almost touches the first: only an exact test at the end of the step can decide its
/// pairs.
const NEARLY: (&str, &str) = (
    "[contact]",
    "[[cloth]]\ngrid = { size = [0.2, 0.2], cells = [12, 12] }\nposition = [0.003, 1e-8, 0.007]\ndensity = 0.2\n\
     stretch = { model = \"membrane\", stiffness = 50.0 }\n\n[contact]",
);

/// Counts the allocations of a second run of one or several steps; the first run provides the capacity.
fn allocated(cloth: &mut Simulation, what: &str, run: impl Fn(&mut Simulation)) {
    let start = cloth.clone();
    run(cloth);
    assert!(
        cloth.restore(&start.state(), start.statistics(), start.contact_statistics()),
        "a simulation restores its own start"
    );
    let counted = allocation_counter::measure(|| run(cloth));
    assert_eq!(
        counted.count_total, 0,
        "{what}: allocated {} times, {} bytes",
        counted.count_total, counted.bytes_total
    );
}

/// Tests a step that is refused, one that is taken in halves, and one whose end is tested exactly.
#[test]
fn a_step_that_is_taken_back_allocates_nothing() {
    for method in [Method::SymplecticEuler, Method::BackwardEuler, Method::Bdf2] {
        let build = |text: &str| {
            let mut scene = kit::scene(text);
            scene.integrator.method = method;
            scene.integrator.step = Some(if method.is_implicit() { 0.005 } else { 0.0004 });
            Simulation::new(&scene, &[]).expect("the scene of this test builds")
        };
        let (name, taken) = (method.name(), "the step is taken");

        let mut refused = build(&TOUCHING.replace(REFUSED.0, REFUSED.1));
        while refused.take_step().is_ok() {
            assert!(refused.time() < 0.2, "{name}: pins led through a plane are not refused");
        }
        allocated(&mut refused, &format!("{name}, refused"), |cloth| {
            assert!(cloth.take_step().is_err(), "{name}: refused once, then taken");
        });

        let mut before = SPEEDS
            .iter()
            .find_map(|&speed| before_halves(build(&fast(speed))))
            .unwrap_or_else(|| panic!("{name}: no step is taken in halves"));
        allocated(&mut before, &format!("{name}, halved"), |cloth| cloth.take_step().expect(taken));

        let mut nearly = build(&TOUCHING.replace(NEARLY.0, NEARLY.1));
        allocated(&mut nearly, &format!("{name}, nearly touching"), |cloth| {
            (0..10).for_each(|_| cloth.take_step().expect(taken));
        });
        assert!(
            nearly.contact_statistics().touching > 0,
            "{name}: no end was tested exactly, {:?}",
            nearly.contact_statistics()
        );
    }
}

macro_rules! estimates {
    ($module:ident, $core:ident) => {
        mod $module {
            use $core::integrate::Scheme;
            use $core::scene;
            use $core::simulation::Simulation;

            /// The largest number of bytes that the build takes at once, and the estimate.
            pub fn bytes(text: &str) -> [f64; 2] {
                let desc = harness::kit::$module::scene(text);
                let own = &desc.integrator;
                let scheme = Scheme {
                    newton: own.newton,
                    preconditioner: own.preconditioner,
                    error: own.error().map(|error| error as _),
                    ..Scheme::fixed(own.method, 1e-4)
                };
                let counted = allocation_counter::measure(|| {
                    let built = scene::build(&desc, &[]).expect("the scene of this test builds");
                    drop(Simulation::from_columns(built, scheme, 0.01));
                });
                let needed = scene::memory(&desc, &[]).expect("the scene of this test is small");
                [counted.bytes_max as f64, needed.bytes as f64]
            }
        }
    };
}

estimates!(single, muslin_core);
estimates!(double, muslin_core_f64);

/// The estimate of memory is at least what the build takes, so that a scene that passes has room, and at most twice as
/// much, so that a scene that has room passes.
#[test]
fn the_estimate_of_memory_is_one_to_two_times_what_the_build_takes() {
    let meshes = [
        "grid = { size = [1.0, 1.0], cells = [46, 46] }",
        "grid = { size = [1.0, 1.0], cells = [46, 46], pattern = \"alternating\" }",
        "tube = { radius = 0.3, height = 1.0, cells = [46, 46] }",
        "disc = { radius = 0.3, rings = 23 }",
    ];
    let membrane = "stretch = { model = \"membrane\", stiffness = 100.0 }\nshear = { stiffness = 1.0 }";
    let hinges = "bend = { model = \"hinge\", rigidity = 1e-5, damping = 0.1 }";
    let springs = "stretch = { model = \"spring\", stiffness = 100.0 }";
    let bend_springs = "bend = { model = \"spring\", stiffness = 1.0 }";
    let wind = "drag = { wind = { velocity = [1.0, 0.0, 0.0], normal = 1.0 } }\n";
    let materials = [
        ("", String::new()),
        ("", springs.into()),
        ("", format!("{springs}\n{bend_springs}")),
        ("", membrane.into()),
        ("", hinges.into()),
        ("", format!("{membrane}\n{hinges}")),
        (wind, format!("{membrane}\n{hinges}")),
    ];
    let methods = [
        "method = \"rk4\"",
        "method = \"backward-euler\"\nstep = 0.01",
        "method = \"backward-euler\"\nstep = 0.01\npreconditioner = \"block-jacobi\"",
        "method = \"bdf2\"\nerror = 0.001\nnewton = 4",
    ];
    for mesh in meshes {
        for (air, material) in &materials {
            for method in methods {
                for contact in ["", "contact = { thickness = 0.002 }\n"] {
                    let text = format!(
                        "name = \"sheet\"\nduration = 1.0\n{air}{contact}[integrator]\n{method}\n[[cloth]]\n{mesh}\n\
                         density = 0.2\n{material}"
                    );
                    for (precision, [taken, estimate]) in [("f32", single::bytes(&text)), ("f64", double::bytes(&text))]
                    {
                        assert!(
                            (1.0..=2.0).contains(&(estimate / taken)),
                            "{precision}: estimated {estimate}, taken {taken} bytes: {text}"
                        );
                    }
                }
            }
        }
    }
}

/// Bytes per particle of a scene's columns.
fn bytes_per_particle(text: &str) -> f64 {
    let scene = kit::scene(text);
    let cloth = Simulation::new(&scene, &[]).expect("the scene of this test builds");
    cloth.bytes() as f64 / cloth.positions().len() as f64
}

#[test]
fn a_spring_cloth_takes_less_than_400_bytes_a_particle() {
    let bytes = bytes_per_particle(
        "name = \"springs\"\nduration = 1.0\n[[cloth]]\ngrid = { size = [1.0, 1.0], cells = [100, 100] }\n\
         density = 0.2\nstretch = { model = \"spring\", stiffness = 100.0 }\n\
         [integrator]\nmethod = \"symplectic-euler\"\n",
    );
    assert!(bytes < 400.0, "{bytes} bytes a particle; Simulation::bytes lists the columns");
}

#[test]
fn membrane_hinges_and_the_solver_take_less_than_2_kb_a_particle() {
    let hanging = muslin_core::scene::BUILT_IN.iter().find(|(name, _)| *name == "hanging");
    let bytes = bytes_per_particle(hanging.expect("hanging is built in").1);
    assert!(bytes < 2048.0, "{bytes} bytes a particle; Simulation::bytes lists the columns");
}
