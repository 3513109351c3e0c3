//! Explicit Euler, v1 = v0 + h a(x0, v0), x1 = x0 + h v0 [eqs. 3.12, 3.13]. First order. Without
//! damping the energy of every mode grows by the factor 1 + (h omega)^2 each step.

use super::{IntegratorStatistics, StepInput};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::scratch::Scratch;

/// Writes the changes in one step to `s.displacements` and `s.velocity_changes`.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    // The column of the changes first holds the forces.
    c.forces((&*from.positions).into(), from.velocities, s.elements, s.velocity_changes, statistics);
    let (h, v, w) = (c.step, &*from.velocities, c.inverse_masses);
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for (i, (dx, dv)) in (start..).zip(dx.iter_mut().zip(dv)) {
            *dx = v.at(i) * h;
            *dv *= h * w.at(i);
        }
    });
}
