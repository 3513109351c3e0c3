//! Errors of a step.

use crate::stage::Term;

/// A step that failed. The state is the same as before the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepError {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// By cause: the first particle that is not finite, the one that moves farthest, or one that collides.
    pub particle: u32,
    /// The term with the largest force on the particle.
    pub term: Option<Term>,
    /// The cause.
    pub cause: Cause,
}

/// Cause of the failure of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The result is NaN or infinite.
    NotFinite,
    /// Too many candidates, or corrections larger than the widest boxes allow, even in the shortest substep.
    TooMuch,
    /// Surfaces would pass through one another even in the shortest substep.
    Contact {
        /// Index of the collider that the particle collides with; `None`: it collides with cloth.
        collider: Option<u32>,
        /// Whether the particle is pinned, so that contact cannot move it.
        pinned: bool,
    },
    /// The host cancelled the step ([`Dispatch::stopped`](crate::dispatch::Dispatch::stopped)).
    Stopped,
}

impl StepError {
    /// Whether a shorter step may succeed.
    pub(super) fn may_help(&self) -> bool {
        matches!(self.cause, Cause::Contact { .. } | Cause::TooMuch)
    }
}

impl core::fmt::Display for StepError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { step, particle, .. } = self;
        let term = self.term.map_or("no term", Term::name);
        match self.cause {
            Cause::NotFinite => write!(f, "diverged in step {step} at particle {particle}, pulled hardest by {term}"),
            Cause::TooMuch => {
                write!(f, "step {step} has more contacts than can be resolved: ")?;
                write!(f, "particle {particle} moves farthest, pulled hardest by {term}")
            }
            Cause::Contact { collider, pinned } => {
                write!(f, "surfaces could not be kept apart in step {step}: ")?;
                write!(f, "{} {particle} meets ", if pinned { "pinned particle" } else { "particle" })?;
                match collider {
                    Some(collider) => write!(f, "collider {collider}"),
                    None => write!(f, "cloth"),
                }
            }
            Cause::Stopped => write!(f, "step {step} was given up"),
        }
    }
}

impl core::error::Error for StepError {}
