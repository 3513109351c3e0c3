//! A host reads between steps: contacts, points of the cloth, and the first hit of a ray.

use glam::DVec3;

use super::parts::Parts;
use crate::column::Column;
use crate::error::{LiveError, checked_vector};
use crate::real::{Sum, to_f64};
use crate::response::constraint::Constraint;

/// A surface that something touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The cloth with this index.
    Cloth(u32),
    /// The collider with this index.
    Collider(u32),
}

/// A contact that pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The two surfaces.
    pub sides: [Side; 2],
    /// Vertices of both features. Those of colliders come after those of the cloth.
    pub vertices: [u32; 4],
    /// Their weights in the nearest points: positive on the first side, negative on the second.
    pub weights: [Sum; 4],
    /// The nearest point of a cloth, in the world, m.
    pub position: [Sum; 3],
    /// Unit vector from the second side to the first.
    pub normal: [Sum; 3],
    /// Force on the first side, with friction, N.
    pub force: [Sum; 3],
}

/// A point of a cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position in the world, m.
    pub position: [Sum; 3],
    /// Velocity, m/s.
    pub velocity: [Sum; 3],
    /// Unit normal of its triangle; zero if the triangle has no area.
    pub normal: [Sum; 3],
}

/// Where a ray hits a cloth first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates on it.
    pub weights: [Sum; 3],
    /// Distance from the origin of the ray, m.
    pub distance: Sum,
}

/// By how much a ray may miss a triangle, in barycentric coordinates: otherwise it could pass between neighbours.
const SEAM: Sum = 1e-9;

impl<'a> Parts<'a> {
    pub fn touches(self) -> impl Iterator<Item = Touch> + use<'a> {
        let step = self.substep;
        let pushes = move |constraint: &&Constraint| step > 0.0 && constraint.normal_impulse > 0.0;
        self.constraints.iter().filter(pushes).map(move |it| self.touch(it, step))
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn touch(&self, constraint: &Constraint, step: Sum) -> Touch {
        let contact = constraint.contact;
        let (weights, normal) = (contact.weights.map(Sum::from), DVec3::from(to_f64(contact.normal)));
        let corners = || contact.vertices.into_iter().zip(weights);
        let sides = [1.0, -1.0].map(|sign| {
            let vertex = corners().find(|(_, weight)| weight * sign > 0.0).map_or(contact.vertices[0], |(v, _)| v);
            self.side(vertex)
        });
        let sign = if matches!(sides[0], Side::Cloth(_)) { 1.0 } else { -1.0 };
        let own = corners().filter(|&(v, weight)| weight * sign > 0.0 && (v as usize) < self.velocities.len());
        let (sum, total) = own.fold((DVec3::ZERO, 0.0), |(sum, total), (v, weight)| {
            (sum + self.place(v) * weight.abs(), total + weight.abs())
        });
        let impulse = normal * Sum::from(constraint.normal_impulse) + DVec3::from(to_f64(constraint.friction_impulse));
        Touch {
            sides,
            vertices: contact.vertices,
            weights,
            position: (sum / total).into(),
            normal: normal.into(),
            force: (impulse / (step * step)).into(),
        }
    }

    /// The surface that a vertex belongs to.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn side(&self, vertex: u32) -> Side {
        match (vertex as usize).checked_sub(self.velocities.len()) {
            Some(of_colliders) => Side::Collider(self.colliders.body_of(of_colliders) as u32),
            None => Side::Cloth(self.firsts.partition_point(|&first| first <= vertex).saturating_sub(1) as u32),
        }
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn point(&self, triangle: u32, weights: [Sum; 3]) -> Result<SurfacePoint, LiveError> {
        let missing = LiveError::NoTriangle { triangle, count: self.triangles.len() as u32 };
        let corners = *self.triangles.get(triangle as usize).ok_or(missing)?;
        checked_vector("a weight", weights)?;
        let places = corners.map(|v| self.place(v));
        let mean = |vectors: [DVec3; 3]| {
            vectors.into_iter().zip(weights).map(|(vector, weight)| vector * weight).sum::<DVec3>()
        };
        let normal = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
        Ok(SurfacePoint {
            position: mean(places).into(),
            velocity: mean(corners.map(|v| to_f64(self.velocities.at(v as usize)).into())).into(),
            normal: normal.into(),
        })
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn hit(&self, origin: [Sum; 3], direction: [Sum; 3]) -> Result<Option<Hit>, LiveError> {
        let (origin, direction) = (checked_vector("a ray", origin)?, checked_vector("a ray", direction)?);
        // Scaled first, so that no square under- or overflows.
        let Some(along) = (direction / direction.abs().max_element()).try_normalize() else { return Ok(None) };
        let mut first: Option<Hit> = None;
        for (triangle, corners) in (0..).zip(self.triangles) {
            let [a, b, c] = corners.map(|v| self.place(v));
            let [ab, ac, from] = [b - a, c - a, origin - a];
            let across = along.cross(ac);
            let volume = ab.dot(across);
            let beside = from.cross(ab);
            let [u, v, distance] = [from.dot(across), along.dot(beside), ac.dot(beside)].map(|x| x / volume);
            // A comparison with NaN, of a ray in the plane of the triangle, is false.
            let hits = u >= -SEAM && v >= -SEAM && u + v <= 1.0 + SEAM && distance >= 0.0;
            if hits && first.is_none_or(|first| distance < first.distance) {
                first = Some(Hit { triangle, weights: [1.0 - u - v, u, v], distance });
            }
        }
        Ok(first)
    }

    /// Position of a vertex of the cloth in the world, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn place(&self, vertex: u32) -> DVec3 {
        self.origin + self.positions.place(vertex as usize)
    }
}
