//! The picture of `muslin needs`.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::annotations::{ReferenceLine, TextAnnotation};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::range;
use crate::study::needs::{Needs, Row, Verdict};
use crate::study::terms::VariantKind;

/// Name and colour of each action; colour-blind readers can distinguish the colours [Wong 2011].
const KINDS: [(VariantKind, &str, &str); 3] = [
    (VariantKind::Off, "switched off", "#0072b2"),
    (VariantKind::Simpler, "put simpler", "#e69f00"),
    (VariantKind::Added, "added", "#009e73"),
];

/// Colour of the change by a finer run.
const FINER: &str = "#d55e00";

/// Sizes, px: width of each panel, height above and below the bars, width of a bar, and distance of the bars.
const WIDTHS: [f64; 2] = [480.0, 360.0];
const MARGIN: f64 = 130.0;
const BAR: f64 = 12.0;
const PITCH: f64 = 24.0;

/// The change by each term beside its cost.
pub fn needs(needs: &Needs) -> String {
    let height = MARGIN + PITCH * needs.rows.len() as f64;
    let figure = Figure::new(1, 2)
        .with_title(format!("{}, {} s: effect and cost of each term", needs.scene, needs.duration_s))
        .with_plots(vec![changes(needs), costs(needs)])
        .with_layouts(vec![change_layout(needs), cost_layout(needs)])
        .with_cell_size(WIDTHS[0], height)
        .with_col_width(0, WIDTHS[0])
        .with_col_width(1, WIDTHS[1])
        .with_shared_legend_bottom();
    SvgBackend.render_scene(&figure.render())
}

/// Rows with their heights in the picture; the first row is on top.
fn places(needs: &Needs) -> impl Iterator<Item = (f64, &Row)> {
    let count = needs.rows.len();
    needs.rows.iter().enumerate().map(move |(row, what)| ((count - row) as f64, what))
}

fn bar([from, to]: [f64; 2], height: f64, color: &str, width: f64) -> LinePlot {
    LinePlot::new().with_data(vec![(from, height), (to, height)]).with_color(color).with_stroke_width(width)
}

fn marks(data: Vec<(f64, f64)>, marker: MarkerShape, name: &str) -> Option<Plot> {
    let marks = ScatterPlot::new().with_color("#000000").with_marker(marker).with_size(4.0).with_legend(name);
    (!data.is_empty()).then(|| Plot::Scatter(marks.with_data(data)))
}

/// The bars of each action; the first bar puts it into the legend.
fn bars(needs: &Needs, ends: impl Fn(&Row) -> Option<[f64; 2]>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (kind, name, color) in KINDS {
        let mut name = Some(name);
        let rows = places(needs).filter(|(_, row)| row.kind == kind);
        for bar in rows.filter_map(|(at, row)| Some(bar(ends(row)?, at, color, BAR))) {
            plots.push(Plot::Line(match name.take() {
                Some(name) => bar.with_legend(name),
                None => bar,
            }));
        }
    }
    plots
}

/// Range of whole decades around all changes, mm.
fn span(needs: &Needs) -> (f64, f64) {
    let rows = needs.rows.iter().flat_map(|row| [row.change_rms, row.change_max]);
    let own = needs.step_error.map(|own| own.rms);
    let changes = rows.chain([own]).flatten().filter(|change| *change > 0.0);
    match range(changes.map(|metres| 1e3 * metres)) {
        (least, most) if least <= most => {
            // Leaves room for the shortest bar, and for crosses to the right of the longest.
            (10f64.powf((0.5 * least).log10().floor()), 10f64.powf((2.0 * most).log10().ceil()))
        }
        _ => (1e-3, 1.0),
    }
}

/// Bars for the RMS, dots for the maximum, and crosses at the right end for runs that fail.
fn changes(needs: &Needs) -> Vec<Plot> {
    let (from, to) = span(needs);
    let mut plots = bars(needs, |row| row.change_rms.filter(|rms| *rms > 0.0).map(|rms| [from, 1e3 * rms]));
    let most = places(needs).filter_map(|(at, row)| Some((1e3 * row.change_max.filter(|max| *max > 0.0)?, at)));
    plots.extend(marks(most.collect(), MarkerShape::Circle, "largest"));
    let failed = places(needs).filter(|(_, row)| row.verdict == Verdict::Diverged).map(|(at, _)| (to / 1.5, at));
    plots.extend(marks(failed.collect(), MarkerShape::Cross, "fails"));
    if needs.step_error.is_some_and(|own| own.rms > 0.0) {
        let line = LinePlot::new().with_data(Vec::<(f64, f64)>::new()).with_color(FINER).with_dashed();
        plots.push(Plot::Line(line.with_legend(format!("change by {}", needs.finer))));
    }
    plots
}

fn layout(needs: &Needs, across: (f64, f64), title: &str, label: &str) -> Layout {
    Layout::new(across, (0.4, needs.rows.len() as f64 + 0.6)).with_title(title).with_x_label(label)
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
            layout.with_reference_line(ReferenceLine::vertical(1e3 * own.rms).with_color(FINER))
        }
        _ => layout,
    }
}

/// Bars longer than this, %, are cut and labelled with their length: otherwise one bar could hide all others.
const CUT: f64 = 100.0;

/// A cost in %, cut to the longest bar.
fn cut(cost: f64) -> f64 {
    (100.0 * cost).clamp(-CUT, CUT)
}

/// Heights of the cut bars, and their full lengths, %.
fn long_bars(needs: &Needs) -> impl Iterator<Item = (f64, f64)> {
    let all = places(needs).filter_map(|(at, row)| Some((at, 100.0 * row.cost_fraction?)));
    all.filter(|(_, cost)| cost.abs() > CUT)
}

/// Bars for the median, and lines over the middle half of the pairs, %.
fn costs(needs: &Needs) -> Vec<Plot> {
    let mut plots = bars(needs, |row| row.cost_fraction.map(|cost| [0.0, cut(cost)]));
    let ranges = places(needs).filter_map(|(at, row)| Some((at, row.cost_range?.map(cut))));
    let wide = ranges.filter(|(_, [least, most])| least < most);
    plots.extend(wide.map(|(at, ends)| Plot::Line(bar(ends, at, "#000000", 1.5))));
    plots
}

fn cost_layout(needs: &Needs) -> Layout {
    let ends = needs.rows.iter().filter_map(|row| row.cost_range).flatten().map(cut);
    let room = long_bars(needs).map(|(_, cost)| 1.5 * CUT.copysign(cost));
    let (least, most) =
        ends.chain(room).fold((-10.0, 10.0), |(least, most): (f64, f64), cost| (least.min(cost), most.max(cost)));
    let names = needs.rows.iter().map(|_| String::new()).collect();
    let layout = layout(needs, (1.1 * least, 1.1 * most), "cost", "part of the time as it is, %")
        .with_y_categories(names)
        // Ticks end where bars are cut: the room beyond is for the lengths.
        .with_x_tick_format(TickFormat::Custom(Arc::new(|cost| {
            if cost.abs() > CUT { String::new() } else { format!("{cost:.0}") }
        })))
        .with_reference_line(ReferenceLine::vertical(0.0).with_color("#666666").with_dasharray("none"));
    long_bars(needs).fold(layout, |layout, (at, cost)| {
        // The library writes text above its position: a lower position puts it beside the end of the bar.
        let text = TextAnnotation::new(format!("{cost:.0} %"), 1.25 * CUT.copysign(cost), at - 0.4);
        layout.with_annotation(text.with_font_size(10))
    })
}
