//! Impact zones: all constraints that are connected through vertices that can move are solved together [Harmon 2008,
//! Tang 2018]. The projection is inelastic and, unlike that of a rigid zone, leaves sliding free.

use super::constraint::Constraint;
use super::work::{Work, relax};
use crate::column::Column;
use crate::inverse_masses::InverseMasses;
use crate::quicksort;
use crate::real::{Real, Vec3};

/// Sweeps over a zone.
const SWEEPS: u32 = 60;
/// Violation that is left, relative to the thickness.
const LEFT: Real = 0.02;

/// Solves the zones of the impacts.
pub(crate) fn resolve(work: &mut Work<'_>) {
    let Work { model, list, first, motion, zones, order, statistics, .. } = work;
    let (constraints, inverse_masses) = (list.all.part_mut(..list.count), &model.inverse_masses);
    for (v, zone) in zones.iter_mut().enumerate() {
        *zone = v as u32;
    }
    for constraint in constraints.iter() {
        join(zones, constraint, inverse_masses);
    }
    // Roots of the new constraints first, then the constraints that lie in their zones.
    let (roots, chosen) = order.cut_mut(constraints.len());
    let mut wanted = 0;
    for constraint in constraints.part(*first..) {
        if let Some(root) = root_of(zones, constraint, inverse_masses) {
            roots.set(wanted, root);
            wanted += 1;
        }
    }
    let roots = roots.part_mut(..wanted);
    quicksort::sort_by_key(roots, |&root| root);
    let mut count = 0;
    for (k, constraint) in (0..).zip(constraints.iter()) {
        let root = root_of(zones, constraint, inverse_masses);
        if root.is_some_and(|root| roots.binary_search(&root).is_ok()) {
            chosen.set(count, k);
            count += 1;
        }
    }
    relax(model, constraints, Some(chosen.part(..count)), motion, SWEEPS, LEFT * model.thickness);
    let mut before = None;
    statistics.zones += roots.iter().filter(|&&root| before.replace(root) != Some(root)).count() as u64;
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
