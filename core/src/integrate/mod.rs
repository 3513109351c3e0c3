//! Time integration: computes the candidate positions and velocities at the end of a step.
//!
//! Every method writes the changes of the state to [`Scratch`], and does not change the state. The step decides whether
//! the candidate becomes the state. Changes are kept apart from the state so that short steps round them as little as
//! long ones.

pub mod backward_euler;
pub mod bdf2;
pub mod coarse;
pub mod columns;
pub mod conjugate_gradient;
pub mod convex_term;
pub mod explicit_euler;
pub mod implicit_midpoint;
pub mod local_error;
pub mod midpoint;
pub mod newton;
#[cfg(feature = "alloc")]
pub mod patches;
pub mod per_cloth;
pub mod pin_forces;
pub mod pins;
pub(crate) mod rigid_motions;
pub mod rk4;
pub mod stability;
pub(crate) mod stopping;
pub mod symplectic_euler;

pub use crate::forces::Jacobian;

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::{self, Model};
use crate::keys::Moment;
use crate::particles::{Particles, Positions};
use crate::real::{Real, Sum, Vec3};
use crate::scratch::Scratch;
use pins::Pins;
use stopping::Goal;

/// The integration methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Method {
    /// First order, unstable at every step without damping.
    ExplicitEuler,
    /// First order; the energy stays bounded below the critical step.
    SymplecticEuler,
    /// Second order Runge-Kutta.
    Midpoint,
    /// Fourth order Runge-Kutta.
    Rk4,
    /// First order, dissipative, stable for large steps.
    #[default]
    BackwardEuler,
    /// Second order, conserves the energy of linear systems.
    ImplicitMidpoint,
    /// Second order, dissipative, two-step.
    Bdf2,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 7] = [
        Self::ExplicitEuler,
        Self::SymplecticEuler,
        Self::Midpoint,
        Self::Rk4,
        Self::BackwardEuler,
        Self::ImplicitMidpoint,
        Self::Bdf2,
    ];

    /// Name in scene files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ExplicitEuler => "explicit-euler",
            Self::SymplecticEuler => "symplectic-euler",
            Self::Midpoint => "midpoint",
            Self::Rk4 => "rk4",
            Self::BackwardEuler => "backward-euler",
            Self::ImplicitMidpoint => "implicit-midpoint",
            Self::Bdf2 => "bdf2",
        }
    }

    /// Whether the method solves a system for the velocities.
    pub const fn is_implicit(self) -> bool {
        matches!(self, Self::BackwardEuler | Self::ImplicitMidpoint | Self::Bdf2)
    }

    /// Whether a step has columns of forces and of velocities inside it: Euler's explicit methods need neither.
    pub(crate) const fn has_more_columns(self) -> bool {
        !matches!(self, Self::ExplicitEuler | Self::SymplecticEuler)
    }
}

/// The preconditioner of conjugate gradients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Preconditioner {
    /// The inverse of each 3x3 diagonal block.
    BlockJacobi,
    /// Block Jacobi plus an exact solve for the affine motions of patches, in large scenes on two levels.
    #[default]
    TwoLevel,
}

/// The integration method with its settings.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// The method.
    pub method: Method,
    /// Largest number of Newton iterations per step; 1: one linear solve without line search.
    pub newton: u32,
    /// Where linear solves and Newton's method stop.
    pub tolerance: Tolerance,
    /// The preconditioner.
    pub preconditioner: Preconditioner,
    /// The Jacobian of the forces.
    pub jacobian: Jacobian,
    /// Largest [estimated error](local_error) of a step, m; `None`: all steps have the same length.
    pub error: Option<Real>,
}

impl Scheme {
    /// One linear solve a step, to a relative residual, by block Jacobi and the projected Jacobian; all steps have the
    /// same length.
    pub const fn fixed(method: Method, residual: Real) -> Self {
        Self {
            method,
            newton: 1,
            tolerance: Tolerance::Residual(residual),
            preconditioner: Preconditioner::BlockJacobi,
            jacobian: Jacobian::Projected,
            error: None,
        }
    }
}

/// Where linear solves and Newton's method stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// At a relative residual.
    Residual(Real),
    /// Linear solves stop where the rest of the solution changes the velocities by less, m/s, in the root mean square
    /// over each cloth, and is at most a tenth of the solution. Newton's method stops where its further corrections add
    /// up to less.
    Velocity(Real),
}

/// Relative residual where a residual is needed but the tolerance is a velocity: in solves of Newton's method, and
/// in the solve that adds contacts to a solution.
const OTHER_RESIDUAL: Real = 1e-3;

/// The step, s, in whose error the part of the solves is a fifth.
const LONG_STEP: Real = 1.0 / 60.0;

impl Tolerance {
    /// Where the solves of a step stop by default, for a step whose error may be this large, m. Their part of the error
    /// of a step of 1/60 s is a fifth. In shorter steps the velocities stay as exact: an error of the velocities that
    /// grows with the number of steps would cost the methods an order.
    pub fn within(error: Real) -> Self {
        Self::Velocity(0.2 * error / LONG_STEP)
    }

    /// A relative residual for solves that stop at nothing else.
    pub(crate) fn residual(self) -> Real {
        match self {
            Self::Residual(residual) => residual,
            Self::Velocity(_) => OTHER_RESIDUAL,
        }
    }
}

/// Counts of the integrator's work, independent of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct IntegratorStatistics {
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Linear solves that ended at a direction of negative curvature.
    pub negative_curvature: u64,
    /// Solves, linear or by Newton's method, that ended before their tolerance, at a limit of iterations.
    pub unconverged: u64,
    /// Line searches that found no decrease.
    pub stalled_searches: u64,
    /// Steps and parts of steps that were committed.
    pub committed: u64,
    /// Steps and parts of steps that were taken back because their error was too large.
    pub inaccurate: u64,
    /// Parts of steps that were committed although their error was too large, because they were the shortest.
    pub exceeding: u64,
    /// Largest number of times that a step was halved.
    pub most_halvings: u64,
}

/// Input of every method: the forces, pins and masses of the particles, and the time step.
#[derive(Clone, Copy)]
pub struct StepInput<'a, D> {
    /// The forces. [`step::take`](crate::step::take) sets them to those at the time of the stage of an implicit method,
    /// or of the first stage of an explicit one.
    pub model: Model<'a>,
    /// The pinned vertices.
    pub pins: &'a Pins<'a>,
    /// Masses, kg.
    pub masses: &'a [Real],
    /// Inverse masses, 1/kg.
    pub inverse_masses: &'a [Real],
    /// Start of the step, s.
    pub time: Sum,
    /// Length of the step, s.
    pub step: Real,
    /// The method and its settings.
    pub scheme: &'a Scheme,
    /// Whether the step follows contact, which changes the velocities abruptly: then the single linear solve linearises
    /// the forces at extrapolated positions only if these are hardly stretched. [`step::take`](crate::step::take) sets it.
    pub follows_contact: bool,
    /// Largest [estimated error](local_error) with which the step is committed, m. Infinite: the error is only
    /// estimated. `None`: it is not estimated.
    pub limit: Option<Real>,
    /// Whether contacts are solved after the candidate state is written
    /// ([`implicit_contact`](crate::implicit_contact)).
    pub has_contact: bool,
    /// Runs the kernels.
    pub dispatch: &'a D,
}

impl<D: Dispatch> StepInput<'_, D> {
    /// Whether the linear solve of the step is left to the one with contacts: by backward Euler without Newton's
    /// method. The other implicit methods need the motion without contacts, and correct it.
    pub fn defers_solve(&self) -> bool {
        self.has_contact && self.scheme.method == Method::BackwardEuler && self.scheme.newton <= 1
    }

    /// Length over which the velocity that the method's stage is solved for moves the positions, s.
    /// `last` is the length of the last step if this one continues it, s.
    pub fn stage_length(&self, last: Option<Real>) -> Real {
        match self.scheme.method {
            Method::Bdf2 => last.map_or(self.step, |last| bdf2::stage_length(self.step, last)),
            Method::BackwardEuler | Method::ImplicitMidpoint => self.step,
            Method::ExplicitEuler | Method::SymplecticEuler | Method::Midpoint | Method::Rk4 => self.step,
        }
    }

    /// The time of the only or the first stage, as a fraction of the step. `last` is as for [`Self::stage_length`].
    pub(crate) fn stage_time(&self, last: Option<Real>) -> Sum {
        match self.scheme.method {
            Method::ExplicitEuler | Method::SymplecticEuler | Method::Midpoint | Method::Rk4 => 0.0,
            Method::Bdf2 if last.is_none() => 0.5,
            Method::ImplicitMidpoint => 0.5,
            Method::BackwardEuler | Method::Bdf2 => 1.0,
        }
    }

    /// The same with the forces at a fraction of the step.
    pub(crate) fn after(&self, fraction: Sum) -> Self {
        let moment = Moment { time: self.time_after(fraction), step: self.times() };
        Self { model: self.model.at(moment), ..*self }
    }

    /// Where a linear solve stops; `residual` is the relative residual for it if the tolerance is a residual.
    pub(crate) fn goal(&self, residual: Sum) -> Goal {
        match self.scheme.tolerance {
            Tolerance::Residual(_) => Goal::Reduce(residual),
            Tolerance::Velocity(velocity) => Goal::Within(Sum::from(velocity) * Sum::from(velocity)),
        }
    }

    /// Writes the forces at the state (`x`, `v`) to `f` and counts the evaluation.
    pub fn forces(
        &self,
        x: Positions<'_>,
        v: &[Vec3],
        scratch: &mut [Vec3],
        f: &mut [Vec3],
        statistics: &mut IntegratorStatistics,
    ) {
        statistics.force_evaluations += 1;
        forces::evaluate(&self.model, self.masses, x, v, scratch, f, self.dispatch);
    }

    /// The time at a fraction of the step, s.
    pub fn time_after(&self, fraction: Sum) -> Sum {
        self.time + fraction * Sum::from(self.step)
    }

    /// Start and end of the step, s.
    pub(crate) fn times(&self) -> [Sum; 2] {
        [self.time, self.time_after(1.0)]
    }
}

/// Computes one step from the state `from`: writes the changes of positions and velocities, and the candidate positions.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    match c.scheme.method {
        Method::ExplicitEuler => explicit_euler::advance(c, from, scratch, statistics),
        Method::SymplecticEuler => symplectic_euler::advance(c, from, scratch, statistics),
        Method::Midpoint => midpoint::advance(c, from, scratch, statistics),
        Method::Rk4 => rk4::advance(c, from, scratch, statistics),
        Method::BackwardEuler => backward_euler::advance(c, from, scratch, statistics),
        Method::ImplicitMidpoint => implicit_midpoint::advance(c, from, scratch, statistics),
        Method::Bdf2 => bdf2::advance(c, from, scratch, statistics),
    }
    c.pins.impose_changes(c.time_after(1.0), from, scratch.displacements, scratch.velocity_changes);
    write_next(c, from, scratch);
}

/// Writes the candidate positions: `from` with the changes in the scratch columns, rounded.
pub(crate) fn write_next<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) {
    let (x, low, dx) = (&*from.positions, &*from.low_positions, &*s.displacements);
    c.dispatch.run(&mut *s.next_positions, |start, part| {
        for (i, next) in (start..).zip(part) {
            *next = x.at(i) + (low.at(i) + dx.at(i));
        }
    });
}

/// The candidate velocity of a vertex: `from` with its change, rounded, m/s. `changes` are those of all vertices.
#[inline]
pub(crate) fn next_velocity(from: &Particles<'_>, changes: &[Vec3], vertex: usize) -> Vec3 {
    from.velocities.at(vertex) + (from.low_velocities.at(vertex) + changes.at(vertex))
}
