//! The panel of scenes with contact: the largest stretch of an edge against cost. Their errors are chaotic, their
//! stretch is not.

use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::study::distance::Measure;
use crate::study::work_precision::{Chart, Row};

use super::{range, room, series};

/// The panel; `None` without contact, or if no edge was stretched.
pub fn panel(chart: &Chart) -> Option<(Vec<Plot>, Layout)> {
    let percent = |row: &Row| row.stretch.map(|ratio| 100.0 * (ratio - 1.0)).filter(|percent| *percent > 0.0);
    let at = |row: &Row| Some((row.wall_s, percent(row)?));
    let stretches: Vec<_> = chart.rows.iter().filter_map(percent).collect();
    if chart.measure == Measure::Positions || stretches.is_empty() {
        return None;
    }
    let times = chart.rows.iter().filter(|row| row.stable).map(|row| row.wall_s);
    let layout = Layout::new(room(range(times)), room(range(stretches.into_iter())))
        .with_log_scale()
        .with_x_tick_format(TickFormat::Sci)
        .with_title("stretch by cost")
        .with_x_label("computing time, s")
        .with_y_label("largest stretch of an edge, %");
    Some((series::all(&chart.rows, at), layout))
}
