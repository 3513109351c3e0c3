//! The last resort: what still meets moves as its obstacle does, or stays where it was; where that
//! does not help, all of the cloth does. Motion is lost, and counted. A held axis moves as it is led, and is
//! an obstacle to the same axis of others.

use super::Motion;
use super::constraint::Constraint;
use crate::contact::ContactModel;
use crate::real::Vec3;

/// Holds the vertices of constraints back.
pub(crate) fn hold(met: &[Constraint], model: &ContactModel<'_>, motion: &mut Motion<'_>, round: u32) {
    for constraint in met {
        let contact = constraint.contact;
        let pairs = || contact.vertices.into_iter().zip(contact.weights);
        // Of the held axes alone.
        let held = |v: u32, x: Vec3| Vec3::select(model.mobility[v as usize].cmpeq(Vec3::ZERO), x, Vec3::ZERO);
        let share: Vec3 = pairs().map(|(v, w)| held(v, Vec3::splat(w.abs()))).sum();
        let moved: Vec3 = pairs().map(|(v, w)| held(v, motion.moves[v as usize] * w.abs())).sum();
        let along = Vec3::select(share.cmpgt(Vec3::ZERO), moved / share, Vec3::ZERO);
        for (v, _) in pairs() {
            set_free_axes(model, motion, v as usize, along, round);
        }
    }
}

/// Holds everything back: what was apart stays apart, unless an obstacle moves into it.
pub(crate) fn freeze(model: &ContactModel<'_>, motion: &mut Motion<'_>, round: u32) {
    for v in 0..model.mobility.len() {
        set_free_axes(model, motion, v, Vec3::ZERO, round);
    }
}

fn set_free_axes(model: &ContactModel<'_>, motion: &mut Motion<'_>, vertex: usize, moves: Vec3, round: u32) {
    let free = model.mobility[vertex].cmpgt(Vec3::ZERO);
    if free.any() {
        motion.moves[vertex] = Vec3::select(free, moves, motion.moves[vertex]);
        motion.rounds[vertex] = round;
    }
}
