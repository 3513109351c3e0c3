//! The geometric stiffness of contacts [Tournier 2015]. Where a triangle tilts on a round collider, its nearest point
//! moves by the distance d of the centre times the angle. So a contact of force p resists the tilt: the displacements u
//! along the normal have the potential `p d |grad u|^2 / 2`.
//!
//! Without it the force stays at the old nearest point in a long step. The triangle tilts too far, and too far back in
//! the next step: cloth under tension stays rough, and loses friction.
//!
//! Cloth that slides around the collider tilts steadily, and its nearest points stay. So only the change from the
//! motion of the last step is resisted. Edges tilt little enough without this stiffness.

use super::augmented_contact::AugmentedContact;
use crate::column::Column;
use crate::forces::matrix::{self, BlockMatrix};
use crate::integrate::pins::Pins;
use crate::particles::Particles;
use crate::real::{Mat3, Real, outer};
use crate::scratch::Scratch;

/// Adds the stiffness to the matrix of a stage of `length`, s, and its impulses by the motion so far to the residual
/// and the forces on pins. `from` is the state at the start of the step, whose length is `step`, s.
#[cfg_attr(small, optimize(size))]
#[inline(never)]
pub fn add(
    pins: &Pins<'_>,
    step: Real,
    from: &Particles<'_>,
    contacts: &[AugmentedContact],
    length: Real,
    s: &mut Scratch<'_>,
) {
    let x = &*from.positions;
    for contact in contacts {
        let stiffness = length * contact.normal.dot(contact.multiplier) * contact.centre_distance;
        if stiffness <= 0.0 {
            continue;
        }
        let normals = outer(contact.normal, contact.normal);
        let mut add = |i: usize, j: usize, factor: Real| {
            let block = normals * (stiffness * factor);
            if block.is_finite() && add_between(&mut s.matrix, i.min(j), i.max(j), &block) {
                let change = |v: usize| s.displacements.at(v) - from.velocities.at(v) * step;
                let impulse = block * (change(i) - change(j)) / length;
                s.residual.add(i, -impulse);
                s.residual.add(j, impulse);
            }
        };
        let weighted = contact.vertices.iter().zip(contact.weights).filter(|&(_, weight)| weight != 0.0);
        let mut corners = weighted.map(|(&v, _)| v as usize).filter(|&v| v < x.len());
        let [Some(a), Some(b), Some(c)] = [corners.next(), corners.next(), corners.next()] else { continue };
        for [i, j, k] in [[a, b, c], [b, c, a], [c, a, b]] {
            let (to_i, to_j) = (x.at(i) - x.at(k), x.at(j) - x.at(k));
            add(i, j, to_i.dot(to_j) / to_i.cross(to_j).length_squared());
        }
    }
    for (force, &vertex) in s.pin_forces.iter_mut().zip(pins.vertices) {
        *force += s.residual.at(vertex as usize) / length;
    }
    pins.filter(s.residual);
}

/// Adds the matrix of a potential of the difference of two vertices. Returns false if they have no block.
#[cfg_attr(small, optimize(size))]
#[inline(never)]
fn add_between(matrix: &mut BlockMatrix<'_>, low: usize, high: usize, block: &Mat3) -> bool {
    let [row, next] = [low, low + 1].map(|row| matrix.offsets.at(row) as usize);
    let Some(slot) = matrix.columns.part(row..next).iter().position(|&column| column as usize == high) else {
        return false;
    };
    for (place, sign) in [(row, 1.0), (matrix.offsets.at(high) as usize, 1.0), (row + slot, -1.0)] {
        if let Some(stored) = matrix.blocks.element_mut(place) {
            matrix::add(stored, &(*block * sign));
        }
    }
    true
}
