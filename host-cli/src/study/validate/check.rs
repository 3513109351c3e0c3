//! One known answer and how to measure it.

use super::lab::{Lab, Miss};

/// How far a measured value may be from what is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// A part of what is expected.
    Relative(f64),
    /// In the unit of the value.
    Absolute(f64),
}

impl Tolerance {
    /// The error that it bounds.
    pub fn error(self, expected: f64, measured: f64) -> f64 {
        match self {
            Self::Relative(_) => measured / expected - 1.0,
            Self::Absolute(_) => measured - expected,
        }
    }

    /// The bound.
    pub fn bound(self) -> f64 {
        match self {
            Self::Relative(bound) | Self::Absolute(bound) => bound,
        }
    }
}

/// How a check measures.
pub type Measure = Box<dyn Fn(&Lab) -> Result<f64, Miss>>;

/// One known answer.
pub struct Check {
    /// What is measured; no two have the same.
    pub name: String,
    /// Of the value; empty where it has none.
    pub unit: &'static str,
    /// The answer.
    pub expected: f64,
    /// How far the core may be from it.
    pub tolerance: Tolerance,
    /// Measures it.
    pub measure: Measure,
}

impl Check {
    /// A number without a unit, by a part of itself.
    pub fn relative(
        name: impl Into<String>,
        expected: f64,
        bound: f64,
        measure: impl Fn(&Lab) -> Result<f64, Miss> + 'static,
    ) -> Self {
        let tolerance = Tolerance::Relative(bound);
        Self { name: name.into(), unit: "", expected, tolerance, measure: Box::new(measure) }
    }

    /// A number without a unit, by its own size.
    pub fn absolute(
        name: impl Into<String>,
        expected: f64,
        bound: f64,
        measure: impl Fn(&Lab) -> Result<f64, Miss> + 'static,
    ) -> Self {
        Self { tolerance: Tolerance::Absolute(bound), ..Self::relative(name, expected, bound, measure) }
    }

    /// The same, of a unit.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }
}
