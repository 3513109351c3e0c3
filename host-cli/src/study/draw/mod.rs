//! Pictures of studies.

mod causes;
mod choose;
mod control;
mod crosses;
mod master_curve;
mod needs;
mod rigidity;
mod series;
mod stability;
mod stretch;
mod work_precision;

pub use choose::choose;
pub use master_curve::master_curve;
pub use needs::needs;
pub use rigidity::rigidity;
pub use stability::stability;
pub use work_precision::work_precision;

use kuva::plot::ScatterPlot;
use kuva::plot::scatter::MarkerShape;

/// Name, colour and marker of each method. Colour-blind readers can distinguish the colours [Wong 2011]; the
/// markers serve prints without colour.
pub const LOOKS: [(&str, &str, MarkerShape); 7] = [
    ("explicit-euler", "#cc79a7", MarkerShape::TriangleDown),
    ("symplectic-euler", "#e69f00", MarkerShape::Triangle),
    ("midpoint", "#56b4e9", MarkerShape::Diamond),
    ("rk4", "#0072b2", MarkerShape::Square),
    ("backward-euler", "#000000", MarkerShape::Circle),
    ("implicit-midpoint", "#009e73", MarkerShape::Pentagon),
    ("bdf2", "#d55e00", MarkerShape::Star),
];

/// Room between the outermost marks and the ends of a logarithmic axis, as a part of its length, and the smallest
/// factor.
const ROOM: f64 = 0.03;
const LEAST_ROOM: f64 = 1.1;

/// The smallest and the largest value.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high), value| (low.min(value), high.max(value)))
}

/// A range of a logarithmic axis with room for whole marks at its ends.
fn room((low, high): (f64, f64)) -> (f64, f64) {
    let factor = (high / low).powf(ROOM).max(LEAST_ROOM);
    (low / factor, high * factor)
}

/// Puts the name of a method into the legend with its first marks only.
fn named(marks: ScatterPlot, name: &mut Option<&str>) -> ScatterPlot {
    match name.take() {
        Some(name) => marks.with_legend(name),
        None => marks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel is at least 300 px wide and a mark has a radius of up to 5 px.
    #[test]
    fn marks_at_the_ends_of_an_axis_are_whole() {
        for (low, high) in [(1.0, 1.0), (1e-3, 2e-3), (1e-14, 1e-2)] {
            let (from, to) = room((low, high));
            let length = f64::ln(to / from) / 300.0;
            assert!(f64::ln(low / from) >= 5.0 * length && f64::ln(to / high) >= 5.0 * length, "{low} to {high}");
        }
    }
}
