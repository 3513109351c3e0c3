//! Backward Euler, M (v1 - v0) = h f(x1, v1), x1 = x0 + h v1 [Baraff 1998; eqs. 3.20-3.25].
//! First order. An undamped mode keeps the fraction 1 / (1 + (h omega)^2) of its energy each step.

use super::newton::{self, ImplicitStage};
use super::{IntegratorStatistics, StepInput};
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::real::Vec3;
use crate::scratch::Scratch;

/// Writes the changes in one step to `s.displacements` and `s.velocity_changes`.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let stage = ImplicitStage {
        length: c.step,
        positions: from.positions,
        offsets: from.low_positions,
        velocities: from.velocities,
    };
    s.next_velocities.copy_from_slice(from.velocities);
    c.pins.prescribe(c.time_after(1.0), from, |_| Vec3::ZERO, c.step, s.next_velocities);
    newton::solve(c, &stage, s, statistics);
    let (h, v1) = (c.step, &*s.next_velocities);
    c.dispatch.run(&mut *s.displacements, |start, dx| {
        for (i, dx) in (start..).zip(dx) {
            *dx = v1[i] * h;
        }
    });
}
