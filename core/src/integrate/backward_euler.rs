//! Backward Euler, M (v1 - v0) = h f(x1, v1), x1 = x0 + h v1 [Baraff 1998; eqs. 3.20-3.25].
//! First order. An undamped mode keeps the fraction 1 / (1 + (h omega)^2) of its energy each step.
//!
//! The guess of v1 is v0. For a single linear solve it turns with cloth that no pin holds.

use super::newton::{self, ImplicitStage};
use super::per_cloth;
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
        length: c.step,
        positions: from.positions,
        offsets: from.low_positions,
        velocities: from.velocities,
    };
    s.stage_velocities.copy_from(from.velocities);
    // Newton's method finds the circle.
    if c.scheme.newton <= 1 {
        turn(c, from, s);
    }
    c.pins.prescribe(c.time_after(1.0), from, |_| Vec3::ZERO, c.step, s.stage_velocities);
    newton::solve(c, &stage, s, statistics);
    let (h, v1) = (c.step, &*s.stage_velocities);
    c.dispatch.run(&mut *s.displacements, |start, dx| {
        for (dx, &v) in dx.iter_mut().zip(v1.part(start..)) {
            *dx = v * h;
        }
    });
}

/// Turns the guess with free cloths. Along the tangents of its circle a step stretches cloth, and the stress there
/// resists changes of the rotation: friction took three times as long to stop a stiff sheet.
#[cfg_attr(small, optimize(size), inline(never))]
fn turn<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) {
    per_cloth::start(s.cloths, c.masses, from.positions, c.pins);
    for (index, cloth) in s.cloths.iter().enumerate().filter(|(_, cloth)| cloth.is_free()) {
        let own = per_cloth::range(s.cloths, index);
        let [x, v] = [&*from.positions, &*from.velocities].map(|column| column.part(own.clone()));
        let rotation = cloth.body.rotation(c.masses.part(own.clone()), x, v);
        rotation.turn(c.step.into(), s.stage_velocities.part_mut(own));
    }
}
