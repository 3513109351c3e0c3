//! Backward Euler, M (v1 - v0) = h f(x1, v1), x1 = x0 + h v1 [Baraff 1998; eqs. 3.20-3.25].
//! First order. An undamped mode keeps the fraction 1 / (1 + (h omega)^2) of its energy each step.

use super::newton::{self, ImplicitStage};
use super::{IntegratorStatistics, StepInput};
use crate::dispatch::Dispatch;
use crate::real::Vec3;
use crate::scratch::Scratch;

/// Writes the state after one step to `s.next_positions` and `s.next_velocities`.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    x: &[Vec3],
    v: &[Vec3],
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let stage = ImplicitStage { length: c.step, positions: x, velocities: v };
    s.next_velocities.copy_from_slice(v);
    c.pins.prescribe(c.time_after(1.0), x, c.step, s.next_velocities);
    newton::solve(c, &stage, s, statistics);
    let (h, v1) = (c.step, &*s.next_velocities);
    c.dispatch.run(&mut *s.next_positions, |start, x1| {
        for (i, x1) in (start..).zip(x1) {
            *x1 = x[i] + v1[i] * h;
        }
    });
}
