//! Why a step is not taken.

use crate::stage::Term;

/// A step that was not taken. The state is that before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepError {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// The first particle that is not finite, that meets something, or the one that moves farthest.
    pub particle: u32,
    /// The term that pulled hardest on it.
    pub term: Option<Term>,
    /// What went wrong.
    pub cause: Cause,
}

/// Why a step cannot be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Its result is not a number.
    NotFinite,
    /// So much moves so far, or is so thick, that contact cannot follow, however short it is taken.
    TooMuch,
    /// Surfaces would pass through one another, however short it is taken.
    Contact {
        /// Index of the collider that the particle meets; else it meets cloth.
        collider: Option<u32>,
        /// Whether the particle is pinned, so that nothing can keep it away.
        pinned: bool,
    },
    /// The host gave it up ([`Dispatch::stopped`](crate::dispatch::Dispatch::stopped)).
    Stopped,
}

impl StepError {
    /// Whether a shorter step may be taken where this one was not.
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
                write!(f, "more comes together in step {step} than contact can follow: ")?;
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
