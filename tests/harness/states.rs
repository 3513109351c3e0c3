//! Random elements: material and rest shape, positions of the corners and their velocities.
//!
//! Every number is exact in f32, so that both precisions get the same input. Triangles and hinges are no
//! slivers: no height is below a fifth of the rest height.

use glam::{DMat2, DVec2, DVec3};

use crate::rng::Rng;

/// The deformation of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Within 5 % of its rest shape.
    Rest,
    /// 1.5 to 3 times as large.
    Stretched,
    /// 0.2 to 0.8 times as large.
    Compressed,
    /// Sheared by up to 1.5, lengths within 20 %.
    Sheared,
    /// Folded past 90 degrees (hinges; the other elements as `Mixed`).
    Folded,
    /// Each length 0.2 to 3 times as large.
    Mixed,
}

impl Regime {
    /// Every regime.
    pub const ALL: [Self; 6] =
        [Self::Rest, Self::Stretched, Self::Compressed, Self::Sheared, Self::Folded, Self::Mixed];

    /// Draws a length divided by its rest length.
    fn ratio(self, rng: &mut Rng) -> f64 {
        match self {
            Self::Rest => rng.between(0.95, 1.05),
            Self::Stretched => rng.between(1.5, 3.0),
            Self::Compressed => rng.between(0.2, 0.8),
            Self::Sheared => rng.between(0.8, 1.2),
            Self::Folded | Self::Mixed => rng.magnitude(0.2, 3.0),
        }
    }
}

/// An element with `K` corners and the parameters `P`.
#[derive(Clone, Copy, Debug)]
pub struct State<P, const K: usize> {
    /// Its deformation.
    pub regime: Regime,
    /// Its rest size, m.
    pub size: f64,
    /// Material and rest shape.
    pub part: P,
    /// m.
    pub x: [DVec3; K],
    /// m/s.
    pub v: [DVec3; K],
}

impl<P: std::fmt::Debug, const K: usize> State<P, K> {
    /// Names the element in messages.
    pub fn place(&self, index: usize) -> String {
        format!("element {index}: {self:?}")
    }

    /// A step for differences: small compared with every length over which forces vary.
    pub fn step(&self) -> f64 {
        1e-3 * self.size
    }

    fn new(regime: Regime, size: f64, part: P, x: [DVec3; K], rng: &mut Rng) -> Self {
        let (rotation, offset) = (rng.rotation(), rng.cube(4.0 * size));
        let x = x.map(|x| single3(offset + rotation * x));
        let v = x.map(|_| single3(rng.cube(size)));
        Self { regime, size, part, x, v }
    }
}

/// A spring.
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    /// Rest length, m.
    pub rest: f64,
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
}

/// A triangle of a membrane.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Corners in warp and weft coordinates, m.
    pub rest: [DVec2; 3],
    /// Warp, weft and shear stiffness, N/m.
    pub stiffness: [f64; 3],
    /// Damping of stretch and shear, s.
    pub damping: [f64; 2],
}

/// A hinge.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    /// N m.
    pub stiffness: f64,
    /// Radians.
    pub rest_angle: f64,
    /// A tenth of the rest edge or of the smaller rest height, m.
    pub least_height: f64,
    /// N m s.
    pub damping: f64,
}

/// A stitch.
#[derive(Clone, Copy, Debug)]
pub struct Stitch {
    /// Position on the edge.
    pub weight: f64,
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
}

/// A spring with the given deformation.
pub fn bar(regime: Regime, rng: &mut Rng) -> State<Bar, 2> {
    let (size, stiffness) = (single(rng.magnitude(0.01, 1.0)), stiffness(rng));
    let part = Bar { rest: size, stiffness, damping: damping(rng, stiffness) };
    let far = DVec3::X * size * regime.ratio(rng);
    State::new(regime, size, part, [DVec3::ZERO, far], rng)
}

/// A triangle with the given deformation; the warp has a random direction.
pub fn triangle(regime: Regime, rng: &mut Rng) -> State<Triangle, 3> {
    let size = rng.magnitude(0.01, 1.0);
    let (along, height) = (rng.between(-0.2, 1.2), rng.between(0.5, 1.2));
    let turn = DMat2::from_angle(rng.between(0.0, 6.3)) * size;
    let rest = [DVec2::ZERO, DVec2::X, DVec2::new(along, height)].map(|x| single2(turn * x));
    let stiffness = [stiffness(rng), stiffness(rng), stiffness(rng)];
    let damping = [rng.between(0.1, 1.0), rng.between(0.1, 1.0)].map(single);
    let shear = if regime == Regime::Sheared { rng.between(-1.5, 1.5) } else { 0.0 };
    let deformation = DMat2::from_angle(rng.between(0.0, 6.3))
        * DMat2::from_cols(DVec2::new(regime.ratio(rng), 0.0), DVec2::new(shear, regime.ratio(rng)))
        * DMat2::from_angle(rng.between(0.0, 6.3));
    let x = rest.map(|x| (deformation * x).extend(0.0));
    State::new(regime, size, Triangle { rest, stiffness, damping }, x, rng)
}

/// A hinge with the given deformation. Its angle stays 0.2 away from the angle opposite to its rest angle,
/// where the energy has a ridge.
pub fn hinge(regime: Regime, rng: &mut Rng) -> State<Fold, 4> {
    let size = rng.magnitude(0.01, 1.0);
    let heights = [rng.between(0.5, 1.2), rng.between(0.5, 1.2)].map(|h| h * size);
    let rest_angle = single(if regime == Regime::Folded { 0.0 } else { rng.between(-1.5, 1.5) });
    let bent = match regime {
        Regime::Rest => rng.between(-0.05, 0.05),
        Regime::Folded => rng.between(1.6, 2.9) * rng.pick(&[-1.0, 1.0]),
        _ => rng.between(-2.9, 2.9),
    };
    let angle = rest_angle + bent;
    let stiffness = single(rng.magnitude(1e-6, 1e-2));
    let damping = damping(rng, stiffness);
    let least_height = single(0.1 * heights[0].min(heights[1]).min(size));
    let [h1, h2] = heights.map(|h| h * regime.ratio(rng));
    let slide = if regime == Regime::Sheared { 1.5 } else { 0.3 };
    let along = [rng.between(-slide, 1.0 + slide), rng.between(-slide, 1.0 + slide)].map(|s| s * size);
    let x = [
        DVec3::ZERO,
        DVec3::X * size * regime.ratio(rng),
        DVec3::new(along[0], h1, 0.0),
        DVec3::new(along[1], -h2 * angle.cos(), -h2 * angle.sin()),
    ];
    State::new(regime, size, Fold { stiffness, rest_angle, least_height, damping }, x, rng)
}

/// A stitch with a gap.
pub fn stitch(regime: Regime, rng: &mut Rng) -> State<Stitch, 3> {
    let (size, stiffness) = (rng.magnitude(0.01, 1.0), stiffness(rng));
    let part = Stitch { weight: single(rng.between(0.0, 1.0)), stiffness, damping: damping(rng, stiffness) };
    let x = [rng.cube(size), rng.cube(size), rng.cube(size)];
    State::new(regime, size, part, x, rng)
}

/// `count` elements of each regime.
pub fn many<P, const K: usize>(
    seed: u64,
    count: usize,
    element: impl Fn(Regime, &mut Rng) -> State<P, K>,
) -> Vec<State<P, K>> {
    let rng = &mut Rng::new(seed);
    Regime::ALL.iter().flat_map(|&regime| (0..count).map(move |_| regime)).map(|regime| element(regime, rng)).collect()
}

/// Rounds to f32.
pub fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Rounds to f32.
pub fn single3(v: DVec3) -> DVec3 {
    v.to_array().map(single).into()
}

fn single2(v: DVec2) -> DVec2 {
    v.to_array().map(single).into()
}

fn stiffness(rng: &mut Rng) -> f64 {
    single(rng.magnitude(1.0, 1e4))
}

/// Damping forces are as large as elastic forces: corners move by about one element size per second.
fn damping(rng: &mut Rng, stiffness: f64) -> f64 {
    single(rng.between(0.1, 1.0) * stiffness)
}
