//! The picture of `muslin stability`: maps of step against stiffness and damping.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::annotations::ShadedRegion;
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::stability::{Axis, Map, Row, Verdict};

use super::range;

/// Colour and marker of each class of runs. Colour-blind readers can distinguish the colours [Wong 2011]; the
/// markers serve prints without colour.
const LOOKS: [(Verdict, &str, MarkerShape); 5] = [
    (Verdict::Fine, "#009e73", MarkerShape::Circle),
    (Verdict::Growth, "#e69f00", MarkerShape::Triangle),
    (Verdict::Diverged, "#d55e00", MarkerShape::Cross),
    (Verdict::GaveUp, "#000000", MarkerShape::Square),
    (Verdict::NotRun, "#999999", MarkerShape::Plus),
];

/// Colour of the theoretical limit.
const THEORY: &str = "#0072b2";

/// Colours of the strip with the runs under error control, and of the mean length of their substeps.
const CONTROL: &str = "#dddddd";
const MEAN: &str = "#888888";

/// Left end, marks and right end of this strip, relative to the longest step.
const STRIP: [f64; 3] = [1.5, 2.4, 3.8];

/// Number of columns and size of one panel, px, for one axis and for two: the columns fill the width of a page.
const PANELS: [(usize, [f64; 2]); 2] = [(2, [410.0, 190.0]), (4, [200.0, 185.0])];

/// Font sizes of titles, of labels and of the numbers at ticks, px.
const SIZES: [u32; 3] = [11, 11, 10];

/// One panel for each method and axis.
pub fn stability(map: &Map) -> String {
    let axes = map.axes();
    // A method without runs has no panel.
    let limits = map.limits.iter().filter(|limit| limit.runs > 0);
    let panels = limits.flat_map(|limit| axes.iter().map(move |&axis| (limit.name.as_str(), axis)));
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.map(|(name, axis)| panel(map, name, axis)).unzip();
    let (columns, [wide, high]) = PANELS[axes.len() - 1];
    let columns = columns.min(plots.len().max(1));
    let figure = Figure::new(plots.len().div_ceil(columns), columns)
        .with_title(format!("{}: where each method fails", map.scene))
        .with_title_size(16)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(wide, high)
        .with_spacing(8.0)
        .with_padding(16.0)
        .with_shared_legend_top_center()
        .with_shared_legend_entries(legend(map));
    SvgBackend.render_scene(&figure.render())
}

/// The legend of the classes that occur on the maps, of the theoretical limit and of error control.
fn legend(map: &Map) -> Vec<LegendEntry> {
    let entry = |label: &str, color: &str, shape| LegendEntry {
        label: label.into(),
        color: color.into(),
        shape,
        dasharray: None,
    };
    let there = |verdict| map.all().any(|row| row.verdict == verdict);
    let marks = LOOKS.iter().filter(|look| there(look.0));
    let marks = marks.map(|&(verdict, color, marker)| entry(verdict.name(), color, LegendShape::Marker(marker)));
    let limited = map.rows.iter().any(|row| row.theory.is_some_and(|theory| theory > 0.0));
    let limit = limited.then(|| entry("theoretical limit", THEORY, LegendShape::Line));
    let control =
        [entry("with error control", CONTROL, LegendShape::Rect), entry("its mean step", MEAN, LegendShape::Line)];
    let control = control.into_iter().filter(|_| !map.controlled.is_empty());
    marks.chain(limit).chain(control).collect()
}

fn panel(map: &Map, name: &str, axis: Axis) -> (Vec<Plot>, Layout) {
    let (fixed, controlled) = (cells(&map.rows, name, axis), cells(&map.controlled, name, axis));
    let steps = range(fixed.iter().map(|(row, _)| row.step));
    let [from, beside, to] = STRIP.map(|ratio| ratio * steps.1);
    let end = if controlled.is_empty() { 1.25 * steps.1 } else { to };
    let mut layout = Layout::new((0.8 * steps.0, end), (0.04, 25.0))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Custom(Arc::new(move |step| decade(step, from))))
        .with_y_tick_format(TickFormat::Custom(Arc::new(|scale| format!("{scale}"))))
        .with_title(name)
        .with_x_label("step, s")
        .with_y_label(format!("times its {}", axis.name()))
        .with_title_size(SIZES[0])
        .with_label_size(SIZES[1])
        .with_tick_size(SIZES[2]);
    if !controlled.is_empty() {
        layout = layout.with_shaded_region(ShadedRegion::vertical(from, to).with_color(CONTROL).with_opacity(1.0));
    }
    let mut plots: Vec<_> = LOOKS.iter().map(|look| marks(&fixed, look, |row| row.step)).collect();
    plots.extend(LOOKS.iter().map(|look| marks(&controlled, look, |_| beside)));
    plots.extend(line(&fixed, steps, THEORY, |row| row.theory));
    plots.extend(line(&controlled, steps, MEAN, Row::mean_substep));
    (plots, layout)
}

/// The runs of a subject on a map, with their scales.
fn cells<'a>(rows: &'a [Row], name: &str, axis: Axis) -> Vec<(&'a Row, f64)> {
    rows.iter().filter(|row| row.name == name).filter_map(|row| Some((row, axis.of(row)?))).collect()
}

/// Labels powers of ten below the strip of error control only: there is no room for other labels.
fn decade(step: f64, strip: f64) -> String {
    let power = step.log10().round();
    let is_labelled = step < strip && (step.log10() - power).abs() < 1e-6;
    if is_labelled { format!("1e{power}") } else { String::new() }
}

/// The marks of all runs of one class.
fn marks(cells: &[(&Row, f64)], look: &(Verdict, &str, MarkerShape), step: impl Fn(&Row) -> f64) -> Plot {
    let &(verdict, color, marker) = look;
    let at: Vec<_> =
        cells.iter().filter(|(row, _)| row.verdict == verdict).map(|(row, scale)| (step(row), *scale)).collect();
    Plot::Scatter(ScatterPlot::new().with_data(at).with_color(color).with_marker(marker).with_size(3.0))
}

/// A step against the scale, where it lies on the map.
fn line(cells: &[(&Row, f64)], steps: (f64, f64), color: &str, step: impl Fn(&Row) -> Option<f64>) -> Option<Plot> {
    let points = cells.iter().filter_map(|(row, scale)| Some((step(row)?, *scale)));
    let mut points: Vec<_> = points.filter(|(step, _)| (steps.0..=steps.1).contains(step)).collect();
    points.sort_by(|a, b| a.1.total_cmp(&b.1));
    points.dedup();
    (points.len() > 1).then(|| Plot::Line(LinePlot::new().with_data(points).with_color(color).with_stroke_width(2.0)))
}
