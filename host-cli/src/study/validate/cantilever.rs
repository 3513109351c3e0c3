//! The heavy cantilever [Romero 2021] on strips cut from the default mesh in three directions.
//!
//! A strip hung over a line is two cantilevers: by symmetry both are clamped at the line, whatever the mesh. A
//! strip must bend as a cylinder, like a part of an endless sheet: z is pinned, and vertices one lattice period
//! apart are sewn together in x and y. Then it differs from the endless sheet only by the hinges that its sides
//! lack; the loss of rigidity is computed and corrected for. Strips with free sides are softer, by a part that
//! falls as 1 / width.

use muslin_core_f64::scene::Content;
use muslin_core_f64::simulation::Simulation;

use super::check::Check;
use super::elastica::drop_over_reach;
use super::lab::{self, Lab, Miss};
use super::lattice::{Strip, strip};

/// Description in the report.
pub const ABOUT: &str = "a strip clamped level bends under its weight; drop over reach of its tip by Gamma = w L^3 / D; \
                         strips with free sides in two widths, led on to an endless one";

/// A direction in which strips are cut.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Name in reports.
    pub name: &'static str,
    /// The lattice node towards which a strip runs.
    along: [i32; 2],
    /// Width in lattice periods; 4 to 7 edges.
    periods: u32,
    /// Width with free sides in lattice periods; 7 to 9 edges.
    free_periods: u32,
}

/// Three directions: by the symmetry of the lattice every other direction is equivalent to one between the first
/// two.
pub const CUTS: [Cut; 3] = [
    Cut { name: "rows along", along: [1, 0], periods: 4, free_periods: 4 },
    Cut { name: "rows across", along: [1, 1], periods: 4, free_periods: 8 },
    Cut { name: "rows askew by 19 degrees", along: [2, 1], periods: 1, free_periods: 2 },
];

/// Values of Gamma for which drop over reach is measured.
pub const GAMMAS: [f64; 12] = [0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];

/// Tolerance of drop over reach.
pub const TOLERANCE: f64 = 0.01;

/// Number of edges in the length L / sqrt(Gamma), over which the strip turns down; and the smallest number of edges
/// in L.
const EDGES: f64 = 10.0;
const LEAST_EDGES: f64 = 20.0;

/// Weight of the strip, N/m^2.
const WEIGHT: f64 = 1.0;

/// Stretch stiffness over the weight of a strip's length: the weight stretches the strip by less than 1e-4.
const STIFFNESS: f64 = 2e4;

/// Stiffness of the seams over rigidity / edge^2.
const SEWING: f64 = 1e4;

/// Condition at the sides of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sides {
    /// The strip bends like a part of an endless sheet.
    Sewn,
    /// The sides are free.
    Free,
}

impl Cut {
    /// The name of the check of drop over reach.
    pub fn check(&self, gamma: f64) -> String {
        format!("{}, Gamma {gamma}", self.name)
    }
}

/// All checks.
pub fn checks() -> Vec<Check> {
    let drops = CUTS.iter().flat_map(|cut| {
        GAMMAS.map(|gamma| {
            let edges = (EDGES * gamma.sqrt()).ceil().max(LEAST_EDGES);
            let measure = move |lab: &Lab| Ok(Hung::settle(lab, cut, Sides::Sewn, gamma, edges, 1)?.drop_over_reach());
            Check::relative(cut.check(gamma), drop_over_reach(gamma), TOLERANCE, measure)
        })
    });
    let free = CUTS.iter().map(|cut| {
        let name = format!("{}, sides free, Gamma 10", cut.name);
        Check::relative(name, drop_over_reach(10.0), TOLERANCE, |lab| endless(lab, cut))
    });
    let stretch = CUTS.iter().map(|cut| {
        let measure = |lab: &Lab| Ok(Hung::settle(lab, cut, Sides::Sewn, 100.0, 100.0, 1)?.strain());
        Check::absolute(format!("{}, stretch at Gamma 100", cut.name), 0.0, 1e-4, measure)
    });
    let order = Check::absolute("rows across, order by the edges", 2.0, 0.1, order);
    drops.chain(free).chain(stretch).chain([order]).collect()
}

/// Drop over reach of strips with free sides, extrapolated to infinite width: the error falls as 1 / width.
fn endless(lab: &Lab, cut: &Cut) -> Result<f64, Miss> {
    let [narrow, wide] = [1, 2].map(|times| Hung::settle(lab, cut, Sides::Free, 10.0, 32.0, times));
    Ok(2.0 * wide?.drop_over_reach() - narrow?.drop_over_reach())
}

/// The order of convergence with the length of the edges, where the mesh is the only source of error.
fn order(lab: &Lab) -> Result<f64, Miss> {
    let error = |edges: f64| {
        let hung = Hung::settle(lab, &CUTS[1], Sides::Sewn, 5.0, edges, 1)?;
        Ok::<_, Miss>(hung.drop_over_reach() - drop_over_reach(5.0))
    };
    Ok((error(16.0)? / error(32.0)?).log2())
}

/// A strip at rest over its line.
pub(super) struct Hung {
    pub strip: Strip,
    pub sim: Simulation,
    stiffness: f64,
}

impl Hung {
    /// Hangs a strip until it is at rest; `edges` are in its length, `times` multiplies its width.
    fn settle(lab: &Lab, cut: &Cut, sides: Sides, gamma: f64, edges: f64, times: u32) -> Result<Self, Miss> {
        let periods = if sides == Sides::Sewn { cut.periods } else { cut.free_periods };
        Self::hang(lab, strip(cut.along, times * periods, 1.0 / edges)?, sides, gamma)
    }

    /// Hangs a strip over its line until it is at rest.
    pub fn hang(lab: &Lab, strip: Strip, sides: Sides, gamma: f64) -> Result<Self, Miss> {
        let stiffness = STIFFNESS * WEIGHT * strip.length;
        let text = scene(&strip, sides, gamma, stiffness);
        let mesh = Content::Mesh(strip.mesh.clone());
        let mut sim = lab::simulation(&text, &[("strip".into(), mesh)])?;
        lab.settle(&mut sim, 1e-6, 100)?;
        Ok(Self { strip, sim, stiffness })
    }

    /// Drop over reach of the tip. It is taken from a line fitted to all vertices near the tip: the end is jagged,
    /// and the strip is straight there.
    pub fn drop_over_reach(&self) -> f64 {
        let Strip { mesh, length, edge, .. } = &self.strip;
        let tips = mesh.positions.iter().zip(self.sim.positions());
        let tips = tips.map(|(rest, x)| [rest[0].abs() - length, x.x * rest[0].signum(), -x.y]);
        let near: Vec<_> = tips.filter(|[beyond, ..]| *beyond > -2.5 * edge).collect();
        let mean = [0, 1, 2].map(|k| near.iter().map(|tip| tip[k]).sum::<f64>() / near.len() as f64);
        let along = |k: usize| near.iter().map(|tip| (tip[0] - mean[0]) * (tip[k] - mean[k])).sum::<f64>();
        let [reach, drop] = [1, 2].map(|k| mean[k] - mean[0] * along(k) / along(0));
        drop / reach
    }

    /// Root mean square strain along the strip, from its stored energy.
    fn strain(&self) -> f64 {
        let area: f64 = self.sim.scene().particles.masses.iter().sum::<f64>() / DENSITY;
        (2.0 * self.sim.energy().stretch / (self.stiffness * area)).sqrt()
    }
}

/// Density, kg/m^2.
const DENSITY: f64 = 0.1;

/// The scene. Its steps are so long that Newton's method finds the state at rest in a few steps.
fn scene(strip: &Strip, sides: Sides, gamma: f64, stiffness: f64) -> String {
    let endless = WEIGHT * strip.length.powi(3) / gamma;
    let gravity = WEIGHT / DENSITY;
    let line = &strip.line;
    let (rigidity, weft, held) = match sides {
        Sides::Free => (endless, stiffness, format!("pin = [{{ select = {{ vertices = {line:?} }} }}]")),
        Sides::Sewn => {
            let rigidity = endless / strip.rigidity;
            let sewing = SEWING * rigidity / (strip.edge * strip.edge);
            let (all, alike) = ((0..strip.mesh.positions.len()).collect::<Vec<_>>(), &strip.alike);
            let pins = format!(
                "pin = [{{ select = {{ vertices = {line:?} }}, axes = \"xy\" }}, \
                 {{ select = {{ vertices = {all:?} }}, axes = \"z\" }}]"
            );
            let seam = format!("seam = [{{ pairs = {alike:?}, stiffness = {sewing:?} }}]");
            // A cylinder of flat triangles is slightly narrower than the flat sheet, but z is pinned: a soft weft
            // keeps the resulting stress small.
            (rigidity, 1e-3 * stiffness, format!("{pins}\n{seam}"))
        }
    };
    format!(
        r#"
        name = "cantilever"
        duration = 1.0
        frame_rate = 0.2
        gravity = [0.0, -{gravity:?}, 0.0]
        [[cloth]]
        mesh = "strip"
        density = {DENSITY:?}
        stretch = {{ model = "membrane", stiffness = {stiffness:?}, weft = {weft:?} }}
        shear = {{ stiffness = {:?} }}
        bend = {{ model = "hinge", rigidity = {rigidity:?} }}
        {held}
        [integrator]
        step = 5.0
        newton = 100
        tolerance = 1e-6
        "#,
        0.1 * stiffness
    )
}
