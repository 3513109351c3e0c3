//! The picture of `muslin choose`: error against cost of all runs, and the tolerance.

use kuva::backend::svg::SvgBackend;
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::choose::{Choice, Row, Verdict};

use super::crosses::Crosses;
use super::{LOOKS, named, range, room};

/// Errors are drawn in micrometres: the library draws nothing below 1e-10.
const DRAWN: f64 = 1e6;

/// Size of the picture, px.
const PANEL: [f64; 2] = [660.0, 440.0];

/// Colour of the simplifications of the best method, and of the scene as it is written.
const TRIED: &str = "#666666";
const WRITTEN: &str = "#bbbbbb";

/// Error against computing time. Runs that were given up are crosses above all errors, one row for each method. Runs
/// that diverged are not drawn: their time is the cost of no result. Simplifications of the best method are numbered.
pub fn choose(choice: &Choice) -> String {
    let rows = &choice.considered;
    let errors = range(rows.iter().filter_map(|row| row.error).chain([choice.tolerance]));
    let timed = rows.iter().filter(|row| row.verdict != Verdict::Failed);
    let times = range(timed.map(|row| row.wall_s).chain([choice.predicted.wall_s]));
    let allowed = LinePlot::new().with_data([times.0, times.1].map(|time| (time, DRAWN * choice.tolerance)));
    let mut plots = vec![Plot::Line(allowed.with_color("#888888").with_dashed().with_legend("tolerance"))];
    plots.extend(rows.iter().filter(|row| row.as_written).filter_map(as_written));
    let mut crosses = Crosses::above(DRAWN * errors.1);
    plots.extend(LOOKS.iter().flat_map(|&look| method(rows, look, &mut crosses)));
    plots.extend(tried(rows, &mut crosses));
    let chosen = ScatterPlot::new().with_data([(choice.predicted.wall_s, DRAWN * choice.predicted.error)]);
    let chosen = chosen.with_color("#000000").with_marker(MarkerShape::Plus).with_size(9.0).with_legend("chosen");
    plots.push(Plot::Scatter(chosen));
    let layout = layout(choice, times, DRAWN * errors.0, &crosses);
    let figure = Figure::new(1, 1).with_plots(vec![plots]).with_layouts(vec![layout]);
    SvgBackend.render_scene(&figure.with_cell_size(PANEL[0], PANEL[1]).with_shared_legend_right_middle().render())
}

/// A halo behind the mark of the scene as it is written.
fn as_written(row: &Row) -> Option<Plot> {
    let halo = ScatterPlot::new().with_data([(row.wall_s, DRAWN * row.error?)]).with_color(WRITTEN).with_size(9.0);
    Some(Plot::Scatter(halo.with_marker(MarkerShape::Circle).with_legend("as written")))
}

fn layout(choice: &Choice, times: (f64, f64), low: f64, crosses: &Crosses) -> Layout {
    let ticks = crosses.ticks(|drawn| format!("{:.0e}", drawn / DRAWN));
    Layout::new(room(times), (room((low, low)).0, crosses.top()))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_y_tick_format(ticks)
        .with_title(format!("{}: chosen {} {}", choice.scene, choice.chosen.method, choice.chosen.precision))
        .with_x_label("computing time, s; crosses: given up; dashed: loose solver; dotted: error control")
        .with_y_label(format!("RMS error of {}, m", choice.measure.name()))
}

/// The kind of a run, which decides its line.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Fixed,
    Loose,
    Controlled,
}

impl Kind {
    fn of(row: &Row) -> Self {
        match (row.allowed_error, row.variant.looser > 1.0) {
            (Some(_), _) => Self::Controlled,
            (None, true) => Self::Loose,
            (None, false) => Self::Fixed,
        }
    }

    fn style(self) -> LineStyle {
        match self {
            Self::Fixed => LineStyle::Solid,
            Self::Loose => LineStyle::Dashed,
            Self::Controlled => LineStyle::Dotted,
        }
    }
}

/// The runs of one method with all terms in series of one precision and kind, from coarse to fine, and its crosses.
/// Marks of double precision are larger.
fn method(rows: &[Row], (method, color, marker): (&str, &str, MarkerShape), crosses: &mut Crosses) -> Vec<Plot> {
    let of = |precision: &'static str, kind: Kind| {
        let is_in = |row: &&Row| (row.precision, Kind::of(row)) == (precision, kind);
        let own = rows.iter().filter(|row| row.method == method && row.terms.is_empty()).filter(is_in);
        let mut ended: Vec<_> = own.filter_map(|row| Some((row, row.error?))).collect();
        ended.sort_by(|(a, _), (b, _)| a.variant.fineness().total_cmp(&b.variant.fineness()));
        ended.into_iter().map(|(row, error)| (row.wall_s, DRAWN * error)).collect::<Vec<_>>()
    };
    let mut name = Some(method);
    let mut plots = Vec::new();
    let kinds = [Kind::Fixed, Kind::Loose, Kind::Controlled];
    for (kind, (precision, size)) in kinds.into_iter().flat_map(|kind| [("f32", 4.0), ("f64", 6.5)].map(|p| (kind, p)))
    {
        let data = of(precision, kind);
        if data.is_empty() {
            continue;
        }
        let line = LinePlot::new().with_data(data.clone()).with_color(color).with_stroke_width(1.0);
        let marks = ScatterPlot::new().with_data(data).with_color(color).with_marker(marker).with_size(size);
        plots.extend([Plot::Line(line.with_line_style(kind.style())), Plot::Scatter(named(marks, &mut name))]);
    }
    let lost = rows.iter().filter(|row| row.method == method && row.terms.is_empty());
    let lost = lost.filter(|row| row.verdict == Verdict::Dear);
    let lost = crosses.row(lost.map(|row| row.wall_s));
    if !lost.is_empty() {
        let marks = ScatterPlot::new().with_data(lost).with_color(color).with_marker(MarkerShape::Cross);
        plots.push(Plot::Scatter(named(marks.with_size(5.0), &mut name)));
    }
    plots
}

/// The simplifications of the best method, numbered; those that were given up are crosses.
fn tried(rows: &[Row], crosses: &mut Crosses) -> Vec<Plot> {
    let tried = rows.iter().filter_map(|row| Some((row, row.terms.last()?)));
    let drawn = tried.enumerate().map(|(index, (row, term))| {
        let number = index + 1;
        let (data, marker, how) = match (row.error, row.verdict) {
            (Some(error), _) => (vec![(row.wall_s, DRAWN * error)], MarkerShape::Circle, ""),
            (None, Verdict::Failed) => (Vec::new(), MarkerShape::Cross, ": diverged"),
            (None, _) => (crosses.row([row.wall_s].into_iter()), MarkerShape::Cross, ""),
        };
        let marks = ScatterPlot::new().with_data(data).with_color(TRIED).with_marker(marker).with_size(3.0);
        Plot::Scatter(marks.with_labels([number.to_string()]).with_legend(format!("{number}: {term}{how}")))
    });
    drawn.collect()
}
