//! A triangle rasteriser: finds the pixel centres that a triangle covers, with barycentric weights.

use glam::Vec3;

/// Calls `cover` for each pixel whose centre the triangle covers, with the index of the pixel, in rows from the
/// top, and the weights of the corners in the plane of the picture. The corners' x and y are in pixels. Both
/// orientations are drawn. A triangle without area, or with a corner that is not finite, covers no pixel.
pub fn triangle([width, height]: [usize; 2], corners: [Vec3; 3], mut cover: impl FnMut(usize, [f32; 3])) {
    let [a, b, c] = corners;
    let area = cross(a, b, c.x, c.y);
    if !area.is_finite() || area == 0.0 {
        return;
    }
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    for row in span(low.y, high.y, height) {
        let y = row as f32 + 0.5;
        for column in span(low.x, high.x, width) {
            let x = column as f32 + 0.5;
            let weights = [cross(b, c, x, y) / area, cross(c, a, x, y) / area, cross(a, b, x, y) / area];
            if weights.iter().all(|&w| w >= 0.0) {
                cover(row * width + column, weights);
            }
        }
    }
}

/// Twice the signed area of the triangle of an edge and the point `[x, y]`.
fn cross(from: Vec3, to: Vec3, x: f32, y: f32) -> f32 {
    (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x)
}

/// The pixels whose centres lie between two coordinates.
fn span(low: f32, high: f32, count: usize) -> std::ops::Range<usize> {
    let pixel = |x: f32| (x.max(0.0) as usize).min(count);
    pixel((low - 0.5).ceil())..pixel((high + 0.5).floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(corners: [[f32; 2]; 3]) -> Vec<usize> {
        let mut pixels = Vec::new();
        triangle([4, 4], corners.map(|[x, y]| Vec3::new(x, y, 1.0)), |pixel, _| pixels.push(pixel));
        pixels
    }

    #[test]
    fn covers_pixel_centres_from_either_side() {
        assert_eq!(covered([[0.0, 0.0], [2.4, 0.0], [0.0, 2.4]]), [0, 1, 4]);
        assert_eq!(covered([[0.0, 0.0], [0.0, 2.4], [2.4, 0.0]]), [0, 1, 4]);
        assert_eq!(covered([[-9.0, -9.0], [90.0, -9.0], [-9.0, 90.0]]).len(), 16);
        assert!(covered([[-9.0, -9.0], [-1.0, -9.0], [-1.0, -1.0]]).is_empty());
    }

    #[test]
    fn weights_give_back_the_point() {
        let corners = [Vec3::new(0.3, 0.1, 0.0), Vec3::new(3.9, 0.7, 0.0), Vec3::new(1.2, 3.8, 0.0)];
        triangle([4, 4], corners, |pixel, [u, v, w]| {
            let point = u * corners[0] + v * corners[1] + w * corners[2];
            let centre = Vec3::new((pixel % 4) as f32 + 0.5, (pixel / 4) as f32 + 0.5, 0.0);
            assert!(point.distance(centre) < 1e-5);
        });
    }

    #[test]
    fn nothing_of_bad_triangles() {
        assert!(covered([[f32::NAN, 0.0], [2.0, 0.0], [0.0, 2.0]]).is_empty());
        assert!(covered([[f32::INFINITY, 0.0], [2.0, 0.0], [0.0, 2.0]]).is_empty());
        assert!(covered([[0.0, 0.0], [2.0, 2.0], [4.0, 4.0]]).is_empty());
    }
}
