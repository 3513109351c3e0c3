//! Moves cloth out of colliders. Planes, spheres and capsules displace the space inside and around them outward, by
//! maps that preserve the order of layers. A piece of cloth leaves a box as a whole, in the direction that is
//! shortest for the whole piece.

use alloc::vec::Vec;

use super::flap::{FALLOFF, draw};
use super::topology::{Pieces, Topology};
use super::{Displacements, Scene};
use crate::colliders::{Body, Form};
use crate::contact::ContactModel;
use crate::real::{Real, Vec3, sqrt};

/// The space above a surface is displaced up to this multiple of the greatest depth.
const ROOM: Real = 6.0;

/// Places on an edge, from 0 to 1, at which its depth in a box is measured.
const SAMPLES: [Real; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Number of cloth vertices that can move and lie inside colliders.
pub fn inside(model: &ContactModel<'_>, places: &[Vec3]) -> usize {
    let (cloth, solids) = places.split_at(model.cloth());
    let free = cloth.iter().enumerate().filter(|(v, _)| model.inverse_masses.at(*v) != Vec3::ZERO);
    free.filter(|&(_, &x)| model.colliders.depth(solids, x) > 0.0).count()
}

/// Requests the displacements that move cloth out of colliders.
pub fn leave(scene: &Scene<'_>, topology: &Topology, places: &[Vec3], displacements: &mut Displacements) {
    let (cloth, solids) = places.split_at(scene.model.cloth());
    for body in scene.model.colliders.bodies {
        let corners = &solids[body.range()];
        match body.form() {
            Form::Box => leave_box(scene, topology, corners, places, displacements),
            Form::Mesh => {}
            Form::Plane(_) | Form::Sphere | Form::Capsule => push_out(scene, body, corners, cloth, displacements),
        }
    }
}

/// Height above the surface of a plane, sphere or capsule, and the direction up.
fn above(body: &Body, corners: &[Vec3], x: Vec3) -> (Real, Vec3) {
    match body.form() {
        Form::Plane(normal) => (normal.dot(x - corners[0]), normal),
        _ => {
            let (a, b) = (corners[0], corners[corners.len() - 1]);
            let axis = b - a;
            let along = (x - a).dot(axis) / axis.length_squared().max(Real::MIN_POSITIVE);
            let arm = x - a - axis * along.clamp(0.0, 1.0);
            let distance = sqrt(arm.length_squared());
            (distance - body.radius, arm.try_normalize().unwrap_or(Vec3::Y))
        }
    }
}

/// Displaces cloth upward: with the greatest depth d and `top = ROOM d + gap`, maps the heights from -d to top
/// linearly onto the heights from the gap to top.
fn push_out(scene: &Scene<'_>, body: &Body, corners: &[Vec3], cloth: &[Vec3], displacements: &mut Displacements) {
    let free = |v: usize| scene.model.inverse_masses.at(v) != Vec3::ZERO;
    let heights = cloth.iter().enumerate().filter(|(v, _)| free(*v)).map(|(_, &x)| above(body, corners, x).0);
    let depth = -heights.fold(0.0, Real::min);
    if depth <= 0.0 {
        return;
    }
    let top = ROOM * depth + scene.gap;
    for (v, &x) in (0..).zip(cloth) {
        let (height, up) = above(body, corners, x);
        if height < top {
            let raised = scene.gap + (height + depth) * (top - scene.gap) / (top + depth);
            displacements.add(v, up * (raised - height), 1.0);
        }
    }
}

/// Moves each piece of cloth that has edges in a box out of it, in the direction that is shortest for the deepest
/// point of the piece.
fn leave_box(
    scene: &Scene<'_>,
    topology: &Topology,
    corners: &[Vec3],
    places: &[Vec3],
    displacements: &mut Displacements,
) {
    let surface = &scene.model.surface;
    let cloth = |edge: &&u32| surface.edges[**edge as usize][0] < scene.model.cloth() as u32;
    let mut pieces = Pieces::new(scene.model.cloth());
    let mut within: Vec<([u32; 2], [Vec3; 2])> = Vec::new();
    for &edge in topology.edges.iter().filter(cloth) {
        let ends = surface.edges[edge as usize];
        if let Some(part) = clip(corners, ends.map(|v| places[v as usize])) {
            pieces.join(ends[0], ends[1]);
            within.push((ends, part));
        }
    }
    let piece_of = pieces.roots();
    within.sort_by_key(|(ends, _)| piece_of[ends[0] as usize]);
    for piece in within.chunk_by(|a, b| piece_of[a.0[0] as usize] == piece_of[b.0[0] as usize]) {
        let mut vertices: Vec<u32> = piece.iter().flat_map(|(ends, _)| *ends).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let inside = piece.iter().flat_map(|(_, [a, b])| SAMPLES.map(|part| *a + (*b - *a) * part));
        let way = |out: Vec3| {
            let deepest = inside.clone().map(|x| exit(corners, x, out)).fold(0.0, Real::max);
            (deepest + scene.gap, out)
        };
        if let Some((length, out)) = directions(corners).map(way).min_by(|a, b| a.0.total_cmp(&b.0)) {
            let members: Vec<_> = vertices.iter().map(|&v| (v, out * length)).collect();
            draw(scene, topology, &members, FALLOFF, places, displacements);
        }
    }
}

/// The part of an edge that lies in a box.
fn clip(corners: &[Vec3], [p, q]: [Vec3; 2]) -> Option<[Vec3; 2]> {
    let (mut from, mut to): (Real, Real) = (0.0, 1.0);
    for axis in [1, 2, 4] {
        let side = corners[axis] - corners[0];
        let length = side.length_squared();
        let (start, speed) = ((p - corners[0]).dot(side), (q - p).dot(side));
        if speed == 0.0 {
            if !(0.0..=length).contains(&start) {
                return None;
            }
        } else {
            let [one, other] = [-start / speed, (length - start) / speed];
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
    }
    (from < to).then(|| [p + (q - p) * from, p + (q - p) * to])
}

/// The directions out of a box across its sides, edges and corners.
fn directions(corners: &[Vec3]) -> impl Iterator<Item = Vec3> {
    let axes = [1, 2, 4].map(|k| (corners[k] - corners[0]).try_normalize().unwrap_or(Vec3::ZERO));
    let sign = |code: usize| [-1.0, 0.0, 1.0][code % 3];
    let all = (0..27).map(move |code| axes[0] * sign(code) + axes[1] * sign(code / 3) + axes[2] * sign(code / 9));
    all.filter_map(|out| out.try_normalize())
}

/// The distance that a point in a box has to move in a direction to leave the box, m.
fn exit(corners: &[Vec3], x: Vec3, out: Vec3) -> Real {
    let along = |axis: usize| {
        let edge = corners[1 << axis] - corners[0];
        let speed = out.dot(edge);
        let part = (x - corners[0]).dot(edge);
        let left = if speed > 0.0 { edge.length_squared() - part } else { part };
        if speed == 0.0 { Real::INFINITY } else { left / speed.abs() }
    };
    (0..3).map(along).fold(Real::INFINITY, Real::min)
}
