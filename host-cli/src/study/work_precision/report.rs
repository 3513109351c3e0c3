//! What a chart says in numbers and words.

use serde::Serialize;

use crate::study::distance::Measure;
use crate::study::draw::LOOKS;
use crate::units::{length, time};

/// Of the reference.
const RK4: f64 = 4.0;

/// How near to theory a measured order must be.
const NEAR_THEORY: f64 = 0.1;

/// Whether a measured order is that of theory.
pub fn is_of_order(measured: f64, theory: f64) -> bool {
    (measured - theory).abs() <= NEAR_THEORY
}

/// One run. Errors are parts of the cloth's diagonal.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// As scenes spell it.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// s.
    pub step: f64,
    /// Of the solver; none of explicit methods.
    pub tolerance: Option<f64>,
    /// Root of the mean square over all samples; of positions by mass, or of the outline. None where
    /// it failed or is nearer than the reference can tell.
    pub error_rms: Option<f64>,
    /// The largest.
    pub error_max: Option<f64>,
    /// The largest difference of total energy from the reference's, over the most kinetic and
    /// elastic energy that has.
    pub energy_drift: Option<f64>,
    /// The largest length over rest length of an edge, at any sample.
    pub stretch: f64,
    /// The deepest that a vertex lay in a collider at any sample, m; none without colliders.
    pub penetration_m: Option<f64>,
    /// In steps; the median of the repeats.
    pub wall_s: f64,
    /// Runs that were timed.
    pub repeats: usize,
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Whether it stayed near the reference at all.
    pub stable: bool,
    /// What went wrong, or why there is no error to tell.
    pub why: Option<String>,
}

impl Row {
    /// Whether it is nearer than the reference can tell.
    pub fn is_nearest(&self) -> bool {
        self.stable && self.error_rms.is_none()
    }

    /// Its error, or what that is less than; none where it failed.
    pub fn error_at_most(&self, least: f64) -> Option<f64> {
        self.error_rms.or(self.stable.then_some(least))
    }
}

/// What errors are measured against.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceReport {
    /// As scenes spell it; in double precision.
    pub method: &'static str,
    /// s.
    pub step: f64,
    /// Its distance from the run with twice its step, of the diagonal.
    pub self_error: f64,
    /// By which power of the step it converged in its last halvings; none after only one.
    pub order: Option<f64>,
    /// Errors below this are left out, of the diagonal.
    pub least_charted: f64,
    /// How an implicit method agrees.
    pub agreement: Option<Agreement>,
}

/// An implicit method that approaches the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Agreement {
    /// As scenes spell it.
    pub method: &'static str,
    /// By which power of the step.
    pub order: f64,
    /// How near it came, of the diagonal.
    pub error_rms: f64,
}

/// The cheapest method for an error.
#[derive(Clone, Debug, Serialize)]
pub struct Winner {
    /// At most, of the diagonal.
    pub error: f64,
    /// As scenes spell it.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// s.
    pub step: f64,
    /// s.
    pub wall_s: f64,
    /// The second, and how many times as long it takes.
    pub next: Option<(&'static str, f64)>,
}

/// The slope of a method's error.
#[derive(Clone, Debug, Serialize)]
pub struct Order {
    /// As scenes spell it.
    pub method: &'static str,
    /// Over its last three steps in double precision.
    pub measured: f64,
    /// Where forces are smooth and steps small.
    pub theory: f64,
}

/// A method without a single good run.
#[derive(Clone, Debug, Serialize)]
pub struct Omitted {
    /// As scenes spell it.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// The reason.
    pub why: String,
}

/// `chart --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// Its name.
    pub scene: String,
    /// Simulated, s.
    pub duration_s: f64,
    /// Of all cloths.
    pub vertices: usize,
    /// Of the box around the cloth at its start, m.
    pub diagonal_m: f64,
    /// What an error is of: positions, or with contact the outline.
    pub measure: Measure,
    /// What errors are measured against.
    pub reference: ReferenceReport,
    /// The processor; one thread of it.
    pub machine: String,
    /// All runs.
    pub rows: Vec<Row>,
    /// Slopes.
    pub orders: Vec<Order>,
    /// Cheapest methods.
    pub winners: Vec<Winner>,
    /// What could not be charted.
    pub omitted: Vec<Omitted>,
    /// What the study took, s.
    pub study_s: f64,
}

impl Chart {
    /// For people.
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
            "error          cheapest                      step       wall       next".into(),
        ];
        lines.extend(self.winners.iter().map(|w| {
            let next = w.next.map_or_else(String::new, |(method, ratio)| format!("{method} ({ratio:.1}x)"));
            let metres = length(w.error * self.diagonal_m);
            let name = format!("{} {}", w.method, w.precision);
            format!("{:<5.0e} {metres:<8} {name:<23} {:>10} {:>10}       {next}", w.error, time(w.step), time(w.wall_s))
        }));
        lines.extend([String::new(), "method             order (theory)   largest step that works".into()]);
        lines.extend(LOOKS.iter().filter_map(|(method, ..)| self.method_line(method)));
        lines.extend(self.contact_lines());
        lines.extend(self.omitted.iter().map(|o| format!("not charted: {} {}: {}", o.method, o.precision, o.why)));
        lines.join("\n")
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
                    "{} comes as near as {:.1e} to it, by order {:.2}: both ways agree",
                    a.method, a.error_rms, a.order
                )
            }
            None if self.is_of_contact() => {
                "with contact velocities jump: the order of every method collapses to one or \
                                             less, and smaller steps change what touches first, not only how exactly"
                    .into()
            }
            None => "no implicit method confirms it".into(),
        }
    }

    /// What else shows how a method goes where the order says nothing, at its shortest step in double precision.
    fn contact_lines(&self) -> Vec<String> {
        let shortest =
            |method: &str| self.rows.iter().rfind(|row| row.method == method && row.precision == "f64" && row.stable);
        let rows: Vec<_> = LOOKS.iter().filter_map(|(method, ..)| shortest(method)).collect();
        if !self.is_of_contact() || rows.is_empty() {
            return Vec::new();
        }
        let head = "shortest step                   outline       stretch   energy    penetration";
        let lines = rows.into_iter().map(|row| {
            let [outline, depth] = [row.error_rms.map(|error| error * self.diagonal_m), row.penetration_m];
            let [outline, depth] = [outline, depth].map(|metres| metres.map_or_else(|| "-".into(), length));
            let drift = row.energy_drift.map_or_else(|| "-".into(), |drift| format!("{:.2} %", 100.0 * drift));
            let stretch = format!("{:.2} %", 100.0 * (row.stretch - 1.0));
            format!("{:<18} {:>10}   {outline:<11} {stretch:>9} {drift:>9}   {depth}", row.method, time(row.step))
        });
        [String::new(), head.into()].into_iter().chain(lines).collect()
    }

    /// The order of a method and its largest step, if any works.
    fn method_line(&self, method: &str) -> Option<String> {
        let mut rows = self.rows.iter().filter(|row| row.method == method && row.precision == "f64");
        let largest = rows.clone().find(|row| row.stable)?;
        let longest = if rows.any(|row| row.step > largest.step) { "" } else { ", the longest tried" };
        let order = self.orders.iter().find(|order| order.method == method);
        let said = order.map_or_else(|| "-".into(), |order| format!("{:.2} ({:.0})", order.measured, order.theory));
        let remark = match order {
            None => "    too few errors for an order",
            Some(order) if is_of_order(order.measured, order.theory) => "",
            Some(_) if self.is_of_contact() => "    its order collapses",
            Some(_) => "    its steps are not small yet, or forces jump",
        };
        Some(format!("{method:<18} {said:<10}       {:>10}{longest}{remark}", time(largest.step)))
    }
}
