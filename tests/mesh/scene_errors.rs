//! Every way in which a scene cannot be built, and its error message: each case is a valid scene with one line
//! exchanged.

use harness::kit::double as kit;
use muslin_core_f64::error::{SceneError, SelectError};
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::scene::{Content, PointCache, build, memory};

const GOOD: &str = r#"
    name = "good"
    duration = 1.0
    frame_rate = 30
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [1.0, 2.0], cells = [2, 3] }
    rest = "shape"
    uv_scale = 1.0
    position = [0.0, 1.0, 0.0]
    rotation = [0.0, 90.0, 0.0]
    scale = 1.0
    density = 0.2
    stretch = { model = "membrane", stiffness = 90.0, damping = 0.0 }
    shear = { stiffness = 30.0, damping = 0.0 }
    bend = { model = "hinge", rigidity = 1e-3, damping = 0.0 }
    pin = [{ select = { corners = [0] }, axes = "xyz", motion = { keys = [[0.0, 0, 0, 0], [1.0, 0, 1, 0]] } }]
    seam = [{ pairs = [[0, 1]], stiffness = 10.0, damping = 0.0 }]
    velocity = [0.0, 0.5, 0.0]
    spin = { axis = [0.0, 0.5, 0.0], rate = 2.0 }
    start = [{ select = { vertices = [1] }, velocity = [0.0, 0.0, 0.2] }]
    load = [{ select = { vertices = [3] }, force = [1.0, 2.0, 3.0] }]
    mass = [{ select = { vertices = [4] }, mass = 0.5 }]
    [drag]
    linear = 0.1
    wind = { velocity = [1.0, 0.0, 0.0], normal = 0.1, tangential = 0.0 }
    [contact]
    thickness = 0.002
    friction = { static = 0.4, kinetic = 0.3, stribeck = 0.1, viscous = 0.0 }
    [[collider]]
    shape = "sphere"
    center = [0.0, -1.0, 0.0]
    radius = 0.3
    motion = { keys= [[0.0, 0, 0, 0], [2.0, 0, 1, 0]] }
    [[collider]]
    shape = "plane"
    point = [0.0, -2.0, 0.0]
    normal = [0.0, 1.5, 0.0]
    [integrator]
    step = 0.01
    newton = 1
    tolerance = 1e-4
"#;

/// Text of the valid scene, the text that replaces it, and the message that follows.
type Case = (&'static str, &'static str, &'static str);

const NUMBERS: &[Case] = &[
    ("duration = 1.0", "duration = -1.0", "duration = -1: must not be negative, and must be finite"),
    ("duration = 1.0", "duration = nan", "duration = NaN: must not be negative, and must be finite"),
    ("frame_rate = 30", "frame_rate = 0", "frame_rate = 0: must be greater than zero and finite"),
    ("frame_rate = 30", "until_rest = 0.0", "until_rest = 0: must be greater than zero and finite"),
    ("gravity = [0.0, -9.81, 0.0]", "gravity = [0.0, inf, 0.0]", "gravity: must be a finite number"),
    ("gravity = [0.0, -9.81, 0.0]", "gravity = { keys = [] }", GRAVITY_KEYS),
    ("gravity = [0.0, -9.81, 0.0]", "gravity = { keys = [[0, 0, 1, 0], [0, 0, 2, 0]] }", GRAVITY_KEYS),
    ("gravity = [0.0, -9.81, 0.0]", "gravity = { keys = [[0, 0, 1, 0], [1, 0, nan, 0]] }", GRAVITY_KEYS),
    ("gravity = [0.0, -9.81, 0.0]", "gravity = { keys = [[-inf, 0, 1, 0], [1, 0, 1, 0]] }", GRAVITY_KEYS),
    ("step = 0.01", "step = 0.0", "integrator.step = 0: must be greater than zero and finite"),
    ("step = 0.01", "step = inf", "integrator.step = inf: must be greater than zero and finite"),
    ("step = 0.01", "error = -0.1", "integrator.error = -0.1: must not be negative, and must be finite"),
    ("newton = 1", "newton = 0", "integrator.newton = 0: must be greater than zero and finite"),
    ("tolerance = 1e-4", "tolerance = 10.0", "integrator.tolerance = 10: must be less than 1"),
    ("density = 0.2", "density = 1e-320", "cloth.density = 1e-320: must be greater than zero and finite"),
    (
        "position = [0.0, 1.0, 0.0]",
        "position = [1e17, 0.0, 1e17]",
        "vertices 1 and 0 are too far away: f64 rounds their positions to more than a hundredth of their distance; move all \
         cloths together and nearer to the origin, or use coarser cells or double precision",
    ),
    ("tolerance = 1e-4", "tolerance = -1e-4", "integrator.tolerance = -0.0001: must be greater than zero and finite"),
    ("linear = 0.1", "linear = -0.1", "drag.linear = -0.1: must not be negative, and must be finite"),
    ("velocity = [1.0", "velocity = [nan", "drag.wind.velocity: must be a finite number"),
    (
        "velocity = [1.0, 0.0, 0.0]",
        "velocity = { keys = [[2, 0, 0, 0], [1, 0, 0, 0]] }",
        "drag.wind.velocity: give at least one key [time, x, y, z]; all numbers must be finite, and times must increase",
    ),
    ("normal = 0.1", "normal = -2.0", "drag.wind.normal = -2: must not be negative, and must be finite"),
    ("tangential = 0.0", "tangential = -2.0", "drag.wind.tangential = -2: must not be negative, and must be finite"),
    ("density = 0.2", "density = -0.2", "cloth.density = -0.2: must be greater than zero and finite"),
    ("uv_scale = 1.0", "uv_scale = 0.0", "cloth.uv_scale = 0: must be greater than zero and finite"),
    ("    scale = 1.0", "    scale = -1.0", "cloth.scale = -1: must be greater than zero and finite"),
    ("position = [0.0", "position = [inf", "cloth.position: must be a finite number"),
    ("rotation = [0.0", "rotation = [nan", "cloth.rotation: must be a finite number"),
    ("stiffness = 90.0", "stiffness = 0.0", "cloth.stretch.stiffness = 0: must be greater than zero and finite"),
    (
        "90.0, damping = 0.0",
        "90.0, damping = -1.0",
        "cloth.stretch.damping = -1: must not be negative, and must be finite",
    ),
    ("90.0, damping = 0.0", "90.0, weft = -1.0", "cloth.stretch.weft = -1: must be greater than zero and finite"),
    ("stiffness = 30.0", "stiffness = -3.0", "cloth.shear.stiffness = -3: must not be negative, and must be finite"),
    (
        "30.0, damping = 0.0",
        "30.0, damping = -1.0",
        "cloth.shear.damping = -1: must not be negative, and must be finite",
    ),
    ("rigidity = 1e-3", "rigidity = 0.0", "cloth.bend.rigidity = 0: must be greater than zero and finite"),
    (
        "1e-3, damping = 0.0",
        "1e-3, damping = -1.0",
        "cloth.bend.damping = -1: must not be negative, and must be finite",
    ),
    ("pairs = [[0, 1]]", "pairs = []", "cloth 0, seam 0: joins no vertices; give pairs, or a file with stitch lines"),
    (
        "pairs = [[0, 1]]",
        "pairs = [[3, 3]]",
        "cloth 0: stitch 0 names a vertex that does not exist, sews a vertex to itself, or has a weight that is not \
         between 0 and 1",
    ),
    ("stiffness = 10.0", "stiffness = 0.0", "cloth.seam.stiffness = 0: must be greater than zero and finite"),
    (
        "10.0, damping = 0.0",
        "10.0, damping = -1.0",
        "cloth.seam.damping = -1: must not be negative, and must be finite",
    ),
];

const MODELS: &[Case] = &[
    (
        "stretch = { model = \"membrane\", stiffness = 90.0, damping = 0.0 }",
        "",
        "cloth.stretch is needed with model = \"membrane\"",
    ),
    ("\"membrane\"", "\"spring\"", "cloth.shear has no meaning with model = \"spring\"; remove it"),
    (
        "\"membrane\", stiffness = 90.0",
        "\"spring\", stiffness = 90.0, weft = 1.0",
        "cloth.stretch.weft has no meaning with model = \"spring\"; remove it",
    ),
    (
        "stiffness = 90.0",
        "stiffness = 90.0, per_spring = true",
        "cloth.stretch.per_spring has no meaning with model = \"membrane\"; remove it",
    ),
    ("rigidity = 1e-3, ", "", "cloth.bend.rigidity is needed with model = \"hinge\""),
    (
        "rigidity = 1e-3",
        "rigidity = 1e-3, stiffness = 1.0",
        "cloth.bend.stiffness has no meaning with model = \"hinge\"; remove it",
    ),
    ("\"hinge\"", "\"spring\"", "cloth.bend.rigidity has no meaning with model = \"spring\"; remove it"),
    ("\"hinge\", rigidity = 1e-3", "\"spring\"", "cloth.bend.stiffness is needed with model = \"spring\""),
];

const GRID: &str = "grid = { size = [1.0, 2.0], cells = [2, 3] }";

const MESHES: &[Case] = &[
    (GRID, "", "cloth 0: give exactly one of grid, tube, disc or mesh"),
    ("density", "mesh = \"m\"\ndensity", "cloth 0: give exactly one of grid, tube, disc or mesh"),
    (GRID, "mesh = \"m\"", "cloth 0: its mesh file was not loaded"),
    ("density", "state = \"s\"\ndensity", "cloth 0: its mesh file was not loaded"),
    ("pairs = [[0, 1]]", "file = \"f\"", "cloth 0: its mesh file was not loaded"),
    ("size = [1.0, 2.0]", "size = [1.0, 0.0]", "grid.size = 0: must be greater than zero and finite"),
    ("cells = [2, 3]", "cells = [0, 3]", "grid.cells: must be at least 1"),
    // Refused before memory of that size is allocated.
    ("cells = [2, 3]", "cells = [20000, 20000]", "the scene would have 400050001 vertices; at most 2^28 are possible"),
    (
        GRID,
        "tube = { radius = 1.0, height = 1.0, cells = [20001, 20000] }",
        "the scene would have 400040001 vertices; at most 2^28 are possible",
    ),
    (
        GRID,
        "disc = { radius = 1.0, rings = 20000 }",
        "the scene would have 1200060000 vertices; at most 2^28 are possible",
    ),
    (
        GRID,
        "tube = { radius = -1.0, height = 1.0, cells = [3, 1] }",
        "tube.radius = -1: must be greater than zero and finite",
    ),
    (
        GRID,
        "tube = { radius = 1.0, height = 0.0, cells = [3, 1] }",
        "tube.height = 0: must be greater than zero and finite",
    ),
    (GRID, "tube = { radius = 1.0, height = 1.0, cells = [2, 1] }", "tube.cells: must be at least 3"),
    (GRID, "tube = { radius = 1.0, height = 1.0, cells = [3, 0] }", "tube.cells: must be at least 1"),
    (GRID, "disc = { radius = 0.0, rings = 1 }", "disc.radius = 0: must be greater than zero and finite"),
    (
        GRID,
        "disc = { radius = 1.0, hole = -0.1, rings = 1 }",
        "disc.hole = -0.1: must not be negative, and must be finite",
    ),
    (
        GRID,
        "disc = { radius = 1.0, hole = 1.0, rings = 1 }",
        "disc.radius - disc.hole = 0: must be greater than zero and finite",
    ),
    (GRID, "disc = { radius = 1.0, rings = 0 }", "disc.rings: must be at least 1"),
];

const PINS: &[Case] = &[
    (
        "corners = [0]",
        "box = [[5.0, 5.0, 5.0], [6.0, 6.0, 6.0]]",
        "cloth 0, pin 0: selects no vertex; the cloth lies between [-1.0, 1.0, -0.5] and [1.0, 1.0, 0.5] m",
    ),
    ("corners = [0]", "corners = []", "cloth 0, pin 0: selects no vertex"),
    ("corners = [0]", "nearest = [nan, 0, 0]", SELECT_NUMBERS),
    ("corners = [0]", "line = { a = [0, 0, 0], b = [1, 0, 0], within = -0.1 }", SELECT_NUMBERS),
    ("corners = [0]", "line = { a = [0, 0, nan], b = [1, 0, 0], within = 0.1 }", SELECT_NUMBERS),
    ("corners = [0]", "plane = { point = [0, 0, 0], normal = [0, 0, 0], within = 0.1 }", SELECT_NUMBERS),
    (
        "corners = [0]",
        "plane = { point = [0, 9, 0], normal = [0, 1, 0], within = 0.1 }",
        "cloth 0, pin 0: selects no vertex; the cloth lies between [-1.0, 1.0, -0.5] and [1.0, 1.0, 0.5] m",
    ),
    ("corners = [0]", "ring = 1", "cloth 0, pin 0: only a disc has rings; select by border, line or plane instead"),
    ("corners = [0]", "border = false", NO_BORDER),
    ("corners = [0]", "ring = 1, border = true", ONE_SELECTION),
    ("corners = [0]", "", ONE_SELECTION),
    ("corners = [0]", "corners = [0], vertices = [1]", ONE_SELECTION),
    ("corners = [0]", "corners = [4]", "cloth 0, pin 0: there is no corner 4: the last one is 3"),
    ("corners = [0]", "vertices = [0, 99]", "cloth 0, pin 0: there is no vertex 99: the last one is 13"),
    ("axes = \"xyz\"", "from = -1.0", "cloth.pin.from = -1: must not be negative, and must be finite"),
    ("axes = \"xyz\"", "from = 2.0, until = 2.0", "cloth 0, pin 0: until must be finite and after from"),
    ("axes = \"xyz\"", "until = nan", "cloth 0, pin 0: until must be finite and after from"),
    ("axes = \"xyz\"", "axes = \"xw\"", AXES),
    ("axes = \"xyz\"", "axes = \"xx\"", AXES),
    ("axes = \"xyz\"", "axes = \"\"", AXES),
    ("[1.0, 0, 1, 0]", "[0.0, 0, 1, 0]", KEYS),
    ("[1.0, 0, 1, 0]", "[1.0, 0, nan, 0]", KEYS),
    ("keys = [", "turn = { axis = [0, 0, 0], rate = 1.0 }, keys = [", TURN),
    ("keys = [", "turn = { axis = [0, 1, 0], rate = inf }, keys = [", TURN),
    ("keys = [", "turn = { axis = [0, 1, 0], rate = 1.0, until = nan }, keys = [", TURN),
];

const GROUPS: &[Case] = &[
    ("velocity = [0.0, 0.5", "velocity = [0.0, nan", "cloth.velocity: must be a finite number"),
    ("rate = 2.0", "rate = inf", "cloth.spin: must be a finite number"),
    ("rate = 2.0", "rate = 2.0, center = [nan, 0, 0]", "cloth.spin: must be a finite number"),
    ("axis = [0.0, 0.5", "axis = [0.0, 0.0", "cloth 0: spin needs an axis with a direction"),
    (
        "vertices = [1]",
        "box = [[5, 5, 5], [6, 6, 6]]",
        "cloth 0, start 0: selects no vertex; the cloth lies between [-1.0, 1.0, -0.5] and [1.0, 1.0, 0.5] m",
    ),
    ("velocity = [0.0, 0.0, 0.2]", "velocity = [0.0, 0.0, inf]", "cloth.start.velocity: must be a finite number"),
    ("vertices = [4]", "vertices = [99]", "cloth 0, mass 0: there is no vertex 99: the last one is 13"),
    ("mass = 0.5", "mass = 0.0", "cloth.mass.mass = 0: must be greater than zero and finite"),
    ("mass = 0.5", "density = -0.3", "cloth.mass.density = -0.3: must be greater than zero and finite"),
    ("mass = 0.5", "density = 0.3, mass = 0.1", "cloth 0, mass 0: give exactly one of mass and density"),
    ("mass = 0.5", "share = \"area\"", "cloth 0, mass 0: give exactly one of mass and density"),
    ("vertices = [3]", "vertices = []", "cloth 0, load 0: selects no vertex"),
    ("force = [1.0", "force = [inf", "cloth.load.force: must be a finite number"),
    (
        "force = [1.0, 2.0, 3.0]",
        "force = { keys = [[0, 0, 0, inf]] }",
        "cloth.load.force: give at least one key [time, x, y, z]; all numbers must be finite, and times must increase",
    ),
    (
        "force = [1.0",
        "share = \"length\", force = [1.0",
        "cloth 0, load 0: share = \"length\" needs edges between the selected vertices",
    ),
];

const COLLIDERS: &[Case] = &[
    ("thickness = 0.002", "thickness = 0.0", "contact.thickness = 0: must be greater than zero and finite"),
    ("static = 0.4", "static = -0.4", "contact.friction = -0.4: must not be negative, and must be finite"),
    ("static = 0.4", "static = 0.2", "friction: static = 0.2 is below kinetic = 0.3"),
    ("stribeck = 0.1", "stribeck = 0.0", "friction.stribeck = 0: must be greater than zero and finite"),
    ("viscous = 0.0", "viscous = -1.0", "friction.viscous = -1: must not be negative, and must be finite"),
    ("radius = 0.3", "radius = 0.0", "collider.radius = 0: must be greater than zero and finite"),
    ("radius = 0.3", "", "collider 0: radius is needed with shape = \"sphere\""),
    (
        "radius = 0.3",
        "radius = 0.3\nhalf = [1, 1, 1]",
        "collider 0: half has no meaning with shape = \"sphere\"; remove it",
    ),
    ("center = [0.0, -1.0, 0.0]", "center = [0.0, nan, 0.0]", "center: must be a finite number"),
    ("normal = [0.0, 1.5, 0.0]", "normal = [0.0, 0.0, 0.0]", "collider 1: the normal of a plane needs a direction"),
    (
        "normal = [0.0, 1.5, 0.0]",
        "normal = [0.0, 1.5, 0.0]\nmotion = { turn = { axis = [1, 0, 0], rate = 1.0 } }",
        "collider 1: a plane cannot turn; take a box whose side is as large as the cloth",
    ),
    ("[2.0, 0, 1, 0]", "[-2.0, 0, 1, 0]", "collider 0: the times of motion.keys must be finite and increase"),
    (
        "keys= [[0.0, 0, 0, 0], [2.0, 0, 1, 0]]",
        "turn = { axis = [0, 0, 0], rate = 1.0 }",
        "collider 0: motion.turn needs an axis with a direction and a finite rate",
    ),
    (
        "shape = \"plane\"\n    point = [0.0, -2.0, 0.0]\n    normal = [0.0, 1.5, 0.0]",
        "shape = \"mesh\"\nfile = \"body.obj\"",
        "collider 1: its file was not loaded",
    ),
];

const ONE_SELECTION: &str =
    "cloth 0, pin 0: give exactly one of corners, vertices, box, nearest, edge, ring, border, line or plane";
const NO_BORDER: &str = "cloth 0, pin 0: border = false selects nothing; write border = true, or another selection";
const SELECT_NUMBERS: &str = "cloth 0, pin 0: the numbers of select must be finite, within must not be negative, and a \
                              normal needs a direction";
const AXES: &str = "cloth 0, pin 0: axes must be a combination of x, y and z, such as \"xz\"";
const TURN: &str = "cloth 0, pin 0: motion.turn needs an axis with a direction and a finite rate";
const KEYS: &str = "cloth 0, pin 0: the times of motion.keys must be finite and increase";

const GRAVITY_KEYS: &str =
    "gravity: give at least one key [time, x, y, z]; all numbers must be finite, and times must increase";

/// A new variant breaks this match: add a case above.
const fn has_a_case(error: &SceneError) -> bool {
    use SceneError::*;
    match error {
        NotPositive { .. } | Negative { .. } | NotFinite { .. } | KeyNotForModel { .. } | KeyNeeded { .. } => true,
        VectorKeys { .. } | NotBelowOne { .. } | TooFar { .. } | EmptySeam { .. } => true,
        SpinAxis { .. }
        | OneMass { .. }
        | OneMeshSource { .. }
        | MissingMesh { .. }
        | TooFewCells { .. }
        | TooLarge { .. } => true,
        Selection { .. }
        | PinAxes { .. }
        | MotionKeys { .. }
        | MotionTurn { .. }
        | PinEnds { .. }
        | PinsDisagree { .. } => true,
        StaticBelowKinetic { .. }
        | ErrorWithoutHalving
        | ShapeNeeds { .. }
        | NotOfShape { .. }
        | NoNormal { .. }
        | MissingColliderFile { .. }
        | ColliderMotion { .. } => true,
        // Tested below, and in `mesh_errors`.
        ColliderWithoutContact | ColliderMesh { .. } | CachePoints { .. } | Memory { .. } => true,
        NoCloth | Mesh { .. } => true,
    }
}

fn each_is_refused(cases: &[Case]) {
    for (good, bad, message) in cases {
        assert_eq!(GOOD.matches(good).count(), 1, "{good:?} must name one place of the good scene");
        let error = match build(&kit::scene(&GOOD.replace(good, bad)), &[]) {
            Err(error) => error,
            Ok(_) => panic!("built with {bad:?}, expected: {message}"),
        };
        assert_eq!(error.to_string(), *message, "for {bad:?}");
        assert!(has_a_case(&error));
    }
}

#[test]
fn the_good_scene_is_built() {
    build(&kit::scene(GOOD), &[]).expect("the good scene");
}

#[test]
fn bad_numbers_are_named() {
    each_is_refused(NUMBERS);
}

#[test]
fn keys_and_models_must_fit() {
    each_is_refused(MODELS);
}

#[test]
fn mesh_sources_are_checked() {
    each_is_refused(MESHES);
}

#[test]
fn pins_must_select_and_move_sensibly() {
    each_is_refused(PINS);
}

#[test]
fn groups_must_select_and_have_sensible_numbers() {
    each_is_refused(GROUPS);
}

#[test]
fn a_scene_needs_a_cloth() {
    let error = build(&kit::scene("name = \"bare\"\nduration = 0\ncloth = []"), &[]);
    assert_eq!(error.map(|_| ()), Err(SceneError::NoCloth));
    assert_eq!(SceneError::NoCloth.to_string(), "the scene has no [[cloth]]");
}

#[test]
fn colliders_and_contact_must_fit() {
    each_is_refused(COLLIDERS);
}

#[test]
fn colliders_need_contact() {
    let bare = GOOD.replace("thickness = 0.002", "").replace("[contact]", "").replace("friction = {", "#");
    assert_eq!(build(&kit::scene(&bare), &[]).map(|_| ()), Err(SceneError::ColliderWithoutContact));
}

/// `muslin` is run with little memory in `tests/cli/bad_scene.rs`.
#[test]
fn memory_is_told_before_it_is_taken() {
    let of = |cells: u32| {
        memory(
            &kit::scene(&format!(
                "name = \"large\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n\
             grid = {{ size = [1.0, 1.0], cells = [{cells}, {cells}], pattern = \"diagonal\" }}\n"
            )),
            &[],
        )
    };
    let needed = of(9_999).unwrap();
    assert_eq!(needed.vertices, 100_000_000);
    let error = SceneError::from(needed);
    assert!(has_a_case(&error));
    let megabytes = needed.bytes.div_ceil(1_000_000);
    assert_eq!(
        error.to_string(),
        format!(
            "the scene has 100000000 vertices and needs about {megabytes} MB of memory, more than is left; take a coarser \
             mesh"
        )
    );
    assert_eq!(of(20_000), Err(SceneError::TooLarge { vertices: 400_040_001 }));
}

/// The files of mesh colliders: an invalid mesh, and a point cache that belongs to another mesh.
#[test]
fn collider_files_must_fit() {
    let plane = "shape = \"plane\"\n    point = [0.0, -2.0, 0.0]\n    normal = [0.0, 1.5, 0.0]";
    let mesh = "shape = \"mesh\"\nfile = \"m\"\nmotion = \"c\"\nmotion_rate = 25";
    let scene = kit::scene(&GOOD.replace(plane, mesh));
    let triangle = |last| TriMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 1, last]],
        ..TriMesh::default()
    };
    let cache = Content::Cache(PointCache { points: 2, positions: vec![[0.0; 3]; 4] });
    let error = |last| {
        let files = [("m".into(), Content::Mesh(triangle(last))), ("c".into(), cache.clone())];
        build(&scene, &files).map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(error(2), "collider 1: its point cache has 2 points, its mesh 3 vertices");
    assert_eq!(error(1), "collider 1: triangle 0 names vertex 1 twice (indices count from 0)");
}

/// Cloths and pins count from 0 in the order of the file.
#[test]
fn messages_count_cloths_and_pins() {
    let two_pins = r#"
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [1, 1] }
    density = 1.0
    pin = [{ select = { edge = "left" } }, { select = { vertices = [] } }]
    [drag]"#;
    let second = GOOD.replace("[drag]", two_pins);
    let error = build(&kit::scene(&second), &[]).map(|_| ());
    assert_eq!(error, Err(SceneError::Selection { cloth: 1, part: "pin", number: 1, error: SelectError::Empty }));
}

/// Two pins with different motions for a vertex at the same time, and those without.
#[test]
fn pins_must_agree() {
    let built = |first: &str, second: &str| {
        let pins =
            format!("pin = [{{ select = {{ edge = \"left\" }}{first} }}, {{ select = {{ corners = [0] }}{second} }}]");
        let start = GOOD.find("    pin = ").expect("the good scene has a pin");
        let end = start + GOOD[start..].find('\n').expect("a line ends");
        build(&kit::scene(&format!("{}{pins}{}", &GOOD[..start], &GOOD[end..])), &[]).map(drop)
    };
    let moves = ", motion = { keys = [[0.0, 0, 0, 0], [1.0, 0, 1, 0]] }";
    let other = ", motion = { keys = [[0.0, 0, 0, 0], [1.0, 1, 0, 0]] }";
    let turns = ", motion = { turn = { axis = [0, 1, 0], rate = 1.0 } }";
    let disagree = Some(SceneError::PinsDisagree { cloth: 0, pins: [0, 1], vertex: 0 });
    for (first, second, refused) in [
        ("", "", false),
        (moves, moves, false),
        ("", moves, true),
        (moves, "", true),
        (moves, other, true),
        // About different centres.
        (turns, turns, true),
        (", axes = \"xz\"", &format!("{moves}, axes = \"y\"")[..], false),
        (", until = 0.5", &format!("{moves}, from = 0.5")[..], false),
        (", until = 0.5", &format!("{moves}, from = 0.4")[..], true),
    ] {
        let found = built(first, second);
        assert_eq!(found.as_ref().err(), disagree.as_ref().filter(|_| refused), "{first:?} and {second:?}");
    }
    let words = built("", moves).expect_err("they disagree").to_string();
    assert_eq!(
        words,
        "cloth 0: pins 0 and 1 have different motions for vertex 0 at the same time; select it in one of them, or give \
         them times (from, until) that do not overlap"
    );
}
