//! Steps in which little moves: their candidates are the pairs within reach, found in pairs that are kept from step to
//! step. The set is that of a fresh detection, whatever was kept.

harness::both_precisions! {
    use glam::DVec3;
    use harness::query::Pair;
    use harness::rng::Rng;
    use muslin::contact::{ContactRoom, ContactModel, ContactScratch, ContactScratchColumns};
    use muslin::dispatch::Serial;
    use muslin::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity};
    use muslin::real::{Real, Vec3, vec3};
    use muslin::response::impact::SEPARATION;
    use muslin::response::repulsion::REACH;
    use muslin::detection;

    /// The sheet that comes to rest, coarser and in contact at once.
    fn rest() -> String {
        include_str!("../scenes/rest.toml").replace("[63, 63]", "[23, 23]").replace("0.303", "0.302")
    }

    /// Two fine sheets that come to rest on each other, on a plane and on a sphere that rises slowly.
    fn sheets() -> String {
        let material = "density = 0.2\nstretch = { model = \"membrane\", stiffness = 500.0, damping = 0.001 }\n\
                        shear = { stiffness = 100.0 }\nbend = { model = \"hinge\", rigidity = 1e-5, damping = 0.001 }\n";
        let sheet = |place: &str| format!("[[cloth]]\ngrid = {{ size = [0.04, 0.04], cells = [10, 10] }}\n{place}\n{material}");
        let lower = sheet("position = [0, 0.0025, 0]");
        let upper = sheet("position = [0.003, 0.0055, 0.002]\nrotation = [0, 20, 0]");
        format!(
            "duration = 2.0\nframe_rate = 50\ngravity = [0.0, -9.81, 0.0]\n{lower}{upper}
            [[collider]]\nshape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]
            [[collider]]\nshape = \"sphere\"\nradius = 0.02\ncenter = [0, -0.021, 0]
            motion = {{ keys = [[0.0, 0, 0, 0], [2.0, 0, 0.008, 0]] }}
            [drag]\nlinear = 1.0
            [contact]\nthickness = 0.002\nfriction = 0.3
            [integrator]\nmethod = \"backward-euler\"\nstep = 0.005\n"
        )
    }

    /// Detects as the simulation does, with columns that grow.
    fn detect(model: &ContactModel<'_>, columns: &mut ContactScratchColumns) {
        loop {
            let counts = detection::detect(model, &mut columns.view(), &Serial).expect("nothing stops the search");
            columns.grow_kept();
            if !columns.grow_pairs(counts) {
                return;
            }
        }
    }

    /// The candidates that are within reach at the start of the step, sorted. All distances are measured here.
    fn near(model: &ContactModel<'_>, contact: &ContactScratch<'_>) -> [Vec<[u32; 2]>; 2] {
        fn near<P: Pairing>(model: &ContactModel<'_>, x: &[Vec3], candidates: &[[u32; 2]]) -> Vec<[u32; 2]> {
            let mut distances = vec![0.0; candidates.len()];
            let (surface, radii) = (&model.surface, model.radii);
            proximity::distances::<P>(candidates, surface, x, radii, Real::INFINITY, &mut distances, &Serial);
            let all = candidates.iter().zip(distances);
            let mut near: Vec<_> =
                all.filter(|&(_, distance)| distance <= REACH * model.thickness).map(|(pair, _)| *pair).collect();
            near.sort_unstable();
            near
        }
        let ContactScratch { start, vertex_triangle, edge_edge, counts, .. } = contact;
        [
            near::<VertexTriangle>(model, start, &vertex_triangle.candidates[..counts.vertex_triangle]),
            near::<EdgeEdge>(model, start, &edge_edge.candidates[..counts.edge_edge]),
        ]
    }

    /// Compares the candidates of every quiet step with those of a search without kept pairs.
    fn compare(text: &str, steps: u32) -> [Vec<[u32; 2]>; 2] {
        let mut sim = kit::simulation(text, &[]);
        let columns = sim.contact().expect("the scene has contact").clone();
        let model = columns.view();
        let [mut ours, mut fresh] = [(); 2].map(|()| ContactScratchColumns::build(&model, 8));
        let (mut quiet, mut kept, mut last) = (0, 0, Default::default());
        for step in 1..=steps {
            let (start, time) = (sim.positions().to_vec(), sim.time());
            sim.take_step().expect("a step");
            let times = [time, sim.time() - time];
            let mut view = ours.view();
            detection::place(&model, times, &start, sim.positions(), &mut view);
            if !detection::is_quiet(&model, &view) {
                continue;
            }
            detection::surround_start(&model, &mut view);
            (quiet, kept) = (quiet + 1, kept + u32::from(view.kept.cover(view.boxes)));
            detect(&model, &mut ours);
            detection::place(&model, times, &start, sim.positions(), &mut fresh.view());
            detection::sweep(&model, model.thickness, &mut fresh.view());
            detect(&model, &mut fresh);
            let (ours, fresh) = (ours.view(), fresh.view());
            last = near(&model, &ours);
            assert_eq!(last, near(&model, &fresh), "step {step}: pairs within reach, and fresh ones");
            let count = ours.counts.vertex_triangle + ours.counts.edge_edge;
            assert_eq!(count, last.iter().map(Vec::len).sum::<usize>(), "step {step}: candidates beyond reach");
        }
        println!("{quiet} quiet steps, {kept} of them with kept pairs; {:?} candidates", last.each_ref().map(Vec::len));
        assert!(kept > 50 && quiet > kept, "pairs are kept, and found anew: {kept} of {quiet} quiet steps");
        last
    }

    #[test]
    fn the_candidates_of_quiet_steps_are_the_pairs_within_reach() {
        compare(&rest(), 300);
        let last = compare(&sheets(), 150);
        assert!(last.iter().all(|pairs| !pairs.is_empty()), "both kinds of pairs are near");
    }

    #[test]
    fn bits_do_not_depend_on_what_was_kept() {
        for text in [rest(), sheets()] {
            let [mut sim, mut resumed] = [(); 2].map(|()| kit::simulation(&text, &[]));
            for step in 1..=150 {
                sim.take_step().expect("a step");
                if step % 5 == 0 {
                    let (statistics, contact_statistics) = (resumed.statistics(), resumed.contact_statistics());
                    let mut again = kit::simulation(&text, &[]);
                    assert!(again.restore(&resumed.state(), statistics, contact_statistics), "the state is of the same scene");
                    resumed = again;
                }
                resumed.take_step().expect("a step");
                assert_eq!(sim.positions(), resumed.positions(), "step {step}: positions of a run that was resumed");
            }
            assert_eq!(sim.contact_statistics(), resumed.contact_statistics(), "counts of a run that was resumed");
        }
    }

    #[test]
    fn rounding_far_from_the_origin_makes_no_step_quiet() {
        let sim = kit::simulation(&rest(), &[]);
        let columns = sim.contact().expect("the scene has contact");
        let (model, mut contact) = (columns.view(), ContactScratchColumns::build(&columns.view(), 8));
        for (far, quiet) in [(0.0, true), (1.0, true), (kit::bound(100.0, 1e12) as Real, false)] {
            let positions: Vec<_> = sim.positions().iter().map(|&x| x + far).collect();
            detection::place(&model, [0.0, 0.0], &positions, &positions, &mut contact.view());
            assert_eq!(detection::is_quiet(&model, &contact.view()), quiet, "{far} m from the origin");
        }
    }

    /// Moves two features straight towards one another by the largest motion that the boxes of a quiet step allow.
    fn collide<P: Pairing>(x: &[Vec3; 4], thickness: Real) -> Option<Real> {
        let towards = P::nearest(x).between;
        // Half of the reach, a hundredth wider, without half of the thickness.
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
                let x = x.map(|x| vec3(x.into()));
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
