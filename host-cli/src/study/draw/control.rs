//! The panel of error control: the error that runs reach against the allowed error of a step.

use std::sync::Arc;

use kuva::plot::LinePlot;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Chart, Row};
use crate::units::round_length;

use super::work_precision::{BESIDE_LENGTHS, DRAWN};
use super::{range, series};

/// The panel; `None` if no run has error control.
pub fn panel(chart: &Chart) -> Option<(Vec<Plot>, Layout)> {
    let at = |row: &Row| Some((DRAWN * row.allowed_error_m?, DRAWN * row.reached_m(chart.diagonal_m)?));
    let runs: Vec<_> = chart.rows.iter().filter_map(at).collect();
    if runs.is_empty() {
        return None;
    }
    let allowed = range(runs.iter().map(|(allowed, _)| *allowed));
    let reached = range(runs.iter().map(|(_, reached)| *reached).chain([allowed.0, allowed.1]));
    let equal = LinePlot::new().with_data([allowed.0, allowed.1].map(|error| (error, error)));
    let mut plots = vec![Plot::Line(equal.with_color("#888888").with_dashed().with_legend("reached = allowed"))];
    plots.extend(series::all(&chart.rows, at));
    let layout = Layout::new(allowed, reached)
        .with_log_scale()
        .with_x_tick_format(TickFormat::Custom(Arc::new(|drawn| format!("{:.0e}", drawn / DRAWN))))
        .with_y_tick_format(TickFormat::Custom(Arc::new(|drawn| round_length(drawn / DRAWN))))
        .with_title("error control")
        .with_x_label("allowed error of a step, m")
        .with_y_label(format!("RMS error of {}", chart.measure.name()))
        .with_y_label_offset(BESIDE_LENGTHS, 0.0);
    Some((plots, layout))
}
