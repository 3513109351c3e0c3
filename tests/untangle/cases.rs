//! Whether tangled states come free, what untangling leaves alone, and that the scene runs afterwards.

use harness::both_precisions;

both_precisions! {
    use crate::tangles::{self, TANGLES, Tangle};
    use glam::DVec3;
    use muslin::contact::ContactScratchColumns;
    use muslin::dispatch::Serial;
    use muslin::real::{NAME, Real, Vec3, to_f64, vec3};
    use muslin::simulation::Simulation;
    use muslin::detection;
    use muslin::untangle::Untangled;
    use harness::rng::Rng;

    fn start(text: &str, change: impl FnOnce(&mut [DVec3])) -> Simulation {
        let mut sim = kit::simulation(text, &[]);
        let mut places: Vec<DVec3> = sim.positions().iter().map(|&x| to_f64(x).into()).collect();
        change(&mut places);
        for (x, place) in sim.state_mut().0.iter_mut().zip(places) {
            *x = vec3(place.into());
        }
        sim
    }

    fn tangle(name: &str) -> Simulation {
        let tangle = TANGLES.iter().find(|tangle| tangle.name == name).expect("the tangle is in the table");
        start(&(tangle.text)(), tangle.start)
    }

    fn untangle(name: &str, sim: &mut Simulation) -> Untangled {
        let (before, velocities) = (sim.crossings(&Serial), sim.velocities().to_vec());
        let untangled = sim.untangle(&Serial);
        println!("{NAME} {name}: {untangled:?}, stretch {:.2}", sim.stretch().max);
        assert_eq!([untangled.before, untangled.after], [before, sim.crossings(&Serial)], "{name}");
        assert!(untangled.after <= untangled.before, "{name}");
        assert_eq!(velocities, sim.velocities(), "{name}");
        untangled
    }

    /// Smallest distance between two features that share no vertex, minus the radii, m.
    fn least_distance(sim: &Simulation) -> Real {
        let model = sim.contact().expect("the scene has contact").view();
        let mut columns = ContactScratchColumns::build(&model, 100_000);
        detection::place(&model, [0.0, 0.0], sim.positions(), sim.positions(), &mut columns.view());
        detection::sweep(&model, 0.0, &mut columns.view());
        let counts = detection::detect(&model, &mut columns.view(), &Serial).expect("nothing stops the search");
        let view = columns.view();
        let distances = |of: &[Real]| of.iter().copied().fold(Real::INFINITY, Real::min);
        distances(&view.vertex_triangle.distances[..counts.vertex_triangle])
            .min(distances(&view.edge_edge.distances[..counts.edge_edge]))
    }

    #[test]
    fn what_is_tangled_comes_free_and_runs() {
        for Tangle { name, text, start: change, most } in TANGLES {
            let mut sim = start(&text(), change);
            let untangled = untangle(name, &mut sim);
            assert!(untangled.before > 0 || untangled.inside[0] > 0, "{name} is no tangle");
            assert_eq!((untangled.after, untangled.inside[1]), (0, 0), "{name}");
            assert!(f64::from(untangled.moved) <= *most, "{name}: {untangled:?}");
            // In single precision a distance is off by several roundings of the coordinates.
            let least = least_distance(&sim);
            assert!(least >= 0.1 * 0.002 - 1e-7, "{name}: features are {least} m apart");
            for step in 1..=20 {
                sim.take_step().unwrap_or_else(|diverged| panic!("{name}: {diverged}"));
                assert_eq!(sim.crossings(&Serial), 0, "{name}, after step {step}");
            }
            assert_eq!(sim.penetration().unwrap_or(0.0), 0.0, "{name}");
        }
    }

    #[test]
    fn what_is_crumpled_comes_free() {
        let (mut free, mut moved): (_, Real) = (0, 0.0);
        let mut seeds = 0..;
        for _ in 0..20 {
            let sheet = |seed| start(&tangles::scene(&[&tangles::sheet("")]), |x| tangles::crumple(x, &mut Rng::new(seed)));
            let tangled = seeds.by_ref().map(|seed| (seed, sheet(seed))).find(|(_, sim)| sim.crossings(&Serial) > 0);
            let (seed, mut sim) = tangled.expect("endless seeds");
            let untangled = untangle(&format!("seed {seed}"), &mut sim);
            free += u32::from(untangled.after == 0);
            moved += untangled.moved;
        }
        println!("{NAME}: {free} of 20 come free, the farthest vertices by {:.1} mm in the mean", 50.0 * moved);
        assert!(free >= 19, "{free} of 20 come free");
    }

    /// Two sheets that are pinned along their borders cannot separate.
    #[test]
    fn what_is_held_stays() {
        let held = |edges: [&str; 2]| {
            edges.map(|edge| format!("[[cloth.pin]]\nselect = {{ edge = \"{edge}\" }}\n")).concat()
        };
        let place = "position = [0.003, 0.0, 0.002]\nrotation = [0, 8, 70]";
        let (one, two) = (held(["front", "back"]), held(["left", "right"]));
        let text = tangles::scene(&[&tangles::sheet(&one), &tangles::sheet(&format!("{place}\n{two}"))]);
        let mut sim = start(&text, |_| ());
        let before = sim.positions().to_vec();
        let untangled = untangle("held", &mut sim);
        assert!(untangled.before > 0 && untangled.after > 0, "{untangled:?}");
        for &v in sim.pins().vertices {
            assert_eq!(before[v as usize], sim.positions()[v as usize], "vertex {v} is pinned");
        }
    }

    #[test]
    fn held_axes_stay() {
        let place = "position = [0.003, 0.003, 0.002]\nrotation = [0, 0, 3]";
        let pins = "[[cloth.pin]]\nselect = { edge = \"left\" }\naxes = \"x\"\n[[cloth.pin]]\nselect = { edge = \"right\" }\n";
        let mut sim = start(&tangles::two(&format!("{place}\n{pins}")), |_| ());
        let before = sim.positions().to_vec();
        let untangled = untangle("held along x", &mut sim);
        assert_eq!(untangled.after, 0);
        let model = sim.contact().expect("the scene has contact").view();
        let moves = before.iter().zip(sim.positions()).enumerate();
        let moves = moves.map(|(v, pair)| (pair, model.inverse_masses.at(v)));
        let held: Vec<_> = moves.filter(|(_, inverse_mass)| inverse_mass.min_element() == 0.0).collect();
        assert!(held.iter().any(|((x, now), _)| x != now), "no vertex that is held along x only moves");
        for ((x, now), inverse_mass) in held {
            let fixed = inverse_mass.cmpeq(Vec3::ZERO);
            assert_eq!(Vec3::select(fixed, *x, Vec3::ZERO), Vec3::select(fixed, *now, Vec3::ZERO));
        }
    }

    #[test]
    fn what_is_free_is_left_alone() {
        let near = tangles::two("position = [0.003, 0.00001, 0.002]");
        let texts = [near];
        // First a scene without crossings, then crossings in a scene that allows cloth to pass through itself.
        let through = tangles::two("position = [0.003, 0.07, 0.002]\nrotation = [0, 8, 70]");
        let through = through.replace("[contact]", "[contact]\nself = false");
        for text in texts.into_iter().chain([through]) {
            let mut sim = start(&text, |_| ());
            let before = sim.positions().to_vec();
            assert_eq!(sim.untangle(&Serial), Untangled::default());
            assert_eq!(before, sim.positions());
        }
    }

    #[test]
    fn what_is_no_number_is_left_alone() {
        let mut sim = tangle("steep");
        sim.state_mut().0[5].x = Real::NAN;
        assert_eq!(sim.untangle(&Serial), Untangled::default());
    }
}
