//! G against finite differences of the contour's length, for two wavy sheets that move rigidly against one
//! another; the sign shows that a step along G shortens the contour.

use harness::both_precisions;

both_precisions! {
    use std::collections::BTreeMap;

    use glam::DVec3;
    use muslin::audit;
    use muslin::contact::ContactModel;
    use muslin::dispatch::Serial;
    use muslin::real::{Vec3, to_f64, vec3};
    use muslin::untangle::contour::{Crossing, gradient};
    use harness::rng::Rng;

    use crate::tangles;

    /// Every crossing, with the triangles that have its edge.
    fn crossings(model: &ContactModel<'_>, places: &[Vec3]) -> Vec<(Crossing, Vec<u32>)> {
        let surface = &model.surface;
        let found = audit::crossings(surface, places, &Serial).into_iter().map(|[edge, triangle]| {
            let ends = surface.edges[edge as usize];
            let on_edge = (0..).zip(surface.triangle_edges).filter(|(_, edges)| edges.contains(&edge));
            let crossing = Crossing::new([edge, triangle], ends, surface.triangles[triangle as usize], places);
            (crossing, on_edge.map(|(side, _)| side).collect())
        });
        found.collect()
    }

    /// Total length of the segments along which two triangles intersect, m: each segment ends at two crossings.
    fn length(model: &ContactModel<'_>, places: &[Vec3]) -> f64 {
        let mut segments: BTreeMap<[u32; 2], Vec<DVec3>> = BTreeMap::new();
        for (crossing, sides) in crossings(model, places) {
            for side in sides {
                let crossed = crossing.features[1];
                let ends = segments.entry([side.min(crossed), side.max(crossed)]).or_default();
                ends.push(to_f64(crossing.place).into());
            }
        }
        segments.values().map(|ends| ends[0].distance(*ends.last().expect("a crossing"))).sum()
    }

    #[test]
    fn g_is_the_gradient_of_the_length() {
        let built = kit::build(&tangles::two(""));
        let contact = built.contact.as_ref().expect("the scene has contact");
        let (model, half) = (&contact.view(), built.particles.positions.len() / 2);
        let mut rng = Rng::new(7);
        let (mut errors, mut sizes) = (0.0, 0.0);
        for _ in 0..20 {
            let (turn, phase) = (rng.rotation(), rng.between(0.0, 6.0));
            let start: Vec<DVec3> = (0..).zip(&built.particles.positions).map(|(v, &x)| {
                let x = DVec3::from(to_f64(x));
                let wave = x + DVec3::Y * 0.01 * (40.0 * x.x + 25.0 * x.z + phase).sin();
                if v < half { wave } else { turn * wave + DVec3::new(0.003, 0.002, 0.001) }
            }).collect();
            let moved = |by: DVec3| -> Vec<Vec3> {
                (0..).zip(&start).map(|(v, &x)| vec3(if v < half { x + by } else { x }.into())).collect()
            };
            let places = moved(DVec3::ZERO);
            let place = |v: u32| places[v as usize];
            let sum: DVec3 = crossings(model, &places).iter().map(|(crossing, sides)| {
                let ends = [crossing.vertices[0], crossing.vertices[1]];
                let third = |&side: &u32| {
                    let corners = model.surface.triangles[side as usize];
                    place(corners.into_iter().find(|v| !ends.contains(v)).expect("a third corner"))
                };
                let opposite: Vec<Vec3> = sides.iter().map(third).collect();
                let g = DVec3::from(to_f64(gradient(ends.map(place), crossing.normal, &opposite)));
                if (ends[0] as usize) < half { g } else { -g }
            }).sum();
            let step = kit::bound(1e-4, 1e-7);
            let along = |by: DVec3| {
                (length(model, &moved(by * step)) - length(model, &moved(by * -step))) / (2.0 * step)
            };
            let measured = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
            errors += measured.distance(-0.5 * sum);
            sizes += measured.length();
        }
        // In single precision the crossings of edges that lie nearly in a triangle's plane are noise.
        let error = errors / sizes;
        println!("{}: G is off by {error:.1e} of its size", muslin::real::NAME);
        assert!(error < kit::bound(0.1, 1e-7), "G is off by {error} of its size");
    }
}
