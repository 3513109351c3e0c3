//! The time of impact of a candidate, and how a column stores it. Shaders write the same numbers.

use bytemuck::{Pod, Zeroable};

use crate::real::Real;

/// Stands for [`TimeOfImpact::Never`], as NEVER does in shaders.
const NEVER: Real = 2.0;

/// Stands for [`TimeOfImpact::Touching`], as TOUCHING does in shaders.
const TOUCHING: Real = 3.0;

/// Whether the features of a candidate collide during a step, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeOfImpact {
    /// The features do not collide in this step.
    Never,
    /// The features collide at this fraction of the step, from 0 to 1.
    At(Real),
    /// The features already touch at the start, within rounding errors.
    Touching,
}

/// A [`TimeOfImpact`] as one number: a fraction of the step, or a number above 1 if the features have no time of
/// impact.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct StoredTime(Real);

impl From<TimeOfImpact> for StoredTime {
    #[inline]
    fn from(time: TimeOfImpact) -> Self {
        Self(match time {
            TimeOfImpact::Never => NEVER,
            TimeOfImpact::At(time) => time,
            TimeOfImpact::Touching => TOUCHING,
        })
    }
}

impl From<StoredTime> for TimeOfImpact {
    #[inline]
    fn from(StoredTime(time): StoredTime) -> Self {
        match time {
            NEVER => Self::Never,
            TOUCHING => Self::Touching,
            time => Self::At(time),
        }
    }
}
