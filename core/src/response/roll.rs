//! Surfaces of spheres and capsules that turn. The vertices of these colliders are a centre and the ends of an axis,
//! which do not move with the surface.

use crate::column::Column;
use crate::contact::ContactModel;
use crate::narrow_phase::Contact;
use crate::real::Vec3;

/// Displacement in a step of the first feature relative to the surface of a round collider that turns under it, beside
/// that of its vertices, m: r n x t for the radius r, the normal n and the rotation t. `turns` are those of all
/// colliders, rad.
pub(crate) fn roll(model: &ContactModel<'_>, contact: &Contact, turns: &[Vec3]) -> Vec3 {
    let cloth = model.cloth();
    let is_round = |&v: &usize| v >= cloth && model.radii.at(v) > 0.0;
    let Some(vertex) = contact.vertices.iter().map(|&v| v as usize).find(is_round) else { return Vec3::ZERO };
    contact.normal.cross(turns.at(model.colliders.body_of(vertex - cloth))) * model.radii.at(vertex)
}
