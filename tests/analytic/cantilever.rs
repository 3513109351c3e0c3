//! The heavy cantilever [Romero 2021]: a strip that is clamped horizontally bends under its weight into a shape
//! that depends only on Gamma = w L^3 / D.
//!
//! The strip is one row of equilateral triangles, so that it bends as a cylinder. It has no hinges along its
//! length; in a wide sheet these contribute a ninth of the rigidity. The hinge model is a plate with a Poisson
//! ratio of -1/3, so a narrow strip has the rigidity D (1 - 1/9). The free length begins at the last but one
//! held vertex, from which the first hinge at the clamp bends.

use glam::DVec3;
use harness::kit::double as kit;
use harness::net::{converged, settle};
use muslin_core_f64::integrate::Method;
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::simulation::Simulation;

/// Weight per area, N/m^2, and free length, m.
const WEIGHT: f64 = 0.2 * 9.81;
pub const LENGTH: f64 = 0.2;

/// A strip of so many cells with the free length [`LENGTH`].
pub struct Strip {
    cells: u32,
    edge: f64,
    /// Its length with the clamp, m.
    long: f64,
    /// Its width, m.
    pub wide: f64,
}

impl Strip {
    pub fn new(cells: u32) -> Self {
        let edge = LENGTH / (f64::from(cells) - 0.5);
        Self { cells, edge, long: edge * f64::from(cells), wide: edge * 0.75f64.sqrt() }
    }

    /// The clamped strip. It bends with `rigidity`, N m; `scene` and `cloth` are further keys.
    pub fn build(&self, rigidity: f64, stiffness: f64, scene: &str, cloth: &str) -> BuiltScene {
        let Self { cells, edge, long, wide } = self;
        // Pins the first triangle.
        let clamp = -0.5 * long + 1.25 * edge;
        kit::build(&format!(
            r#"
            duration = 1.0
            {scene}
            [[cloth]]
            grid = {{ size = [{long}, {wide}], cells = [{cells}, 1] }}
            density = 0.2
            stretch = {{ model = "membrane", stiffness = {stiffness} }}
            shear = {{ stiffness = {stiffness} }}
            bend = {{ model = "hinge", rigidity = {} }}
            pin = [{{ select = {{ box = [[-9.0, -9.0, -9.0], [{clamp}, 9.0, 9.0]] }} }}]
            {cloth}"#,
            rigidity / (1.0 - 1.0 / 9.0)
        ))
    }

    /// Drop and reach of a point, divided by the free length.
    pub fn shape(&self, end: DVec3) -> [f64; 2] {
        [-end.y / LENGTH, (end.x + 0.5 * self.long - 0.5 * self.edge) / LENGTH]
    }
}

/// Drop and reach of the tip, divided by the free length, and the largest stretch minus one.
fn drape(gamma: f64, cells: u32) -> ([f64; 2], f64) {
    let (strip, rigidity) = (Strip::new(cells), WEIGHT * LENGTH.powi(3) / gamma);
    let built = strip.build(rigidity, 2e5 * WEIGHT * LENGTH, "gravity = [0.0, -9.81, 0.0]", "");
    let tip: Vec<_> =
        (0..built.particles.positions.len()).filter(|&i| built.particles.positions[i].x > 0.499 * strip.long).collect();
    let mut sim = Simulation::from_columns(built, converged(Method::BackwardEuler, 1e-6), 0.2);
    settle(&mut sim, 1e-6, 200);
    let end = tip.iter().map(|&i| sim.positions()[i]).sum::<DVec3>() / tip.len() as f64;
    (strip.shape(end), sim.stretch().max - 1.0)
}

/// Gamma, then drop and reach of the tip, divided by the length.
const TRUTH: [(f64, [f64; 2]); 3] =
    [(5.0, [0.49590504, 0.84665718]), (10.0, [0.70019972, 0.65635376]), (50.0, [0.90791712, 0.24501476])];

#[test]
fn strip_drapes_by_gamma() {
    for (gamma, truth) in TRUTH {
        // The strip turns down over the length L / sqrt(Gamma), which holds more than ten edges.
        let (shape, stretch) = drape(gamma, 75);
        for (what, got, want) in [
            ("H/L", shape[0], truth[0]),
            ("W/L", shape[1], truth[1]),
            ("H/W", shape[0] / shape[1], truth[0] / truth[1]),
        ] {
            let error = got / want - 1.0;
            println!("Gamma {gamma}: {what} {got:.6}, expected {want:.6}, error {:.3} %", 100.0 * error);
            assert!(error.abs() <= 0.01, "Gamma {gamma}: {what} is {got}, expected {want} within 1 %");
        }
        assert!(stretch < 1e-4, "Gamma {gamma}: stretched by {stretch:e}, the truth does not stretch");
    }
}

#[test]
fn strip_drapes_at_second_order() {
    for (gamma, truth) in TRUTH {
        let errors = [10, 20, 40].map(|cells| drape(gamma, cells).0[0] - truth[0]);
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        println!("Gamma {gamma}: H/L orders {orders:.3?}, errors {errors:?}");
        let second = orders.iter().all(|p| (p - 2.0).abs() <= 0.1);
        assert!(
            second,
            "Gamma {gamma}: H/L of 10, 20, 40 cells has orders {orders:.3?}, expected 2; errors {errors:?}"
        );
    }
}

/// Tip of a plate that bends as a cylinder under its weight, over w L^4 / (8 D); its last two rows are pinned, and L is
/// counted from the middle between them, or from the inner one. All vertices of a row are sewn together in y.
fn clamped(rows: u32) -> [f64; 2] {
    const ACROSS: u32 = 4;
    const GRAVITY: f64 = 1e-4;
    let row = 1.0 / f64::from(rows);
    let wide = f64::from(ACROSS) * row / 0.75f64.sqrt();
    let grid = format!("grid = {{ size = [{wide:?}, 1.0], cells = [{ACROSS}, {rows}] }}");
    let flat = kit::build(&format!("name = \"flat\"\nduration = 0\n[[cloth]]\n{grid}\ndensity = 1.0"));
    let rest = kit::positions(&flat);
    let beside: Vec<_> =
        (1..rest.len()).filter(|&v| rest[v].z - rest[v - 1].z < 0.5 * row).map(|v| [v - 1, v]).collect();
    let built = kit::build(&format!(
        r#"
        name = "clamped"
        duration = 1.0
        gravity = [0.0, -{GRAVITY:?}, 0.0]
        [[cloth]]
        {grid}
        density = 1.0
        bend = {{ model = "hinge", rigidity = 1.0 }}
        pin = [
            {{ select = {{ box = [[-9, -9, -9], [9, 9, {:?}]] }} }},
            {{ select = {{ box = [[-9, -9, -9], [9, 9, 9]] }}, axes = "xz" }},
        ]
        seam = [{{ pairs = {beside:?}, stiffness = {:?} }}]
        "#,
        1.5 * row - 0.5,
        1e4 / (row * row),
    ));
    let mut sim = Simulation::from_columns(built, converged(Method::BackwardEuler, 1e-10), 1e4);
    settle(&mut sim, 1e-12, 100);
    let drop = -sim.positions().last().expect("a sheet has vertices").y;
    [0.5, 1.0].map(|part| 8.0 * drop / (GRAVITY * (1.0 - part * row).powi(4)))
}

#[test]
fn two_pinned_rows_clamp_in_the_middle_between_them() {
    for rows in [20, 40] {
        let [middle, inner] = clamped(rows).map(|ratio| ratio - 1.0);
        println!("{rows} rows: the drop is off by {middle:.4} from the middle, by {inner:.4} from the inner row");
        let bound = 2.0 / f64::from(rows * rows);
        assert!(
            middle.abs() < bound,
            "{rows} rows: counted from the middle the drop is off by {middle}, bound {bound}"
        );
        let wrong = 1.5 / f64::from(rows);
        assert!(inner > wrong, "{rows} rows: counted from the inner row the drop is off by {inner} only");
    }
}
