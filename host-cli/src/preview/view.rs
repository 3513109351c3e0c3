//! The view that all pictures of a run share: the visible space, its floor, camera and light.

use glam::Vec3;

use super::camera::Camera;
use super::shadow::Light;

/// How far the camera follows the cloth from its first position, in diagonals of its first bounding box. Vertices
/// that leave this space have diverged, or are too far away to be seen.
const FOLLOWED: f32 = 2.0;
/// Limit on the size of cloth and solids that the camera keeps in the picture. The size of the cloth is relative
/// to its median or first size, whichever is larger, so that cloth that flies apart does not move the camera
/// away. The size of the solids is relative to the extent of the motion.
const FRAMED: f32 = 2.0;

/// The fixed surroundings of the cloth.
pub struct View {
    /// Picture size, pixels.
    pub size: [usize; 2],
    /// The camera.
    pub camera: Camera,
    /// The light that casts shadows.
    pub light: Light,
    /// A point of the floor under the middle of the motion, metres.
    pub floor: Vec3,
    /// Normal of the floor, of length 1.
    pub up: Vec3,
    /// Length of the diagonal of the box around the motion, metres.
    pub extent: f32,
    space: [Vec3; 2],
}

impl View {
    /// A view of the cloth in all snapshots, and of the solids if these are not much larger, in pictures of `size`
    /// pixels. `floor` is a point and the normal of the floor, if the scene has one.
    pub fn around<'a>(
        snapshots: impl Iterator<Item = &'a [Vec3]> + Clone,
        solids: &[Vec3],
        floor: Option<[Vec3; 2]>,
        size: [usize; 2],
    ) -> View {
        let first = snapshots.clone().find_map(|points| bounds(points.iter().filter(|p| p.is_finite())));
        let [low, high] = first.unwrap_or([Vec3::ZERO; 2]);
        let followed = Vec3::splat(FOLLOWED * low.distance(high));
        let space = [low - followed, high + followed];
        let shown = |points: &'a [Vec3]| points.iter().filter(move |&&point| within(space, point));
        let framed = framed(snapshots.filter_map(|points| Some((bounds(shown(points))?, points))).collect());

        let [low, high] = bounds(framed.iter().flat_map(|points| shown(points))).unwrap_or([Vec3::ZERO; 2]);
        let extent = low.distance(high).max(1e-6);
        let middle = (low + high) / 2.0;
        let solids = bounds(solids.iter().filter(|p| within(space, **p)));
        let all = solids.into_iter().flat_map(corners);
        let solids = solids.filter(|[low, high]| low.distance(*high) <= FRAMED * extent);
        let lowest = solids.map_or(low.y, |[solid, _]| solid.y.min(low.y));
        let [floor, up] = floor.unwrap_or([middle.with_y(lowest - 0.01 * extent), Vec3::Y]);
        // Two more points, so that cloth that is a single point needs no special case.
        let around = [middle - Vec3::splat(extent / 4.0), middle + Vec3::splat(extent / 4.0)];
        let corners = solids.into_iter().flat_map(corners);
        let points = || framed.iter().flat_map(|points| shown(points)).copied().chain(around).chain(corners.clone());
        View {
            size,
            camera: Camera::fit(points(), size),
            light: Light::fit(points().chain(all)),
            floor: middle - up * up.dot(middle - floor),
            up,
            extent,
            space,
        }
    }

    /// Whether a vertex is in the space in which the camera follows it.
    pub fn shows(&self, point: Vec3) -> bool {
        within(self.space, point)
    }
}

/// The corners of a box.
fn corners([low, high]: [Vec3; 2]) -> impl Iterator<Item = Vec3> + Clone {
    let side = move |corner: usize, axis: usize| [low, high][corner >> axis & 1][axis];
    (0..8).map(move |k| Vec3::new(side(k, 0), side(k, 1), side(k, 2)))
}

/// Selects the snapshots, given with their bounding boxes, in which the cloth is at most [`FRAMED`] times as
/// large as its median or first size.
fn framed(snapshots: Vec<([Vec3; 2], &[Vec3])>) -> Vec<&[Vec3]> {
    let size = |[low, high]: [Vec3; 2]| low.distance(high);
    let mut sizes: Vec<f32> = snapshots.iter().map(|&(around, _)| size(around)).collect();
    let first = sizes.first().copied().unwrap_or(0.0);
    sizes.sort_unstable_by(f32::total_cmp);
    let most = sizes.get(sizes.len() / 2).map_or(0.0, |&median| FRAMED * median.max(first));
    snapshots.into_iter().filter(|&(around, _)| size(around) <= most).map(|(_, points)| points).collect()
}

fn within([low, high]: [Vec3; 2], point: Vec3) -> bool {
    point.cmpge(low).all() && point.cmple(high).all()
}

fn bounds<'a>(points: impl Iterator<Item = &'a Vec3>) -> Option<[Vec3; 2]> {
    points.map(|&p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_motion_but_not_divergence() {
        let start = [Vec3::ZERO, Vec3::ONE];
        let fallen = [Vec3::new(0.0, -2.0, 0.0), Vec3::new(1.0, -1.0, 1.0)];
        let gone = [Vec3::splat(1e30), Vec3::NAN];
        let view = View::around([&gone[1..], &start, &fallen, &gone].into_iter(), &[], None, [48, 36]);
        assert!(start.iter().chain(&fallen).all(|&p| view.shows(p)));
        assert!(!gone.iter().any(|&p| view.shows(p)));
        assert!((view.floor.y + 2.03).abs() < 0.02 && view.extent < 4.0);
    }

    #[test]
    fn cloth_that_flies_apart_does_not_push_the_camera_away() {
        let calm = [Vec3::ZERO, Vec3::ONE];
        let apart = [Vec3::splat(-2.0), Vec3::splat(3.0)];
        let extent =
            |snapshots: &[[Vec3; 2]]| View::around(snapshots.iter().map(|s| &s[..]), &[], None, [48, 36]).extent;
        assert_eq!(extent(&[calm, calm, apart]), extent(&[calm]));
    }

    #[test]
    fn follows_flat_cloth() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Z];
        let view = View::around([&flat[..]].into_iter(), &[], None, [48, 36]);
        assert!(flat.iter().all(|&p| view.shows(p)));
    }

    #[test]
    fn has_a_camera_even_for_nothing() {
        for snapshot in [&[][..], &[Vec3::NAN], &[Vec3::ONE]] {
            assert!(View::around([snapshot].into_iter(), &[], None, [48, 36]).camera.eye.is_finite());
        }
    }
}
