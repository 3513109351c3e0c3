//! The panel of the causes: the errors of step, solver and linearisation against the step.

use std::sync::Arc;

use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::work_precision::{Cause, Chart};
use crate::units::round_length;

use super::work_precision::{BESIDE_LENGTHS, DRAWN, UNIT};
use super::{range, room};

/// Name, colour and marker of each cause, and its error.
type Look = (&'static str, &'static str, MarkerShape, fn(&Cause) -> f64);
const CAUSES: [Look; 3] = [
    ("of the step", "#7f7f7f", MarkerShape::Square, |cause| cause.of_step),
    ("of the solver", "#8c564b", MarkerShape::Diamond, |cause| cause.solver),
    ("of the linearisation", "#9467bd", MarkerShape::Triangle, |cause| cause.linearisation),
];

/// The panel; `None` if the causes are not known.
pub fn panel(chart: &Chart) -> Option<(Vec<Plot>, Layout)> {
    let causes = chart.causes.as_ref()?;
    let unit = DRAWN * chart.diagonal_m;
    let mut plots = Vec::new();
    for (name, color, marker, error) in CAUSES {
        let known = causes.steps.iter().map(|cause| (cause.step, unit * error(cause)));
        let known: Vec<_> = known.filter(|(_, error)| *error > 0.0).collect();
        let line = LinePlot::new().with_data(known.clone()).with_color(color).with_stroke_width(1.5);
        let marks = ScatterPlot::new().with_data(known).with_color(color).with_marker(marker).with_size(4.5);
        plots.extend([Plot::Line(line), Plot::Scatter(marks.with_legend(name))]);
    }
    let errors = causes.steps.iter().flat_map(|cause| CAUSES.map(|(.., error)| unit * error(cause)));
    let steps = range(causes.steps.iter().map(|cause| cause.step));
    let layout = Layout::new(room(steps), room(range(errors.filter(|error| *error > 0.0))))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_y_tick_format(TickFormat::Custom(Arc::new(|drawn| round_length(drawn / DRAWN))))
        .with_title("error by cause")
        .with_x_label(format!("step of {}, s", causes.method))
        .with_y_label(format!("RMS error of {}, {UNIT}", chart.measure.name()))
        .with_y_label_offset(BESIDE_LENGTHS, 0.0);
    Some((plots, layout))
}
