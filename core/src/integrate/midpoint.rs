//! Midpoint Runge-Kutta, vm = v0 + h/2 a0, xm = x0 + h/2 v0, v1 = v0 + h a(xm, vm),
//! x1 = x0 + h vm [eqs. 3.16-3.19]. Second order. Without damping the energy of a mode grows by
//! the factor 1 + (h omega)^4 / 4 each step.

use super::pins::JumpSide;
use super::{IntegratorStatistics, StepInput};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::scratch::Scratch;

/// Writes the changes in one step to `s.displacements` and `s.velocity_changes`. The state in the middle is stored in
/// `s.next_positions` and `s.stage_velocities`.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let (h, half, w) = (c.step, 0.5 * c.step, c.inverse_masses);
    let (x, v) = (&*from.positions, &*from.velocities);
    c.forces(x.into(), v, s.elements, s.forces, statistics);
    let f = &*s.forces;
    c.dispatch.run((&mut *s.next_positions, &mut *s.stage_velocities), |start, (xm, vm)| {
        for (i, (xm, vm)) in (start..).zip(xm.iter_mut().zip(vm)) {
            *xm = x.at(i) + v.at(i) * half;
            *vm = v.at(i) + f.at(i) * (half * w.at(i));
        }
    });
    c.pins.impose(c.time_after(0.5), JumpSide::Before, s.next_positions, s.stage_velocities);
    c.after(0.5).forces((&*s.next_positions).into(), s.stage_velocities, s.elements, s.forces, statistics);
    let (vm, f) = (&*s.stage_velocities, &*s.forces);
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for (i, (dx, dv)) in (start..).zip(dx.iter_mut().zip(dv)) {
            *dx = vm.at(i) * h;
            *dv = f.at(i) * (h * w.at(i));
        }
    });
}
