//! BDF2, M (v1 - vh) = g f(x1, v1), x1 = xh + g v1 with g = 2h/3, xh = (4 x0 - x-1)/3 and
//! vh = (4 v0 - v-1)/3 [Choi 2002]: a backward Euler stage from an extrapolated state. Second order,
//! dissipative. The step must be constant. A step without history uses implicit midpoint.

use super::newton::{self, ImplicitStage};
use super::{IntegratorStatistics, StepInput, implicit_midpoint};
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3};
use crate::scratch::Scratch;

/// g, s.
pub fn stage_length(step: Real) -> Real {
    step * (2.0 / 3.0)
}

/// Writes the state after one step to `s.next_positions` and `s.next_velocities`. Reads
/// `s.previous_positions` and `s.previous_velocities` if `s.has_history` is set.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    x: &[Vec3],
    v: &[Vec3],
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    if !s.has_history {
        return implicit_midpoint::advance(c, x, v, s, statistics);
    }
    let g = stage_length(c.step);
    let (xp, vp) = (&*s.previous_positions, &*s.previous_velocities);
    c.dispatch.run((&mut *s.base_positions, &mut *s.base_velocities), |start, (xh, vh)| {
        for (i, (xh, vh)) in (start..).zip(xh.iter_mut().zip(vh)) {
            *xh = x[i] + (x[i] - xp[i]) / 3.0;
            *vh = v[i] + (v[i] - vp[i]) / 3.0;
        }
    });
    let (base_positions, base_velocities) =
        (core::mem::take(&mut s.base_positions), core::mem::take(&mut s.base_velocities));
    let stage = ImplicitStage { length: g, positions: base_positions, velocities: base_velocities };
    s.next_velocities.copy_from_slice(base_velocities);
    c.pins.prescribe(c.time_after(1.0), base_positions, g, s.next_velocities);
    newton::solve(c, &stage, s, statistics);
    let (xh, v1) = (&*base_positions, &*s.next_velocities);
    c.dispatch.run(&mut *s.next_positions, |start, x1| {
        for (i, x1) in (start..).zip(x1) {
            *x1 = xh[i] + v1[i] * g;
        }
    });
    (s.base_positions, s.base_velocities) = (base_positions, base_velocities);
}
