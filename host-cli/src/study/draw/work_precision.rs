//! The picture of `muslin chart`: error against step and error against cost.

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Chart, Row};
use crate::units::round_length;

use super::crosses::Crosses;
use super::{LOOKS, named, range};

/// Factor from the error to the drawn number: the library draws nothing below 1e-10.
const DRAWN: f64 = 1e6;

/// Size of one panel, px.
const PANEL: [f64; 2] = [430.0, 400.0];

/// Factor by which the tick of a hollow mark reaches below the smallest error that the reference resolves.
const TICK: f64 = 2.0;

/// Part of a hollow mark's diameter that is white.
const HOLLOW: f64 = 0.6;

/// The contents of one panel.
struct Panel {
    title: &'static str,
    label: &'static str,
    across: fn(&Row) -> f64,
    /// Whether failures are shown: the time of a failed run is not the cost of any result.
    failures: bool,
    /// Drawn number of an error as large as the diagonal.
    unit: f64,
    up: String,
    /// Horizontal offset of the y label from its default position, px: the library underestimates the width of tick
    /// labels.
    aside: f64,
    format: fn(f64) -> String,
}

/// Error as a part of the diagonal against step, and beside it error as a length against computing time.
pub fn work_precision(chart: &Chart) -> String {
    let measure = chart.measure.name();
    let by_step = Panel {
        title: "by step",
        label: "step, s",
        across: |row| row.step,
        failures: true,
        unit: DRAWN,
        up: format!("RMS error of {measure} / {:.2} m", chart.diagonal_m),
        aside: 0.0,
        format: |drawn| format!("{:.0e}", drawn / DRAWN),
    };
    let by_cost = Panel {
        title: "by cost, as a length",
        label: "computing time, s",
        across: |row| row.wall_s,
        failures: false,
        unit: DRAWN * chart.diagonal_m,
        up: format!("RMS error of {measure}"),
        aside: -14.0,
        format: |drawn| round_length(drawn / DRAWN),
    };
    let (plots, layouts): (Vec<_>, Vec<_>) = [by_step, by_cost].iter().map(|panel| draw(chart, panel)).unzip();
    let hollow =
        if has_nearest(chart) { "; hollow, with a tick down: below the resolution of the reference" } else { "" };
    let figure = Figure::new(1, 2)
        .with_title(format!("{}, {} s{hollow}", chart.scene, chart.duration_s))
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(PANEL[0], PANEL[1])
        .with_shared_legend_right_middle();
    SvgBackend.render_scene(&figure.render())
}

fn draw(chart: &Chart, panel: &Panel) -> (Vec<Plot>, Layout) {
    let floor = chart.reference.least_charted;
    let (low, high) = range(chart.rows.iter().filter_map(|row| row.error_at_most(floor)));
    let low = if has_nearest(chart) { low / TICK } else { low };
    let mut crosses = Crosses::above(panel.unit * high);
    let plots = curves(chart, panel, &mut crosses);
    (plots, layout(chart, panel, panel.unit * low, &crosses))
}

fn has_nearest(chart: &Chart) -> bool {
    chart.rows.iter().any(Row::is_nearest)
}

fn layout(chart: &Chart, panel: &Panel, low: f64, crosses: &Crosses) -> Layout {
    let shown = chart.rows.iter().filter(|row| row.stable || panel.failures);
    Layout::new(range(shown.map(panel.across)), (low, crosses.top()))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_y_tick_format(crosses.ticks(panel.format))
        .with_title(panel.title)
        .with_x_label(panel.label)
        .with_y_label(panel.up.as_str())
        .with_y_label_offset(panel.aside, 0.0)
}

/// A line and marks for each method and precision, and legend entries for the kinds of marks.
fn curves(chart: &Chart, panel: &Panel, crosses: &mut Crosses) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (method, color, marker) in LOOKS {
        let mut name = Some(method);
        for precision in ["f64", "f32"] {
            let rows: Vec<_> =
                chart.rows.iter().filter(|row| row.method == method && row.precision == precision).collect();
            let marks = ScatterPlot::new().with_color(color).with_size(if precision == "f64" { 4.5 } else { 2.5 });
            plots.extend(plots_of(&rows, panel, precision, marks.clone().with_marker(marker), &mut name));
            plots.extend(nearest(&rows, panel, chart.reference.least_charted, marks.with_marker(marker), &mut name));
        }
        // Rows of failures are reserved in both panels, so that both end at the same error.
        let failures = chart.rows.iter().filter(|row| row.method == method && !row.stable);
        let failures = crosses.row(failures.map(panel.across));
        if panel.failures && !failures.is_empty() {
            let marks = ScatterPlot::new().with_data(failures).with_color(color).with_marker(MarkerShape::Cross);
            plots.push(Plot::Scatter(named(marks.with_size(5.0), &mut name)));
        }
    }
    plots.extend(meanings());
    plots
}

/// Line and marks of the errors that the reference resolves.
fn plots_of(
    rows: &[&Row],
    panel: &Panel,
    precision: &str,
    marks: ScatterPlot,
    name: &mut Option<&'static str>,
) -> Vec<Plot> {
    let at: Vec<_> = rows.iter().filter_map(|row| Some(((panel.across)(row), panel.unit * row.error_rms?))).collect();
    if at.is_empty() {
        return Vec::new();
    }
    let line = LinePlot::new().with_data(at.clone()).with_color(marks.color.clone()).with_stroke_width(1.5);
    let line = if precision == "f64" { line } else { line.with_dashed() };
    vec![Plot::Line(line), Plot::Scatter(named(marks.with_data(at), name))]
}

/// Hollow marks for errors that are too small for the reference. They stand at the smallest error that it resolves,
/// with a tick down.
fn nearest(rows: &[&Row], panel: &Panel, least: f64, marks: ScatterPlot, name: &mut Option<&'static str>) -> Vec<Plot> {
    let (at, end) = (panel.unit * least, panel.unit * least / TICK);
    let across: Vec<_> = rows.iter().filter(|row| row.is_nearest()).map(|row| (panel.across)(row)).collect();
    let tick = |&x: &f64| {
        Plot::Line(
            LinePlot::new().with_data([(x, at), (x, end)]).with_color(marks.color.clone()).with_stroke_width(1.0),
        )
    };
    let mut plots: Vec<_> = across.iter().map(tick).collect();
    if !across.is_empty() {
        let data: Vec<_> = across.iter().map(|&x| (x, at)).collect();
        // The library can draw only circles hollow, so a smaller white mark covers the inside of the others.
        let inside = marks.clone().with_color("white").with_size(HOLLOW * marks.size).with_data(data.clone());
        plots.push(Plot::Scatter(named(marks.with_data(data), name)));
        plots.push(Plot::Scatter(inside));
    }
    plots
}

/// Legend entries that all methods share; they draw nothing.
fn meanings() -> [Plot; 3] {
    const GRAY: &str = "#666666";
    let none = Vec::<(f64, f64)>::new;
    let line = || LinePlot::new().with_data(none()).with_color(GRAY).with_stroke_width(1.5);
    let marks = ScatterPlot::new().with_data(none()).with_color(GRAY).with_size(4.5);
    [
        Plot::Line(line().with_legend("f64")),
        Plot::Line(line().with_dashed().with_legend("f32, small marks")),
        Plot::Scatter(marks.with_marker(MarkerShape::Cross).with_legend("failed")),
    ]
}
