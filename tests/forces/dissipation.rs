//! Damping and air, in f64: each force is -dR/dv. R is the dissipation function (half of the power lost),
//! implemented again from the definition of the term, with strain rates by differences in time.

use std::fmt::Debug;

use glam::{DMat2, DVec3};
use harness::differences::{gradient, slope};
use harness::kit::double as kit;
use harness::states::{Bar, Fold, State, Stitch, Triangle, bar, hinge, many, stitch, triangle};
use harness::worst::{Worst, norm};
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::hinge::Hinges;

const COUNT: usize = 100;
/// R is quadratic in v, so differences in v are exact; differences in time have an error of 1e-8.
const BOUND: f64 = 1e-7;
/// Bound for the power lost, which is 2R: equal to `BOUND`.
const POWER: f64 = 1e-7;

fn half(x: f64) -> f64 {
    0.5 * x * x
}

fn moved<const K: usize>(x: &[DVec3; K], v: &[DVec3; K], t: f64) -> [DVec3; K] {
    std::array::from_fn(|k| x[k] + v[k] * t)
}

fn force_is_slope_of_dissipation<const K: usize, P: Debug>(
    term: &impl Element<K>,
    states: &[State<P, K>],
    dissipation: impl Fn(usize, &State<P, K>, &[DVec3; K]) -> f64,
) {
    let mut slopes = Worst::new("damping force against -dR/dv", BOUND);
    let mut powers = Worst::new("power of the damping force against -2R", POWER);
    for (i, s) in states.iter().enumerate() {
        let (moving, still) = (kit::force(term, i, &s.x, &s.v), kit::force(term, i, &s.x, &[DVec3::ZERO; K]));
        let force: [DVec3; K] = std::array::from_fn(|k| moving[k] - still[k]);
        let want = gradient(&s.v, s.size, |v| -dissipation(i, s, v));
        slopes.vectors(norm(&want), &force, &want, || s.place(i));
        let power: f64 = force.iter().zip(&s.v).map(|(f, v)| f.dot(*v)).sum();
        powers.compare(norm(&force) * norm(&s.v), &[power], &[-2.0 * dissipation(i, s, &s.v)], || s.place(i));
    }
    slopes.check();
    powers.check();
}

#[test]
fn spring_damping_resists_the_rate_of_length() {
    let states = many(21, COUNT, bar);
    force_is_slope_of_dissipation(&kit::bars(&states), &states, |_, s: &State<Bar, 2>, v| {
        let length = |t: f64| moved(&s.x, v, t)[0].distance(moved(&s.x, v, t)[1]);
        s.part.damping * half(slope(1e-3, length))
    });
}

#[test]
fn membrane_damping_resists_the_rates_of_stretch_and_shear() {
    let states = many(22, COUNT, triangle);
    let columns = kit::membrane(&states);
    force_is_slope_of_dissipation(&columns.view(), &states, |_, s: &State<Triangle, 3>, v| {
        let [r0, r1, r2] = s.part.rest;
        let rest = DMat2::from_cols(r1 - r0, r2 - r0);
        let (inverse, area) = (rest.inverse(), rest.determinant().abs() / 2.0);
        // Stretch of warp and weft, and shear.
        let strain = |t: f64| {
            let [x0, x1, x2] = moved(&s.x, v, t);
            let [wu, wv] = [0, 1].map(|c| (x1 - x0) * inverse.col(c).x + (x2 - x0) * inverse.col(c).y);
            [wu.length(), wv.length(), wu.dot(wv)]
        };
        let ([warp, weft, shear], [stretch_time, shear_time]) = (s.part.stiffness, s.part.damping);
        let coefficients = [warp * stretch_time, weft * stretch_time, shear * shear_time];
        (0..3).map(|k| area * coefficients[k] * half(slope(1e-3, |t| strain(t)[k]))).sum()
    });
}

#[test]
fn hinge_damping_resists_the_rate_of_the_angle() {
    let states = many(23, COUNT, hinge);
    let columns = kit::hinges(&states);
    force_is_slope_of_dissipation(&columns.view(), &states, |i, s: &State<Fold, 4>, v| {
        let term: Hinges<'_> = columns.view();
        let now = term.angle(i, &s.x);
        // Shifted so that the angle does not jump from pi to -pi.
        let angle = |t: f64| (term.angle(i, &moved(&s.x, v, t)) - now + 9.0).rem_euclid(std::f64::consts::TAU);
        s.part.damping * half(slope(1e-4, angle))
    });
}

#[test]
fn seam_damping_resists_the_rate_of_the_gap() {
    let states = many(24, COUNT, stitch);
    force_is_slope_of_dissipation(&kit::seams(&states).view(), &states, |_, s: &State<Stitch, 3>, v| {
        let weight = s.part.weight;
        s.part.damping * half((v[1] * (1.0 - weight) + v[2] * weight - v[0]).length())
    });
}

/// Air at rest; the next test shows that wind is equivalent to still air in the frame of the wind.
#[test]
fn still_air_resists_normal_and_tangential_velocity() {
    let states = many(25, COUNT, triangle);
    let [normal, tangential] = [0.6, 0.07];
    let columns = kit::wind(&states, DVec3::ZERO, [normal, tangential]);
    force_is_slope_of_dissipation(&columns.view(), &states, |_, s: &State<Triangle, 3>, v| {
        let twice = (s.x[1] - s.x[0]).cross(s.x[2] - s.x[0]);
        let (area, n) = (twice.length() / 2.0, twice.normalize());
        let w = (v[0] + v[1] + v[2]) / 3.0;
        let across = w - n * w.dot(n);
        area * (normal * half(w.dot(n)) + tangential * half(across.length()))
    });
}

#[test]
fn wind_is_the_air_s_velocity_relative_to_the_cloth() {
    let states = many(26, COUNT, triangle);
    let (velocity, coefficients) = (DVec3::new(3.0, -1.0, 2.0), [0.6, 0.07]);
    let (windy, still) = (kit::wind(&states, velocity, coefficients), kit::wind(&states, DVec3::ZERO, coefficients));
    let mut worst = Worst::new("wind against still air seen by moving cloth", 1e-13);
    for (i, s) in states.iter().enumerate() {
        let force = kit::force(&windy.view(), i, &s.x, &s.v);
        let want = kit::force(&still.view(), i, &s.x, &s.v.map(|v| v - velocity));
        worst.vectors(norm(&want), &force, &want, || s.place(i));
    }
    worst.check();
}

#[test]
fn air_acts_on_the_area_of_a_sheet_once() {
    let scene = |air: &str, turn: f64| {
        format!(
            "name = \"sheet\"\nduration = 0\n[drag]\n{air}\n[[cloth]]\ndensity = 1.0\nrotation = [{turn:?}, 0, 0]\n\
             grid = {{ size = [2.0, 0.5], cells = [4, 4] }}"
        )
    };
    let total = |text: &str, v: DVec3| {
        let built = kit::build(text);
        let x = kit::positions(&built);
        kit::forces(&built.model.view(), &built.particles.masses, &x, &vec![v; x.len()]).into_iter().sum::<DVec3>()
    };
    let mut worst = Worst::new("force of the air on a sheet of 1 m^2, over coefficient and velocity", 1e-13);
    // Either side may face the air: there is no second force on the far side.
    for turn in [0.0, 180.0] {
        let wind = scene("wind = { velocity = [0, 3, 0], normal = 0.5 }", turn);
        worst.vectors(1.5, &[total(&wind, DVec3::ZERO)], &[DVec3::Y * 1.5], || format!("wind, turned by {turn}"));
        let drag = scene("linear = 0.5", turn);
        worst.vectors(1.5, &[total(&drag, DVec3::Y * 3.0)], &[DVec3::Y * -1.5], || format!("drag, turned by {turn}"));
    }
    worst.check();
}
