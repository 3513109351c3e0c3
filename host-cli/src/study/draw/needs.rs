//! The picture of `muslin needs`.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::annotations::ReferenceLine;
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::range;
use crate::study::needs::{Deed, Needs, Row, Verdict};

/// Colours that the colour-blind tell apart [Wong 2011].
const DEEDS: [(Deed, &str, &str); 3] = [
    (Deed::Off, "switched off", "#0072b2"),
    (Deed::Simpler, "put simpler", "#e69f00"),
    (Deed::Added, "added", "#009e73"),
];

/// px: of each panel, of what is above and below the bars, of a bar and from one to the next.
const WIDTHS: [f64; 2] = [480.0, 360.0];
const MARGIN: f64 = 130.0;
const BAR: f64 = 12.0;
const PITCH: f64 = 24.0;

/// What each term changes beside what it costs.
pub fn needs(needs: &Needs) -> String {
    let height = MARGIN + PITCH * (needs.rows.len() + 1) as f64;
    let figure = Figure::new(1, 2)
        .with_title(format!("{}, {} s: what each term is worth", needs.scene, needs.duration_s))
        .with_plots(vec![changes(needs), costs(needs)])
        .with_layouts(vec![change_layout(needs), cost_layout(needs)])
        .with_cell_size(WIDTHS[0], height)
        .with_col_width(0, WIDTHS[0])
        .with_col_width(1, WIDTHS[1])
        .with_shared_legend_bottom();
    SvgBackend.render_scene(&figure.render())
}

/// Rows with the height at which they stand: the first on top.
fn places(needs: &Needs) -> impl Iterator<Item = (f64, &Row)> {
    let count = needs.rows.len();
    needs.rows.iter().enumerate().map(move |(row, what)| ((count - row) as f64, what))
}

fn bar(from: f64, to: f64, height: f64, color: &str, width: f64) -> Plot {
    Plot::Line(LinePlot::new().with_data(vec![(from, height), (to, height)]).with_color(color).with_stroke_width(width))
}

fn marks(data: Vec<(f64, f64)>, marker: MarkerShape, name: &str) -> Option<Plot> {
    let marks = ScatterPlot::new().with_color("#000000").with_marker(marker).with_size(4.0).with_legend(name);
    (!data.is_empty()).then(|| Plot::Scatter(marks.with_data(data)))
}

/// Bars of each deed, the first with its name.
fn bars(needs: &Needs, ends: impl Fn(&Row) -> Option<[f64; 2]>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (deed, name, color) in DEEDS {
        let rows = places(needs).filter(|(_, row)| row.deed == deed);
        let mut drawn: Vec<_> = rows.filter_map(|(at, row)| Some((at, ends(row)?))).collect();
        let first = drawn.pop().map(|(at, [from, to])| {
            let line = LinePlot::new().with_data(vec![(from, at), (to, at)]).with_color(color);
            Plot::Line(line.with_stroke_width(BAR).with_legend(name))
        });
        plots.extend(first);
        plots.extend(drawn.into_iter().map(|(at, [from, to])| bar(from, to, at, color, BAR)));
    }
    plots
}

/// Whole decades around all changes, mm.
fn span(needs: &Needs) -> (f64, f64) {
    let rows = needs.rows.iter().flat_map(|row| [row.change_rms, row.change_max]);
    let own = needs.step_error.map(|own| own.rms);
    let changes = rows.chain([own]).flatten().filter(|change| *change > 0.0);
    match range(changes.map(|metres| 1e3 * metres)) {
        (least, most) if least <= most => {
            // Room for the shortest bar, and for crosses beyond the longest.
            (10f64.powf((0.5 * least).log10().floor()), 10f64.powf((2.0 * most).log10().ceil()))
        }
        _ => (1e-3, 1.0),
    }
}

/// Bars of the RMS, dots at the largest, crosses at the far end for what diverges.
fn changes(needs: &Needs) -> Vec<Plot> {
    let (from, to) = span(needs);
    let mut plots = bars(needs, |row| row.change_rms.filter(|rms| *rms > 0.0).map(|rms| [from, 1e3 * rms]));
    let most = places(needs).filter_map(|(at, row)| Some((1e3 * row.change_max.filter(|max| *max > 0.0)?, at)));
    plots.extend(marks(most.collect(), MarkerShape::Circle, "largest"));
    let diverged = places(needs).filter(|(_, row)| row.verdict == Verdict::Diverged).map(|(at, _)| (to / 1.5, at));
    plots.extend(marks(diverged.collect(), MarkerShape::Cross, "diverges"));
    plots
}

fn layout(needs: &Needs, across: (f64, f64), title: &str, label: &str) -> Layout {
    Layout::new(across, (0.4, needs.rows.len() as f64 + 1.4)).with_title(title).with_x_label(label)
}

fn change_layout(needs: &Needs) -> Layout {
    let format = TickFormat::Custom(Arc::new(|mm| if mm < 0.01 { format!("{mm:.0e}") } else { format!("{mm}") }));
    let names = needs.rows.iter().rev().map(|row| row.run.clone());
    let layout = layout(needs, span(needs), "change", &format!("RMS change of {}, mm", needs.measure.name()))
        .with_log_x()
        .with_x_tick_format(format)
        .with_y_categories(names.collect());
    match needs.step_error {
        Some(own) if own.rms > 0.0 => {
            layout.with_reference_line(ReferenceLine::vertical(1e3 * own.rms).with_label("half the step"))
        }
        _ => layout,
    }
}

/// Bars of the median and lines from the least to the most, %.
fn costs(needs: &Needs) -> Vec<Plot> {
    let mut plots = bars(needs, |row| row.cost_fraction.map(|cost| [0.0, 100.0 * cost]));
    let ranges = places(needs).filter_map(|(at, row)| Some((at, row.cost_range.filter(|_| row.repeats > 1)?)));
    plots.extend(ranges.map(|(at, [least, most])| bar(100.0 * least, 100.0 * most, at, "#000000", 1.5)));
    plots
}

fn cost_layout(needs: &Needs) -> Layout {
    let ends = || needs.rows.iter().filter_map(|row| row.cost_range).flatten().map(|cost| 100.0 * cost);
    let (least, most) = (ends().fold(-10.0, f64::min), ends().fold(10.0, f64::max));
    let names = needs.rows.iter().map(|_| String::new()).collect();
    layout(needs, (1.1 * least, 1.1 * most), "cost", "part of the time as it is, %")
        .with_y_categories(names)
        .with_reference_line(ReferenceLine::vertical(0.0).with_color("#666666").with_dasharray("none"))
}
