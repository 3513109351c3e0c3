//! Error against step and against cost.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Chart, Row};

use super::{LOOKS, named, range};

/// Errors are drawn in these units of the diagonal: the library draws nothing below 1e-10.
const DRAWN: f64 = 1e6;

/// px of one panel.
const PANEL: [f64; 2] = [430.0, 400.0];

/// Error against step beside error against time.
pub fn work_precision(chart: &Chart) -> String {
    let floor = chart.reference.least_charted;
    let errors = range(chart.rows.iter().filter_map(|row| row.error_at_most(floor)));
    // Crosses for what failed stand above all that did not.
    let top = 3.0 * errors.1;
    let panel = |title: &str, label: &str, failures: bool, across: fn(&Row) -> f64| {
        let shown = chart.rows.iter().filter(|row| row.stable || failures);
        let layout = Layout::new(range(shown.map(across)), (DRAWN * errors.0, DRAWN * top))
            .with_log_scale()
            .with_x_tick_format(TickFormat::Sci)
            .with_y_tick_format(TickFormat::Custom(Arc::new(|drawn| format!("{:.0e}", drawn / DRAWN))))
            .with_title(title)
            .with_x_label(label)
            .with_y_label(format!("RMS error of {} / {:.2} m", chart.measure.name(), chart.diagonal_m));
        (curves(chart, across, failures.then_some(top)), layout)
    };
    let (by_step, by_step_layout) = panel("by step", "step, s", true, |row| row.step);
    let (by_time, by_time_layout) = panel("by cost", "computing time, s", false, |row| row.wall_s);
    let figure = Figure::new(1, 2)
        .with_title(format!("{}, {} s: full f64, dashed f32, crosses failed", chart.scene, chart.duration_s))
        .with_plots(vec![by_step, by_time])
        .with_layouts(vec![by_step_layout, by_time_layout])
        .with_cell_size(PANEL[0], PANEL[1])
        .with_shared_legend_right_middle();
    SvgBackend.render_scene(&figure.render())
}

/// A line and marks for each method and precision, and crosses at `top` for what failed: what that
/// took is no cost of anything. What is nearer than the reference can tell stands at the least that it
/// can.
fn curves(chart: &Chart, across: fn(&Row) -> f64, top: Option<f64>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (method, color, marker) in LOOKS {
        let mut name = Some(method);
        for precision in ["f64", "f32"] {
            let rows = || chart.rows.iter().filter(|row| row.method == method && row.precision == precision);
            let good: Vec<_> = rows()
                .filter_map(|row| Some((across(row), DRAWN * row.error_at_most(chart.reference.least_charted)?)))
                .collect();
            let bad: Vec<_> =
                rows().filter(|row| !row.stable).filter_map(|row| Some((across(row), DRAWN * top?))).collect();
            let double = precision == "f64";
            if !good.is_empty() {
                let line = LinePlot::new().with_data(good.clone()).with_color(color).with_stroke_width(1.5);
                plots.push(Plot::Line(if double { line } else { line.with_dashed() }));
                let marks = ScatterPlot::new().with_data(good).with_color(color).with_marker(marker);
                plots.push(Plot::Scatter(named(marks.with_size(if double { 4.5 } else { 2.5 }), &mut name)));
            }
            if !bad.is_empty() {
                let marks = ScatterPlot::new().with_data(bad).with_color(color).with_marker(MarkerShape::Cross);
                plots.push(Plot::Scatter(named(marks.with_size(5.0), &mut name)));
            }
        }
    }
    plots
}
