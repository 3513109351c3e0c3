//! How the budget is shared, so that what comes first leaves something for what comes later.

use std::time::Duration;

use crate::study::Study;

/// A part of what is left of a study's budget.
pub struct Share<'a, 'b> {
    /// The study.
    pub study: &'a Study<'b>,
    /// For what comes later.
    kept: Duration,
}

impl<'a, 'b> Share<'a, 'b> {
    /// One of so many that are still to come.
    pub fn one_of(to_come: usize, study: &'a Study<'b>) -> Self {
        let left = study.left();
        Self { study, kept: left - left.div_f64(to_come as f64) }
    }

    /// What is left of it.
    pub fn left(&self) -> Duration {
        self.study.left().saturating_sub(self.kept)
    }
}
