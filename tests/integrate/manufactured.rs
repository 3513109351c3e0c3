//! Manufactured solutions: the nodal force M x*'' - f(x*, x*') drives the cloth along a chosen smooth motion
//! x*(X, t). Here f is an independent implementation, as constraints whose gradients are central differences.
//! RK4 with the core's forces must reproduce x* at fourth order; a wrong force anywhere along the motion leaves
//! an error that does not decrease.

use glam::{DMat2, DVec2, DVec3};
use harness::differences::{gradient, slope};
use harness::kit::double as kit;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::{self, Model, Term};
use muslin_core_f64::mesh::IncidenceColumns;
use muslin_core_f64::scene::BuiltScene;

const BOUND: f64 = 0.05;
/// s.
const DURATION: f64 = 0.1;
/// m and s: the relative error (step / edge)^6 of the differences is 1e-12.
const DIFFERENCE: f64 = 2e-4;

const WARP: f64 = 2.0;
const WEFT: f64 = 1.5;
const SHEAR: f64 = 1.0;
const SPRING: f64 = 2.0;
const BEND_SPRING: f64 = 1.0;
const RIGIDITY: f64 = 1e-3;
const SEAM: f64 = 1.0;
const LINEAR: f64 = 0.5;
const WIND: DVec3 = DVec3::new(2.0, 1.0, 3.0);
const NORMAL: f64 = 0.6;
const TANGENTIAL: f64 = 0.1;
/// s, for every term with damping.
const DAMPING: f64 = 0.004;

/// Vertices of the first sheet that are sewn to points of its edges.
const STITCHES: [([u32; 3], f64); 2] = [([0, 13, 14], 0.3), ([3, 17, 16], 0.85)];

/// Two sheets, so that both in-plane models and both bending models occur.
fn scene(damping: f64) -> BuiltScene {
    let sheet = r#"grid = { size = [0.3, 0.26], cells = [3, 3] }
        density = 0.2"#;
    let mut built = kit::build(&format!(
        r#"
        name = "manufactured"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        [drag]
        linear = {LINEAR}
        wind = {{ velocity = [{}, {}, {}], normal = {NORMAL}, tangential = {TANGENTIAL} }}
        [[cloth]]
        {sheet}
        stretch = {{ model = "membrane", stiffness = {WARP}, weft = {WEFT}, damping = {damping} }}
        shear = {{ stiffness = {SHEAR}, damping = {damping} }}
        bend = {{ model = "hinge", rigidity = {RIGIDITY}, damping = {damping} }}
        seam = [{{ pairs = [[0, 13], [3, 17]], stiffness = {SEAM}, damping = {damping} }}]
        [[cloth]]
        {sheet}
        stretch = {{ model = "spring", stiffness = {SPRING}, damping = {damping} }}
        bend = {{ model = "spring", stiffness = {BEND_SPRING}, damping = {damping} }}
        load = [{{ select = {{ corners = [1, 2] }}, force = [0.01, 0.02, -0.03] }}]"#,
        WIND.x, WIND.y, WIND.z
    ));
    // The pairs of a scene join vertices; seams with weights come from files, which the host reads.
    let count = built.particles.positions.len();
    let seams = built.model.seams.as_mut().expect("the scene has seams");
    (seams.vertices, seams.weights) = STITCHES.into_iter().unzip();
    seams.incidence = IncidenceColumns::build(count, &seams.vertices);
    built
}

type Value = dyn Fn(&[DVec3; 4]) -> f64;

/// Energy k/2 C^2 and dissipation kd/2 (dC/dt)^2 of up to four corners.
struct Constraint {
    corners: [u32; 4],
    stiffness: f64,
    damping: f64,
    value: Box<Value>,
}

impl Constraint {
    fn add_force(&self, x: &[DVec3], v: &[DVec3], f: &mut [DVec3]) {
        let (x, v) = (self.corners.map(|i| x[i as usize]), self.corners.map(|i| v[i as usize]));
        let rate = slope(DIFFERENCE, |t| (self.value)(&std::array::from_fn(|i| x[i] + v[i] * t)));
        let pull = self.stiffness * (self.value)(&x) + self.damping * rate;
        for (&corner, gradient) in self.corners.iter().zip(gradient(&x, DIFFERENCE, &self.value)) {
            f[corner as usize] -= gradient * pull;
        }
    }
}

/// The rest shape, from which the independent implementation derives its constraints.
struct Sheets<'a> {
    rest: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    damping: f64,
}

impl Sheets<'_> {
    fn area(&self, t: [u32; 3]) -> f64 {
        let [a, b, c] = t.map(|i| self.rest[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    }

    /// Edges, each with the opposite corners and the total area of its triangles.
    fn edges(&self) -> Vec<([u32; 2], Vec<u32>, f64)> {
        let count = self.rest.len() as u32;
        let edge = |a: u32, b: u32| {
            let beside: Vec<_> = self.triangles.iter().filter(|t| t.contains(&a) && t.contains(&b)).collect();
            let far: Vec<u32> = beside.iter().flat_map(|t| t.iter().copied().filter(|&v| v != a && v != b)).collect();
            ([a, b], far, beside.iter().map(|&&t| self.area(t)).sum())
        };
        let pairs = (0..count).flat_map(|b| (0..b).map(move |a| edge(a, b)));
        pairs.filter(|(_, far, _)| !far.is_empty()).collect()
    }

    fn constraint(&self, corners: &[u32], stiffness: f64, value: impl Fn(&[DVec3; 4]) -> f64 + 'static) -> Constraint {
        // The value does not depend on the repeated corner, so its gradient is zero.
        let corners = std::array::from_fn(|i| *corners.get(i).unwrap_or(&corners[0]));
        Constraint { corners, stiffness, damping: self.damping * stiffness, value: Box::new(value) }
    }

    fn spring(&self, [a, b]: [u32; 2], stiffness: f64) -> Constraint {
        let rest = self.rest[a as usize].distance(self.rest[b as usize]);
        self.constraint(&[a, b], stiffness, move |x| x[1].distance(x[0]) - rest)
    }

    fn term(&self, term: Term) -> Vec<Constraint> {
        // The second sheet has the springs.
        let springs = |end: u32| end >= self.rest.len() as u32 / 2;
        let edges = self
            .edges()
            .into_iter()
            .filter(|([a, _], ..)| springs(*a) == matches!(term, Term::StretchSpring | Term::BendSpring));
        let hinges = edges.clone().filter(|(_, far, _)| far.len() == 2);
        match term {
            Term::StretchSpring => edges
                .map(|(ends, _, area)| {
                    let square = self.rest[ends[0] as usize].distance_squared(self.rest[ends[1] as usize]);
                    self.spring(ends, SPRING * area / square)
                })
                .collect(),
            Term::BendSpring => hinges.map(|(_, far, _)| self.spring([far[0], far[1]], BEND_SPRING)).collect(),
            Term::Hinge => hinges
                .map(|([a, b], far, area)| {
                    let square = self.rest[a as usize].distance_squared(self.rest[b as usize]);
                    self.constraint(&[a, b, far[0], far[1]], RIGIDITY * square / area, fold)
                })
                .collect(),
            Term::Membrane => {
                self.triangles.iter().filter(|t| !springs(t[0])).flat_map(|&t| self.membrane(t)).collect()
            }
            Term::Seam => {
                let gap = |(corners, w): ([u32; 3], f64), axis: usize| {
                    self.constraint(&corners, SEAM, move |x| (x[1] * (1.0 - w) + x[2] * w - x[0])[axis])
                };
                STITCHES.into_iter().flat_map(|stitch| (0..3).map(move |axis| gap(stitch, axis))).collect()
            }
            Term::Gravity | Term::Drag | Term::Wind | Term::Load => Vec::new(),
        }
    }

    fn membrane(&self, t: [u32; 3]) -> [Constraint; 3] {
        let [a, b, c] = t.map(|i| DVec2::new(self.rest[i as usize].x, self.rest[i as usize].z));
        let to_rest = DMat2::from_cols(b - a, c - a).inverse();
        let root = self.area(t).sqrt();
        // Derivatives of position along warp and weft.
        let columns =
            move |x: &[DVec3; 4]| [to_rest.x_axis, to_rest.y_axis].map(|w| (x[1] - x[0]) * w.x + (x[2] - x[0]) * w.y);
        [
            self.constraint(&t, WARP, move |x| root * (columns(x)[0].length() - 1.0)),
            self.constraint(&t, WEFT, move |x| root * (columns(x)[1].length() - 1.0)),
            self.constraint(&t, SHEAR, move |x| root * columns(x)[0].dot(columns(x)[1])),
        ]
    }
}

/// Angle of the second triangle's height on the edge against the first's; a flat hinge has 0.
fn fold(x: &[DVec3; 4]) -> f64 {
    let along = (x[1] - x[0]).normalize();
    let [h1, h2] = [x[2] - x[0], x[3] - x[0]].map(|arm| arm.reject_from_normalized(along));
    along.dot(h1.cross(-h2)).atan2(-h1.dot(h2))
}

/// Gravity, wind, drag and loads.
fn add_outer_forces(model: &Model<'_>, sheets: &Sheets<'_>, masses: &[f64], x: &[DVec3], v: &[DVec3], f: &mut [DVec3]) {
    for (f, &m) in f.iter_mut().zip(masses) {
        *f += model.gravity.map_or(DVec3::ZERO, |gravity| gravity.acceleration * m);
    }
    if let Some(loads) = &model.loads {
        for (vertex, force) in loads.forces() {
            f[vertex] += force;
        }
    }
    for t in sheets.triangles {
        let [p, q, r] = t.map(|i| x[i as usize]);
        let double = (q - p).cross(r - p);
        let (normal, area) = (double.normalize(), double.length() / 2.0);
        let wind = WIND - t.iter().map(|&i| v[i as usize]).sum::<DVec3>() / 3.0;
        let along = normal * wind.dot(normal);
        for &i in t {
            if model.wind.is_some() {
                f[i as usize] += (along * NORMAL + (wind - along) * TANGENTIAL) * (area / 3.0);
            }
            if model.drag.is_some() {
                f[i as usize] -= v[i as usize] * (LINEAR * sheets.area(*t) / 3.0);
            }
        }
    }
}

/// x* and its first and second time derivative.
fn motion(rest: DVec3, t: f64) -> [DVec3; 3] {
    const SIZE: DVec3 = DVec3::new(0.02, 0.04, 0.025);
    const RATE: DVec3 = DVec3::new(31.0, 24.0, 38.0);
    let waves = DVec3::new(
        rest.dot(DVec3::new(9.0, 0.0, 5.0)),
        rest.dot(DVec3::new(7.0, 0.0, 11.0)),
        rest.dot(DVec3::new(-6.0, 0.0, 8.0)),
    );
    let phase = waves + RATE * t;
    let (sin, cos) = (phase.map(f64::sin), phase.map(f64::cos));
    [rest + SIZE * sin, SIZE * RATE * cos, -SIZE * RATE * RATE * sin]
}

/// Error of position at the end of `steps` steps of RK4.
fn error(built: &BuiltScene, model: &Model<'_>, nodal: &impl Fn(f64) -> Vec<DVec3>, steps: u32) -> f64 {
    let (rest, particles) = (&built.particles.positions, &built.particles);
    let slope = |t: f64, x: &[DVec3], v: &[DVec3]| -> (Vec<DVec3>, Vec<DVec3>) {
        let (mut f, mut scratch) = (vec![DVec3::ZERO; rest.len()], vec![DVec3::ZERO; model.force_scratch()]);
        forces::evaluate(model, &particles.masses, x.into(), v, &mut scratch, &mut f, &Serial);
        let a = f.iter().zip(nodal(t)).zip(&particles.inverse_masses).map(|((&f, n), &w)| f * w + n);
        (v.to_vec(), a.collect())
    };
    let moved =
        |x: &[DVec3], by: &[DVec3], h: f64| -> Vec<DVec3> { x.iter().zip(by).map(|(&x, &k)| x + k * h).collect() };
    let h = DURATION / f64::from(steps);
    let start = |k: usize| -> Vec<DVec3> { rest.iter().map(|&r| motion(r, 0.0)[k]).collect() };
    let (mut x, mut v) = (start(0), start(1));
    for n in 0..steps {
        let t = h * f64::from(n);
        let k1 = slope(t, &x, &v);
        let k2 = slope(t + h / 2.0, &moved(&x, &k1.0, h / 2.0), &moved(&v, &k1.1, h / 2.0));
        let k3 = slope(t + h / 2.0, &moved(&x, &k2.0, h / 2.0), &moved(&v, &k2.1, h / 2.0));
        let k4 = slope(t + h, &moved(&x, &k3.0, h), &moved(&v, &k3.1, h));
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            (x, v) = (moved(&x, &k.0, weight * h / 6.0), moved(&v, &k.1, weight * h / 6.0));
        }
    }
    x.iter().zip(rest).map(|(x, &r)| x.distance_squared(motion(r, DURATION)[0])).sum::<f64>().sqrt()
}

fn check(what: &str, damping: f64, term: Option<Term>) {
    let built = scene(damping);
    let (rest, whole) = (&built.particles.positions, built.model.view());
    let model = term.map_or(whole, |term| whole.only(term).expect("the scene has every term"));
    let sheets = Sheets { rest, triangles: &built.triangles, damping };
    let terms = Term::ALL.into_iter().filter(|&t| term.is_none_or(|term| t == term));
    let constraints: Vec<_> = terms.flat_map(|term| sheets.term(term)).collect();
    let nodal = |t: f64| -> Vec<DVec3> {
        let [x, v, a] = [0, 1, 2].map(|k| rest.iter().map(|&r| motion(r, t)[k]).collect::<Vec<_>>());
        let mut f = vec![DVec3::ZERO; rest.len()];
        constraints.iter().for_each(|c| c.add_force(&x, &v, &mut f));
        add_outer_forces(&model, &sheets, &built.particles.masses, &x, &v, &mut f);
        a.iter().zip(&f).zip(&built.particles.inverse_masses).map(|((&a, &f), &w)| a - f * w).collect()
    };
    let errors: Vec<_> = (0..5).map(|k| error(&built, &model, &nodal, 48 << k)).collect();
    let orders: Vec<_> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let measured = format!("{what}: orders {orders:.3?}, errors {:.1e} to {:.1e}", errors[0], errors[4]);
    println!("{measured}");
    assert!(orders.iter().all(|p| (p - 4.0).abs() <= BOUND), "{measured}; expected 4 within {BOUND}");
}

#[test]
fn every_term_returns_to_the_manufactured_motion() {
    for term in Term::ALL {
        check(term.name(), 0.0, Some(term));
        if !matches!(term, Term::Gravity | Term::Drag | Term::Wind | Term::Load) {
            check(&format!("{}, damped", term.name()), DAMPING, Some(term));
        }
    }
}

#[test]
fn all_terms_together_return_to_the_manufactured_motion() {
    check("all terms", DAMPING, None);
}
