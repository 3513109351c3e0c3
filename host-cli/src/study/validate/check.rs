//! One known answer and the way to measure it.

use super::lab::{Lab, Miss};

/// The largest allowed difference between measured and expected value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// A part of the expected value.
    Relative(f64),
    /// A difference in the unit of the value.
    Absolute(f64),
}

impl Tolerance {
    /// The error to compare with the bound.
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
    /// Name of the measured quantity; no two checks have the same name.
    pub name: String,
    /// Unit of the value; empty if it has no unit.
    pub unit: &'static str,
    /// The known answer.
    pub expected: f64,
    /// The largest allowed error.
    pub tolerance: Tolerance,
    /// Measures the value.
    pub measure: Measure,
}

impl Check {
    /// A check of a value without a unit; `bound` is a part of the expected value.
    pub fn relative(
        name: impl Into<String>,
        expected: f64,
        bound: f64,
        measure: impl Fn(&Lab) -> Result<f64, Miss> + 'static,
    ) -> Self {
        let tolerance = Tolerance::Relative(bound);
        Self { name: name.into(), unit: "", expected, tolerance, measure: Box::new(measure) }
    }

    /// A check of a value without a unit; `bound` is a difference.
    pub fn absolute(
        name: impl Into<String>,
        expected: f64,
        bound: f64,
        measure: impl Fn(&Lab) -> Result<f64, Miss> + 'static,
    ) -> Self {
        Self { tolerance: Tolerance::Absolute(bound), ..Self::relative(name, expected, bound, measure) }
    }

    /// Sets the unit.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }
}
