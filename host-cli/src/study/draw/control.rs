//! The panel of error control: the error that runs reach against the allowed error of a step.

use std::sync::Arc;

use kuva::plot::LinePlot;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Chart, Row};
use crate::units::round_length;

use super::work_precision::{BESIDE_LENGTHS, DRAWN, UNIT};
use super::{range, room, series};

/// The label of a tick; those of odd powers of ten are empty, since there is no room for all.
fn every_second_power(drawn: f64) -> String {
    let error = drawn / DRAWN;
    let is_even = (error.log10().round() as i64).rem_euclid(2) == 0;
    if is_even { format!("{error:.0e}") } else { String::new() }
}

/// The panel; `None` if no run has error control.
pub fn panel(chart: &Chart) -> Option<(Vec<Plot>, Layout)> {
    let at = |row: &Row| Some((DRAWN * row.allowed_error_m?, DRAWN * row.reached_m(chart.diagonal_m)?));
    let runs: Vec<_> = chart.rows.iter().filter_map(at).collect();
    if runs.is_empty() {
        return None;
    }
    let allowed = range(runs.iter().map(|(allowed, _)| *allowed));
    let reached = range(runs.iter().map(|(_, reached)| *reached));
    let equal = [allowed.0.max(reached.0), allowed.1.min(reached.1)].map(|error| (error, error));
    let equal = LinePlot::new().with_data(equal);
    let mut plots = vec![Plot::Line(equal.with_color("#888888").with_dashed().with_legend("reached = allowed"))];
    plots.extend(series::all(&chart.rows, at));
    let layout = Layout::new(room(allowed), room(reached))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Custom(Arc::new(every_second_power)))
        .with_y_tick_format(TickFormat::Custom(Arc::new(|drawn| round_length(drawn / DRAWN))))
        .with_title("error control")
        .with_x_label("allowed error of a step, m")
        .with_y_label(format!("RMS error of {}, {UNIT}", chart.measure.name()))
        .with_y_label_offset(BESIDE_LENGTHS, 0.0);
    Some((plots, layout))
}
