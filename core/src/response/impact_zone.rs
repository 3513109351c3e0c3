//! Impact zones: all constraints that are connected through vertices that can move are solved together [Harmon 2008,
//! Tang 2018]. The projection is inelastic and, unlike that of a rigid zone, leaves sliding free.

use super::constraint::Constraint;
use super::work::{Work, relax};
use crate::column::Column;
use crate::inverse_masses::InverseMasses;
use crate::real::{Real, Vec3};

/// Sweeps over a zone.
const SWEEPS: u32 = 60;
/// Violation that is left, relative to the thickness.
const LEFT: Real = 0.02;

/// Solves the zones of the impacts.
pub(crate) fn resolve(work: &mut Work<'_>) {
    let Work { model, list, first, motion, zones, wanted, order, statistics, .. } = work;
    let (constraints, inverse_masses) = (list.all.part_mut(..list.count), &model.inverse_masses);
    for (v, zone) in zones.iter_mut().enumerate() {
        *zone = v as u32;
    }
    for constraint in constraints.iter() {
        join(zones, constraint, inverse_masses);
    }
    // The zones of the new constraints, and all constraints that lie in them.
    wanted.fill(0);
    for constraint in constraints.part(*first..) {
        if let Some(root) = root_of(zones, constraint, inverse_masses) {
            statistics.zones += u64::from(wanted.at(root as usize) == 0);
            wanted.set(root as usize, 1);
        }
    }
    let mut count = 0;
    for (k, constraint) in (0..).zip(constraints.iter()) {
        let root = root_of(zones, constraint, inverse_masses);
        if root.is_some_and(|root| wanted.at(root as usize) > 0) {
            order.set(count, k);
            count += 1;
        }
    }
    relax(model, constraints, Some(order.part(..count)), motion, SWEEPS, LEFT * model.thickness);
}

fn movable(inverse_masses: &InverseMasses<'_>, vertex: u32) -> bool {
    inverse_masses.at(vertex as usize) != Vec3::ZERO
}

fn root(zones: &mut [u32], vertex: u32) -> u32 {
    let mut v = vertex;
    loop {
        let above = zones.at(v as usize);
        if above == v {
            return v;
        }
        let next = zones.at(above as usize);
        zones.set(v as usize, next);
        v = next;
    }
}

fn root_of(zones: &mut [u32], constraint: &Constraint, inverse_masses: &InverseMasses<'_>) -> Option<u32> {
    let found = constraint.contact.vertices.into_iter().find(|&v| movable(inverse_masses, v));
    found.map(|v| root(zones, v))
}

fn join(zones: &mut [u32], constraint: &Constraint, inverse_masses: &InverseMasses<'_>) {
    let Some(zone) = root_of(zones, constraint, inverse_masses) else { return };
    let mut low = zone;
    for v in constraint.contact.vertices {
        if movable(inverse_masses, v) {
            let other = root(zones, v);
            // The smaller root is kept, in any order.
            let (less, more) = (low.min(other), low.max(other));
            zones.set(more as usize, less);
            low = less;
        }
    }
}
