//! Steps in which the cloth moves: no pair is missing from the candidates that collides, or is near at either end, while the
//! vertices end anywhere in their boxes. Compared with all pairs whose boxes around the motion overlap.

harness::both_precisions! {
    use harness::rng::Rng;
    use harness::steps::Steps;
    use muslin::broad_phase::{self, Candidates, Counts, GridColumns};
    use muslin::contact::{ContactModel, ContactScratchColumns, Searched};
    use muslin::detection::{self, Purpose};
    use muslin::dispatch::{Here, Serial, block_on};
    use muslin::geometry::aabb::Aabb;
    use muslin::narrow_phase::continuous::{self, LinearMotion};
    use muslin::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
    use muslin::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity};
    use muslin::real::{Real, Vec3, vec3};
    use muslin::response::impact::SEPARATION;
    use muslin::response::repulsion::REACH;
    use std::collections::BTreeSet;

    type Pairs = [Vec<[u32; 2]>; 2];

    /// Counts over all steps of a scene.
    #[derive(Debug, Default)]
    struct Seen {
        swept: u32,
        comoving: u32,
        hits: usize,
        near: usize,
        all: usize,
        ours: usize,
    }

    /// A ribbon that falls on its end and folds, in long steps.
    fn fold() -> String {
        include_str!("../../core/scenes/fold.toml").replace("step = ", "step = 0.0166666666667 # ")
    }

    /// Two coarse skirts that spin, one on the other.
    fn spin() -> String {
        let text = include_str!("../scenes/spin.toml").replace("rings = 43", "rings = 10");
        let (before, rest) = text.split_once("[[cloth]]").expect("a cloth");
        let (cloth, after) = rest.split_once("[contact]").expect("contact");
        let above = cloth.replace("[0.0, 1.0, 0.0]", "[0.0, 1.003, 0.0]");
        let after = after.replace("step = ", "step = 0.01 # ");
        format!("{before}[[cloth]]{cloth}[[cloth]]{above}[contact]{after}")
    }

    /// The candidates of columns.
    fn candidates(columns: &mut ContactScratchColumns) -> Pairs {
        let view = columns.view();
        let Counts { vertex_triangle, edge_edge } = *view.counts;
        [view.vertex_triangle.candidates[..vertex_triangle].to_vec(), view.edge_edge.candidates[..edge_edge].to_vec()]
    }

    /// All pairs whose boxes overlap.
    fn all_pairs(model: &ContactModel<'_>, boxes: &[Aabb]) -> Pairs {
        let mut grid = GridColumns::build(boxes.len(), model.surface.triangles.len());
        let mut pairs = Pairs::default();
        loop {
            let [vertex_triangle, edge_edge] = &mut pairs;
            let mut out = Candidates { vertex_triangle, edge_edge };
            let counts = broad_phase::candidates(boxes, &model.surface, &mut grid.view(), None, &mut out, &Serial);
            let needed = [counts.vertex_triangle, counts.edge_edge];
            let fits = pairs.iter().zip(needed).all(|(pairs, needed)| pairs.len() >= needed);
            pairs.iter_mut().zip(needed).for_each(|(pairs, needed)| pairs.resize(needed, [0; 2]));
            if fits {
                return pairs;
            }
        }
    }

    /// The pairs that must not be missing if the vertices move from `start` to `end`: those that collide, and those that
    /// are near at the start or, if it is `checked`, at the end.
    fn needed<P: Pairing>(
        model: &ContactModel<'_>,
        pairs: &[[u32; 2]],
        [start, end]: [&[Vec3]; 2],
        checks_end: bool,
        seen: &mut Seen,
    ) -> BTreeSet<[u32; 2]> {
        let distances = |x: &[Vec3]| {
            let mut distances = vec![0.0; pairs.len()];
            proximity::distances::<P>(pairs, &model.surface, x, model.radii, Real::INFINITY, &mut distances, &Serial);
            distances
        };
        let (first, last) = (distances(start), distances(end));
        let displacements: Vec<Vec3> = end.iter().zip(start).map(|(end, start)| *end - *start).collect();
        let (displacements, rounds) = (&displacements[..], &vec![0; start.len()][..]);
        let motion = LinearMotion { start, end, displacements, radii: model.radii, rounds, round: 0 };
        let mut times: Vec<StoredTime> = vec![TimeOfImpact::Never.into(); pairs.len()];
        let separation = SEPARATION * model.thickness;
        continuous::times::<P>(pairs, &first, &model.surface, motion, separation, &mut times, &Serial);
        let mut needed = BTreeSet::new();
        for (k, &pair) in pairs.iter().enumerate() {
            let hits = !matches!(times[k].into(), TimeOfImpact::Never);
            let near = first[k].min(if checks_end { last[k] } else { Real::INFINITY }) <= REACH * model.thickness;
            (seen.hits, seen.near) = (seen.hits + usize::from(hits), seen.near + usize::from(near));
            if hits || near {
                needed.insert(pair);
            }
        }
        needed
    }

    /// Moves the vertices to places in their end boxes, and compares.
    fn compare(model: &ContactModel<'_>, columns: &mut ContactScratchColumns, rng: &mut Rng, step: u32, seen: &mut Seen) {
        let ours = candidates(columns);
        let view = columns.view();
        let all = all_pairs(model, view.boxes);
        for trial in 0..3 {
            // First the motion itself, then ends from which the next near pairs are found, then ends anywhere.
            let narrower = [0.5, 0.5 * REACH + 0.01, 0.5][trial] * model.thickness;
            let end: Vec<Vec3> = (view.ends.iter().zip(&*view.end).zip(model.radii))
                .map(|((around, &end), &radius)| {
                    let room = (around.max - around.min) * 0.5 - (radius + narrower);
                    let at = vec3(rng.cube(1.0).to_array()) * room * (1.0 - 1e-3);
                    if trial == 0 { end } else { (around.min + around.max) * 0.5 + at }
                })
                .collect();
            let motion = [&*view.start, &end[..]];
            let needed = [
                needed::<VertexTriangle>(model, &all[0], motion, trial < 2, seen),
                needed::<EdgeEdge>(model, &all[1], motion, trial < 2, seen),
            ];
            for (needed, ours) in needed.iter().zip(&ours) {
                let ours: BTreeSet<_> = ours.iter().copied().collect();
                let missing: Vec<_> = needed.difference(&ours).collect();
                assert!(missing.is_empty(), "step {step}, ends {trial}: {missing:?} are missing ({:?})", view.searched);
            }
        }
        seen.all += all.iter().map(Vec::len).sum::<usize>();
        seen.ours += ours.iter().map(Vec::len).sum::<usize>();
    }

    fn misses_nothing(text: &str, steps: u32) -> Seen {
        let (mut sim, mut rng, mut seen) = (kit::simulation(text, &[]), Rng::new(7), Seen::default());
        let columns = sim.contact().expect("the scene has contact").clone();
        let model = columns.view();
        let mut contact = ContactScratchColumns::build(&model, 8);
        for step in 1..=steps {
            let (start, time) = (sim.positions().to_vec(), sim.time());
            sim.take_step().expect("a step");
            detection::place(&model, [time, sim.time() - time], &start, sim.positions(), &mut contact.view());
            if detection::is_quiet(&model, &contact.view()) {
                continue;
            }
            // Around the motion, as if it was predicted before the solve; then anew, as if the solve had changed it.
            for searches in 0..2 {
                let purpose = Purpose::Response { widened: 0 };
                block_on(detection::search(&model, purpose, &mut contact, &Here(&Serial))).expect("candidates");
                match *contact.view().searched {
                    Searched::Swept => seen.swept += 1,
                    Searched::Comoving => seen.comoving += 1,
                    other => panic!("{other:?} around a motion"),
                }
                compare(&model, &mut contact, &mut rng, step, &mut seen);
                if searches == 0 {
                    contact.view().ends.fill(Aabb::EMPTY);
                }
            }
        }
        println!("{seen:?}");
        seen
    }

    #[test]
    fn no_pair_is_missing_that_touches_where_cloth_moves() {
        for (text, steps) in [(fold(), 40), (spin(), 30)] {
            let Seen { swept, comoving, hits, near, all, ours } = misses_nothing(&text, steps);
            assert!(comoving > 10, "{comoving} searches in the frame that moves with the cloth");
            assert!(swept + comoving > 20 && hits > 100 && near > 100, "{swept} others, {hits} hits, {near} near pairs");
            assert!(3 * ours < 2 * all, "{ours} candidates of {all} pairs whose boxes overlap");
        }
    }
}
