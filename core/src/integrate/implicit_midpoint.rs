//! Implicit midpoint, M (vm - v0) = h/2 f(xm, vm), xm = x0 + h/2 vm, then v1 = 2 vm - v0,
//! x1 = x0 + h vm: a backward Euler stage to the middle of the step, then extrapolated to its end.
//! Second order. Conserves the energy of a linear system exactly.

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
    let stage = ImplicitStage { length: 0.5 * c.step, positions: x, velocities: v };
    s.next_velocities.copy_from_slice(v);
    // The mean velocity that moves a pin to its prescribed position at the end of the step.
    c.pins.prescribe(c.time_after(1.0), x, c.step, s.next_velocities);
    newton::solve(c, &stage, s, statistics);
    let h = c.step;
    c.dispatch.run((&mut *s.next_positions, &mut *s.next_velocities), |start, (x1, v1)| {
        for (i, (x1, v1)) in (start..).zip(x1.iter_mut().zip(v1)) {
            *x1 = x[i] + *v1 * h;
            *v1 = *v1 * 2.0 - v[i];
        }
    });
}
