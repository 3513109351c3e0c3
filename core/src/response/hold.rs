//! The last resort. Vertices that still collide move as their obstacle does, or do not move. If that does not suffice,
//! no vertex of the cloth moves. Such steps lose motion, and are counted. Axes held by pins and axes of colliders move
//! as prescribed; they are the obstacle to the same axes of other vertices.

use super::work::{Motion, Work};
use crate::column::Column;
use crate::contact::ContactModel;
use crate::real::Vec3;

/// Holds the vertices of the impacts back.
pub(crate) fn hold(work: &mut Work<'_>) {
    let Work { model, list, first, motion, statistics, .. } = work;
    statistics.failsafe = 1;
    for constraint in list.all.part(*first..list.count) {
        let contact = constraint.contact;
        let pairs = || contact.vertices.into_iter().zip(contact.weights);
        // Only held axes count.
        let held = |v: u32, x: Vec3| Vec3::select(model.inverse_masses.at(v as usize).cmpeq(Vec3::ZERO), x, Vec3::ZERO);
        let share: Vec3 = pairs().map(|(v, w)| held(v, Vec3::splat(w.abs()))).sum();
        let moved: Vec3 = pairs().map(|(v, w)| held(v, motion.displacements.at(v as usize) * w.abs())).sum();
        let along = Vec3::select(share.cmpgt(Vec3::ZERO), moved / share, Vec3::ZERO);
        for (v, _) in pairs() {
            set_free_axes(model, motion, v as usize, along);
        }
    }
}

/// Holds all vertices back. Features that are apart stay apart, unless an obstacle moves into them.
pub(crate) fn freeze(work: &mut Work<'_>) {
    work.statistics.failsafe = 1;
    for v in 0..work.model.inverse_masses.len() {
        set_free_axes(work.model, &mut work.motion, v, Vec3::ZERO);
    }
}

/// Not inlined: it is rare and called in many places.
#[inline(never)]
fn set_free_axes(model: &ContactModel<'_>, motion: &mut Motion<'_>, vertex: usize, displacements: Vec3) {
    let free = model.inverse_masses.at(vertex).cmpgt(Vec3::ZERO);
    if free.any() {
        let before = motion.displacements.at(vertex);
        motion.displacements.set(vertex, Vec3::select(free, displacements, before));
        motion.rounds.set(vertex, motion.round);
    }
}
