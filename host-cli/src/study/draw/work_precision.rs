//! The picture of `muslin chart`: error against step and against cost, allowed against reached error, the causes of the
//! error, and with contact the stretch.

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Chart, Row, front};
use crate::units::round_length;

use super::crosses::Crosses;
use super::{LOOKS, causes, control, named, range, room, series, stretch};

/// Factor from the error to the drawn number: the library draws nothing below 1e-10.
pub const DRAWN: f64 = 1e6;

/// The unit of an axis whose ticks are lengths, from picometres to metres.
pub const UNIT: &str = "unit at the ticks";

/// Horizontal offset of a y label beside ticks that are lengths, px: the library underestimates their width.
pub const BESIDE_LENGTHS: f64 = -14.0;

/// Colours of the marks that belong to no method, and of the front.
const GRAY: &str = "#666666";
const FRONT: &str = "#cccccc";

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
    /// Whether costs are compared. Then failures are not shown, since the time of a failed run is not the cost of any
    /// result; the front and the runs with other solvers are.
    costs: bool,
    /// Drawn number of an error as large as the diagonal.
    unit: f64,
    up: String,
    /// Horizontal offset of the y label from its default position, px: the library underestimates the width of tick
    /// labels.
    aside: f64,
    format: fn(f64) -> String,
}

impl Panel {
    /// The position of a run, if its error is known.
    fn at(&self, row: &Row) -> Option<(f64, f64)> {
        Some(((self.across)(row), self.unit * row.error_rms?))
    }
}

/// Error as a part of the diagonal against step, and beside it error as a length against computing time.
pub fn work_precision(chart: &Chart) -> String {
    let measure = chart.measure.name();
    let by_step = Panel {
        title: "by step",
        label: "step, s; with error control the mean",
        across: |row| row.step,
        costs: false,
        unit: DRAWN,
        up: format!("RMS error of {measure} / diagonal of {:.2} m", chart.diagonal_m),
        aside: 0.0,
        format: |drawn| format!("{:.0e}", drawn / DRAWN),
    };
    let by_cost = Panel {
        title: "by cost, as a length",
        label: "computing time, s",
        across: |row| row.wall_s,
        costs: true,
        unit: DRAWN * chart.diagonal_m,
        up: format!("RMS error of {measure}, {UNIT}"),
        aside: BESIDE_LENGTHS,
        format: |drawn| round_length(drawn / DRAWN),
    };
    let mut panels = vec![draw(chart, &by_step), draw(chart, &by_cost)];
    panels.extend(control::panel(chart));
    panels.extend(causes::panel(chart));
    panels.extend(stretch::panel(chart));
    let rows = panels.len().div_ceil(2);
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let hollow =
        if has_nearest(chart) { "; hollow, with a tick down: below the resolution of the reference" } else { "" };
    let figure = Figure::new(rows, 2)
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
    let shown = chart.rows.iter().filter(|row| row.stable || !panel.costs);
    Layout::new(room(range(shown.map(panel.across))), (room((low, low)).0, crosses.top()))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_y_tick_format(crosses.ticks(panel.format))
        .with_title(panel.title)
        .with_x_label(panel.label)
        .with_y_label(panel.up.as_str())
        .with_y_label_offset(panel.aside, 0.0)
}

/// A line and marks for each method, precision and kind of step, and legend entries for the kinds of marks.
fn curves(chart: &Chart, panel: &Panel, crosses: &mut Crosses) -> Vec<Plot> {
    let mut plots = Vec::new();
    plots.extend(panel.costs.then(|| cheapest(chart, panel)));
    for (method, color, marker) in LOOKS {
        let mut name = Some(method);
        let own: Vec<_> = chart.rows.iter().filter(|row| row.method == method).collect();
        let marks = ScatterPlot::new().with_color(color).with_marker(marker);
        for rows in series::each(&own) {
            plots.extend(series::one(&rows, |row| panel.at(row), marks.clone(), &mut name));
            let marks = marks.clone().with_size(series::size(rows[0].precision));
            plots.extend(nearest(&rows, panel, chart.reference.least_charted, marks, &mut name));
        }
        let varied = own.iter().filter(|row| panel.costs && row.solver.is_some());
        let varied: Vec<_> = varied.filter_map(|row| panel.at(row)).collect();
        let marks = ScatterPlot::new().with_data(varied).with_color(color).with_marker(MarkerShape::Plus);
        plots.push(Plot::Scatter(marks.with_size(5.0)));
        // Rows of failures are reserved in both panels, so that both end at the same error.
        let failures = crosses.row(own.iter().filter(|row| !row.stable).map(|row| (panel.across)(row)));
        if !panel.costs && !failures.is_empty() {
            let marks = ScatterPlot::new().with_data(failures).with_color(color).with_marker(MarkerShape::Cross);
            plots.push(Plot::Scatter(named(marks.with_size(5.0), &mut name)));
        }
    }
    plots.extend(meanings(chart));
    plots
}

/// The front of the cheapest runs.
fn cheapest(chart: &Chart, panel: &Panel) -> Plot {
    let least = chart.reference.least_charted;
    let points = front(&chart.rows, least).into_iter();
    let points = points.filter_map(|row| Some(((panel.across)(row), panel.unit * row.error_at_most(least)?)));
    let line = LinePlot::new().with_data(points.collect::<Vec<_>>()).with_color(FRONT).with_stroke_width(6.0);
    Plot::Line(line.with_legend("cheapest"))
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
fn meanings(chart: &Chart) -> Vec<Plot> {
    let none = Vec::<(f64, f64)>::new;
    let line = || LinePlot::new().with_data(none()).with_color(GRAY).with_stroke_width(1.5);
    let marks = |marker| ScatterPlot::new().with_data(none()).with_color(GRAY).with_size(4.5).with_marker(marker);
    let mut meanings = vec![
        Plot::Line(line().with_legend("f64")),
        Plot::Line(line().with_dashed().with_legend("f32, small marks")),
        Plot::Scatter(marks(MarkerShape::Cross).with_legend("failed")),
    ];
    if chart.rows.iter().any(Row::is_controlled) {
        meanings.push(Plot::Line(line().with_dotted().with_legend("error control")));
    }
    if chart.rows.iter().any(|row| row.solver.is_some()) {
        meanings.push(Plot::Scatter(marks(MarkerShape::Plus).with_legend("other solver")));
    }
    meanings
}
