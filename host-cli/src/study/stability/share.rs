//! Division of the budget, so that early runs leave something for later ones.

use std::time::Duration;

use crate::study::Study;

/// A part of the remaining budget of a study.
pub struct Share<'a, 'b> {
    /// The study.
    pub study: &'a Study<'b>,
    /// Time kept for later shares.
    kept: Duration,
}

impl<'a, 'b> Share<'a, 'b> {
    /// The share of one of `to_come` runs that are still to come.
    pub fn one_of(to_come: usize, study: &'a Study<'b>) -> Self {
        let left = study.left();
        Self { study, kept: left - left.div_f64(to_come as f64) }
    }

    /// Time left in this share.
    pub fn left(&self) -> Duration {
        self.study.left().saturating_sub(self.kept)
    }
}
