//! Contact inside the implicit system. A step that was solved as if nothing touched is corrected
//! for what does: with A the matrix of the step, G d the relative displacement of each contact that
//! pushes, and s stiff beside A,
//!
//! `(A + G^T s G) y = G^T s (g - G d)`
//!
//! brings the contacts to where the response put them and lets the rest of the cloth give way
//! elastically. Without it only the vertices that touch would be moved, and a sheet pressed
//! together would stay as if it were not [Otaduy 2009, Tang 2016].

use super::conjugate_gradient::StoppingCriterion;
use super::{IntegratorStatistics, Method, StepInput, newton};
use crate::dispatch::Dispatch;
use crate::forces::matrix;
use crate::real::{Mat3, Real, Vec3, outer, scaled_identity};
use crate::scratch::Scratch;
use crate::stage::Stage;

/// Stiffness of a hold beside that of the cloth at its vertices.
const STIFFNESS: Real = 30.0;

/// Solves that find out what slides and what lets go: all that touches sticks, then what cannot
/// slides.
const MOST_TRIALS: u32 = 3;

/// How much tighter a solve is than the step's own: what the holds ask for is thirty times larger than
/// what the cloth bears, and friction is judged by the latter.
const TIGHTER: Real = 0.3;

/// A contact that pushes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hold {
    /// The vertices of both features.
    pub vertices: [u32; 4],
    /// Positive on the first feature, negative on the second.
    pub weights: [Real; 4],
    /// Unit vector from the second feature to the first.
    pub normal: Vec3,
    /// By how much the displacement of the contact is wrong, m.
    pub missing: Vec3,
    /// The impulse of the contact, kg m/s; written here.
    pub impulse: Vec3,
    /// How far it slides if nothing holds it, m.
    pub slide: Real,
    /// How stiffly sliding is held beside the normal: 1 where it sticks, 0 where it is free.
    pub sticks: Real,
    /// 1: nothing is held.
    pub released: Real,
    /// Index of the contact's constraint.
    pub constraint: u32,
    /// s, kg; written here.
    pub stiffness: Real,
}

impl Hold {
    /// The directions that are held, times the stiffness.
    #[inline]
    fn along(&self, v: Vec3) -> Vec3 {
        let normal = self.normal * self.normal.dot(v);
        (normal + (v - normal) * self.sticks) * (self.stiffness * (1.0 - self.released))
    }

    /// The same as a matrix: from relative displacement to force.
    pub fn matrix(&self) -> Mat3 {
        let normal = outer(self.normal, self.normal);
        let held = normal + (scaled_identity(1.0) - normal) * self.sticks;
        held * (self.stiffness * (1.0 - self.released))
    }
}

/// Adds `G^T s G p` to a column over the cloth's vertices; others do not move.
pub fn add_product(holds: &[Hold], p: &[Vec3], out: &mut [Vec3]) {
    for hold in holds {
        scatter(hold, hold.along(gather(hold, p)), out);
    }
}

/// G p.
fn gather(hold: &Hold, p: &[Vec3]) -> Vec3 {
    let parts = hold.vertices.iter().zip(hold.weights);
    parts.map(|(&v, weight)| p.get(v as usize).map_or(Vec3::ZERO, |&p| p * weight)).sum()
}

fn scatter(hold: &Hold, force: Vec3, out: &mut [Vec3]) {
    for (&v, weight) in hold.vertices.iter().zip(hold.weights) {
        if let Some(out) = out.get_mut(v as usize) {
            *out += force * weight;
        }
    }
}

/// Adds the holds' diagonal blocks.
pub fn add_diagonal(holds: &[Hold], blocks: &mut [Mat3]) {
    for hold in holds {
        for (k, &v) in hold.vertices.iter().enumerate() {
            if let Some(block) = blocks.get_mut(v as usize) {
                *block += hold.matrix() * (hold.weights[k] * hold.weights[k]);
            }
        }
    }
}

/// How the positions at the end of a step follow from the velocity that its stage was solved for, s.
fn length(method: Method, step: Real, has_history: bool) -> Real {
    match method {
        Method::Bdf2 if has_history => step * (2.0 / 3.0),
        _ => step,
    }
}

/// Corrects the candidate state of an implicit step, whose matrix must still be in `s`. After each
/// solve `release` may let go of holds; it returns whether it did.
pub fn correct<D: Dispatch>(
    c: &StepInput<'_, D>,
    holds: &mut [Hold],
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
    mut release: impl FnMut(&mut [Hold]) -> bool,
) {
    let to_position = length(c.scheme.method, c.step, s.has_history);
    // A contact takes the velocity that it took from the way. As the second-order methods follow
    // their stage, it would throw back what it stops.
    let to_velocity = to_position / c.step;
    for hold in &mut *holds {
        hold.stiffness = STIFFNESS * stiffness(hold, c.masses, s);
    }
    let reduction = (c.scheme.tolerance * TIGHTER).into();
    for trial in 0..=MOST_TRIALS {
        // Each solve goes on from the one before.
        solve(c, holds, to_position, StoppingCriterion { reduction, warm_start: trial > 0 }, s, statistics);
        for hold in &mut *holds {
            let relative = gather(hold, s.solution);
            hold.impulse = hold.along(hold.missing / to_position - relative);
        }
        if trial == MOST_TRIALS || !release(holds) {
            break;
        }
    }
    c.dispatch.enter(Stage::Integrate);
    let y = &*s.solution;
    c.dispatch.run((&mut *s.next_positions, &mut *s.next_velocities), |start, (x, v)| {
        for (i, (x, v)) in (start..).zip(x.iter_mut().zip(v)) {
            *x += y[i] * to_position;
            *v += y[i] * to_velocity;
        }
    });
}

/// Writes y to `s.solution`.
fn solve<D: Dispatch>(
    c: &StepInput<'_, D>,
    holds: &[Hold],
    to_position: Real,
    until: StoppingCriterion,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    s.residual.fill(Vec3::ZERO);
    for hold in holds {
        scatter(hold, hold.along(hold.missing / to_position), s.residual);
    }
    c.pins.filter(s.residual);
    newton::solve_linear(c, holds, until, s, statistics);
}

/// 1 / sum W^2 / (n . A n) over a hold's vertices, kg.
fn stiffness(hold: &Hold, masses: &[Real], s: &Scratch<'_>) -> Real {
    let compliance = |(&v, weight): (&u32, Real)| {
        let Some(&mass) = masses.get(v as usize) else { return 0.0 };
        let block = matrix::to_mat3(&s.matrix.blocks[s.matrix.offsets[v as usize] as usize]);
        weight * weight / (mass + hold.normal.dot(block * hold.normal).max(0.0))
    };
    let sum: Real = hold.vertices.iter().zip(hold.weights).map(compliance).sum();
    if sum > 0.0 { 1.0 / sum } else { 0.0 }
}
