//! Lines and marks of the runs of every method, precision and kind of step.

use kuva::plot::line::LineStyle;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::plots::Plot;

use crate::study::work_precision::Row;

use super::{LOOKS, named};

/// The size of the marks of a precision.
pub fn size(precision: &str) -> f64 {
    if precision == "f64" { 4.5 } else { 2.5 }
}

/// The series of all methods in a panel; the legend is that of another panel.
pub fn all(rows: &[Row], at: impl Fn(&Row) -> Option<(f64, f64)>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (method, color, marker) in LOOKS {
        let own: Vec<_> = rows.iter().filter(|row| row.method == method).collect();
        let marks = ScatterPlot::new().with_color(color).with_marker(marker);
        plots.extend(each(&own).iter().flat_map(|rows| one(rows, &at, marks.clone(), &mut None)));
    }
    plots
}

/// The runs of one method in series of one precision and kind of step; runs with another solver belong to none.
pub fn each<'a>(rows: &[&'a Row]) -> Vec<Vec<&'a Row>> {
    let kinds = [("f64", false), ("f32", false), ("f64", true), ("f32", true)];
    let of = |(precision, controlled)| {
        let is_in =
            |row: &&Row| (row.precision, row.is_controlled()) == (precision, controlled) && row.solver.is_none();
        rows.iter().copied().filter(is_in).collect()
    };
    kinds.map(of).into_iter().filter(|rows: &Vec<_>| !rows.is_empty()).collect()
}

/// Line and marks of one series.
pub fn one(
    rows: &[&Row],
    at: impl Fn(&Row) -> Option<(f64, f64)>,
    marks: ScatterPlot,
    name: &mut Option<&str>,
) -> Vec<Plot> {
    let data: Vec<_> = rows.iter().filter_map(|row| at(row)).collect();
    if data.is_empty() {
        return Vec::new();
    }
    let line = LinePlot::new().with_data(data.clone()).with_color(marks.color.clone()).with_stroke_width(1.5);
    let line = line.with_line_style(style(rows[0]));
    vec![Plot::Line(line), Plot::Scatter(named(marks.with_data(data).with_size(size(rows[0].precision)), name))]
}

/// The style of a line.
fn style(row: &Row) -> LineStyle {
    match (row.is_controlled(), row.precision) {
        (true, _) => LineStyle::Dotted,
        (false, "f64") => LineStyle::Solid,
        (false, _) => LineStyle::Dashed,
    }
}
