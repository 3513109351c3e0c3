//! Edges that hit or miss a triangle by a rounding error: endpoints constructed in its plane, on its sides and
//! at its corners, then rounded; and numbers of every magnitude.

harness::both_precisions! {
    use glam::DVec3;
    use muslin::geometry::intersect::{edge_meets_triangle, triangles_meet};
    use muslin::real::{Vec3, to_f64, vec3};
    use harness::rng::Rng;

    use crate::oracle::{integers, meet};

    /// Compares `count` random cases with integer arithmetic; each of the two answers must occur at least
    /// `least` times.
    #[track_caller]
    fn agrees(count: usize, least: usize, mut random: impl FnMut() -> [Vec3; 5]) {
        let mut met = 0;
        for _ in 0..count {
            let points = random();
            let [p, q, a, b, c] = points;
            let exact = integers(&points.map(to_f64));
            let answer = meet(&exact[..2], &exact[2..]);
            assert_eq!(edge_meets_triangle([p, q], [a, b, c]), answer, "{points:?}");
            assert_eq!(edge_meets_triangle([q, p], [c, b, a]), answer, "turned round: {points:?}");
            met += usize::from(answer);
        }
        println!("{met} of {count} meet");
        assert!(met >= least && count - met >= least);
    }

    fn rounded(point: DVec3) -> Vec3 {
        vec3(point.to_array())
    }

    /// A triangle far enough from the origin that its plane is not exact after rounding.
    fn triangle(rng: &mut Rng) -> [Vec3; 3] {
        let (centre, size) = (rng.cube(2.0), rng.magnitude(0.01, 1.0));
        [(); 3].map(|()| rounded(centre + rng.cube(size)))
    }

    /// A point in the plane of a triangle, before rounding; often on the line of a side, or a corner.
    fn of_plane(rng: &mut Rng, triangle: [Vec3; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|point| DVec3::from(to_f64(point)));
        let outside = rng.between(-0.5, 1.5);
        let u = rng.pick(&[0.0, 1.0, 0.5, outside]);
        let outside = rng.between(-0.5, 1.5);
        let v = rng.pick(&[0.0, 1.0 - u, outside]);
        a + (b - a) * u + (c - a) * v
    }

    #[test]
    fn in_one_plane_but_for_rounding() {
        let rng = &mut Rng::new(311);
        agrees(6000, 500, || {
            let corners @ [a, b, c] = triangle(rng);
            let [p, q] = [(); 2].map(|()| rounded(of_plane(rng, corners)));
            [p, q, a, b, c]
        });
    }

    #[test]
    fn through_a_side_but_for_rounding() {
        let rng = &mut Rng::new(312);
        agrees(6000, 1000, || {
            let corners @ [a, b, c] = triangle(rng);
            let (on, away) = (of_plane(rng, corners), rng.cube(0.5));
            let far = rng.between(0.0, 2.0);
            let [p, q] = [on + away, on - away * rng.pick(&[0.0, 1.0, far])].map(rounded);
            [p, q, a, b, c]
        });
    }

    /// All points lie exactly in an axis-aligned plane, and on the lines of the sides up to rounding.
    #[test]
    fn on_a_line_but_for_rounding() {
        let rng = &mut Rng::new(315);
        agrees(6000, 500, || {
            let flat = |point: Vec3, level: f64| vec3([to_f64(point)[0], to_f64(point)[1], level]);
            let (level, turns) = (rng.between(-1.0, 1.0), rng.pick(&[0, 1, 2]));
            let corners = triangle(rng).map(|point| flat(point, level));
            let ends = [(); 2].map(|()| flat(rounded(of_plane(rng, corners)), level));
            [ends[0], ends[1], corners[0], corners[1], corners[2]].map(|point| {
                let mut point = to_f64(point);
                point.rotate_left(turns);
                vec3(point)
            })
        });
    }

    /// All exponents for which the predicates are exact; in f32 these are all exponents.
    #[test]
    fn of_every_magnitude() {
        let rng = &mut Rng::new(313);
        let (low, high) = if size_of::<Vec3>() == 12 { (1e-45, 3e38) } else { (1e-70, 1e70) };
        agrees(1500, 50, || {
            let spread = rng.magnitude(1.0, high / low);
            let low = rng.magnitude(low, high / spread);
            let few = [(); 4].map(|()| rng.magnitude(low, low * spread) * rng.pick(&[-1.0, 1.0]));
            [(); 5].map(|()| vec3([(); 3].map(|()| rng.pick(&few))))
        });
    }

    #[test]
    fn triangles_that_nearly_share_a_side() {
        let (rng, mut met) = (&mut Rng::new(314), 0);
        for _ in 0..400 {
            let one = triangle(rng);
            let other = [rng.direction(), of_plane(rng, one), of_plane(rng, one)].map(rounded);
            let exact = integers(&[one[0], one[1], one[2], other[0], other[1], other[2]].map(to_f64));
            let answer = meet(&exact[..3], &exact[3..]);
            assert_eq!(triangles_meet(one, other), answer, "{one:?} {other:?}");
            met += usize::from(answer);
        }
        assert!((40..360).contains(&met), "{met}");
    }
}
