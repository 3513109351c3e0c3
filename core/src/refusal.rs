//! Why a step fails, and where.

use crate::column::Column;
use crate::contact::ContactModel;
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
    /// The estimated error is larger than the limit of the input
    /// ([`StepInput::limit`](crate::integrate::StepInput::limit)).
    Inaccurate,
    /// The columns of contact lack room. The host must take the step again with more.
    Short {
        /// Candidates of each kind that need room; 0 if there is enough.
        pairs: usize,
        /// Constraints that need room; 0 if there is enough.
        constraints: usize,
    },
    /// The host cancelled the step ([`Dispatch::stopped`](crate::dispatch::Dispatch::stopped)).
    Stopped,
    /// A fault of Muslin: an index was out of range.
    Fault,
}

impl Cause {
    /// Whether a shorter step may succeed.
    pub fn asks_for_shorter_step(self) -> bool {
        match self {
            Self::Contact { .. } | Self::TooMuch | Self::Inaccurate => true,
            Self::NotFinite | Self::Short { .. } | Self::Stopped | Self::Fault => false,
        }
    }
}

/// The cause for which a step, or a part of one, cannot be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle {
    /// The cause.
    pub cause: Cause,
    /// As in [`StepError`].
    pub particle: u32,
}

impl Obstacle {
    pub(crate) const STOPPED: Self = Self { cause: Cause::Stopped, particle: 0 };

    /// Two features collide. The obstacle is at a pinned particle of theirs if there is one, else at the first particle
    /// of the cloth.
    pub(crate) fn between(model: &ContactModel<'_>, vertices: [u32; 4]) -> Self {
        let cloth = model.cloth();
        let mut particles = vertices.into_iter().filter(|&v| (v as usize) < cloth);
        let pinned = particles.clone().find(|&v| model.inverse_masses.at(v as usize).min_element() == 0.0);
        let bodies = model.colliders.bodies;
        let body = |v: usize| bodies.iter().position(|body| body.range().contains(&v)).map(|body| body as u32);
        let collider = vertices.into_iter().find_map(|v| body((v as usize).checked_sub(cloth)?));
        let cause = Cause::Contact { collider, pinned: pinned.is_some() };
        Self { cause, particle: pinned.or_else(|| particles.next()).unwrap_or_default() }
    }

    /// An edge and a triangle cross.
    pub(crate) fn at_crossing(model: &ContactModel<'_>, [edge, triangle]: [u32; 2]) -> Self {
        let [a, b] = model.surface.edges.at(edge as usize);
        let [c, d, _] = model.surface.triangles.at(triangle as usize);
        Self::between(model, [a, b, c, d])
    }
}

impl core::fmt::Display for StepError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { step, particle, .. } = self;
        let term = self.term.map_or("no term", Term::name);
        match self.cause {
            Cause::NotFinite => write!(f, "diverged in step {step} at vertex {particle}, pulled hardest by {term}"),
            Cause::TooMuch => {
                write!(f, "step {step} has more contacts than can be resolved: ")?;
                write!(f, "vertex {particle} moves farthest, pulled hardest by {term}")
            }
            Cause::Contact { collider, pinned } => {
                write!(f, "surfaces could not be kept apart in step {step}: ")?;
                write!(f, "{} {particle} meets ", if pinned { "pinned vertex" } else { "vertex" })?;
                match collider {
                    Some(collider) => write!(f, "collider {collider}"),
                    None => write!(f, "cloth"),
                }
            }
            Cause::Short { pairs, constraints: 0 } => write!(f, "step {step} needs room for {pairs} candidates"),
            Cause::Short { pairs: 0, constraints } => write!(f, "step {step} needs room for {constraints} contacts"),
            Cause::Short { pairs, constraints } => {
                write!(f, "step {step} needs room for {pairs} candidates and {constraints} contacts")
            }
            Cause::Inaccurate => write!(f, "step {step} has too large an error"),
            Cause::Stopped => write!(f, "step {step} was given up"),
            Cause::Fault => write!(f, "step {step} met a fault of Muslin"),
        }
    }
}

impl core::error::Error for StepError {}
