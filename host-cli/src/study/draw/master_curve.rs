//! The picture of `muslin validate`: the master curve of the heavy cantilever and the results of the core.

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::validate::{CUTS, GAMMAS, Row, TOLERANCE, drop_over_reach};

/// Colour [Wong 2011], marker and size for each of the three cuts.
const LOOKS: [(&str, MarkerShape, f64); 3] = [
    ("#0072b2", MarkerShape::Square, 5.5),
    ("#d55e00", MarkerShape::Triangle, 4.5),
    ("#009e73", MarkerShape::Circle, 3.0),
];

/// Size of one panel, px.
const PANEL: [f64; 2] = [430.0, 400.0];

/// Range of Gamma that is drawn, slightly wider than the measured one.
const ENDS: (f64, f64) = (0.06, 1600.0);

/// Number of points of the curve.
const POINTS: u32 = 120;

/// Drop over reach against Gamma, and beside it the error. `None` if nothing was measured.
pub fn master_curve(rows: &[Row]) -> Option<String> {
    let panel = |title: &str, label: &str, heights: (f64, f64)| {
        let layout = Layout::new(ENDS, heights).with_title(title).with_x_label("Gamma = w L^3 / D").with_y_label(label);
        layout.with_log_x().with_x_tick_format(TickFormat::Sci)
    };
    let measured = points(rows, |row| row.measured);
    if measured.iter().all(Vec::is_empty) {
        return None;
    }
    let errors = points(rows, |row| row.error.map(|error| 100.0 * error));
    let reach = errors.iter().flatten().map(|point| point.1.abs()).fold(150.0 * TOLERANCE, |a, b| a.max(1.1 * b));
    let drops = panel("drop over reach", "H / W", (drop_over_reach(ENDS.0), drop_over_reach(ENDS.1)));
    let off = panel("its error", "error of H / W, per cent", (-reach, reach));
    let curve = LinePlot::new().with_data(curve()).with_color("#000000").with_stroke_width(1.2).with_legend("truth");
    let above = [curve].into_iter().map(Plot::Line).chain(marks(measured, true));
    let beside = band().into_iter().map(Plot::Line).chain(marks(errors, false));
    let figure = Figure::new(1, 2)
        .with_title("Strips of the default mesh, cut in three directions, bend under their weight")
        .with_plots(vec![above.collect(), beside.collect()])
        .with_layouts(vec![drops.with_log_y().with_y_tick_format(TickFormat::Sci), off])
        .with_cell_size(PANEL[0], PANEL[1])
        .with_shared_legend_right_middle();
    Some(SvgBackend.render_scene(&figure.render()))
}

/// For each cut, Gamma and a value of the checks that have one.
fn points(rows: &[Row], value: fn(&Row) -> Option<f64>) -> [Vec<(f64, f64)>; 3] {
    CUTS.map(|cut| {
        let at = |gamma: f64| rows.iter().find(|row| row.name == cut.check(gamma)).and_then(value);
        GAMMAS.into_iter().filter_map(|gamma| Some((gamma, at(gamma)?))).collect()
    })
}

fn marks(points: [Vec<(f64, f64)>; 3], named: bool) -> impl Iterator<Item = Plot> {
    let each = points.into_iter().zip(CUTS).zip(LOOKS).filter(|((points, _), _)| !points.is_empty());
    each.map(move |((points, cut), (color, marker, size))| {
        let marks = ScatterPlot::new().with_data(points).with_color(color).with_marker(marker).with_size(size);
        Plot::Scatter(if named { marks.with_legend(cut.name) } else { marks })
    })
}

/// The exact curve at points that are equidistant in log Gamma.
fn curve() -> Vec<(f64, f64)> {
    let grown = ENDS.1 / ENDS.0;
    let gammas = (0..=POINTS).map(|k| ENDS.0 * grown.powf(f64::from(k) / f64::from(POINTS)));
    gammas.map(|gamma| (gamma, drop_over_reach(gamma))).collect()
}

/// Lines at zero error and at the tolerance.
fn band() -> Vec<LinePlot> {
    let level = |percent: f64| LinePlot::new().with_data([(ENDS.0, percent), (ENDS.1, percent)]).with_color("#000000");
    let bound = |sign: f64| level(100.0 * sign * TOLERANCE).with_dashed();
    vec![level(0.0).with_stroke_width(1.2), bound(1.0).with_legend("tolerated"), bound(-1.0)]
}
