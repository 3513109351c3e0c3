//! Colliders as surfaces to draw: spheres and capsules become triangles, boxes get sharp edges.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// Corners of a ring around a sphere, and rings from pole to pole.
const AROUND: usize = 48;
const RINGS: usize = 24;

/// A collider, given by indices of the colliders' vertices.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// The half space behind the plane through a vertex with a normal.
    Plane {
        /// The vertex on the plane.
        vertex: usize,
        /// Outward normal, of length 1.
        normal: [f32; 3],
    },
    /// All points within a radius of the segment between two vertices, which may be the same vertex.
    Round {
        /// Vertices at the ends of the segment.
        ends: [usize; 2],
        /// Radius, m.
        radius: f32,
    },
    /// Triangles with sharp edges.
    Faceted(Vec<[u32; 3]>),
    /// Triangles with rounded edges.
    Smooth(Vec<[u32; 3]>),
}

/// Colliders prepared for drawing: each has triangles between its own points.
#[derive(Debug, Default)]
pub struct Solids {
    solids: Vec<Solid>,
    /// Triangles of all colliders, as indices of [`points`](Self::points).
    pub triangles: Vec<[u32; 3]>,
}

impl Solids {
    /// Triangulates colliders.
    pub fn new(solids: Vec<Solid>) -> Solids {
        let (mut triangles, mut first) = (Vec::new(), 0);
        for solid in &solids {
            let own = match solid {
                Solid::Plane { .. } => Vec::new(),
                Solid::Round { .. } => round_triangles(),
                Solid::Faceted(of) => (0..of.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
                Solid::Smooth(of) => {
                    let least = *span(of).start();
                    of.iter().map(|t| t.map(|v| v - least)).collect()
                }
            };
            let next = first + point_count(solid);
            triangles.extend(own.into_iter().map(|t| t.map(|v| v + first)));
            first = next;
        }
        Solids { solids, triangles }
    }

    /// Number of points of all colliders.
    pub fn point_count(&self) -> usize {
        self.solids.iter().map(|solid| point_count(solid) as usize).sum()
    }

    /// Positions of all points, m, when the colliders' vertices are at `places`, m.
    pub fn points(&self, places: &[[f32; 3]]) -> Vec<Vec3> {
        let at = |vertex: usize| places.get(vertex).map_or(Vec3::NAN, |&p| Vec3::from_array(p));
        let mut points = Vec::new();
        for solid in &self.solids {
            match solid {
                Solid::Plane { .. } => {}
                Solid::Round { ends, radius } => points.extend(round_points(ends.map(at), *radius)),
                Solid::Faceted(of) => points.extend(of.as_flattened().iter().map(|&v| at(v as usize))),
                Solid::Smooth(of) => points.extend(span(of).map(|v| at(v as usize))),
            }
        }
        points
    }

    /// A point of the first plane that faces upward, and the normal of that plane.
    pub fn floor(&self, places: &[[f32; 3]]) -> Option<[Vec3; 2]> {
        self.solids.iter().find_map(|solid| match solid {
            Solid::Plane { vertex, normal } if normal[1] > 0.3 => {
                Some([Vec3::from_array(*places.get(*vertex)?), Vec3::from_array(*normal)])
            }
            _ => None,
        })
    }
}

/// Range of the vertices of triangles: from the smallest to the largest index.
fn span(triangles: &[[u32; 3]]) -> std::ops::RangeInclusive<u32> {
    let all = || triangles.as_flattened().iter().copied();
    all().min().unwrap_or(1)..=all().max().unwrap_or(0)
}

fn point_count(solid: &Solid) -> u32 {
    match solid {
        Solid::Plane { .. } => 0,
        Solid::Round { .. } => (AROUND * RINGS) as u32,
        Solid::Faceted(of) => 3 * of.len() as u32,
        Solid::Smooth(of) => span(of).count() as u32,
    }
}

/// Points of rings from pole to pole; the upper half is around the first end, the lower half around the second.
fn round_points([a, b]: [Vec3; 2], radius: f32) -> impl Iterator<Item = Vec3> {
    let axis = (a - b).try_normalize().unwrap_or(Vec3::Y);
    let (x, z) = axis.any_orthonormal_pair();
    (0..AROUND * RINGS).map(move |k| {
        let (ring, place) = (k / AROUND, k % AROUND);
        // Two rings lie at the equator: the straight part of a capsule is between them.
        let half = ring.min(RINGS - 1 - ring) as f32 / (RINGS / 2 - 1) as f32;
        let (sin, cos) = (half * PI / 2.0).sin_cos();
        let (east, north) = (place as f32 / AROUND as f32 * TAU).sin_cos();
        let (end, up) = if ring < RINGS / 2 { (a, cos) } else { (b, -cos) };
        end + radius * (axis * up + (x * north + z * east) * sin)
    })
}

fn round_triangles() -> Vec<[u32; 3]> {
    let corner = |ring: usize, place: usize| (ring * AROUND + place % AROUND) as u32;
    let quads = (1..RINGS).flat_map(|ring| (0..AROUND).map(move |place| [ring - 1, ring, place, place + 1]));
    quads
        .flat_map(|[r, s, p, q]| {
            [[corner(r, p), corner(s, p), corner(s, q)], [corner(r, p), corner(s, q), corner(r, q)]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_things_are_round_and_face_outward() {
        let ends = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.5, 0.0, 0.2)];
        for ends in [ends, [ends[0]; 2]] {
            let places = ends.map(|p| p.to_array());
            let solids = Solids::new(vec![Solid::Round { ends: [0, 1], radius: 0.3 }]);
            let points = solids.points(&places);
            let axis = ends[1] - ends[0];
            let nearest =
                |p: Vec3| ends[0] + axis * ((p - ends[0]).dot(axis) / axis.length_squared().max(1e-9)).clamp(0.0, 1.0);
            assert!(points.iter().all(|&p| (p.distance(nearest(p)) - 0.3).abs() < 1e-5));
            for triangle in &solids.triangles {
                let [a, b, c] = triangle.map(|v| points[v as usize]);
                let middle = (a + b + c) / 3.0;
                assert!((b - a).cross(c - a).dot(middle - nearest(middle)) >= -1e-9);
            }
        }
    }

    #[test]
    fn solids_have_points_of_their_own() {
        let triangles = vec![[3, 4, 5], [5, 4, 6]];
        let solids = Solids::new(vec![
            Solid::Plane { vertex: 0, normal: [0.0, 1.0, 0.0] },
            Solid::Round { ends: [1, 2], radius: 0.1 },
            Solid::Faceted(triangles.clone()),
            Solid::Smooth(triangles),
        ]);
        let places: Vec<[f32; 3]> = (0..7).map(|k| [k as f32, 0.0, (k * k) as f32]).collect();
        let points = solids.points(&places);
        assert_eq!(points.len(), AROUND * RINGS + 6 + 4);
        assert_eq!(solids.triangles.iter().flatten().max(), Some(&(points.len() as u32 - 1)));
        let last: Vec<_> = solids.triangles[solids.triangles.len() - 2..].iter().flatten().collect();
        assert_eq!(points[*last[5] as usize], Vec3::from_array(places[6]));
        assert_eq!(solids.floor(&places), Some([Vec3::ZERO, Vec3::Y]));
        assert!(solids.points(&[])[0].is_nan());
    }
}
