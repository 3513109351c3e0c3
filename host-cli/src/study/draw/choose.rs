//! Error against cost of what was considered, and the tolerance.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::choose::{Choice, Row};

use super::{LOOKS, named, range};

/// Errors are drawn in micrometres: the library draws nothing below 1e-10.
const DRAWN: f64 = 1e6;

/// px.
const PANEL: [f64; 2] = [660.0, 400.0];

/// Error against time; crosses at the top, by the time that they took, are what failed or was given up.
pub fn choose(choice: &Choice) -> String {
    let rows = &choice.considered;
    let errors = range(rows.iter().filter_map(|row| row.error).chain([choice.tolerance]));
    let (top, times) = (3.0 * errors.1, range(rows.iter().map(|row| row.wall_s)));
    let layout = Layout::new(times, (DRAWN * errors.0, DRAWN * top))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_y_tick_format(TickFormat::Custom(Arc::new(|drawn| format!("{:.0e}", drawn / DRAWN))))
        .with_title(format!("{}: chosen {} {}", choice.scene, choice.chosen.method, choice.chosen.precision))
        .with_x_label("computing time, s; crosses: failed or given up")
        .with_y_label(format!("RMS error of {}, m", choice.measure.name()));
    let allowed = LinePlot::new().with_data([times.0, times.1].map(|time| (time, DRAWN * choice.tolerance)));
    let mut plots = vec![Plot::Line(allowed.with_color("#888888").with_dashed().with_legend("tolerance"))];
    plots.extend(LOOKS.iter().flat_map(|&(method, color, marker)| marks(rows, method, color, marker, top)));
    let chosen = ScatterPlot::new().with_data([(choice.predicted.wall_s, DRAWN * choice.predicted.error)]);
    plots.push(Plot::Scatter(
        chosen.with_color("#000000").with_marker(MarkerShape::Plus).with_size(9.0).with_legend("chosen"),
    ));
    let figure = Figure::new(1, 1).with_plots(vec![plots]).with_layouts(vec![layout]);
    SvgBackend.render_scene(&figure.with_cell_size(PANEL[0], PANEL[1]).with_shared_legend_right_middle().render())
}

/// The runs of a method, and crosses at `top` for those without an error.
fn marks(rows: &[Row], method: &str, color: &str, marker: MarkerShape, top: f64) -> Vec<Plot> {
    let of = |has_error: bool| {
        let rows = rows.iter().filter(move |row| row.method == method && row.error.is_some() == has_error);
        rows.map(|row| (row.wall_s, DRAWN * row.error.unwrap_or(top))).collect::<Vec<_>>()
    };
    let groups = [(of(true), marker, 4.5), (of(false), MarkerShape::Cross, 5.0)];
    let mut name = Some(method);
    let drawn = groups.into_iter().filter(|(data, ..)| !data.is_empty()).map(|(data, marker, size)| {
        let marks = ScatterPlot::new().with_data(data).with_color(color).with_marker(marker).with_size(size);
        Plot::Scatter(named(marks, &mut name))
    });
    drawn.collect()
}
