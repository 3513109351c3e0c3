//! The report of `muslin chart`: numbers and text.

use serde::Serialize;

use crate::study::distance::Measure;
use crate::study::draw::LOOKS;
use crate::study::variant::Variant;
use crate::units::{length, time};

use super::causes::Causes;

/// Order of RK4, the reference's method without contact.
const RK4: f64 = 4.0;

/// Largest difference between a measured order and theory.
const NEAR_THEORY: f64 = 0.1;

/// Number of allowed errors that the text shows for each method.
const MOST_PAIRS: usize = 5;

/// Ending of the name of a method under error control.
const CONTROLLED: &str = " with error control";

/// Whether a measured order agrees with theory.
pub fn is_of_order(measured: f64, theory: f64) -> bool {
    (measured - theory).abs() <= NEAR_THEORY
}

/// One run. Errors are parts of the cloth's diagonal.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name as in a scene file.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// Step, s; under error control the mean.
    pub step: f64,
    /// Allowed error of a step, m; `None`: all steps have the same length.
    pub allowed_error_m: Option<f64>,
    /// Tolerance of the solver; `None` for explicit methods and where it follows the allowed error.
    pub tolerance: Option<f64>,
    /// How the solver differs from that of the other runs; `None` for most runs.
    pub solver: Option<&'static str>,
    /// Root mean square error over all samples: of the positions, weighted by mass, or of the outline. `None` if
    /// the run failed or the error is too small for the reference to resolve.
    pub error_rms: Option<f64>,
    /// The largest error.
    pub error_max: Option<f64>,
    /// The largest difference of the total energy from the reference's, over the reference's largest kinetic and
    /// elastic energy.
    pub energy_drift: Option<f64>,
    /// The largest ratio of length to rest length of an edge at any sample; `None` if the run failed.
    pub stretch: Option<f64>,
    /// The largest depth of a vertex inside a collider at any sample, m; `None` without colliders or if the run failed.
    pub penetration_m: Option<f64>,
    /// Median computing time of the steps, s.
    pub wall_s: f64,
    /// Number of timed runs.
    pub repeats: usize,
    /// Steps; under error control the ones that were kept.
    pub steps: u64,
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Whether the run stayed near the reference.
    pub stable: bool,
    /// Why the run failed, or why it has no error.
    pub why: Option<String>,
    /// The variant that was run.
    #[serde(skip)]
    pub variant: Variant,
}

impl Row {
    /// Whether error control divided a step.
    pub fn is_divided(&self) -> bool {
        self.variant.is_divided(self.steps)
    }

    /// Whether it ran under error control.
    pub fn is_controlled(&self) -> bool {
        self.allowed_error_m.is_some()
    }

    /// Whether it belongs to the series of a method with fixed steps.
    pub fn is_fixed(&self) -> bool {
        !self.is_controlled() && self.solver.is_none()
    }

    /// Whether it belongs to the series of a method with fixed steps in double precision.
    fn is_of(&self, method: &str) -> bool {
        self.is_fixed() && self.method == method && self.precision == "f64"
    }

    /// Its RMS error, m, on a cloth with the given diagonal, m; `None` if it is not known.
    pub fn reached_m(&self, diagonal: f64) -> Option<f64> {
        self.error_rms.map(|error| error * diagonal)
    }

    /// Whether its error is too small for the reference to resolve.
    pub fn is_nearest(&self) -> bool {
        self.stable && self.error_rms.is_none()
    }

    /// The method, and whether it runs under error control.
    pub fn approach(&self) -> String {
        let control = if self.is_controlled() { CONTROLLED } else { "" };
        format!("{}{control}", self.method)
    }

    /// Its error, or `least` as an upper bound; `None` if the run failed.
    pub fn error_at_most(&self, least: f64) -> Option<f64> {
        self.error_rms.or(self.stable.then_some(least))
    }
}

/// The reference that errors are measured against.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceReport {
    /// Name as in a scene file; it runs in double precision.
    pub method: &'static str,
    /// Step, s.
    pub step: f64,
    /// Distance from the run with twice the step, as a part of the diagonal.
    pub self_error: f64,
    /// Order of convergence in the last two halvings; `None` after a single halving.
    pub order: Option<f64>,
    /// Errors below this are not charted; a part of the diagonal.
    pub least_charted: f64,
    /// The implicit method that confirms the reference.
    pub agreement: Option<Agreement>,
}

/// An implicit method that converges to the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Agreement {
    /// Name as in a scene file.
    pub method: &'static str,
    /// Order of convergence.
    pub order: f64,
    /// Smallest error, as a part of the diagonal.
    pub error_rms: f64,
}

/// The cheapest method for an error.
#[derive(Clone, Debug, Serialize)]
pub struct Winner {
    /// The largest allowed error, as a part of the diagonal.
    pub error: f64,
    /// Name as in a scene file.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// Step, s; under error control the mean.
    pub step: f64,
    /// Allowed error of a step, m; `None`: all steps have the same length.
    pub allowed_error_m: Option<f64>,
    /// How the solver differs from that of the other runs.
    pub solver: Option<&'static str>,
    /// Computing time, s.
    pub wall_s: f64,
    /// The second cheapest approach, and its time over the time of the cheapest.
    pub next: Option<(String, f64)>,
}

/// The order of convergence of a method.
#[derive(Clone, Debug, Serialize)]
pub struct Order {
    /// Name as in a scene file.
    pub method: &'static str,
    /// Measured over its last three steps in double precision.
    pub measured: f64,
    /// Order by theory, for smooth forces and small steps.
    pub theory: f64,
}

/// A method without a stable run.
#[derive(Clone, Debug, Serialize)]
pub struct Omitted {
    /// Name as in a scene file.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// Whether its steps follow an allowed error.
    pub error_control: bool,
    /// The reason.
    pub why: String,
}

impl Omitted {
    fn line(&self) -> String {
        let control = if self.error_control { CONTROLLED } else { "" };
        format!("not charted: {} {}{control}: {}", self.method, self.precision, self.why)
    }
}

/// The report, `chart --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// Name of the scene.
    pub scene: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Number of vertices of all cloths.
    pub vertices: usize,
    /// Diagonal of the cloth's bounding box at the start, m.
    pub diagonal_m: f64,
    /// The compared quantity: positions, or with contact the outline.
    pub measure: Measure,
    /// The reference that errors are measured against.
    pub reference: ReferenceReport,
    /// The processor, of which one thread is used; a note if costs are counted.
    pub machine: String,
    /// All runs.
    pub rows: Vec<Row>,
    /// The error of the scene's method by cause; `None` for an explicit method, or if there was no time.
    pub causes: Option<Causes>,
    /// A sentence that explains why `causes` is `None`; `None` if there are causes.
    pub no_causes: Option<String>,
    /// Orders of convergence.
    pub orders: Vec<Order>,
    /// Cheapest method for each error.
    pub winners: Vec<Winner>,
    /// Methods that could not be charted.
    pub omitted: Vec<Omitted>,
    /// Cost of the study, s.
    pub study_s: f64,
}

impl Chart {
    /// The report as text.
    pub fn lines(&self) -> String {
        let mut lines = vec![
            format!(
                "{}: {} s of {} vertices; errors are RMS over 20 moments of the {}, of the diagonal of {:.3} m",
                self.scene,
                self.duration_s,
                self.vertices,
                self.measure.name(),
                self.diagonal_m
            ),
            self.reference_line(),
            self.agreement_line(),
            String::new(),
            format!("error          {:<23} {:>14}   {:<21} {:>10}   next", "cheapest", "step", "solver", "wall"),
        ];
        lines.extend(self.winners.iter().map(|winner| self.winner_line(winner)));
        lines.extend([String::new(), "method             order (theory)   largest step that works".into()]);
        lines.extend(LOOKS.iter().filter_map(|(method, ..)| self.method_line(method)));
        lines.extend(self.contact_lines());
        lines.extend(self.control_lines());
        lines.extend(self.cause_lines());
        lines.extend(self.omitted.iter().map(Omitted::line));
        lines.join("\n")
    }

    fn winner_line(&self, w: &Winner) -> String {
        let solver = w.solver.unwrap_or_default();
        let next = w.next.as_ref().map_or_else(String::new, |(name, ratio)| format!("{name} ({ratio:.1}x)"));
        let metres = length(w.error * self.diagonal_m);
        let name = format!("{} {}", w.method, w.precision);
        let step = w.allowed_error_m.map_or_else(|| time(w.step), |error| format!("error {}", length(error)));
        let line = format!(
            "{:<5.0e} {metres:<8} {name:<23} {step:>14}   {solver:<21} {:>10}   {next}",
            w.error,
            time(w.wall_s)
        );
        line.trim_end().into()
    }

    /// For each method with error control: allowed errors of a step that divide steps, and the errors that the runs
    /// reach.
    fn control_lines(&self) -> Vec<String> {
        let line = |method: &str| {
            let rows = self.rows.iter().filter(|row| row.method == method && row.precision == "f64");
            let known = rows.filter(|row| row.solver.is_none() && row.is_divided()).filter_map(|row| {
                Some(format!("{} -> {}", length(row.allowed_error_m?), length(row.reached_m(self.diagonal_m)?)))
            });
            let known: Vec<_> = known.take(MOST_PAIRS).collect();
            (!known.is_empty()).then(|| format!("{method:<18} {}", known.join(", ")))
        };
        let lines: Vec<_> = LOOKS.iter().filter_map(|(method, ..)| line(method)).collect();
        let head = [String::new(), "error control      allowed error of a step -> error of the run, f64".into()];
        if lines.is_empty() { lines } else { head.into_iter().chain(lines).collect() }
    }

    /// The error of the scene's method by cause.
    fn cause_lines(&self) -> Vec<String> {
        let Some(causes) = &self.causes else { return vec![String::new(), self.no_causes.clone().unwrap_or_default()] };
        let metres = |part: f64| length(part * self.diagonal_m);
        let head = format!(
            "{:<18} f64  error: of the step       of the solver     of the linearisation    largest",
            causes.method
        );
        let lines = causes.steps.iter().map(|cause| {
            let [step, solver, linear] = [cause.of_step, cause.solver, cause.linearisation].map(metres);
            let largest = cause.largest();
            format!("steps of {:<14} {step:>17} {solver:>19} {linear:>24}    {largest}", time(cause.step))
        });
        [String::new(), head].into_iter().chain(lines).collect()
    }

    fn is_of_contact(&self) -> bool {
        self.measure == Measure::Outline
    }

    fn reference_line(&self) -> String {
        let r = &self.reference;
        let by = match r.order {
            None => String::new(),
            Some(order) if self.is_of_contact() || is_of_order(order, RK4) => format!(", by order {order:.2}"),
            Some(order) => {
                format!(", by order {order:.2} instead of {RK4}: forces jump, as where a pin has a key inside a step")
            }
        };
        format!(
            "reference: {} f64, step {:.2e} s, differs from twice its step by {:.1e}{by}; charted down to {:.1e}",
            r.method, r.step, r.self_error, r.least_charted
        )
    }

    fn agreement_line(&self) -> String {
        match &self.reference.agreement {
            Some(a) => {
                format!(
                    "{} comes as near as {:.1e} to it, with order {:.2}: both methods agree",
                    a.method, a.error_rms, a.order
                )
            }
            None if self.is_of_contact() => {
                "with contact velocities jump: the order of every method collapses to one or less, and smaller steps \
                 change which features touch first, not only the accuracy"
                    .into()
            }
            None => "no implicit method confirms it".into(),
        }
    }

    /// With contact orders say nothing. This table shows other quantities for the shortest step of each method in
    /// double precision.
    fn contact_lines(&self) -> Vec<String> {
        let shortest = |method: &str| self.rows.iter().rfind(|row| row.is_of(method) && row.stable);
        let rows: Vec<_> = LOOKS.iter().filter_map(|(method, ..)| shortest(method)).collect();
        if !self.is_of_contact() || rows.is_empty() {
            return Vec::new();
        }
        let head = "shortest step                   outline       stretch   energy    penetration";
        let lines = rows.into_iter().map(|row| {
            let [outline, depth] = [row.error_rms.map(|error| error * self.diagonal_m), row.penetration_m];
            let [outline, depth] = [outline, depth].map(|metres| metres.map_or_else(|| "-".into(), length));
            let drift = row.energy_drift.map_or_else(|| "-".into(), |drift| format!("{:.2} %", 100.0 * drift));
            let stretch = row.stretch.map_or_else(|| "-".into(), |ratio| format!("{:.2} %", 100.0 * (ratio - 1.0)));
            format!("{:<18} {:>10}   {outline:<11} {stretch:>9} {drift:>9}   {depth}", row.method, time(row.step))
        });
        [String::new(), head.into()].into_iter().chain(lines).collect()
    }

    /// The order of a method and its longest stable step, if a step is stable.
    fn method_line(&self, method: &str) -> Option<String> {
        let mut rows = self.rows.iter().filter(|row| row.is_of(method));
        let largest = rows.clone().find(|row| row.stable)?;
        let longest = if rows.any(|row| row.step > largest.step) { "" } else { ", the longest tried" };
        let order = self.orders.iter().find(|order| order.method == method);
        let said = order.map_or_else(|| "-".into(), |order| format!("{:.2} ({:.0})", order.measured, order.theory));
        let remark = match order {
            None => "    too few errors for an order",
            Some(order) if is_of_order(order.measured, order.theory) => "",
            Some(_) if self.is_of_contact() => "    its order collapses",
            Some(_) => "    its steps are not small enough yet, or forces jump",
        };
        Some(format!("{method:<18} {said:<10}       {:>10}{longest}{remark}", time(largest.step)))
    }
}
