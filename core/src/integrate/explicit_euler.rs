//! Explicit Euler, v1 = v0 + h a(x0, v0), x1 = x0 + h v0 [eqs. 3.12, 3.13]. First order. Without
//! damping the energy of every mode grows by the factor 1 + (h omega)^2 each step.

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
    c.forces(x, v, s.elements, s.forces, statistics);
    let (h, f, w) = (c.step, &*s.forces, c.inverse_masses);
    c.dispatch.run((&mut *s.next_positions, &mut *s.next_velocities), |start, (x1, v1)| {
        for (i, (x1, v1)) in (start..).zip(x1.iter_mut().zip(v1)) {
            *x1 = x[i] + v[i] * h;
            *v1 = v[i] + f[i] * (h * w[i]);
        }
    });
}
