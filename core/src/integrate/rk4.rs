//! The classical Runge-Kutta method of fourth order, y1 = y0 + h/6 (k1 + 2 k2 + 2 k3 + k4).
//! Stable for h omega <= 2 sqrt 2 without damping.

use super::pins::JumpSide;
use super::{IntegratorStatistics, StepInput};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::real::{Real, Sum};
use crate::scratch::Scratch;

/// For the second to fourth stage: the fraction of the step, and the weight of the slope there.
const STAGES: [(Real, Real); 3] = [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];

/// Writes the changes in one step to `s.displacements` and `s.velocity_changes`. The current stage
/// is stored in `s.stage_positions` and `s.stage_velocities`.
pub fn advance<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let (sixth, w) = (c.step / 6.0, c.inverse_masses);
    let (x, v) = (&*from.positions, &*from.velocities);
    c.forces(x.into(), v, s.elements, s.forces, statistics);
    let f = &*s.forces;
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for (i, (dx, dv)) in (start..).zip(dx.iter_mut().zip(dv)) {
            *dx = v.at(i) * sixth;
            *dv = f.at(i) * (sixth * w.at(i));
        }
    });
    for (stage, (fraction, weight)) in STAGES.into_iter().enumerate() {
        let (h, f) = (fraction * c.step, &*s.forces);
        c.dispatch.run((&mut *s.stage_positions.rounded, &mut *s.stage_velocities), |start, (xs, vs)| {
            for (i, (xs, vs)) in (start..).zip(xs.iter_mut().zip(vs)) {
                // The slope of the previous stage: its velocity here, its forces in `f`.
                let slope = if stage == 0 { v.at(i) } else { *vs };
                *xs = x.at(i) + slope * h;
                *vs = v.at(i) + f.at(i) * (h * w.at(i));
            }
        });
        let fraction = Sum::from(fraction);
        c.pins.impose(c.time_after(fraction), JumpSide::Before, s.stage_positions.rounded, s.stage_velocities);
        c.after(fraction).forces(
            (&*s.stage_positions.rounded).into(),
            s.stage_velocities,
            s.elements,
            s.forces,
            statistics,
        );
        let (f, vs, part) = (&*s.forces, &*s.stage_velocities, weight * sixth);
        c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
            for (i, (dx, dv)) in (start..).zip(dx.iter_mut().zip(dv)) {
                *dx += vs.at(i) * part;
                *dv += f.at(i) * (part * w.at(i));
            }
        });
    }
}
