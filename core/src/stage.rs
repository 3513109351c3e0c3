//! The stages of a step and the force terms, by name. Hosts use them to time stages and to write
//! reports; the core has no clock of its own.

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

/// A force term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Gravity.
    Gravity,
    /// Linear drag.
    Drag,
    /// Stretch springs.
    StretchSpring,
    /// Bending springs.
    BendSpring,
    /// Stretch and shear of triangles.
    Membrane,
    /// Hinge bending.
    Hinge,
    /// Seams.
    Seam,
    /// Wind.
    Wind,
}

impl Term {
    /// Every term, in the order of evaluation.
    pub const ALL: [Self; 8] = [
        Self::Gravity,
        Self::Drag,
        Self::StretchSpring,
        Self::BendSpring,
        Self::Membrane,
        Self::Hinge,
        Self::Seam,
        Self::Wind,
    ];

    /// The name for messages and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Drag => "drag",
            Self::StretchSpring => "stretch (springs)",
            Self::BendSpring => "bend (springs)",
            Self::Membrane => "stretch and shear (membrane)",
            Self::Hinge => "bend (hinges)",
            Self::Seam => "seam",
            Self::Wind => "wind",
        }
    }
}
