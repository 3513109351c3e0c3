//! The views of a run: the visible space, its floor if the scene has one, camera and light. All pictures share one view,
//! unless the cloth goes too far for that: then the camera goes with it.

use glam::Vec3;

use super::camera::Camera;
use super::shadow::Light;

/// How far the middle of the cloth may go in a view that does not move, in diagonals of its first bounding box.
const WHOLE: f32 = 2.0;
/// How far the camera goes with the middle of the cloth, likewise. Single precision does not tell the vertices of cloth
/// that is farther away apart.
const FARTHEST: f32 = 1e4;
/// How far vertices are shown around the first bounding box, which moves with the camera, likewise. Vertices that leave
/// this space have diverged, or have left the rest of the cloth.
const SHOWN: f32 = WHOLE + 1.0;
/// Limit on the size of cloth and solids that the camera keeps in the picture. The size of the cloth is relative
/// to its median or first size, whichever is larger, so that cloth that flies apart does not move the camera
/// away. The size of the solids is relative to the extent of the motion.
const FRAMED: f32 = 2.0;

/// The surroundings of the cloth in a picture.
#[derive(Clone, Copy)]
pub struct View {
    /// Picture size, pixels.
    pub size: [usize; 2],
    /// The camera.
    pub camera: Camera,
    /// The light that casts shadows.
    pub light: Light,
    /// A point of the floor under the middle of the motion, metres, and the normal of the floor, of length 1. `None`: the
    /// scene has no floor.
    pub floor: Option<[Vec3; 2]>,
    /// Length of the diagonal of the box around the motion, metres.
    pub extent: f32,
    space: [Vec3; 2],
}

/// The views of all snapshots.
pub struct Views {
    /// The view before the camera moves.
    first: View,
    /// The way of the camera until each snapshot, metres.
    ways: Vec<Vec3>,
}

impl Views {
    /// Views of the cloth in the snapshots, and of the solids in each of them if these are not much larger, in pictures
    /// of `size` pixels. `floor` is a point and the normal of the floor, if the scene has one.
    pub fn around<'a>(
        snapshots: impl Iterator<Item = &'a [Vec3]> + Clone,
        solids: &[Vec<Vec3>],
        floor: Option<[Vec3; 2]>,
        size: [usize; 2],
    ) -> Views {
        let first = snapshots.clone().find_map(|points| bounds(points.iter().copied().filter(|p| p.is_finite())));
        let [low, high] = first.unwrap_or([Vec3::ZERO; 2]);
        let diagonal = low.distance(high);
        let space = [low - SHOWN * diagonal, high + SHOWN * diagonal];
        let ways = ways(snapshots.clone(), diagonal);
        // Seen from the camera.
        let shown =
            |(points, way): (&'a [Vec3], Vec3)| points.iter().map(move |p| p - way).filter(move |&p| within(space, p));
        let snapshots = snapshots.zip(ways.iter().copied());
        let framed = framed(snapshots.filter_map(|snapshot| Some((bounds(shown(snapshot))?, snapshot))).collect());

        let [low, high] = bounds(framed.iter().flat_map(|&snapshot| shown(snapshot))).unwrap_or([Vec3::ZERO; 2]);
        let extent = low.distance(high).max(1e-6);
        let middle = (low + high) / 2.0;
        let solids = solids.iter().zip(&ways).flat_map(|(points, way)| points.iter().map(move |p| p - way));
        let solids = bounds(solids.filter(|&p| within(space, p)));
        let all = solids.into_iter().flat_map(corners);
        let solids = solids.filter(|[low, high]| low.distance(*high) <= FRAMED * extent);
        // Two more points, so that cloth that is a single point needs no special case.
        let around = [middle - Vec3::splat(extent / 4.0), middle + Vec3::splat(extent / 4.0)];
        let corners = solids.into_iter().flat_map(corners);
        let points = || framed.iter().flat_map(|&snapshot| shown(snapshot)).chain(around).chain(corners.clone());
        let first = View {
            size,
            camera: Camera::fit(points(), size),
            light: Light::fit(points().chain(all)),
            floor: floor.map(|[floor, up]| [middle - up * up.dot(middle - floor), up]),
            extent,
            space,
        };
        Views { first, ways }
    }

    /// The view of a snapshot.
    pub fn at(&self, snapshot: usize) -> View {
        self.first.moved(self.ways[snapshot])
    }
}

impl View {
    fn moved(self, way: Vec3) -> View {
        View {
            camera: self.camera.moved(way),
            light: self.light.moved(way),
            floor: self.floor.map(|[floor, up]| [floor + way - up * up.dot(way), up]),
            space: self.space.map(|corner| corner + way),
            ..self
        }
    }

    /// Whether a vertex is in the space in which the camera follows it.
    pub fn shows(&self, point: Vec3) -> bool {
        within(self.space, point)
    }
}

/// The way of the camera until each snapshot: it goes with the middle of the cloth if this leaves the fixed view.
/// `diagonal` is that of the first bounding box.
fn ways<'a>(snapshots: impl Iterator<Item = &'a [Vec3]>, diagonal: f32) -> Vec<Vec3> {
    let places: Vec<_> = snapshots.map(middle).collect();
    let first = places.iter().copied().find(|place| place.is_finite()).unwrap_or_default();
    let mut last = Vec3::ZERO;
    let way = |place: &Vec3| {
        // Diverged cloth leaves the camera where it is.
        last = Some(place - first).filter(|way| way.length() <= FARTHEST * diagonal).unwrap_or(last);
        last
    };
    let ways: Vec<_> = places.iter().map(way).collect();
    let is_near = ways.iter().all(|way| way.length() <= WHOLE * diagonal);
    if is_near { vec![Vec3::ZERO; ways.len()] } else { ways }
}

/// The median of the points along each axis, which a few vertices that fly away do not move; NaN without points.
fn middle(points: &[Vec3]) -> Vec3 {
    let median = |axis: usize| {
        let mut along: Vec<f32> = points.iter().map(|point| point[axis]).collect();
        along.sort_unstable_by(f32::total_cmp);
        along.get(along.len() / 2).copied().unwrap_or(f32::NAN)
    };
    Vec3::new(median(0), median(1), median(2))
}

/// The corners of a box.
fn corners([low, high]: [Vec3; 2]) -> impl Iterator<Item = Vec3> + Clone {
    let side = move |corner: usize, axis: usize| [low, high][corner >> axis & 1][axis];
    (0..8).map(move |k| Vec3::new(side(k, 0), side(k, 1), side(k, 2)))
}

/// Selects the snapshots, given with their bounding boxes, in which the cloth is at most [`FRAMED`] times as
/// large as its median or first size.
fn framed<Snapshot>(snapshots: Vec<([Vec3; 2], Snapshot)>) -> Vec<Snapshot> {
    let size = |[low, high]: [Vec3; 2]| low.distance(high);
    let mut sizes: Vec<f32> = snapshots.iter().map(|(around, _)| size(*around)).collect();
    let first = sizes.first().copied().unwrap_or(0.0);
    sizes.sort_unstable_by(f32::total_cmp);
    let most = sizes.get(sizes.len() / 2).map_or(0.0, |&median| FRAMED * median.max(first));
    snapshots.into_iter().filter(|(around, _)| size(*around) <= most).map(|(_, snapshot)| snapshot).collect()
}

fn within([low, high]: [Vec3; 2], point: Vec3) -> bool {
    point.cmpge(low).all() && point.cmple(high).all()
}

fn bounds(points: impl Iterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    points.map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_motion_but_not_divergence() {
        let start = [Vec3::ZERO, Vec3::ONE];
        let fallen = [Vec3::new(0.0, -2.0, 0.0), Vec3::new(1.0, -1.0, 1.0)];
        let gone = [Vec3::splat(1e30), Vec3::NAN];
        let view = Views::around([&gone[1..], &start, &fallen, &gone].into_iter(), &[], None, [48, 36]).at(3);
        assert!(start.iter().chain(&fallen).all(|&p| view.shows(p)));
        assert!(!gone.iter().any(|&p| view.shows(p)));
        assert!(view.floor.is_none() && view.extent < 4.0);
    }

    #[test]
    fn cloth_that_flies_apart_does_not_push_the_camera_away() {
        let calm = [Vec3::ZERO, Vec3::ONE];
        let apart = [Vec3::splat(-2.0), Vec3::splat(3.0)];
        let extent =
            |snapshots: &[[Vec3; 2]]| Views::around(snapshots.iter().map(|s| &s[..]), &[], None, [48, 36]).at(0).extent;
        assert_eq!(extent(&[calm, calm, apart]), extent(&[calm]));
    }

    #[test]
    fn goes_with_cloth_that_falls_far() {
        let fallen = |metres: f32| [Vec3::ZERO, Vec3::ONE, Vec3::X].map(|p| p - metres * Vec3::Y);
        for deepest in [3.0, 100.0] {
            let snapshots: Vec<_> = (0..5).map(|k| fallen(deepest * k as f32 / 4.0)).collect();
            let floor = Some([Vec3::new(0.0, -deepest, 0.0), Vec3::Y]);
            let views = Views::around(snapshots.iter().map(|s| &s[..]), &[], floor, [48, 36]);
            let rows = (0..5).map(|k| {
                let view = views.at(k);
                let seen = snapshots[k].map(|p| view.camera.project(p));
                assert!(snapshots[k].iter().all(|&p| view.shows(p)), "{deepest} m, snapshot {k}");
                assert!(seen.iter().all(|p| (0.0..48.0).contains(&p.x) && (0.0..36.0).contains(&p.y)), "{seen:?}");
                assert!(view.floor.is_some_and(|[floor, _]| (floor.y + deepest).abs() < 0.1), "{:?}", view.floor);
                seen[1].y
            });
            let rows: Vec<f32> = rows.collect();
            let moved = rows[4] - rows[0];
            assert_eq!(moved > 10.0, deepest == 3.0, "the cloth falls {deepest} m and {moved} pixels");
        }
    }

    #[test]
    fn follows_flat_cloth() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Z];
        let view = Views::around([&flat[..]].into_iter(), &[], None, [48, 36]).at(0);
        assert!(flat.iter().all(|&p| view.shows(p)));
    }

    #[test]
    fn has_a_camera_even_for_nothing() {
        for snapshot in [&[][..], &[Vec3::NAN], &[Vec3::ONE]] {
            assert!(Views::around([snapshot].into_iter(), &[], None, [48, 36]).at(0).camera.eye.is_finite());
        }
    }
}
