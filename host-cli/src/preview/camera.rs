//! The camera that takes the pictures.

use glam::Vec3;

/// Direction to the camera: from the front and right, a little above; y is up.
const TOWARDS_EYE: Vec3 = Vec3::new(0.55, 0.5, 0.85);
/// Tangent of half the vertical angle of view.
const HALF_ANGLE: f32 = 0.27;
/// Part of the picture that the cloth may fill.
const FILL: f32 = 0.86;

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Position of the camera, metres.
    pub eye: Vec3,
    right: Vec3,
    up: Vec3,
    back: Vec3,
    size: [f32; 2],
    /// Pixels per unit of slope.
    focal: f32,
}

impl Camera {
    /// The nearest camera that sees all points in a picture of `size` pixels. There must be at least one point.
    pub fn fit(points: impl Iterator<Item = Vec3>, size: [usize; 2]) -> Camera {
        let size = size.map(|s| s as f32);
        let back = TOWARDS_EYE.normalize();
        let right = Vec3::Y.cross(back).normalize();
        let up = back.cross(right);

        // The four sides of the view frustum, each moved outward until all points are inside.
        let tan_y = HALF_ANGLE * FILL;
        let tan_x = tan_y * size[0] / size[1];
        let sides = [right + back * tan_x, -right + back * tan_x, up + back * tan_y, -up + back * tan_y];
        let [east, west, north, south] = points
            .fold([f32::NEG_INFINITY; 4], |reach, point| std::array::from_fn(|k| reach[k].max(sides[k].dot(point))));
        let distance = ((east + west) / tan_x).max((north + south) / tan_y) / 2.0;
        let eye = right * ((east - west) / 2.0) + up * ((north - south) / 2.0) + back * distance;
        Camera { eye, right, up, back, size, focal: size[1] / (2.0 * HALF_ANGLE) }
    }

    /// The same camera at another place.
    pub fn moved(self, way: Vec3) -> Camera {
        Camera { eye: self.eye + way, ..self }
    }

    /// Position of a point in the picture, in pixels, and the inverse of its depth (1/metres).
    pub fn project(&self, point: Vec3) -> Vec3 {
        let from_eye = point - self.eye;
        let inverse = -1.0 / self.back.dot(from_eye);
        let slope = [self.right.dot(from_eye) * inverse, -self.up.dot(from_eye) * inverse];
        Vec3::new(self.size[0] / 2.0 + slope[0] * self.focal, self.size[1] / 2.0 + slope[1] * self.focal, inverse)
    }

    /// Direction of the ray through a pixel, not normalised.
    pub fn ray(&self, x: f32, y: f32) -> Vec3 {
        let slope = [(x - self.size[0] / 2.0) / self.focal, (self.size[1] / 2.0 - y) / self.focal];
        self.right * slope[0] + self.up * slope[1] - self.back
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sees_all_points_and_fills_the_picture() {
        let corner = |k: usize| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32 * 3.0, (k >> 2) as f32 * 2.0 + 50.0);
        let camera = Camera::fit((0..8).map(corner), [480, 360]);
        let seen: Vec<Vec3> = (0..8).map(|k| camera.project(corner(k))).collect();
        assert!(seen.iter().all(|p| p.z > 0.0 && (0.0..480.0).contains(&p.x) && (0.0..360.0).contains(&p.y)));
        let range = |along: fn(&Vec3) -> f32| {
            let values = seen.iter().map(along);
            values.clone().fold(0.0, f32::max) - values.fold(f32::MAX, f32::min)
        };
        assert!((range(|p| p.y) - 360.0 * FILL).abs() < 0.5 && range(|p| p.x) <= 480.0 * FILL);
    }

    #[test]
    fn rays_meet_what_is_projected() {
        let camera = Camera::fit([Vec3::ZERO, Vec3::ONE].into_iter(), [480, 360]);
        let point = Vec3::new(0.2, 0.9, 0.4);
        let seen = camera.project(point);
        assert!((camera.eye + camera.ray(seen.x, seen.y) / seen.z).distance(point) < 1e-4);
    }
}
