//! Rows of crosses above all errors, for runs without an error. Each method has a row of its own, so that no cross
//! hides another.

use std::sync::Arc;

use kuva::render::layout::TickFormat;

/// Factors from the largest error to the first row, and from one row to the next.
const ABOVE: f64 = 2.0;
const APART: f64 = 1.5;

/// The position of the next row, in the units of the picture.
pub struct Crosses {
    first: f64,
    next: f64,
}

impl Crosses {
    /// Starts above the given error.
    pub fn above(error: f64) -> Self {
        Self { first: ABOVE * error, next: ABOVE * error }
    }

    /// A new row of crosses at the given horizontal positions, if there are any.
    pub fn row(&mut self, across: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let row: Vec<_> = across.map(|x| (x, self.next)).collect();
        if !row.is_empty() {
            self.next *= APART;
        }
        row
    }

    /// Upper end of the axis.
    pub fn top(&self) -> f64 {
        self.next
    }

    /// Tick labels; those among the crosses are empty, since crosses have no value.
    pub fn ticks(&self, format: impl Fn(f64) -> String + Send + Sync + 'static) -> TickFormat {
        let first = self.first;
        TickFormat::Custom(Arc::new(move |drawn| if drawn < first { format(drawn) } else { String::new() }))
    }
}
