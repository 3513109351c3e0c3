//! Four candidates at a time get the bits that each of them gets alone, and lanes those of scalars: for random numbers,
//! zeros of either sign, infinities and NaN.
//!
//! Run: `cargo test -p muslin-tests --test narrow_phase lanes`.

harness::both_precisions! {
    use harness::crumpled;
    use harness::rng::Rng;
    use muslin::broad_phase::comoving::Motion;
    use muslin::dispatch::Serial;
    use muslin::geometry::aabb::Aabb;
    use muslin::lanes::{Vec3x4, clamp_to_unit, greater, lesser, max, min};
    use muslin::mesh::SurfaceColumns;
    use muslin::narrow_phase::continuous::{LinearMotion, times};
    use muslin::narrow_phase::time_of_impact::TimeOfImpact;
    use muslin::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity, slab};
    use muslin::real::{Lanes, Real, Vec3, vec3};

    const SPECIAL: [Real; 9] =
        [0.0, -0.0, 1.0, -1.0, 0.5, Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MIN_POSITIVE];

    /// NaN compares equal to any NaN: its sign and payload depend on the machine.
    fn is_same(a: Real, b: Real) -> bool {
        a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
    }

    #[test]
    fn choices_are_those_of_scalars() {
        for &a in &SPECIAL {
            for &b in &SPECIAL {
                let of = |f: fn(Lanes, Lanes) -> Lanes| f(Lanes::splat(a), Lanes::splat(b)).to_array()[3];
                let (u, v) = (Vec3::splat(a), Vec3::splat(b));
                assert!(is_same(of(lesser), u.min(v).x), "lesser of {a:?} and {b:?}");
                assert!(is_same(of(greater), u.max(v).x), "greater of {a:?} and {b:?}");
                // The sign of the lesser of two zeros is open.
                assert!(of(min) == a.min(b) || a.is_nan() && b.is_nan(), "minimum of {a:?} and {b:?}");
                assert!(of(max) == a.max(b) || a.is_nan() && b.is_nan(), "maximum of {a:?} and {b:?}");
            }
            assert!(is_same(clamp_to_unit(Lanes::splat(a)).to_array()[1], a.clamp(0.0, 1.0)), "{a:?} in [0, 1]");
        }
    }

    #[test]
    fn vectors_are_those_of_glam() {
        let rng = &mut Rng::new(731);
        for case in 0..1000 {
            let mut four = || [0; 4].map(|_| {
                let mut v = vec3(rng.cube(2.0).to_array());
                if case % 3 == 0 {
                    v[rng.pick(&[0, 1, 2])] = rng.pick(&SPECIAL);
                }
                v
            });
            let (a, b) = (four(), four());
            let (a4, b4) = (Vec3x4::new(a), Vec3x4::new(b));
            for lane in 0..4 {
                let (a, b) = (a[lane], b[lane]);
                let same = |lanes: Lanes, scalar: Real| is_same(lanes.to_array()[lane], scalar);
                assert!(same(a4.dot(b4), a.dot(b)) && same((a4 - b4).length_squared(), (a - b).length_squared()), "{a} {b}");
                assert!(same((a4 + b4).abs().max_element(), (a + b).abs().max_element()), "{a} {b}");
                assert!(same(a4.min(b4).element_sum(), a.min(b).element_sum()), "{a} {b}");
                assert!(same((a4.max(b4) * Lanes::splat(0.3)).element_sum(), (a.max(b) * 0.3).element_sum()), "{a} {b}");
            }
        }
    }

    /// A crumpled sheet in motion, with a triangle and an edge without extent and a vertex that is not finite.
    fn alone_as_together<P: Pairing>(candidates: &[[u32; 2]]) {
        let (mesh, rng) = (crumpled::sheet(6), &mut Rng::new(732));
        let mut start: Vec<_> = mesh.positions.iter().map(|x| vec3(x.to_array())).collect();
        let [a, b, c] = mesh.triangles[0].map(|v| v as usize);
        (start[b], start[c]) = (start[a], start[a]);
        start[mesh.triangles[9][2] as usize].y = Real::NAN;
        let displacements: Vec<_> = start.iter().map(|_| vec3(rng.cube(0.2).to_array())).collect();
        let end: Vec<_> = start.iter().zip(&displacements).map(|(x, d)| *x + *d).collect();
        let ends: Vec<_> = end.iter().map(|&x| Aabb { min: x - 0.01, max: x + 0.02 }).collect();
        let radii: Vec<_> = (0..start.len()).map(|v| 0.001 * (v % 3) as Real).collect();
        let rounds: Vec<_> = (0..start.len()).map(|v| u32::from(v % 11 == 0)).collect();
        let surface = SurfaceColumns::build(start.len(), &mesh.triangles, &[]);
        let surface = &surface.view();
        let all = |candidates: &[[u32; 2]]| {
            let count = candidates.len();
            let (mut bounds, mut distances) = (vec![0.0; count], vec![0.0; count]);
            let motion = Motion { start: &start, radii: &radii, margin: 0.01, ends: &ends, rounding: 0.0 };
            slab::bounds::<P>(candidates, surface, &motion, &mut bounds, &Serial);
            proximity::distances::<P>(candidates, surface, &start, &radii, 0.5, &mut distances, &Serial);
            let found = [0, 1].map(|round| {
                let mut found = vec![TimeOfImpact::Never.into(); count];
                let motion = LinearMotion {
                    start: &start, end: &end, radii: &radii, rounds: &rounds, round,
                };
                times::<P>(candidates, &distances, surface, motion, 0.01, &mut found, &Serial);
                found.into_iter().map(TimeOfImpact::from).collect::<Vec<_>>()
            });
            (bounds, distances, found)
        };
        let (bounds, distances, [found, found_again]) = all(candidates);
        for (k, &candidate) in candidates.iter().enumerate() {
            let (bound, distance, [time, time_again]) = all(&[candidate]);
            assert!(is_same(bounds[k], bound[0]), "bound of {candidate:?}: {} and {}", bounds[k], bound[0]);
            assert!(is_same(distances[k], distance[0]), "distance of {candidate:?}: {} and {}", distances[k], distance[0]);
            assert_eq!((found[k], found_again[k]), (time[0], time_again[0]), "time of {candidate:?}");
        }
    }

    #[test]
    fn candidates_are_the_same_alone() {
        let all_pairs = |first: u32, second: u32| (0..first).flat_map(move |a| (0..second).map(move |b| [a, b]));
        alone_as_together::<VertexTriangle>(&all_pairs(30, 40).collect::<Vec<_>>());
        alone_as_together::<EdgeEdge>(&all_pairs(50, 45).filter(|[a, b]| a != b).collect::<Vec<_>>());
    }
}
