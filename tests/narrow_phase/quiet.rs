//! Steps in which little moves: their candidates are the pairs within reach, found in pairs that are kept from step to
//! step. The set is that of a fresh detection, whatever was kept.

harness::both_precisions! {
    use glam::DVec3;
    use harness::query::Pair;
    use harness::rng::Rng;
    use harness::steps::Steps;
    use muslin::contact::{ContactModel, ContactScratch, ContactScratchColumns};
    use muslin::dispatch::Serial;
    use muslin::narrow_phase::{EdgeEdge, Pairing, VertexTriangle};
    use muslin::real::{Real, Vec3, vec3};
    use muslin::response::impact::SEPARATION;
    use muslin::response::repulsion::REACH;
    use muslin::step;

    /// The sheet that comes to rest, coarser and in contact at once.
    fn rest() -> String {
        include_str!("../scenes/rest.toml").replace("[63, 63]", "[23, 23]").replace("0.303", "0.302")
    }

    /// The candidates within reach at the start of the step, sorted.
    fn near(model: &ContactModel<'_>, contact: &ContactScratch<'_>) -> [Vec<[u32; 2]>; 2] {
        let [vertex_triangle, edge_edge] = [
            (&contact.vertex_triangle, contact.counts.vertex_triangle),
            (&contact.edge_edge, contact.counts.edge_edge),
        ]
        .map(|(pairs, count)| {
            let all = pairs.candidates[..count].iter().zip(&pairs.distances[..count]);
            let mut near: Vec<_> =
                all.filter(|(_, distance)| **distance <= REACH * model.thickness).map(|(pair, _)| *pair).collect();
            near.sort_unstable();
            near
        });
        [vertex_triangle, edge_edge]
    }

    #[test]
    fn the_candidates_of_quiet_steps_are_the_pairs_within_reach() {
        let mut sim = kit::simulation(&rest(), &[]);
        let columns = sim.contact().expect("the scene has contact").clone();
        let model = columns.view();
        let [mut ours, mut fresh] = [(); 2].map(|()| ContactScratchColumns::build(&model, 100_000));
        let (mut quiet, mut kept) = (0, 0);
        for step in 1..=300 {
            let start = sim.positions().to_vec();
            sim.take_step().expect("a step");
            let mut ours = ours.view();
            step::place(&model, [0.0, 0.0], &start, sim.positions(), &mut ours);
            if !step::is_quiet(&model, &ours) {
                continue;
            }
            step::surround_start(&model, &mut ours);
            (quiet, kept) = (quiet + 1, kept + u32::from(ours.kept.cover(ours.boxes)));
            step::detect(&model, &mut ours, &Serial);
            let mut fresh = fresh.view();
            step::place(&model, [0.0, 0.0], &start, sim.positions(), &mut fresh);
            step::sweep(&model, model.thickness, &mut fresh);
            step::detect(&model, &mut fresh, &Serial);
            assert_eq!(near(&model, &ours), near(&model, &fresh), "step {step}: pairs within reach, and fresh ones");
            let count = ours.counts.vertex_triangle + ours.counts.edge_edge;
            let within: usize = near(&model, &ours).iter().map(Vec::len).sum();
            assert_eq!(count, within, "step {step}: candidates beyond reach");
        }
        println!("{quiet} quiet steps, {kept} of them with kept pairs");
        assert!(kept > 50 && quiet > kept, "pairs are kept, and found anew: {kept} of {quiet} quiet steps");
    }

    #[test]
    fn bits_do_not_depend_on_what_was_kept() {
        let mut sim = kit::simulation(&rest(), &[]);
        let mut resumed = kit::simulation(&rest(), &[]);
        for step in 1..=300 {
            sim.take_step().expect("a step");
            if step % 5 == 0 {
                let (statistics, tally) = (resumed.statistics(), resumed.tally());
                let mut again = kit::simulation(&rest(), &[]);
                assert!(again.restore(&resumed.state(), statistics, tally), "the state is of the same scene");
                resumed = again;
            }
            resumed.take_step().expect("a step");
            assert_eq!(sim.positions(), resumed.positions(), "step {step}: positions of a run that was resumed");
        }
        assert_eq!(sim.tally(), resumed.tally(), "counts of a run that was resumed");
    }

    /// Moves two features straight towards one another by the largest motion that the boxes of a quiet step allow.
    fn collide<P: Pairing>(x: &[Vec3; 4], thickness: Real) -> Option<Real> {
        let towards = P::nearest(x).between;
        let most = 0.51 * thickness;
        let sign = |k: usize| if k < P::FIRST { -1.0 } else { 1.0 };
        let end = core::array::from_fn(|k| x[k] + towards.signum() * (sign(k) * most));
        P::time_of_impact(x, &end, SEPARATION * thickness, 0.5 * SEPARATION * thickness)
    }

    #[test]
    fn pairs_beyond_reach_do_not_collide_in_a_quiet_step() {
        let mut rng = Rng::new(5);
        let (mut beyond, mut nearest) = (0, Real::INFINITY);
        for _ in 0..20_000 {
            for pair in [Pair::VertexTriangle, Pair::EdgeEdge] {
                let size = rng.magnitude(0.1, 100.0);
                let x: [DVec3; 4] = std::array::from_fn(|_| size * rng.direction());
                // In units of the thickness.
                let x = x.map(|x| vec3((x).into()));
                let apart = match pair {
                    Pair::VertexTriangle => VertexTriangle::nearest(&x).between,
                    Pair::EdgeEdge => EdgeEdge::nearest(&x).between,
                };
                let distance = apart.length_squared().sqrt();
                if distance <= REACH {
                    continue;
                }
                (beyond, nearest) = (beyond + 1, distance.min(nearest));
                let time = match pair {
                    Pair::VertexTriangle => collide::<VertexTriangle>(&x, 1.0),
                    Pair::EdgeEdge => collide::<EdgeEdge>(&x, 1.0),
                };
                assert_eq!(time, None, "{x:?}, {distance} thicknesses apart");
            }
        }
        println!("{beyond} pairs beyond reach, from {nearest} thicknesses on");
        assert!(beyond > 1_000 && nearest < 2.01, "{beyond} pairs, from {nearest} thicknesses on");
    }
}
