//! The picture of a run under error control: length of the substeps and estimated error over time.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::course::Course;
use crate::units;

/// Size of one panel, px.
const PANEL: [f64; 2] = [720.0, 250.0];
/// Most points of a curve. A longer run merges neighbouring steps.
const MOST: usize = 1500;
/// Errors are drawn from this part of the largest allowed one on.
const LEAST: f64 = 1e-4;

/// One step, or several that are drawn as one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    /// Simulated time at the end, s.
    time: f64,
    /// Mean length of the substeps of the step, s. Of several steps this is the shortest mean.
    substep: f64,
    /// The largest estimated error of a substep, m.
    error: f64,
}

impl Row {
    fn merged(pair: &[Row]) -> Row {
        let merge =
            |a: Row, b: &Row| Row { time: b.time, substep: a.substep.min(b.substep), error: a.error.max(b.error) };
        pair[1..].iter().fold(pair[0], merge)
    }
}

/// Collects the steps of a run.
pub struct StepPlot {
    /// The largest allowed error of a substep, m.
    most: f64,
    /// Substeps before the next step.
    substeps: u64,
    /// Length of the shortest substep of the run, s.
    shortest: f64,
    rows: Vec<Row>,
    /// Steps of the last row, and of a full one.
    filled: usize,
    stride: usize,
}

impl StepPlot {
    /// A plot without steps. `most` is the largest allowed error of a substep, m; `substeps` were taken before.
    pub fn new(most: f64, substeps: u64) -> StepPlot {
        StepPlot { most, substeps, shortest: f64::INFINITY, rows: Vec::new(), filled: 0, stride: 1 }
    }

    /// Adds the step that was just taken.
    pub fn step(&mut self, course: &Course) {
        let (engine, step) = (&course.engine, course.timing.step);
        let substeps = engine.substeps();
        let (time, substep) = (course.steps as f64 * step, step / (substeps - self.substeps) as f64);
        self.substeps = substeps;
        self.shortest = step / 2f64.powi(engine.report().substeps[3] as i32);
        if let Some(error) = engine.estimated_error() {
            self.add(Row { time, substep, error });
        }
    }

    fn add(&mut self, row: Row) {
        if self.rows.len() == MOST && self.filled == self.stride {
            self.rows = self.rows.chunks(2).map(Row::merged).collect();
            self.stride *= 2;
            self.filled = self.stride;
        }
        match self.rows.last_mut() {
            Some(last) if self.filled < self.stride => {
                *last = Row::merged(&[*last, row]);
                self.filled += 1;
            }
            _ => {
                self.rows.push(row);
                self.filled = 1;
            }
        }
    }

    /// The picture as SVG; `None` without steps.
    pub fn draw(&self, scene: &str) -> Option<String> {
        let (first, last) = (self.rows.first()?, self.rows.last()?);
        let times = (first.time - first.substep, last.time);
        let at = TickFormat::Custom(Arc::new(move |time| units::tick(time, times.1 - times.0)));
        let least = LEAST * self.most;
        let curve = |value: fn(&Row) -> f64, least: f64| {
            let point = |time: f64, row: &Row| (time, 1e3 * value(row).max(least));
            // From the start of the first step, so that a single step is a line.
            let start = point(times.0, first);
            let data: Vec<_> = [start].into_iter().chain(self.rows.iter().map(|row| point(row.time, row))).collect();
            Plot::Line(LinePlot::new().with_data(data).with_color("#0072b2").with_stroke_width(1.2))
        };
        let dashed = |value: f64| {
            let line = LinePlot::new().with_data(<[f64; 2]>::from(times).map(|time| (time, 1e3 * value)));
            Plot::Line(line.with_color("#888888").with_dashed())
        };
        let panel = |label: &str, values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
            let layout = Layout::new(times, (1e3 * low / 1.5, 1e3 * high * 1.5)).with_log_y();
            let layout = layout.with_x_tick_format(at.clone());
            layout.with_y_tick_format(TickFormat::Custom(Arc::new(tick))).with_y_label(label)
        };
        let lengths = self.rows.iter().map(|row| row.substep).chain([self.shortest]);
        let lengths = panel("substep, ms", &mut { lengths }).with_title(format!(
            "mean substep of each step; dashed: the shortest of the run, {:.3} ms",
            1e3 * self.shortest
        ));
        let errors = self.rows.iter().map(|row| row.error.max(least)).chain([self.most]);
        let errors = panel("estimated error, mm", &mut { errors })
            .with_x_label("simulated time, s")
            .with_title("largest estimated error of each step; dashed: the largest allowed");
        let figure = Figure::new(2, 1)
            .with_title(format!("{scene}: substeps under error control"))
            .with_plots(vec![
                vec![dashed(self.shortest), curve(|row| row.substep, 0.0)],
                vec![dashed(self.most), curve(|row| row.error, least)],
            ])
            .with_layouts(vec![lengths, errors])
            .with_cell_size(PANEL[0], PANEL[1]);
        Some(SvgBackend.render_scene(&figure.render()))
    }
}

/// A value of a logarithmic axis, without digits that are only rounding errors.
fn tick(value: f64) -> String {
    format!("{}", (1e9 * value).round() / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(steps: usize) -> StepPlot {
        let mut plot = StepPlot::new(1e-3, 0);
        plot.shortest = 5e-4;
        for k in 1..=steps {
            let hard = k == 7;
            let [substep, error] = if hard { [1e-3, 9e-4] } else { [1e-2, 1e-5] };
            plot.add(Row { time: k as f64, substep, error });
        }
        plot
    }

    #[test]
    fn long_runs_keep_their_hardest_step() {
        for steps in [7, MOST, MOST + 1, 2 * MOST + 1, 10 * MOST + 3] {
            let plot = plot(steps);
            assert!(plot.rows.len() <= MOST && plot.rows.len() >= steps.min(MOST / 2));
            let worst = Row::merged(&plot.rows);
            assert_eq!(worst, Row { time: steps as f64, substep: 1e-3, error: 9e-4 });
            assert!(plot.rows.is_sorted_by(|a, b| a.time < b.time));
        }
    }

    /// Number of points of each curve.
    fn points(svg: &str) -> Vec<usize> {
        let curves = svg.split("<path").filter(|path| path.contains("#0072b2"));
        curves.map(|path| path.matches(['M', 'L']).count()).collect()
    }

    #[test]
    fn is_drawn_if_there_is_a_step() {
        assert_eq!(plot(0).draw("ball"), None);
        for steps in [1, 9] {
            let svg = plot(steps).draw("ball").unwrap();
            assert!(svg.starts_with("<svg") && svg.contains("ball: substeps"), "{svg}");
            assert!(svg.contains("dashed: the shortest of the run, 0.500 ms"), "{svg}");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert_eq!(points(&svg), [steps + 1; 2]);
        }
    }
}
