//! Sheets of every generator, bent by the whole core: the rigidity that strips, discs and tubes show in equilibrium.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::scene::{BuiltScene, Content};
use muslin_core_f64::simulation::Simulation;

use super::bisect::bisect;
use super::cantilever::{Hung, Sides};
use super::check::Check;
use super::elastica::drop_over_reach;
use super::lab::{self, Lab, Miss};
use super::lattice::{ROW, Strip};

/// Description in the report.
pub const ABOUT: &str = "sheets of every generator in equilibrium: the rigidity that shows in the drop of a strip, the sag \
                         and the energy of a disc and the frequency of a tube, over the one asked for";

/// Gamma of the strips: they sink by a thousandth of their length.
const SLIGHT: f64 = 0.01;

/// Edges in the length of a strip.
const EDGES: u32 = 80;

/// All checks. The rigidities of a strip follow from the tensors of `hinge`. Those of a disc are limits from up to 160
/// rings by a separate program, which solves the hinges as linear equations.
pub fn checks() -> Vec<Check> {
    let rolled = [0, 45].map(|degrees| {
        let name = format!("disc, border held on a cylinder along {degrees} degrees");
        Check::relative(name, 1.11, 0.01, move |lab| led_on([20, 40], |rings| rolled(lab, rings, degrees)))
    });
    let others = [
        Check::relative("alternating strip, cylinder", 5.0 / 6.0, 0.01, |lab| hung(lab, "alternating")),
        Check::relative("diagonal strip, cylinder", 1.0, 0.01, |lab| hung(lab, "diagonal")),
        Check::absolute("diagonal strip, free sides, twist", -0.2, 5e-3, twist),
        Check::relative("tube, frequency of its oval", 1.0, 5e-3, |lab| led_on([16, 32], |cells| oval(lab, cells))),
        Check::relative("disc, clamped", 0.94, 0.01, |lab| led_on([20, 40], |rings| clamped(lab, rings))),
    ];
    others.into_iter().chain(rolled).collect()
}

/// A value at a number and at its double, led on to infinity: its error falls as the inverse of the number.
fn led_on(numbers: [u32; 2], value: impl Fn(u32) -> Result<f64, Miss>) -> Result<f64, Miss> {
    let [coarse, fine] = numbers.map(value);
    Ok(2.0 * fine? - coarse?)
}

/// The columns of a sheet of 1 kg/m^2 without a material.
fn sheet(mesh: &str) -> Result<BuiltScene, Miss> {
    lab::columns(&format!("name = \"sheet\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n{mesh}"), &[])
}

/// A mesh with the triangles of a sheet.
fn mesh(built: &BuiltScene, place: impl Fn(DVec3) -> DVec3) -> TriMesh {
    let positions = built.particles.positions.iter().map(|&x| place(x).to_array()).collect();
    TriMesh { positions, triangles: built.triangles.clone(), ..TriMesh::default() }
}

/// A strip along x of a grid with square cells, `across` of them in its width. It hangs over its middle column.
fn strip(pattern: &str, across: u32) -> Result<Strip, Miss> {
    let (edge, columns) = (1.0 / f64::from(EDGES), 2 * EDGES + 1);
    let width = edge * f64::from(across);
    let cells = [2 * EDGES, across];
    let built = sheet(&format!("grid = {{ size = [2.0, {width:?}], cells = {cells:?}, pattern = \"{pattern}\" }}"))?;
    Ok(Strip {
        mesh: mesh(&built, |x| x),
        length: 1.0,
        edge,
        line: (0..=across).map(|row| row * columns + EDGES).collect(),
        // Both patterns repeat after two cells.
        alike: (0..columns * (across - 1)).map(|vertex| [vertex, vertex + 2 * columns]).collect(),
        rigidity: 1.0,
    })
}

/// Rigidity of a strip that is kept a cylinder. Its sides lack hinges, which is a share that falls with its width.
fn hung(lab: &Lab, pattern: &str) -> Result<f64, Miss> {
    let drop =
        led_on([4, 8], |across| Ok(Hung::hang(lab, strip(pattern, across)?, Sides::Sewn, SLIGHT)?.drop_over_reach()))?;
    Ok(SLIGHT / bisect([0.1 * SLIGHT, 10.0 * SLIGHT], |gamma| drop_over_reach(gamma) >= drop))
}

/// Twist over curvature of a diagonal strip with free sides.
fn twist(lab: &Lab) -> Result<f64, Miss> {
    led_on([8, 16], |across| {
        let hung = Hung::hang(lab, strip("diagonal", across)?, Sides::Free, SLIGHT)?;
        let x = hung.sim.positions();
        let column = |at: u32| (0..=across).map(move |row| x[(row * (2 * EDGES + 1) + EDGES + at) as usize]);
        let height = |at: u32| column(at).map(|x| x.y).sum::<f64>() / f64::from(across + 1);
        let slope = |at: u32| 0.5 * f64::from(EDGES) * (height(at + 1) - height(at - 1));
        let turn = |at: u32| column(at).map(|x| x.y * x.z).sum::<f64>() / column(at).map(|x| x.z * x.z).sum::<f64>();
        // The line and the tip hinder the twist near them.
        let ends = [EDGES / 4, 3 * EDGES / 4];
        let [slopes, turns] = [ends.map(slope), ends.map(turn)].map(|[from, to]| to - from);
        Ok(turns / slopes)
    })
}

/// A disc of 1 m and 1 N m at rest. Its last two rings are held at the heights of `border`; nothing moves in the plane.
fn disc(lab: &Lab, rings: u32, gravity: f64, border: impl Fn(DVec3) -> f64) -> Result<Simulation, Miss> {
    let source = format!("disc = {{ radius = 1.0, rings = {rings} }}");
    let flat = sheet(&source)?;
    let start = mesh(&flat, |x| x + DVec3::Y * border(x));
    let rest = &flat.particles.positions;
    let all: Vec<_> = (0..rest.len()).collect();
    let held: Vec<_> = all.iter().filter(|&&v| rest[v].length() > 1.0 - 1.5 / f64::from(rings)).collect();
    let text = format!(
        r#"
        name = "disc"
        duration = 1.0
        frame_rate = 1e-4
        gravity = [0.0, -{gravity:?}, 0.0]
        [[cloth]]
        {source}
        state = "start"
        density = 1.0
        bend = {{ model = "hinge", rigidity = 1.0 }}
        pin = [
            {{ select = {{ vertices = {held:?} }}, axes = "y" }},
            {{ select = {{ vertices = {all:?} }}, axes = "xz" }},
        ]
        [integrator]
        step = 1e4
        newton = 100
        tolerance = 1e-8
        "#
    );
    let mut sim = lab::simulation(&text, &[("start".into(), Content::Mesh(start))])?;
    lab.settle(&mut sim, 1e-12, 100)?;
    Ok(sim)
}

/// Rigidity of a clamped disc by the sag of its centre, w = q a^4 / (64 D). It is free within the last ring but one.
fn clamped(lab: &Lab, rings: u32) -> Result<f64, Miss> {
    const GRAVITY: f64 = 1e-5;
    let sim = disc(lab, rings, GRAVITY, |_| 0.0)?;
    let free = 1.0 - 1.0 / f64::from(rings);
    Ok(GRAVITY * free.powi(4) / (64.0 * -sim.positions()[0].y))
}

/// Rigidity of a disc by its energy, D/2 per area at unit curvature, if its border is held on a cylinder. Hinges up to
/// the last ring but one bend.
fn rolled(lab: &Lab, rings: u32, degrees: u32) -> Result<f64, Miss> {
    const CURVATURE: f64 = 1e-6;
    let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
    let sim = disc(lab, rings, 0.0, |x| 0.5 * CURVATURE * (cosine * x.x + sine * x.z).powi(2))?;
    let bent = PI * (1.0 - 0.5 / f64::from(rings)).powi(2);
    Ok(sim.energy().bend / (0.5 * CURVATURE * CURVATURE * bent))
}

/// Rigidity of an open tube by the frequency at which its circle becomes an oval, omega^2 = 36/5 D / (rho R^4). Its
/// ends are softer, since they are free to curve along the axis: a share that falls with its height.
fn oval(lab: &Lab, along: u32) -> Result<f64, Miss> {
    const AROUND: u32 = 72;
    const SQUARE: f64 = 36.0 / 5.0;
    let step = TAU / SQUARE.sqrt() / 800.0;
    let height = ROW * TAU / f64::from(AROUND) * f64::from(along);
    let text = format!(
        r#"
        name = "tube"
        duration = 1.0
        frame_rate = {:?}
        [[cloth]]
        tube = {{ radius = 1.0, height = {height:?}, cells = [{AROUND}, {along}] }}
        density = 1.0
        stretch = {{ model = "membrane", stiffness = 1e6 }}
        shear = {{ stiffness = 4e5 }}
        bend = {{ model = "hinge", rigidity = 1.0 }}
        [integrator]
        method = "implicit-midpoint"
        step = {step:?}
        newton = 20
        tolerance = 1e-8
        "#,
        1.0 / step
    );
    let mut sim = lab::simulation(&text, &[])?;
    let rest = sim.positions().to_vec();
    // The oval without stretch: cos(2 a) outward and -1/2 sin(2 a) around.
    let oval = |x: DVec3| {
        let (sine, cosine) = (2.0 * x.z.atan2(x.x)).sin_cos();
        DVec3::new(x.x, 0.0, x.z) * cosine - DVec3::new(-x.z, 0.0, x.x) * (0.5 * sine)
    };
    let ovals: Vec<_> = rest.into_iter().map(|x| (x, oval(x))).collect();
    for (v, (_, oval)) in sim.state_mut().1.iter_mut().zip(&ovals) {
        *v = 1e-4 * *oval;
    }
    let mut before = 0.0;
    // It is round again after half a period, 400 steps.
    for count in 0..800 {
        lab.steps(&mut sim, 1)?;
        let now: f64 = sim.positions().iter().zip(&ovals).map(|(x, (rest, oval))| (*x - *rest).dot(*oval)).sum();
        if now <= 0.0 {
            let half = step * (f64::from(count) + before / (before - now));
            return Ok((PI / half).powi(2) / SQUARE);
        }
        before = now;
    }
    Err(Miss::Why("the tube does not swing back".into()))
}
