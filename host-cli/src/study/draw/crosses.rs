//! Rows of crosses above all errors, for what has none: each method its own, so that none hides another.

use std::sync::Arc;

use kuva::render::layout::TickFormat;

/// From the largest error to the first row, and from one row to the next; as factors.
const ABOVE: f64 = 2.0;
const APART: f64 = 1.5;

/// Where the next row stands, in the units that are drawn.
pub struct Crosses {
    first: f64,
    next: f64,
}

impl Crosses {
    /// Above some error.
    pub fn above(error: f64) -> Self {
        Self { first: ABOVE * error, next: ABOVE * error }
    }

    /// A row of its own for crosses at these places across, if there are any.
    pub fn row(&mut self, across: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let row: Vec<_> = across.map(|x| (x, self.next)).collect();
        if !row.is_empty() {
            self.next *= APART;
        }
        row
    }

    /// Where the axis ends.
    pub fn top(&self) -> f64 {
        self.next
    }

    /// Labels of ticks: among crosses there is nothing to read off.
    pub fn ticks(&self, format: impl Fn(f64) -> String + Send + Sync + 'static) -> TickFormat {
        let first = self.first;
        TickFormat::Custom(Arc::new(move |drawn| if drawn < first { format(drawn) } else { String::new() }))
    }
}
