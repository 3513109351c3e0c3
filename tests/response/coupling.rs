//! The solve of a step together with its contacts: its solution against the law of contact written anew and a dense
//! matrix, for every implicit method, and that the state after it is one that the method itself could have come to.
//!
//! Run: `cargo test -p muslin-tests --test response coupling`; with `-- --nocapture` it prints the
//! worst error of every comparison beside its bound.

use harness::both_precisions;

/// s.
const STEP: f64 = 0.01;
/// Columns and rows of vertices.
const GRID: [u32; 2] = [4, 5];
const SHEET: &str = r#"
    name = "coupling"
    duration = 1.0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.3, 0.4], cells = [3, 4], pattern = "diagonal" }
    density = 0.2
    stretch = { model = "membrane", stiffness = 100.0, damping = 0.001 }
    shear = { stiffness = 40.0 }
    bend = { model = "hinge", rigidity = 1e-4 }
    pin = [{ select = { corners = [0] } }, { select = { corners = [2] }, axes = "y" }]
    [contact]
    thickness = 0.001
"#;

/// A sheet that lies on a plane.
const RESTING: &str = r#"
    name = "resting"
    duration = 1.0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.3, 0.3], cells = [6, 6] }
    position = [0.0, 0.004, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 100.0, damping = 0.001 }
    shear = { stiffness = 40.0 }
    bend = { model = "hinge", rigidity = 1e-4 }
    [[collider]]
    shape = "plane"
    point = [0.0, 0.0, 0.0]
    normal = [0.0, 1.0, 0.0]
    [contact]
    thickness = 0.004
    friction = 0.4
    [integrator]
    step = 0.01
"#;

both_precisions! {
    use super::{GRID, RESTING, SHEET, STEP};
    use glam::DVec3;
    use muslin::contact::{ContactRoom, ContactScratchColumns};
    use muslin::dispatch::Serial;
    use muslin::forces::matrix;
    use muslin::implicit_contact::multiplier::Multiplier;
    use muslin::implicit_contact::{self, augmented_contact, exchange};
    use muslin::implicit_contact::augmented_contact::{ActiveContacts, AugmentedContact, ContactLines, Friction};
    use muslin::integrate::conjugate_gradient::add_diagonal;
    use muslin::integrate::pins::JumpSide;
    use muslin::integrate::{self, StepInput, Method, Preconditioner, Scheme, IntegratorStatistics};
    use muslin::particles::Particles;
    use muslin::real::{Mat3, Real, Vec3, to_f64, vec3};
    use muslin::scene::BuiltScene;
    use muslin::scratch::{Scratch, ScratchColumns};

    use nalgebra::DMatrix;
    use harness::rng::Rng;
    use harness::worst::Worst;

    const VERTICES: u32 = GRID[0] * GRID[1];
    const PRECONDITIONERS: [Preconditioner; 2] = [Preconditioner::BlockJacobi, Preconditioner::TwoLevel];

    fn wide(v: Vec3) -> DVec3 {
        to_f64(v).into()
    }

    fn column(v: &[Vec3]) -> Vec<DVec3> {
        v.iter().map(|&v| wide(v)).collect()
    }

    /// A method, with or without a state before the last.
    #[derive(Clone, Copy, Debug)]
    struct Advance {
        method: Method,
        history: bool,
    }

    const ADVANCES: [Advance; 4] = [
        Advance { method: Method::BackwardEuler, history: false },
        Advance { method: Method::ImplicitMidpoint, history: false },
        Advance { method: Method::Bdf2, history: false },
        Advance { method: Method::Bdf2, history: true },
    ];

    impl Advance {
        /// How positions follow from the velocity of the stage, s.
        fn length(self) -> f64 {
            f64::from(STEP as Real) * if self.history { 2.0 / 3.0 } else { 1.0 }
        }
    }

    /// A crumpled sheet in motion.
    fn sheet(seed: u64) -> BuiltScene {
        let mut built = kit::build(SHEET);
        let mut rng = Rng::new(seed);
        let particles = &mut built.particles;
        for (x, v) in particles.positions.iter_mut().zip(&mut particles.velocities) {
            *x += vec3(rng.cube(0.01).into());
            *v = vec3(rng.cube(1.0).into());
        }
        built.pins.view().impose(0.0, JumpSide::After, &mut particles.positions, &mut particles.velocities);
        built
    }

    /// Contacts between vertices of the sheet, and with vertices beyond it, which are a collider's. The least and the
    /// relative velocity are displacements, as the solve expects them.
    fn contacts(rng: &mut Rng, count: usize) -> Vec<AugmentedContact> {
        let contact = |_| {
            let beyond = rng.bits().is_multiple_of(2);
            let vertex = |rng: &mut Rng| (rng.bits() % u64::from(VERTICES)) as u32;
            let mut vertices = [0; 4];
            for k in 0..4 {
                vertices[k] = loop {
                    let v = if beyond && k > 0 { VERTICES + k as u32 } else { vertex(rng) };
                    if !vertices[..k].contains(&v) {
                        break v;
                    }
                };
            }
            let [a, b] = [0; 2].map(|_| rng.between(0.1, 0.9));
            let weights =
                if rng.bits().is_multiple_of(2) { [1.0, -a * b, a * b - a, a - 1.0] } else { [1.0 - a, a, b - 1.0, -b] };
            let at_rest = rng.pick(&[0.0, 0.3, 0.6]);
            let kinetic = at_rest * rng.between(0.5, 1.0);
            AugmentedContact {
                vertices,
                weights: weights.map(|w| w as Real),
                normal: vec3(rng.direction().into()),
                least_velocity: rng.between(-0.002, 0.005) as Real,
                slack: 0.004,
                velocity: vec3(rng.cube(0.005).into()),
                multiplier: vec3((DVec3::from(rng.cube(1.0)) * rng.pick(&[0.0, 0.002])).into()),
                coefficients: [at_rest as Real, kinetic as Real],
                ..AugmentedContact::default()
            }
        };
        (0..count).map(contact).collect()
    }

    /// The input and the result of [`implicit_contact::correct`] and [`implicit_contact::resume`].
    struct Corrected {
        /// The matrix of the step, held axes not yet cleared.
        matrix: DMatrix<f64>,
        /// The residual before the solve where the solve was deferred to it, otherwise zero.
        residual: Vec<DVec3>,
        predicted: [Vec<DVec3>; 2],
        end: [Vec<DVec3>; 2],
        solution: Vec<DVec3>,
        given: Vec<AugmentedContact>,
        contacts: Vec<AugmentedContact>,
        built: BuiltScene,
        work: IntegratorStatistics,
    }

    fn correct(
        advance: Advance,
        preconditioner: Preconditioner,
        built: BuiltScene,
        given: Vec<AugmentedContact>,
    ) -> Corrected {
        let tolerance = kit::bound(1e-6, 1e-13) as Real;
        let scheme = Scheme { preconditioner, ..Scheme::fixed(advance.method, tolerance) };
        let mut columns = ScratchColumns::build(&built, &scheme);
        let (mut state, mut work) = (built.particles.clone(), IntegratorStatistics::default());
        let (model, pins) = (built.model.view(), built.pins.view());
        let context = StepInput {
            model,
            pins: &pins,
            masses: &built.particles.masses,
            inverse_masses: &built.particles.inverse_masses,
            time: 0.0,
            step: STEP as Real,
            scheme: &scheme,
            follows_contact: false,
            limit: None,
            has_contact: true,
            dispatch: &Serial,
        };
        let particles = &state.view();
        let s = &mut columns.view();
        assert_eq!(s.solution.len(), VERTICES as usize, "the sheet has other vertices");
        if advance.history {
            s.last_step = Some(STEP as Real);
            let mut rng = Rng::new(7);
            let changes = s.previous_displacements.iter_mut().zip(&mut *s.previous_velocity_changes);
            for (&velocity, (displacement, change)) in particles.velocities.iter().zip(changes) {
                *change = vec3(rng.cube(0.1).into());
                *displacement = (velocity - *change) * STEP as Real;
            }
            pins.filter(s.previous_displacements);
            pins.filter(s.previous_velocity_changes);
        }
        integrate::advance(&context, particles, s, &mut work);
        let predicted = [column(s.next_positions), next_velocities(particles, s)];
        let matrix = dense(s, &built.particles.masses);
        let zero = vec![DVec3::ZERO; VERTICES as usize];
        let residual = if context.defers_solve() { column(s.residual) } else { zero };
        let mut contacts = given.clone();
        let lines = &mut vec![ContactLines::default(); contacts.len().div_ceil(4)];
        // The last contact is an impact that is only found in the motion of the others.
        let known = contacts.len() - 1;
        let has_begun = implicit_contact::correct(&context, particles, (&mut contacts[..known], lines), s, &mut work);
        if !has_begun {
            s.solution.fill(Vec3::ZERO);
        }
        let first = column(s.solution);
        let moved = contacts[known].gather(s.solution) * advance.length() as Real;
        contacts[known].velocity += moved;
        implicit_contact::resume(&context, particles, (&mut contacts, lines), known, has_begun, s, &mut work);
        let end = [column(s.next_positions), next_velocities(particles, s)];
        let solution = first.iter().zip(column(s.solution)).map(|(&a, b)| a + b).collect();
        Corrected { matrix, residual, predicted, end, solution, given, contacts, built, work }
    }

    /// The velocities after the step.
    fn next_velocities(from: &Particles<'_>, s: &Scratch<'_>) -> Vec<DVec3> {
        let low = from.low_velocities.iter().zip(&*s.velocity_changes).map(|(&low, &change)| low + change);
        column(&from.velocities.iter().zip(low).map(|(&velocity, change)| velocity + change).collect::<Vec<_>>())
    }

    /// A, read off products with unit vectors.
    fn dense(s: &Scratch<'_>, masses: &[Real]) -> DMatrix<f64> {
        let size = 3 * masses.len();
        let mut dense = DMatrix::<f64>::zeros(size, size);
        let mut product = vec![Vec3::ZERO; masses.len()];
        for k in 0..size {
            let mut unit = vec![Vec3::ZERO; masses.len()];
            unit[k / 3][k % 3] = 1.0;
            matrix::multiply(&s.matrix, masses, 1.0, &unit, &mut product, &Serial);
            (0..size).for_each(|i| dense[(i, k)] = wide(product[i / 3])[i % 3]);
        }
        dense
    }

    /// The vertices of a contact that are the sheet's.
    fn parts(contact: &AugmentedContact) -> impl Iterator<Item = (usize, f64)> {
        let parts = contact.vertices.into_iter().zip(contact.weights);
        parts.filter(|part| part.0 < VERTICES).map(|(v, w)| (v as usize, f64::from(w)))
    }

    fn relative(contact: &AugmentedContact, moves: &[DVec3]) -> DVec3 {
        parts(contact).map(|(v, w)| moves[v] * w).sum()
    }

    /// The impulse by the law of contact, at the relative velocity `u`.
    fn law(contact: &AugmentedContact, u: DVec3) -> DVec3 {
        let (normal, multiplier) = (wide(contact.normal), wide(contact.multiplier));
        let (stiffness, bound) = (f64::from(contact.stiffness), f64::from(contact.bound));
        let along = multiplier.dot(normal) + stiffness * (f64::from(contact.least_velocity) - u.dot(normal));
        let flat = |v: DVec3| v - normal * v.dot(normal);
        let across = flat(multiplier) - flat(u) * stiffness;
        normal * along.max(0.0) + across.clamp_length_max(bound)
    }

    impl Corrected {
        fn is_held(&self, vertex: usize, axis: usize) -> bool {
            let pins = &self.built.pins;
            pins.vertices.iter().zip(&pins.axes).any(|(&v, &axes)| v as usize == vertex && axes >> axis & 1 == 1)
        }

        /// Sheet vertices without a held axis.
        fn free(&self) -> impl Iterator<Item = usize> {
            (0..VERTICES as usize).filter(|&v| (0..3).all(|axis| !self.is_held(v, axis)))
        }
    }

    fn largest(column: &[DVec3]) -> f64 {
        column.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max)
    }

    /// `A y = r + sum G^T impulse` on the free axes, with the impulses that the law gives at the solution.
    #[test]
    fn the_solution_balances_elasticity_and_contacts() {
        for advance in ADVANCES {
            for preconditioner in PRECONDITIONERS {
                let name = format!("{} {advance:?}, {preconditioner:?}", muslin::real::NAME);
                let mut balance = Worst::new(format!("{name}: balance"), kit::bound(3e-4, 1e-9));
                let mut impulses = Worst::new(format!("{name}: impulses"), kit::bound(3e-4, 1e-9));
                let mut pushing = 0;
                for seed in 0..20 {
                    let count = 3 + seed as usize % 4;
                    let got = correct(advance, preconditioner, sheet(seed), contacts(&mut Rng::new(seed), count));
                    assert_eq!(got.work.unconverged, 0, "{name}, seed {seed}: the solve did not converge");
                    let mut sum = got.residual.clone();
                    for (contact, given) in got.contacts.iter().zip(&got.given) {
                        let u = wide(given.velocity) / advance.length() + relative(contact, &got.solution);
                        let want = law(contact, u);
                        impulses.vectors(want.length().max(1e-3), &[wide(contact.impulse)], &[want], || format!("seed {seed}"));
                        pushing += u32::from(want.dot(wide(contact.normal)) > 0.0);
                        parts(contact).for_each(|(v, w)| sum[v] += want * w);
                    }
                    let scale = largest(&sum);
                    for (v, axis) in (0..VERTICES as usize).flat_map(|v| [0, 1, 2].map(|axis| (v, axis))) {
                        let row = 3 * v + axis;
                        let product: f64 =
                            (0..got.matrix.ncols()).map(|k| got.matrix[(row, k)] * got.solution[k / 3][k % 3]).sum();
                        if !got.is_held(v, axis) {
                            balance.compare(scale, &[product], &[sum[v][axis]], || format!("vertex {v}, seed {seed}"));
                        }
                    }
                }
                balance.check();
                impulses.check();
                assert!(pushing > 20, "{name}: only {pushing} contacts push");
            }
        }
    }

    /// A contact changes displacement and velocity alike, whatever the method: one that extrapolates would otherwise
    /// return what the contact stops.
    #[test]
    fn what_is_stopped_is_not_thrown_back() {
        for advance in ADVANCES {
            let mut worst = Worst::new(format!("{} {advance:?}: update", muslin::real::NAME), kit::bound(2e-5, 1e-13));
            for seed in 0..20 {
                let got = correct(advance, Preconditioner::TwoLevel, sheet(seed), contacts(&mut Rng::new(seed + 100), 4));
                let h = f64::from(STEP as Real);
                let ([x, v0], [x1, v1]) = (&got.predicted, &got.end);
                let scale = largest(x);
                for v in got.free() {
                    let want = x[v] + (v1[v] - v0[v]) * h;
                    worst.vectors(scale, &[x1[v]], &[want], || format!("vertex {v}, seed {seed}"));
                }
            }
            worst.check();
        }
    }

    /// Friction obeys the bound that the final normal impulse sets, with the coefficient of its state.
    #[test]
    fn friction_is_bounded_by_the_normal_impulse() {
        let mut slipping = 0;
        let mut worst = Worst::new(format!("{}: friction beyond its cone", muslin::real::NAME), kit::bound(1e-5, 1e-12));
        for seed in 0..40 {
            let given = contacts(&mut Rng::new(seed + 200), 5);
            let got = correct(ADVANCES[0], Preconditioner::TwoLevel, sheet(seed), given);
            for contact in &got.contacts {
                let normal = wide(contact.normal);
                let along = wide(contact.impulse).dot(normal);
                let across = (wide(contact.impulse) - normal * along).length();
                let coefficient = contact.coefficients[usize::from(contact.friction == Friction::Slips)];
                let beyond = across - f64::from(coefficient) * along.max(0.0);
                worst.see((beyond / along.max(1e-3)).max(0.0), || format!("seed {seed}: {contact:?}"));
                slipping += u32::from(contact.friction == Friction::Slips && along > 0.0);
            }
        }
        worst.check();
        assert!(slipping > 10, "only {slipping} contacts slip");
    }

    /// The curvature is that of the impulse, by central differences in between the kinks.
    #[test]
    fn curvature_is_the_derivative_of_the_impulse() {
        let mut rng = Rng::new(5);
        let mut worst = Worst::new(format!("{}: curvature", muslin::real::NAME), kit::bound(1e-3, 1e-8));
        for case in 0..200 {
            let mut contact = contacts(&mut rng, 1)[0];
            contact.stiffness = rng.between(0.5, 2.0) as Real;
            contact.bound = rng.between(0.0005, 0.004) as Real;
            contact.change = vec3(rng.cube(1.0).into());
            let small = kit::bound(2e-5, 1e-8);
            let at = |d: f64| wide(contact.impulse_at(contact.velocity + contact.change * d as Real));
            let (before, now, after) = (at(-small), at(0.0), at(small));
            let left = (now - before).dot(wide(contact.change)) / small;
            let right = (after - now).dot(wide(contact.change)) / small;
            if (left - right).abs() > kit::bound(5e-3, 1e-4) * left.abs().max(right.abs()).max(0.1) {
                continue;
            }
            let Some(line) = contact.line(contact.change) else {
                assert!(now == DVec3::ZERO && after == DVec3::ZERO, "case {case}: {contact:?} has an impulse");
                continue;
            };
            let mut lines = ContactLines::default();
            lines.set(case % 4, &line);
            let along = |length: f64| augmented_contact::slope_and_curvature(&[lines], length as Real);
            worst.see((along(0.0)[1] + 0.5 * (left + right)).abs(), || format!("case {case}: {contact:?}"));
            // Also far from where the line was taken.
            for length in [0.0, 1e-3, 2e-3, 4e-3] {
                let want = at(length).dot(wide(contact.change));
                worst.see((along(length)[0] - want).abs(), || format!("case {case}, length {length}: {contact:?}"));
            }
        }
        worst.check();
    }

    #[test]
    fn diagonal_blocks_are_those_of_the_contacts_that_push() {
        let mut rng = Rng::new(61);
        let mut worst = Worst::new(format!("{}: blocks", muslin::real::NAME), kit::bound(1e-5, 1e-13));
        for case in 0..100 {
            let mut all = contacts(&mut rng, 6);
            for contact in &mut all {
                (contact.stiffness, contact.bound) = (rng.between(0.1, 1.0) as Real, rng.between(0.0, 0.002) as Real);
            }
            let mut blocks = vec![Mat3::IDENTITY; VERTICES as usize];
            add_diagonal(&ActiveContacts::new(&mut all, &mut []), &mut blocks);
            for v in 0..VERTICES as usize {
                for axis in 0..3 {
                    let mut want = wide(Mat3::IDENTITY.col(axis));
                    for contact in &all {
                        let pushes = law(contact, wide(contact.velocity)).dot(wide(contact.normal)) > 1e-9;
                        let Some(matrix) = contact.matrix() else {
                            assert!(!pushes, "case {case}: {contact:?} pushes");
                            continue;
                        };
                        let squares: f64 = parts(contact).filter(|part| part.0 == v).map(|(_, w)| w * w).sum();
                        want += wide(matrix.col(axis)) * squares;
                    }
                    worst.vectors(1.0, &[wide(blocks[v].col(axis))], &[want], || format!("block {v}, case {case}"));
                }
            }
        }
        worst.check();
    }

    /// A cloth at rest on a plane needs no iterations: its contacts start from the forces of the step before. In single
    /// precision the rounding of its elastic forces needs one in every second step.
    #[test]
    fn a_sheet_at_rest_needs_no_iterations() {
        let mut sim = kit::simulation(RESTING, &[]);
        for _ in 0..200 {
            sim.take_step().expect("a sheet on a plane");
        }
        let before = sim.statistics().cg_iterations;
        let settled = sim.positions().to_vec();
        for _ in 0..50 {
            sim.take_step().expect("a sheet on a plane");
        }
        let iterations = sim.statistics().cg_iterations - before;
        let most = if muslin::real::NAME == "f32" { 30 } else { 5 };
        assert!(iterations <= most, "{iterations} iterations in 50 steps at rest, expected at most {most}");
        let moved = sim.positions().iter().zip(&settled).map(|(a, b)| a.distance(*b)).fold(0.0, Real::max);
        assert!(moved < 1e-6, "the sheet moved by {moved} m at rest");
        assert!(!sim.state().multipliers.is_empty(), "no contact carries the sheet");
    }

    /// A pair that is near and collides has two constraints. The force of the step before acts on it once.
    #[test]
    fn a_pair_with_two_constraints_gets_its_force_once() {
        let contact = kit::build(RESTING).contact.expect("the scene has contact");
        let model = contact.view();
        let mut columns = ContactScratchColumns::build(&model, 100);
        let scratch = &mut columns.columns();
        let force = vec3([0.1, 0.2, 0.3]);
        let pairs = [[0, 1, 2, 3], [4, 5, 6, 7], [4, 5, 6, 7], [0, 1, 2, 3]];
        for (constraint, vertices) in scratch.constraints.iter_mut().zip(pairs) {
            constraint.contact.vertices = vertices;
            constraint.inverse_mass = 1.0;
        }
        scratch.multipliers[0] = Multiplier { vertices: [0, 1, 2, 3], force };
        scratch.multipliers[1] = Multiplier { vertices: [4, 5, 6, 7], force: force * 2.0 };
        scratch.lengths.multipliers = 2;
        // The near pair first; what the motion brings near and its impacts later.
        for constraints in [0..1, 1..4] {
            exchange::add_contacts(&model, scratch, constraints, STEP as Real);
        }
        let got = scratch.contacts[..scratch.lengths.contacts].iter().map(|contact| contact.multiplier / STEP as Real);
        let worst = got.zip([force, force * 2.0, Vec3::ZERO, Vec3::ZERO]).map(|(got, want)| got.distance(want));
        let worst: Vec<_> = worst.collect();
        assert_eq!(worst.len(), 4);
        assert!(worst.iter().all(|&error| error < 1e-6), "errors of the four forces, N: {worst:?}");
    }
}
