//! Input of the broad phase: boxes that f32 holds exactly, and a surface.

use crate::rng::Rng;
use glam::DVec3;

/// Boxes of vertices, and the triangles and seams of those vertices.
#[derive(Clone, Debug, Default)]
pub struct Case {
    /// Shown when a test fails.
    pub name: String,
    /// Smallest and largest corner, one box per vertex.
    pub boxes: Vec<[DVec3; 2]>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Pairs of vertices that are sewn together.
    pub sewn: Vec<[u32; 2]>,
    /// Triangles from here on belong to a collider.
    pub first_passive: Option<u32>,
    /// Whether the cloth does not touch itself.
    pub without_own_contact: bool,
}

impl Case {
    /// Boxes of half the size `inflation` around the points.
    pub fn new(name: &str, points: &[DVec3], triangles: &[[u32; 3]], inflation: f64) -> Self {
        let around = |&x: &DVec3| [single(x - inflation), single(x + inflation)];
        Self {
            name: name.into(),
            boxes: points.iter().map(around).collect(),
            triangles: triangles.to_vec(),
            ..Self::default()
        }
    }

    /// Triangles that share no vertex, from their corners.
    pub fn soup(name: &str, corners: &[[DVec3; 3]], inflation: f64) -> Self {
        let triangles: Vec<_> = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self::new(name, corners.as_flattened(), &triangles, inflation)
    }

    /// Adds the triangles of `passive` as triangles of a collider.
    pub fn against(mut self, passive: &Self) -> Self {
        let first = self.boxes.len() as u32;
        self.first_passive = Some(self.triangles.len() as u32);
        self.boxes.extend(&passive.boxes);
        self.triangles.extend(passive.triangles.iter().map(|t| t.map(|v| v + first)));
        self
    }
}

/// Rounds to f32.
pub fn single(x: DVec3) -> DVec3 {
    x.as_vec3().as_dvec3()
}

/// Random triangles of the given size in a cube of half the side `half`.
pub fn random(rng: &mut Rng, count: usize, half: f64, size: impl Fn(&mut Rng) -> f64) -> Vec<[DVec3; 3]> {
    let triangle = |_| {
        let (center, size) = (rng.cube(half), size(rng));
        std::array::from_fn(|_| center + rng.cube(size))
    };
    (0..count).map(triangle).collect()
}
