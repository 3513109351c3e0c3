//! BDF2, M (v1 - vh) = g f(x1, v1), x1 = xh + g v1 with g = h (1 + w) / (1 + 2 w), xh = x0 + (x0 - x-1) w^2 / (1 + 2 w)
//! and vh likewise, where w is the length h of the step relative to the last one [Hairer 1993, III.5]. For equal steps
//! g = 2h/3 and xh = (4 x0 - x-1)/3 [Choi 2002]. It is a backward Euler stage from an extrapolated state. Second order,
//! dissipative, stable for w up to 1 + sqrt(2). A step without history uses implicit midpoint.

use super::newton::{self, ImplicitStage};
use super::{IntegratorStatistics, StepInput, implicit_midpoint};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::real::Real;
use crate::scratch::Scratch;

/// Largest length of a step, relative to the last one.
pub const MOST_GROWTH: Real = 2.0;

/// g, s. `last` is the length of the last step, s.
pub fn stage_length(step: Real, last: Real) -> Real {
    let w = step / last;
    step * ((1.0 + w) / (1.0 + 2.0 * w))
}

/// The truncation error of a step, relative to the third derivative times the cube of its length [Hairer 1993, III.5].
pub fn error_constant(step: Real, last: Real) -> Real {
    let w = step / last;
    (1.0 + w) * (1.0 + w) / (6.0 * w * (1.0 + 2.0 * w))
}

/// How far the state that the stage starts from is extrapolated, relative to the change in the last step.
pub fn extrapolation(step: Real, last: Real) -> Real {
    let w = step / last;
    w * w / (1.0 + 2.0 * w)
}

/// Writes the changes in one step to `s.displacements` and `s.velocity_changes`. Reads
/// `s.previous_displacements` and `s.previous_velocity_changes` if `s.last_step` is given.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let Some(last) = s.last_step else {
        return implicit_midpoint::advance(c, from, s, statistics);
    };
    let (g, part) = (stage_length(c.step, last), extrapolation(c.step, last));
    let (low, v) = (&*from.low_positions, &*from.velocities);
    let (dxp, dvp) = (&*s.previous_displacements, &*s.previous_velocity_changes);
    c.dispatch.run((&mut *s.base_offsets, &mut *s.base_velocities), |start, (offset, vh)| {
        for (i, (offset, vh)) in (start..).zip(offset.iter_mut().zip(vh)) {
            *offset = low.at(i) + dxp.at(i) * part;
            *vh = v.at(i) + dvp.at(i) * part;
        }
    });
    let (offsets, velocities) = (core::mem::take(&mut s.base_offsets), core::mem::take(&mut s.base_velocities));
    let stage = ImplicitStage { length: g, positions: from.positions, offsets, velocities };
    s.stage_velocities.copy_from(velocities);
    c.pins.prescribe(c.time_after(1.0), from, |i| dxp.at(i) * part, g, s.stage_velocities);
    newton::solve(c, &stage, s, statistics);
    let (dxp, dvp, v1) = (&*s.previous_displacements, &*s.previous_velocity_changes, &*s.stage_velocities);
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for (i, (dx, dv)) in (start..).zip(dx.iter_mut().zip(dv)) {
            *dx = dxp.at(i) * part + v1.at(i) * g;
            *dv += dvp.at(i) * part;
        }
    });
    (s.base_offsets, s.base_velocities) = (offsets, velocities);
}
