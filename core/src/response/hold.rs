//! The last resort: what still meets moves as its obstacle does, or stays where it was; where that
//! does not help, all of the cloth does. Motion is lost, and counted.

use super::Motion;
use super::constraint::Constraint;
use crate::contact::ContactModel;
use crate::real::Vec3;

/// Holds the vertices of constraints back.
pub(crate) fn hold(met: &[Constraint], model: &ContactModel<'_>, motion: &mut Motion<'_>, round: u32) {
    for constraint in met {
        let contact = constraint.contact;
        let pairs = || contact.vertices.into_iter().zip(contact.weights);
        let fixed = || pairs().filter(|&(v, _)| model.mobility[v as usize] == Vec3::ZERO);
        let share: crate::real::Real = fixed().map(|(_, w)| w.abs()).sum();
        let along = match share > 0.0 {
            true => fixed().map(|(v, w)| motion.moves[v as usize] * w.abs()).sum::<Vec3>() / share,
            false => Vec3::ZERO,
        };
        for (v, _) in pairs().filter(|&(v, _)| model.mobility[v as usize] != Vec3::ZERO) {
            motion.moves[v as usize] = along;
            motion.rounds[v as usize] = round;
        }
    }
}

/// Holds everything back: what was apart stays apart, unless an obstacle moves into it.
pub(crate) fn freeze(model: &ContactModel<'_>, motion: &mut Motion<'_>, round: u32) {
    for (v, mobility) in model.mobility.iter().enumerate() {
        if *mobility != Vec3::ZERO {
            motion.moves[v] = Vec3::select(mobility.cmpgt(Vec3::ZERO), Vec3::ZERO, motion.moves[v]);
            motion.rounds[v] = round;
        }
    }
}
