//! No pair is missing from the candidates that collides or is near at either end of a step. Compared with all pairs
//! whose boxes around the motion overlap: in steps of cloth that moves fast, with vertices that end anywhere in their
//! boxes, and in every search of the built-in scenes, most of which find their pairs among those that were kept.
//!
//! Run: `cargo test -p muslin-tests --test narrow_phase complete`; all steps of the built-in scenes:
//! `cargo test -p muslin-tests --test narrow_phase -- --ignored --nocapture long_form_of_built_in`.

harness::both_precisions! {
    use harness::rng::Rng;
    use muslin::broad_phase::{self, Candidates, Counts, GridColumns};
    use muslin::contact::{ContactModel, ContactRoom, ContactScratch, ContactScratchColumns, Searched};
    use muslin::detection::{self, Purpose};
    use muslin::dispatch::Serial;
    use muslin::geometry::aabb::Aabb;
    use muslin::narrow_phase::continuous::{self, LinearMotion};
    use muslin::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
    use muslin::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, proximity};
    use muslin::integrate::{IntegratorStatistics, StepInput};
    use muslin::real::{Real, Vec3, vec3};
    use muslin::response::ContactStatistics;
    use muslin::response::impact::SEPARATION;
    use muslin::response::repulsion::REACH;
    use muslin::scene::BUILT_IN;
    use muslin::scratch::ScratchColumns;
    use muslin::step::{self, History, StepContact, Work};
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
            let counts = broad_phase::candidates(boxes, &model.surface, &mut grid.view(), None, &mut out, &Serial).expect("nothing stops the search");
            let needed = [counts.vertex_triangle, counts.edge_edge];
            let fits = pairs.iter().zip(needed).all(|(pairs, needed)| pairs.len() >= needed);
            pairs.iter_mut().zip(needed).for_each(|(pairs, needed)| pairs.resize(needed, [0; 2]));
            if fits {
                return pairs;
            }
        }
    }

    /// The pairs that must not be missing if the vertices move from `start` to `end`: those that collide, and those
    /// that are near at the start or, if it is `checked`, at the end.
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
        let rounds = &vec![0; start.len()][..];
        let motion = LinearMotion { start, end, radii: model.radii, rounds, round: 0 };
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
                detection::search(&model, purpose, &mut contact, &Serial).expect("candidates");
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

    /// Columns of contact that check the candidates of every search.
    struct Checked<'a> {
        model: &'a ContactModel<'a>,
        columns: ContactScratchColumns,
        /// The boxes for which pairs were kept at the last search.
        kept: Vec<Aabb>,
        /// Searches, and those of them that needed no new pairs.
        searches: [u32; 2],
        seen: Seen,
    }

    impl ContactRoom for Checked<'_> {
        fn columns(&mut self) -> ContactScratch<'_> {
            self.columns.view()
        }
        fn grow_pairs(&mut self, needed: Counts) -> bool {
            self.columns.grow_pairs(needed)
        }
        fn grow_constraints(&mut self, needed: usize) -> bool {
            self.columns.grow_constraints(needed)
        }
        /// A step calls this after each search.
        fn grow_kept(&mut self) {
            let view = self.columns.view();
            if view.has_room(*view.counts) {
                self.check();
            }
            ContactRoom::grow_kept(&mut self.columns);
        }
    }

    impl Checked<'_> {
        fn check(&mut self) {
            let (model, seen) = (self.model, &mut self.seen);
            let ours = candidates(&mut self.columns);
            let view = self.columns.view();
            let is_near = *view.searched == Searched::Near;
            let lasted = is_near && self.kept[..] == view.kept.boxes[..];
            self.kept.copy_from_slice(view.kept.boxes);
            self.searches[0] += 1;
            self.searches[1] += u32::from(lasted);
            // Before the solve of a fast step, only the pairs that are near at its start are needed.
            let end = if is_near && !detection::is_quiet(model, &view) { &*view.start } else { &*view.end };
            let around: Vec<Aabb> = (view.start.iter().zip(end).zip(model.radii))
                .map(|((&a, &b), &radius)| {
                    let wide = (0.5 * REACH * model.thickness + radius) * 1.001;
                    Aabb { min: a.min(b) - wide, max: a.max(b) + wide }
                })
                .collect();
            let all = all_pairs(model, &around);
            let motion = [&*view.start, end];
            let needed = [
                needed::<VertexTriangle>(model, &all[0], motion, !is_near, seen),
                needed::<EdgeEdge>(model, &all[1], motion, !is_near, seen),
            ];
            for (needed, ours) in needed.iter().zip(&ours) {
                let ours: BTreeSet<_> = ours.iter().copied().collect();
                let missing: Vec<_> = needed.difference(&ours).collect();
                let searches = self.searches[0];
                assert!(missing.is_empty(), "search {searches}: {missing:?} are missing ({:?}, {lasted})", view.searched);
            }
        }
    }

    /// Runs a built-in scene for so many seconds at most, and checks every search. Returns the numbers of searches, of
    /// those that needed no new pairs, and of pairs that are near or collide.
    fn built_in(name: &str, seconds: f64) -> [usize; 3] {
        let text = BUILT_IN.iter().find(|(known, _)| *known == name).expect("a built-in scene").1;
        // This driver does not divide steps.
        let lines = text.lines().filter(|line| !line.starts_with("error ="));
        let text = &lines.map(|line| format!("{line}\n")).collect::<String>();
        let text = &text.replace("[integrator]\n", "[integrator]\nstep = 0.004166666666666667\n");
        let scene = kit::scene(text);
        let (sim, mut built) = (kit::simulation(text, &[]), kit::build(text));
        let (scheme, length) = (*sim.scheme(), sim.step_length());
        let mut scratch = ScratchColumns::build(&built, &scheme);
        let columns = built.contact.take().expect("the scene has contact");
        let model = columns.view();
        let mut checked = Checked {
            model: &model,
            columns: ContactScratchColumns::build(&model, 8),
            kept: vec![Aabb::EMPTY; model.radii.len()],
            searches: [0; 2],
            seen: Seen::default(),
        };
        let mut history = History::Start;
        let steps = (scene.duration.min(seconds) / scene.timing().step) as u32;
        for n in 0..steps {
            let mut particles = built.particles.view();
            let input = StepInput {
                model: built.model.view(),
                pins: &built.pins.view(),
                masses: particles.masses,
                inverse_masses: particles.inverse_masses,
                time: f64::from(n) * scene.timing().step,
                step: length,
                scheme: &scheme,
                follows_contact: false,
                limit: None,
                has_contact: true,
                dispatch: &Serial,
            };
            let contact = Some(StepContact { model: &model, columns: &mut checked, hold: false });
            let (mut integrator, mut statistics) = (IntegratorStatistics::default(), ContactStatistics::default());
            let work = Work { integrator: &mut integrator, contact: &mut statistics, searched: &mut 0, done: None };
            let taken = step::take(&input, &mut particles, &mut scratch.view(), contact, &mut history, work);
            taken.unwrap_or_else(|obstacle| panic!("{name}, step {n}: {obstacle:?}"));
        }
        let Checked { searches: [searches, lasted], seen, .. } = checked;
        println!("{name}: {steps} steps, {searches} searches, {lasted} of pairs kept, {seen:?}");
        [searches as usize, lasted as usize, seen.near + seen.hits]
    }

    #[test]
    #[ignore = "slow"]
    fn no_search_of_a_built_in_scene_misses_a_pair() {
        for (name, seconds, least_lasted) in [("ball", 0.6, 10), ("fold", 0.4, 5), ("twist", 0.5, 0)] {
            let [searches, lasted, touching] = built_in(name, seconds);
            assert!(searches > 80 && touching > 10_000, "{name}: {searches} searches, {touching} pairs that touch");
            assert!(lasted >= least_lasted, "{name}: only {lasted} of {searches} searches found their pairs kept");
        }
    }

    #[test]
    #[ignore = "long"]
    fn long_form_of_built_in_scenes() {
        let scenes = BUILT_IN.iter().filter(|(_, text)| kit::build(text).contact.is_some());
        let found: Vec<_> = scenes.map(|(name, _)| built_in(name, f64::INFINITY)).collect();
        assert!(found.len() >= 9, "{} built-in scenes have contact", found.len());
        let lasted: usize = found.iter().map(|[_, lasted, _]| lasted).sum();
        assert!(lasted > 40, "only {lasted} searches found their pairs kept");
    }
}
