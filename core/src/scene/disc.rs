//! A disc in the xz plane, centred at the origin: concentric rings, each with about six vertices more than the
//! last. From one of six radii to the next the triangles change from right-angled to isosceles and back, so hinge
//! bending is not isotropic (see the README of this crate).

use core::f64::consts::PI;
use core::ops::Range;

use crate::error::SceneError;
use crate::mesh::TriMesh;

/// A disc of `rings` rings.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DiscDesc {
    /// Radius, m.
    pub radius: f64,
    /// Radius of the hole, m; 0: no hole.
    #[cfg_attr(feature = "serde", serde(default))]
    pub hole: f64,
    /// Number of rings between the centre, or the hole, and the border.
    pub rings: u32,
}

/// Number of vertices, nearly: a ring has about 6 radius / spacing.
pub(super) fn vertices(disc: &DiscDesc) -> u64 {
    let rings = f64::from(disc.rings);
    let hole = rings * disc.hole / (disc.radius - disc.hole);
    (3.0 * (rings + 1.0) * (rings + 2.0 * hole)) as u64
}

/// Number of vertices of a ring; ring 0 is the innermost.
fn count(disc: &DiscDesc, ring: u32) -> u32 {
    let spacing = spacing(disc);
    let radius = disc.hole + spacing * f64::from(ring);
    if radius == 0.0 { 1 } else { (libm::round(6.0 * radius / spacing) as u32).max(6) }
}

/// Distance of the rings, m.
fn spacing(disc: &DiscDesc) -> f64 {
    (disc.radius - disc.hole) / f64::from(disc.rings)
}

/// The vertices of a ring.
pub(super) fn ring(disc: &DiscDesc, ring: u32) -> Range<u32> {
    let first = (0..ring).map(|ring| count(disc, ring)).sum();
    first..first + count(disc, ring)
}

pub(super) fn mesh(disc: &DiscDesc) -> Result<TriMesh, SceneError> {
    super::check::positive("disc.radius", disc.radius)?;
    super::check::not_negative("disc.hole", disc.hole)?;
    super::check::positive("disc.radius - disc.hole", disc.radius - disc.hole)?;
    super::check::at_least("disc.rings", [disc.rings, u32::MAX], 1)?;
    super::check::nameable(vertices(disc))?;
    let spacing = spacing(disc);
    let mut mesh = TriMesh::default();
    let mut inner = (0, 0);
    for ring in 0..=disc.rings {
        let radius = disc.hole + spacing * f64::from(ring);
        let count = count(disc, ring);
        let outer = (mesh.positions.len() as u32, count);
        for i in 0..count {
            let angle = 2.0 * PI * f64::from(i) / f64::from(count);
            let (x, z) = (radius * libm::cos(angle), radius * libm::sin(angle));
            mesh.positions.push([x, 0.0, z]);
            mesh.uvs.push([x, z]);
        }
        if ring > 0 {
            zip_rings(&mut mesh, inner, outer);
        }
        inner = outer;
    }
    Ok(super::grid::finish(mesh))
}

/// Adds the triangles between two rings, each given as (first vertex, count). Walks both rings by angle.
fn zip_rings(mesh: &mut TriMesh, inner: (u32, u32), outer: (u32, u32)) {
    let (mut i, mut k) = (0, 0);
    let at = |ring: (u32, u32), n: u32| ring.0 + n % ring.1;
    let inner_steps = if inner.1 == 1 { 0 } else { inner.1 };
    while i < inner_steps || k < outer.1 {
        // Compare the angles of the next vertices in integers, without rounding.
        let outer_next = i == inner_steps
            || (k < outer.1 && u64::from(k + 1) * u64::from(inner.1) <= u64::from(i + 1) * u64::from(outer.1));
        if outer_next {
            mesh.triangles.push([at(inner, i), at(outer, k + 1), at(outer, k)]);
            k += 1;
        } else {
            mesh.triangles.push([at(inner, i), at(inner, i + 1), at(outer, k)]);
            i += 1;
        }
    }
}
