//! A belt over a drum, with a heavy and a light end.

use core::f64::consts::PI;

/// Radius of the drum, m: its axis lies along z.
const DRUM: f64 = 0.05;
const THICKNESS: f64 = 0.002;
/// Length of the heavier end, m, from the side of the drum downward.
pub const HEAVY_END: f64 = 0.5;

/// A ribbon or a drum, as a mesh.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// m.
    pub positions: Vec<[f64; 3]>,
    /// m; empty for a drum.
    pub uvs: Vec<[f64; 2]>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// A drum with `sides` sides, around the z axis.
pub fn drum(sides: u32) -> Mesh {
    let mut drum = Mesh::default();
    for side in 0..sides {
        let (sine, cosine) = (2.0 * PI * f64::from(side) / f64::from(sides)).sin_cos();
        drum.positions.extend([-0.2, 0.2].map(|z| [DRUM * cosine, DRUM * sine, z]));
        let [a, b] = [2 * side, 2 * ((side + 1) % sides)];
        drum.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
    }
    drum
}

/// A ribbon over the drum; its lighter end hangs on the left and has the length `light_end`, m. Its rows of vertices
/// are about `spacing` apart, m.
pub fn belt(light_end: f64, spacing: f64) -> Mesh {
    const ACROSS: usize = 4;
    let radius = DRUM + THICKNESS + 1e-5;
    let length = light_end + PI * radius + HEAVY_END;
    let rows = (length / spacing) as usize;
    let place = |s: f64| {
        let angle = (s - light_end) / radius;
        if angle < 0.0 {
            [-radius, s - light_end]
        } else if angle < PI {
            [-radius * angle.cos(), radius * angle.sin()]
        } else {
            [radius, -(s - light_end - PI * radius)]
        }
    };
    let mut belt = Mesh::default();
    for row in 0..=rows {
        let s = length * row as f64 / rows as f64;
        let [x, y] = place(s);
        for k in 0..ACROSS {
            let z = 0.04 * k as f64 / (ACROSS - 1) as f64 - 0.02;
            belt.positions.push([x, y, z]);
            belt.uvs.push([z, s]);
        }
    }
    for cell in (0..rows * ACROSS).filter(|cell| cell % ACROSS < ACROSS - 1) {
        let [a, b, c, d] = [cell, cell + 1, cell + ACROSS, cell + ACROSS + 1].map(|v| v as u32);
        belt.triangles.extend([[a, b, c], [b, d, c]]);
    }
    belt
}

/// Acceleration of gravity, m/s^2.
const GRAVITY: f64 = 9.81;

/// Tension behind the drum, divided by the mass per length, of an inextensible belt that slips or is about to. Over the
/// drum it grows by `dT / da = mu N + R (dv / dt + g cos a)` with `N = T + R g sin a - v^2` [Euler 1769].
fn tension_behind(friction: f64, light_end: f64, speed: f64, acceleration: f64) -> f64 {
    const PARTS: usize = 1000;
    let (radius, part) = (DRUM + THICKNESS, PI / PARTS as f64);
    let growth = |tension: f64, angle: f64| {
        let pressure = (tension + radius * GRAVITY * angle.sin() - speed * speed).max(0.0);
        friction * pressure + radius * (acceleration + GRAVITY * angle.cos())
    };
    (0..PARTS).fold(light_end * (GRAVITY + acceleration), |tension, k| {
        let middle = part * (k as f64 + 0.5);
        tension + part * growth(tension + 0.5 * part * growth(tension, middle), middle)
    })
}

/// Length of the lighter end at which the belt just holds, m.
pub fn holding_end(friction: f64) -> f64 {
    let (mut low, mut high) = (0.0, HEAVY_END);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        let slips = tension_behind(friction, middle, 0.0, 0.0) < HEAVY_END * GRAVITY;
        if slips { low = middle } else { high = middle }
    }
    high
}

/// How far an inextensible belt slips in a time, s, from rest, m.
pub fn slips(friction: f64, light_end: f64, seconds: f64) -> f64 {
    const STEP: f64 = 1e-4;
    let (mut way, mut speed) = (0.0, 0.0);
    for _ in 0..(seconds / STEP).round() as usize {
        // The pull of the heavy end less the tension that holds it. It is linear in the acceleration as long as the
        // belt presses everywhere.
        let pull = |acceleration: f64| {
            (HEAVY_END + way) * (GRAVITY - acceleration)
                - tension_behind(friction, light_end - way, speed, acceleration)
        };
        let (at_rest, at_one) = (pull(0.0), pull(1.0));
        speed += STEP * at_rest / (at_rest - at_one);
        way += STEP * speed;
    }
    way
}

/// The drum as a capsule, for [`hanging`].
pub const ROUND: &str = "shape = \"capsule\"\na = [0, 0, -0.2]\nb = [0, 0, 0.2]\nradius = 0.05";

/// How long the lighter end is held, s. A belt that were let go at once would slip under waves of tension, which change
/// its way by half.
pub const HELD: f64 = 0.2;

/// The scene of the mesh "belt" over a drum, with a coefficient of friction, a stiffness (N/m) and an `[integrator]`
/// table. Its lighter end is [`HELD`], so that the belt takes up its weight.
pub fn hanging(friction: f64, stiffness: f64, integrator: &str, drum: &str) -> String {
    let damping = 0.02 / stiffness;
    format!(
        r#"
        name = "belt"
        duration = 0.4
        frame_rate = 10
        gravity = [0.0, -9.81, 0.0]
        [contact]
        thickness = {THICKNESS:?}
        friction = {friction:?}
        {integrator}
        [[cloth]]
        mesh = "belt"
        rest = "uv"
        uv_scale = 1.0
        density = 0.2
        stretch = {{ model = "membrane", stiffness = {stiffness:?}, damping = {damping:?} }}
        shear = {{ stiffness = 30.0 }}
        bend = {{ model = "hinge", rigidity = 1e-6 }}
        [[cloth.pin]]
        select = {{ vertices = [0, 1, 2, 3] }}
        until = {HELD:?}
        [[collider]]
        {drum}
        "#
    )
}

/// The scene of a belt that hangs over the drum on both sides, with a load at each end, N. Both ends of its
/// mesh are 0.5 m long.
pub fn loaded(friction: f64, stiffness: f64, loads: [f64; 2], step: f64) -> String {
    let vertices = belt(HEAVY_END, 0.0068).positions.len() as u32;
    let load = |first: u32, newton: f64| {
        let row = [first, first + 1, first + 2, first + 3];
        format!("[[cloth.load]]\nselect = {{ vertices = {row:?} }}\nforce = [0, {:?}, 0]\n", -newton)
    };
    format!(
        r#"
        name = "loaded"
        duration = 1.0
        frame_rate = 10
        gravity = [0.0, 0.0, 0.0]
        [contact]
        thickness = {THICKNESS:?}
        friction = {friction:?}
        [drag]
        linear = 0.5
        [integrator]
        method = "backward-euler"
        step = {step:?}
        [[cloth]]
        mesh = "belt"
        rest = "uv"
        uv_scale = 1.0
        density = 0.2
        stretch = {{ model = "membrane", stiffness = {stiffness:?} }}
        shear = {{ stiffness = {:?} }}
        {}
        {}
        [[collider]]
        {ROUND}
        "#,
        0.4 * stiffness,
        load(0, loads[0]),
        load(vertices - 4, loads[1]),
    )
}

/// The scene of a belt of both ends of 0.5 m, without weight, over a drum. Pins strain its ends in 20 ms and then draw
/// it toward its heavy end with a `speed`, m/s.
pub fn drawn(friction: f64, stiffness: f64, speed: f64, drum: &str) -> String {
    let rows = belt(HEAVY_END, 0.0068).positions.len() as u32;
    let (strained, until) = (-20.0 / stiffness * HEAVY_END, 1.0);
    let pin = |first: u32, speed: f64| {
        let vertices = [first, first + 1, first + 2, first + 3];
        let end = strained + speed * (until - 0.02);
        format!(
            "[[cloth.pin]]\nselect = {{ vertices = {vertices:?} }}\n\
             motion = {{ keys = [[0, 0, 0, 0], [0.02, 0, {strained:?}, 0], [{until:?}, 0, {end:?}, 0]] }}\n"
        )
    };
    let pins = pin(0, speed) + &pin(rows - 4, -speed);
    let scene = hanging(friction, stiffness, "[integrator]\nmethod = \"backward-euler\"\nstep = 0.00025", drum);
    let (before, after) = scene.split_once("[[cloth.pin]]").expect("the scene has a pin");
    let (_, collider) = after.split_once("[[collider]]").expect("the scene has a collider");
    before.replace("-9.81", "0.0") + &pins + "[[collider]]" + collider
}

/// The colliders of a [drawn belt](DRAWN).
pub const ROUND_ONES: [&str; 2] =
    ["shape = \"capsule\"\na = [0, 0, -0.2]\nb = [0, 0, 0.2]", "shape = \"sphere\"\ncenter = [0, 0, 0]"];

/// A belt over a COLLIDER of radius 0.1 m, whose one end is drawn down and whose other end is loaded with 1 N.
pub const DRAWN: &str = r#"
    name = "drawn"
    duration = 3.0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.6, 0.03], cells = [60, 2] }
    position = [0.0, 0.1055, 0.0]
    density = 0.1
    stretch = { model = "membrane", stiffness = 3000.0, damping = 0.001 }
    shear = { stiffness = 1000.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
    pin = [{ select = { edge = "left" }, motion = { keys = [[0, 0, 0, 0], [1, 0.19, -0.25, 0]] } }]
    load = [{ select = { edge = "right" }, force = { keys = [[0, 0, -0.05, 0], [1, 0, -1, 0]] } }]
    [[collider]]
    COLLIDER
    radius = 0.1
    [contact]
    thickness = 0.004
    friction = FRICTION
    self = false
    [drag]
    linear = 0.2
"#;
