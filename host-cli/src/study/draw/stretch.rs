//! The panel of scenes with contact: the largest stretch of an edge against cost. Their errors are chaotic, their
//! stretch is not.

use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::distance::Measure;
use crate::study::work_precision::{Chart, Row};

use super::{range, series};

/// The panel; `None` without contact, or if no edge was stretched.
pub fn panel(chart: &Chart) -> Option<(Vec<Plot>, Layout)> {
    let percent = |row: &Row| Some(100.0 * (row.stretch - 1.0)).filter(|percent| row.stable && *percent > 0.0);
    let at = |row: &Row| Some((row.wall_s, percent(row)?));
    let stretches: Vec<_> = chart.rows.iter().filter_map(percent).collect();
    if chart.measure == Measure::Positions || stretches.is_empty() {
        return None;
    }
    let layout = Layout::new(range(chart.rows.iter().map(|row| row.wall_s)), range(stretches.into_iter()))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_title("stretch by cost")
        .with_x_label("computing time, s")
        .with_y_label("largest stretch of an edge, %");
    Some((series::all(&chart.rows, at), layout))
}
