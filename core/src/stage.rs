//! The stages of a step and the force terms, by name. Hosts use them to time stages and to write
//! reports; the core has no clock of its own.

pub use crate::forces::Term;

/// The stage of a step that the following kernels belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Evaluating a force term.
    Force(Term),
    /// Writing a force term's Jacobian.
    Jacobian(Term),
    /// Solving the linear system.
    Solve,
    /// Finding candidate pairs.
    BroadPhase,
    /// Computing distances and times of impact.
    NarrowPhase,
    /// Responding to contacts and impacts.
    Response,
    /// All other work: updating and checking positions and velocities.
    Integrate,
}
