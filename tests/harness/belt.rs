//! A belt over a drum, with a heavy and a light end.

use core::f64::consts::PI;

/// Radius of the drum, m: its axis lies along z.
const DRUM: f64 = 0.05;
const THICKNESS: f64 = 0.002;
/// Length of the heavier end, m, from the side of the drum downward.
const HEAVY_END: f64 = 0.5;

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

/// A ribbon over the drum; its lighter end hangs on the left and has the length `light_end`, m.
pub fn belt(light_end: f64) -> Mesh {
    const ACROSS: usize = 4;
    let radius = DRUM + THICKNESS + 1e-5;
    let length = light_end + PI * radius + HEAVY_END;
    let rows = (length / 0.012) as usize;
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

/// Length of the lighter end at which the belt just holds, m. The tension T, divided by the weight per length,
/// grows over the drum by `dT / da = mu (T + R sin a) + R cos a` [Euler 1769], which includes the belt's own
/// weight.
pub fn holding_end(mu: f64) -> f64 {
    const STEPS: usize = 4000;
    let radius = DRUM + THICKNESS;
    let slips = |light_end: f64| {
        let part = PI / STEPS as f64;
        let grow = |tension: f64, k: usize| {
            let (sine, cosine) = (part * (k as f64 + 0.5)).sin_cos();
            tension + part * (mu * (tension + radius * sine) + radius * cosine)
        };
        (0..STEPS).fold(light_end, grow) < HEAVY_END
    };
    let (mut low, mut high) = (0.0, HEAVY_END);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if slips(middle) { low = middle } else { high = middle }
    }
    high
}

/// The drum as a capsule, for [`hanging`].
pub const ROUND: &str = "shape = \"capsule\"\na = [0, 0, -0.2]\nb = [0, 0, 0.2]\nradius = 0.05";

/// The scene of the mesh "belt" over a drum, with a coefficient of friction and an `[integrator]` table.
pub fn hanging(friction: f64, integrator: &str, drum: &str) -> String {
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
        stretch = {{ model = "membrane", stiffness = 100.0, damping = 0.0002 }}
        shear = {{ stiffness = 30.0 }}
        bend = {{ model = "hinge", rigidity = 1e-6 }}
        [[collider]]
        {drum}
        "#
    )
}
