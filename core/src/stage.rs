//! The names of what a step does, for hosts that keep clocks and for reports: the core has no
//! clock of its own.

/// What the kernels that follow belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Evaluating a force term.
    Force(Term),
    /// Writing a force term's Jacobian.
    Jacobian(Term),
    /// Solving the linear system.
    Solve,
    /// Finding candidates.
    BroadPhase,
    /// Distances and times of impact.
    NarrowPhase,
    /// Solving contacts.
    Response,
    /// Everything else: updating positions and velocities, checking them.
    Integrate,
}

/// The names of the terms, for reports.
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

    /// As scenes and messages call it.
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
