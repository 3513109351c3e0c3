//! Shadows of the key light: a map of the height up to which surfaces reach towards the light.

use glam::{Vec2, Vec3};

use super::raster;

/// Direction to the key light: from the left, above and a little in front.
const TOWARDS_LIGHT: Vec3 = Vec3::new(-0.36, 0.88, 0.30);
/// Width and height of the map, texels.
const SIDE: usize = 384;

/// A distant light, and the region on which it casts shadows.
#[derive(Clone, Copy)]
pub struct Light {
    /// Towards the light, of length 1.
    pub direction: Vec3,
    axes: [Vec3; 2],
    low: Vec2,
    /// Size of a texel, metres.
    pub texel: f32,
}

impl Light {
    /// A light whose map covers all points. There must be at least one point.
    pub fn fit(points: impl Iterator<Item = Vec3>) -> Light {
        let direction = TOWARDS_LIGHT.normalize();
        let right = Vec3::Z.cross(direction).normalize();
        let axes = [right, direction.cross(right)];
        let flat = points.map(|p| Vec2::new(axes[0].dot(p), axes[1].dot(p)));
        let (low, high) = flat.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let texel = (high - low).max_element() / (SIDE - 2) as f32;
        Light { direction, axes, low: low - texel, texel }
    }

    /// The same light on a region that has moved.
    pub fn moved(self, way: Vec3) -> Light {
        Light { low: self.low + self.flat(way), ..self }
    }

    fn flat(&self, point: Vec3) -> Vec2 {
        Vec2::new(self.axes[0].dot(point), self.axes[1].dot(point))
    }

    /// Position in the map, in texels, and height towards the light, metres.
    fn project(&self, point: Vec3) -> Vec3 {
        ((self.flat(point) - self.low) / self.texel).extend(self.direction.dot(point))
    }

    /// The shadows that these triangles cast.
    pub fn shadows(&self, triangles: impl Iterator<Item = [Vec3; 3]>) -> ShadowMap<'_> {
        let mut heights = vec![f32::NEG_INFINITY; SIDE * SIDE];
        for corners in triangles {
            let corners = corners.map(|corner| self.project(corner));
            raster::triangle([SIDE; 2], corners, |texel, weights| {
                let height = (0..3).map(|k| weights[k] * corners[k].z).sum();
                heights[texel] = heights[texel].max(height);
            });
        }
        ShadowMap { light: self, heights }
    }
}

/// Shadows at one instant.
pub struct ShadowMap<'a> {
    light: &'a Light,
    heights: Vec<f32>,
}

impl ShadowMap<'_> {
    /// Fraction of the light that reaches a point, 0 to 1. Shadow edges are softened over `reach` texels each way.
    pub fn lit(&self, point: Vec3, reach: i32) -> f32 {
        let place = self.light.project(point);
        let free = |x: i32, y: i32| {
            let inside = (0..SIDE as i32).contains(&x) && (0..SIDE as i32).contains(&y);
            !inside || self.heights[y as usize * SIDE + x as usize] <= place.z
        };
        let (x, y) = (place.x as i32, place.y as i32);
        let taps =
            (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (x.saturating_add(i), y.saturating_add(j))));
        let free = taps.filter(|&(x, y)| free(x, y)).count();
        free as f32 / (2 * reach + 1).pow(2) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_shades_what_is_behind_it() {
        let corners = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(2.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 2.0)];
        let light = Light::fit(corners.into_iter());
        let map = light.shadows([corners].into_iter());
        let behind = |metres: f32| map.lit(-light.direction * metres, 2);
        assert_eq!((behind(1.0), behind(0.1), behind(-0.1)), (0.0, 0.0, 1.0));
        assert_eq!(map.lit(Vec3::new(1e6, -1.0, 0.0), 2), 1.0);
        let edge = map.lit((corners[0] + corners[1]) / 2.0 - light.direction, 2);
        assert!(0.0 < edge && edge < 1.0);
    }
}
