//! Implicit midpoint, M (vm - v0) = h/2 f(xm, vm), xm = x0 + h/2 vm, then v1 = 2 vm - v0,
//! x1 = x0 + h vm: a backward Euler stage to the middle of the step, then extrapolated to its end.
//! Second order. Conserves the energy of a linear system exactly.

use super::newton::{self, ImplicitStage};
use super::{IntegratorStatistics, StepInput};
use crate::column::Column;
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
        length: 0.5 * c.step,
        positions: from.positions,
        offsets: from.low_positions,
        velocities: from.velocities,
    };
    s.stage_velocities.copy_from(from.velocities);
    // The mean velocity that moves a pin to its prescribed position at the end of the step.
    c.pins.prescribe(c.time_after(1.0), from, |_| Vec3::ZERO, c.step, s.stage_velocities);
    newton::solve(c, &stage, s, statistics);
    let (h, vm) = (c.step, &*s.stage_velocities);
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for ((dx, dv), &vm) in dx.iter_mut().zip(dv).zip(vm.part(start..)) {
            *dx = vm * h;
            *dv *= 2.0;
        }
    });
}
