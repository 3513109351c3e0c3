//! One step in phases, the only place that knows their order:
//!
//! [`predict`] (forces, integrate) -> [`commit`], or nothing at all: a candidate that is not
//! committed leaves the state as it was. Detection and response will stand between the two.

use crate::diagnostics;
use crate::dispatch::Dispatch;
use crate::integrate::{self, Context, Work};
use crate::particles::Particles;
use crate::scratch::Scratch;

/// What became of a prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// All candidates are finite.
    Fine,
    /// The first particle whose candidate is NaN or infinite.
    NotFinite {
        /// Its index.
        particle: u32,
    },
}

/// Writes the candidate state to `scratch`.
pub fn predict<D: Dispatch>(
    context: &Context<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    work: &mut Work,
) -> Prediction {
    integrate::advance(context, particles.positions, particles.velocities, scratch, work);
    match diagnostics::first_non_finite(scratch.next_positions, scratch.next_velocities) {
        Some(particle) => Prediction::NotFinite { particle },
        None => Prediction::Fine,
    }
}

/// Makes the candidate the state by exchanging columns; where a history is kept (BDF2), the old
/// state becomes it.
pub fn commit<'a>(particles: &mut Particles<'a>, scratch: &mut Scratch<'a>) {
    core::mem::swap(&mut particles.positions, &mut scratch.next_positions);
    core::mem::swap(&mut particles.velocities, &mut scratch.next_velocities);
    if !scratch.previous_positions.is_empty() {
        core::mem::swap(&mut scratch.previous_positions, &mut scratch.next_positions);
        core::mem::swap(&mut scratch.previous_velocities, &mut scratch.next_velocities);
        scratch.has_history = true;
    }
}
