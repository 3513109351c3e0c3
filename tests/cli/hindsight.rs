//! `muslin choose` in hindsight: its choice is within the tolerance of a reference by RK4 in double precision,
//! and a search over all methods and steps finds no run that is much cheaper.
//!
//! Costs are computed from counts, so that `choose` and this test compare the same costs on every machine. The cost
//! of the choice is the lowest cost of its method with all terms. A run counts only if it meets the tolerance.
//! The test asserts for each method:
//! - If `choose` found runs of the method that meet the tolerance, none of them is cheaper than the choice, and
//!   no run with the solver of the scene costs less than 1 / 1.3 of the choice.
//! - If it found none, no run with the solver of the scene is cheaper than the choice at all.
//! - If it found some, no run with a solver as exact as the choice's solver costs less than 1 / 1.3 of the cheapest
//!   of them.
//! - If the method is implicit, no run with a looser solver or under error control costs less than 1 / 1.3 of the
//!   cheapest run with all terms, whatever its solver.

use serde_json::Value;
use toml::Table;

use crate::choose::{EXPLICIT, METHODS, areas, number, rms};
use crate::kit::{Place, PointCache, obj};

/// Largest allowed ratio of a known cost to the lowest cost in hindsight.
const DEARER: f64 = 1.3;

/// Assumed memory bandwidth, B/s, that converts counted bytes to a cost.
const SPEED: f64 = 1e10;

/// Allowed error of the reference of the choice, as a fraction of the tolerance.
const OWN: f64 = 1.0 / 16.0;

/// Ratio of a step to the next shorter step in the search.
const FINER: f64 = 1.1;

/// Factors by which the solver of the scene is loosened, and the ratio of an allowed error to the next smaller one.
const LOOSER: [f64; 3] = [10.0, 100.0, 1000.0];
const SMALLER: f64 = 0.8;

/// The smallest allowed error of a step in hindsight, as a multiple of the tolerance, which is the largest.
const SMALLEST: f64 = 1e-4;

/// Number of steps between two moments in the first run for the reference.
const FIRST: u64 = 64;

/// A scene without contact, and the tolerance for it.
struct Case {
    name: &'static str,
    tolerance: &'static str,
    duration: f64,
    /// Keys of the cloth; `rest` contains the sections after the cloth.
    cloth: &'static str,
    rest: &'static str,
}

/// Solver tolerances: the value that the scenes use, and the smallest value that is requested in single precision.
const TOLERANCE: [f64; 2] = [1e-4, 1e-6];

const HELD: &str = "pin = [{ select = { corners = [0, 1] } }]";

/// Soft and stiff, long and short, springs and membranes, planar and bent, free and pinned; sorted from the
/// coarsest tolerance to the finest.
const CASES: [Case; 9] = [
    Case {
        name: "springs",
        tolerance: "5mm",
        duration: 0.3,
        cloth: "grid = { size = [0.3, 0.3], cells = [4, 4] }\nstretch = { model = \"spring\", stiffness = 50.0 }",
        rest: "[integrator]\nstep = 0.02\n",
    },
    Case {
        name: "damped",
        tolerance: "2mm",
        duration: 0.5,
        cloth: "grid = { size = [0.4, 0.4], cells = [4, 4] }\nshear = { stiffness = 60.0, damping = 0.01 }\n\
                stretch = { model = \"membrane\", stiffness = 200.0, damping = 0.01 }",
        rest: "[integrator]\nmethod = \"bdf2\"\nstep = 0.01\n",
    },
    Case {
        name: "soft",
        tolerance: "1mm",
        duration: 0.4,
        cloth: "grid = { size = [0.4, 0.35], cells = [4, 4] }\nshear = { stiffness = 2.0 }\n\
                stretch = { model = \"membrane\", stiffness = 5.0, damping = 0.01 }\n\
                bend = { model = \"hinge\", rigidity = 1e-4 }",
        rest: "[integrator]\nstep = 0.005\n",
    },
    Case {
        name: "stiff",
        tolerance: "0.5mm",
        duration: 0.2,
        cloth: "grid = { size = [0.3, 0.3], cells = [5, 5] }\nshear = { stiffness = 300.0 }\n\
                stretch = { model = \"membrane\", stiffness = 2000.0, damping = 0.001 }",
        rest: "[integrator]\nstep = 0.005\n",
    },
    Case {
        name: "strip",
        tolerance: "0.2mm",
        duration: 0.1,
        cloth: "grid = { size = [0.2, 0.05], cells = [8, 2] }\nshear = { stiffness = 50.0 }\n\
                stretch = { model = \"membrane\", stiffness = 100.0 }\n\
                bend = { model = \"hinge\", rigidity = 1e-3, damping = 0.001 }",
        rest: "[integrator]\nstep = 0.002\n",
    },
    Case {
        name: "drawn",
        tolerance: "0.1mm",
        duration: 0.3,
        cloth: "grid = { size = [0.3, 0.2], cells = [5, 3] }\nshear = { stiffness = 20.0 }\n\
                stretch = { model = \"membrane\", stiffness = 40.0 }",
        rest: "[integrator]\nstep = 0.01\n",
    },
    Case {
        name: "blown",
        tolerance: "50um",
        duration: 0.4,
        cloth: "grid = { size = [0.3, 0.3], cells = [3, 3] }\nstretch = { model = \"spring\", stiffness = 10.0 }\n\
                bend = { model = \"spring\", stiffness = 0.5 }",
        rest: "[drag]\nlinear = 0.2\nwind = { velocity = [2.0, 0.0, 1.0], normal = 0.3 }\n\
               [integrator]\nmethod = \"rk4\"\nstep = 0.01\n",
    },
    Case {
        name: "short",
        tolerance: "20um",
        duration: 0.06,
        cloth: "grid = { size = [0.3, 0.3], cells = [6, 6] }\nshear = { stiffness = 50.0 }\n\
                stretch = { model = \"membrane\", stiffness = 100.0 }\n\
                bend = { model = \"hinge\", rigidity = 1e-5 }",
        rest: "[integrator]\nmethod = \"implicit-midpoint\"\nstep = 0.003\nnewton = 4\n",
    },
    Case {
        name: "exact",
        tolerance: "10um",
        duration: 0.2,
        cloth: "grid = { size = [0.3, 0.3], cells = [4, 4] }\nstretch = { model = \"spring\", stiffness = 50.0 }",
        rest: "[integrator]\nstep = 0.01\n",
    },
];

impl Case {
    /// The scene file. Its frames are the 20 moments, so that a run takes exactly the steps that are tried.
    fn text(&self) -> String {
        let Self { name, duration, cloth, rest, .. } = self;
        let (rate, held) = (20.0 / duration, if *name == "blown" { "" } else { HELD });
        format!(
            "name = \"{name}\"\nduration = {duration:?}\nframe_rate = {rate:?}\ngravity = [0.0, -9.81, 0.0]\n\n\
             [[cloth]]\ndensity = 0.2\n{cloth}\n{held}\n\n{rest}"
        )
    }

    /// Arguments that run the scene by another method with `steps` steps between two moments.
    fn by(&self, method: &str, steps: u64) -> String {
        let step = self.duration / (20 * steps) as f64;
        format!("scene.toml --set integrator.method={method} --set integrator.step={step:e}")
    }

    /// The same arguments with a solver tolerance.
    fn by_looser_solver(&self, method: &str, steps: u64, factor: f64) -> String {
        format!("{} --set integrator.tolerance={:e}", self.by(method, steps), factor * TOLERANCE[0])
    }

    /// Arguments that run the scene by a method under error control, with steps of at most 1/60 s.
    fn by_control(&self, method: &str, error: f64) -> String {
        let steps = (60.0 * self.duration / 20.0).ceil() as u64;
        format!("{} --set integrator.error={error:e}", self.by(method, steps))
    }

    /// The same arguments with a solver tolerance that decreases with the step by the order of the method.
    fn by_exact_solver(&self, method: &str, steps: u64) -> String {
        let own = toml::from_str::<Table>(&self.text()).unwrap()["integrator"]["step"].as_float().unwrap();
        let finer = (self.duration / (20 * steps) as f64 / own).min(1.0);
        let order = if method == "backward-euler" { 1 } else { 2 };
        let [most, least] = TOLERANCE;
        let tolerance = (most * finer.powi(order)).max(least);
        format!("{} --set integrator.tolerance={tolerance:e}", self.by(method, steps))
    }
}

/// A run: its cost from counts, s, and its positions at the moments.
struct Flight {
    cost: f64,
    moments: PointCache,
}

/// Runs a scene to its end; `None` if the run fails.
fn fly(place: &Place, words: &str) -> Option<Flight> {
    let run = place.muslin(&format!("run {words} --out out --preview none --export pc2 --threads 1 --json"));
    let moments = (run.code == Some(0)).then(|| PointCache::parse(&place.read("out/cloth.pc2")))?;
    Some(Flight { cost: number(&run.json()["work"]["streamed_bytes"]) / SPEED, moments })
}

/// A reference by RK4 in double precision: its step is halved until this changes the result by less than a
/// hundredth of `tolerance`, m.
fn reference(place: &Place, case: &Case, tolerance: f64, areas: &[f64]) -> PointCache {
    let by = |steps| fly(place, &format!("{} --precision f64", case.by("rk4", steps)));
    let mut steps = FIRST;
    loop {
        let [coarse, fine] = [steps, 2 * steps].map(by);
        if let (Some(coarse), Some(fine)) = (coarse, fine)
            && rms(&coarse.moments, &fine.moments, areas) < 0.01 * tolerance
        {
            return fine.moments;
        }
        steps *= 2;
    }
}

/// The rows of a method in which no term is left out or simplified.
fn rows<'a>(choice: &'a Value, method: &str) -> Vec<&'a Value> {
    let rows = choice["considered"].as_array().unwrap().iter();
    rows.filter(|row| row["method"] == method && row["terms"].as_array().unwrap().is_empty()).collect()
}

/// The cost of a row, s.
fn cost(row: &Value) -> f64 {
    number(&row["wall_s"])
}

/// The lowest cost of the rows that meet the tolerance, s.
fn least(rows: &[&Value]) -> Option<f64> {
    rows.iter().filter(|row| row["verdict"] == "meets").map(|row| cost(row)).min_by(f64::total_cmp)
}

/// The cost of a force evaluation without a Jacobian, s: a lower bound on the cost of a step of any method.
fn least_step(choice: &Value) -> f64 {
    let rows = rows(choice, "symplectic-euler");
    let row = rows.iter().find(|row| row["precision"] == "f32").unwrap();
    cost(row) / number(&row["force_evaluations"])
}

/// The lowest cost, s, of a run that meets the tolerance and costs less than `below`; `None` if there is no such run.
/// `fly` runs the scene with a number of steps between two moments.
fn cheapest(
    [below, least_step]: [f64; 2],
    fly: impl Fn(u64) -> Option<Flight>,
    meets: impl Fn(&Flight) -> bool,
) -> Option<f64> {
    let mut steps = 1;
    let mut least: Option<f64> = None;
    while 20.0 * (steps as f64) * least_step < least.unwrap_or(below) {
        let flight = fly(steps).filter(|flight| flight.cost < least.unwrap_or(below));
        least = flight.filter(|flight| meets(flight)).map(|flight| flight.cost).or(least);
        steps = (steps + 1).max((FINER * steps as f64) as u64);
    }
    least
}

/// The lowest cost, s, of a run under error control that meets the tolerance, m, and costs less than `below`; `None` if
/// there is no such run. `fly` runs the scene with an allowed error of a step, m.
fn cheapest_controlled(
    below: f64,
    tolerance: f64,
    fly: impl Fn(f64) -> Option<Flight>,
    meets: impl Fn(&Flight) -> bool,
) -> Option<f64> {
    let mut error = tolerance;
    while error > SMALLEST * tolerance {
        match fly(error) {
            // Smaller errors cost more.
            Some(flight) if flight.cost >= below => return None,
            Some(flight) if meets(&flight) => return Some(flight.cost),
            Some(_) | None => error *= SMALLER,
        }
    }
    None
}

fn judge(case: &Case) {
    let place = Place::new();
    place.write("scene.toml", case.text());
    let words = format!(
        "choose scene.toml --tolerance {} --cost counts --write chosen.toml --out study --json",
        case.tolerance
    );
    let choice = place.muslin(&words).expect(0).json();
    let tolerance = number(&choice["tolerance"]);
    place.run("scene.toml --duration 0 --export obj");
    let areas = areas(obj(&place.read("out/frames/frame_00000.obj")));
    let exact = reference(&place, case, tolerance, &areas);
    let error = |flight: &Flight| rms(&flight.moments, &exact, &areas);

    let [method, precision] = ["method", "precision"].map(|key| choice["chosen"][key].as_str().unwrap());
    let off = error(&fly(&place, &format!("chosen.toml --precision {precision}")).unwrap());
    assert!(off <= (1.0 + OWN) * tolerance, "{}: {off} off, of {tolerance}", case.name);

    let best = least(&rows(&choice, method)).unwrap();
    let least_step = least_step(&choice);
    // Closer to the tolerance, the two references may disagree on whether a run meets it.
    let meets = |flight: &Flight| error(flight) <= (1.0 - OWN) * tolerance;
    let ratios = METHODS.map(|method| {
        let rows = rows(&choice, method);
        let by_own = |steps| fly(&place, &case.by(method, steps));
        let by_exact = |steps| fly(&place, &case.by_exact_solver(method, steps));
        let known = least(&rows);
        let allowed = if known.is_some() { best / DEARER } else { best };
        let cheaper = cheapest([allowed, least_step], by_own, meets);
        assert!(cheaper.is_none(), "{}: {method} costs {cheaper:?} s, the choice {best}: {rows:?}", case.name);
        if !EXPLICIT.contains(&method) {
            let below = best / DEARER;
            let loose = LOOSER.map(|factor| {
                let by_loose = |steps| fly(&place, &case.by_looser_solver(method, steps, factor));
                cheapest([below, least_step], by_loose, meets)
            });
            let by_control = |error| fly(&place, &case.by_control(method, error));
            let controlled = cheapest_controlled(below, tolerance, by_control, meets);
            println!("{} {method}: looser {loose:?}, controlled {controlled:?}, below {below:?}", case.name);
            assert!(loose == [None; 3] && controlled.is_none(), "{}: {method} costs {loose:?} s with a looser solver and {controlled:?} under error control, the choice {}", case.name, best);
        }
        let Some(known) = known else { return 1.0 };
        assert!(known >= best, "{}: {method} costs {known} s, the choice {best}", case.name);
        let ratio = known / cheapest([known, least_step], by_exact, meets).unwrap_or(known);
        assert!(ratio <= DEARER, "{}: {ratio} times the best: {rows:?}", case.name);
        ratio
    });
    let own = METHODS.iter().zip(ratios).find_map(|(known, ratio)| (*known == method).then_some(ratio)).unwrap();
    println!(
        "{}: {method} {precision}, {off:.1e} m off by RK4; {own:.2} times the best, other methods at most \
         {:.2}; {:.2} of its cost with all terms; found in {:.0} times that",
        case.name,
        ratios.into_iter().fold(1.0, f64::max),
        number(&choice["predicted"]["wall_s"]) / best,
        number(&choice["pilot_s"]) / best
    );
}

#[test]
#[ignore = "slow"]
fn coarse_choices_are_near_the_best_in_hindsight() {
    CASES[..3].iter().for_each(judge);
}

#[test]
fn choices_are_near_the_best_in_hindsight() {
    CASES[3..6].iter().for_each(judge);
}

#[test]
#[ignore = "slow"]
fn fine_choices_are_near_the_best_in_hindsight() {
    CASES[6..].iter().for_each(judge);
}
