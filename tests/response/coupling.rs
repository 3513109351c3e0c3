//! What pushes, held inside the implicit system: the correction against LU of the same system
//! `A + G^T s G`, assembled densely, for every implicit method, and that the state after it is one
//! that the method itself could have come to.
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
"#;

both_precisions! {
    use super::{GRID, SHEET, STEP};
    use glam::{DMat3, DVec3};
    use muslin::dispatch::Serial;
    use muslin::forces::matrix;
    use muslin::integrate::coupling::{self, Hold};
    use muslin::integrate::pins::JumpSide;
    use muslin::integrate::{StepInput, Jacobian, Method, Preconditioner, Scheme, IntegratorStatistics};
    use muslin::particles::Particles;
    use muslin::real::{Mat3, Real, Vec3, to_f64, vec3};
    use muslin::scene::BuiltScene;
    use muslin::scratch::{Scratch, ScratchColumns};
    use muslin::step;
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

    /// Holds between vertices of the sheet, and with vertices beyond it, which are a collider's.
    fn holds(rng: &mut Rng, count: usize) -> Vec<Hold> {
        let hold = |_| {
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
            let weights = if rng.bits().is_multiple_of(2) { [1.0, -a * b, a * b - a, a - 1.0] } else { [1.0 - a, a, b - 1.0, -b] };
            Hold {
                vertices,
                weights: weights.map(|w| w as Real),
                normal: vec3(rng.direction().into()),
                missing: vec3(rng.cube(0.005).into()),
                sticks: rng.pick(&[0.0, 0.2, 1.0]) as Real,
                released: if rng.bits().is_multiple_of(5) { 1.0 } else { 0.0 },
                ..Hold::default()
            }
        };
        (0..count).map(hold).collect()
    }

    /// What [`coupling::correct`] was given and what it made of it.
    struct Corrected {
        /// The matrix of the step, held axes not yet cleared.
        matrix: DMatrix<f64>,
        predicted: [Vec<DVec3>; 2],
        end: [Vec<DVec3>; 2],
        solution: Vec<DVec3>,
        holds: Vec<Hold>,
        built: BuiltScene,
        work: IntegratorStatistics,
    }

    fn correct(
        advance: Advance,
        preconditioner: Preconditioner,
        built: BuiltScene,
        mut holds: Vec<Hold>,
        release: impl FnMut(&mut [Hold]) -> bool,
    ) -> Corrected {
        let tolerance = kit::bound(1e-7, 1e-13) as Real;
        let scheme = Scheme { method: advance.method, newton: 1, tolerance, preconditioner, jacobian: Jacobian::Projected };
        let mut columns = ScratchColumns::build(&built, &scheme);
        let (mut particles, mut work) = (built.particles.clone(), IntegratorStatistics::default());
        let (model, pins) = (built.model.view(), built.pins.view());
        let context = StepInput {
            model: &model,
            pins: &pins,
            masses: &built.particles.masses,
            inverse_masses: &built.particles.inverse_masses,
            time: 0.0,
            step: STEP as Real,
            scheme: &scheme,
                extrapolates: true,
            dispatch: &Serial,
        };
        let particles = Particles {
            positions: &mut particles.positions,
            velocities: &mut particles.velocities,
            masses: &built.particles.masses,
            inverse_masses: &built.particles.inverse_masses,
        };
        let s = &mut columns.view();
        assert_eq!(s.solution.len(), VERTICES as usize, "the sheet has other vertices");
        if advance.history {
            s.has_history = true;
            let mut rng = Rng::new(7);
            for (k, (x, v)) in s.previous_positions.iter_mut().zip(&mut *s.previous_velocities).enumerate() {
                *v = particles.velocities[k] + vec3(rng.cube(0.1).into());
                *x = particles.positions[k] - *v * STEP as Real;
            }
            pins.impose(0.0, JumpSide::After, s.previous_positions, s.previous_velocities);
        }
        step::predict(&context, &particles, s, &mut work);
        let predicted = [column(s.next_positions), column(s.next_velocities)];
        let matrix = dense(s, &built.particles.masses);
        coupling::correct(&context, &mut holds, s, &mut work, release);
        let end = [column(s.next_positions), column(s.next_velocities)];
        let solution = column(s.solution);
        Corrected { matrix, predicted, end, solution, holds, built, work }
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

    /// n n^T + sticks (1 - n n^T), or nothing where it is released.
    fn directions(hold: &Hold) -> DMat3 {
        let normal = wide(hold.normal);
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let held = along + (DMat3::IDENTITY - along) * f64::from(hold.sticks);
        held * (1.0 - f64::from(hold.released))
    }

    /// The vertices of a hold that are the sheet's.
    fn parts(hold: &Hold) -> impl Iterator<Item = (usize, f64)> {
        let parts = hold.vertices.into_iter().zip(hold.weights);
        parts.filter(|part| part.0 < VERTICES).map(|(v, w)| (v as usize, f64::from(w)))
    }

    fn relative(hold: &Hold, moves: &[DVec3]) -> DVec3 {
        parts(hold).map(|(v, w)| moves[v] * w).sum()
    }

    impl Corrected {
        /// y by LU of `A + G^T s G` with held axes cleared; `right` is added to the right hand side.
        fn dense(&self, length: f64) -> Vec<DVec3> {
            let mut matrix = self.matrix.clone();
            let mut right = DMatrix::<f64>::zeros(matrix.nrows(), 1);
            for hold in &self.holds {
                let stiff = directions(hold) * f64::from(hold.stiffness);
                let wanted = stiff * wide(hold.missing) / length;
                for (a, weight) in parts(hold) {
                    (0..3).for_each(|i| right[(3 * a + i, 0)] += weight * wanted[i]);
                    for (b, other) in parts(hold) {
                        for (i, k) in (0..9).map(|e| (e / 3, e % 3)) {
                            matrix[(3 * a + i, 3 * b + k)] += weight * other * stiff.col(k)[i];
                        }
                    }
                }
            }
            self.solve(matrix, right)
        }

        fn solve(&self, mut matrix: DMatrix<f64>, mut right: DMatrix<f64>) -> Vec<DVec3> {
            for (v, axis) in (0..VERTICES as usize).flat_map(|v| [0, 1, 2].map(|axis| (v, axis))) {
                if self.is_held(v, axis) {
                    let row = 3 * v + axis;
                    (0..matrix.ncols()).for_each(|k| matrix[(row, k)] = f64::from(u8::from(k == row)));
                    right[(row, 0)] = 0.0;
                }
            }
            let y = matrix.lu().solve(&right).expect("the matrix is regular");
            (0..VERTICES as usize).map(|v| DVec3::from_array(std::array::from_fn(|k| y[(3 * v + k, 0)]))).collect()
        }

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

    #[test]
    fn the_correction_is_the_dense_one() {
        for advance in ADVANCES {
            for preconditioner in PRECONDITIONERS {
                let what = format!("{} {advance:?}, {preconditioner:?}", muslin::real::NAME);
                let mut worst = Worst::new(format!("{what}: y and the state"), kit::bound(2e-4, 1e-9));
                let mut impulses = Worst::new(format!("{what}: impulses"), kit::bound(2e-3, 1e-9));
                for seed in 0..20 {
                    let count = 3 + seed as usize % 4;
                    let holds = holds(&mut Rng::new(seed), count);
                    let got = correct(advance, preconditioner, sheet(seed), holds, |_| false);
                    assert_eq!(got.work.unconverged, 0, "{what}, seed {seed}: the solve did not converge");
                    let length = advance.length();
                    let velocity = length / f64::from(STEP as Real);
                    let y = got.dense(length);
                    let scale = largest(&y);
                    worst.vectors(scale, &got.solution, &y, || format!("y, seed {seed}"));
                    for (k, (factor, scale)) in [(length, scale * length), (velocity, scale)].into_iter().enumerate() {
                        let change: Vec<_> = got.end[k].iter().zip(&got.predicted[k]).map(|(a, b)| *a - *b).collect();
                        let want: Vec<_> = y.iter().map(|&y| y * factor).collect();
                        // In f32 a position rounds beside its small change.
                        worst.vectors(scale, &change, &want, || format!("column {k}, seed {seed}"));
                    }
                    let wanted = |hold: &Hold| {
                        directions(hold) * (wide(hold.missing) / length - relative(hold, &y)) * f64::from(hold.stiffness)
                    };
                    let want: Vec<_> = got.holds.iter().map(wanted).collect();
                    let impulse: Vec<_> = got.holds.iter().map(|hold| wide(hold.impulse)).collect();
                    impulses.vectors(largest(&want), &impulse, &want, || format!("seed {seed}"));
                }
                worst.check();
                impulses.check();
            }
        }
    }

    /// What a contact takes of the way it takes of the velocity, whatever the method: one that rings
    /// would else throw back what it stops.
    #[test]
    fn what_is_stopped_is_not_thrown_back() {
        for advance in ADVANCES {
            let mut worst = Worst::new(format!("{} {advance:?}: update", muslin::real::NAME), kit::bound(2e-5, 1e-13));
            for seed in 0..20 {
                let holds = holds(&mut Rng::new(seed + 100), 4);
                let got = correct(advance, Preconditioner::TwoLevel, sheet(seed), holds, |_| false);
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

    /// One contact alone closes its gap but for `1 / (1 + s c)`, c being how its vertices give way
    /// with the whole cloth behind them.
    #[test]
    fn a_hold_leaves_of_its_gap_what_its_stiffness_says() {
        for advance in ADVANCES {
            let mut worst = Worst::new(format!("{} {advance:?}: gap left", muslin::real::NAME), kit::bound(1e-3, 1e-9));
            let mut most: f64 = 0.0;
            for seed in 0..20 {
                let mut hold = holds(&mut Rng::new(seed + 200), 1);
                (hold[0].sticks, hold[0].released) = (0.0, 0.0);
                let got = correct(advance, Preconditioner::TwoLevel, sheet(seed), hold, |_| false);
                let (hold, normal) = (&got.holds[0], wide(got.holds[0].normal));
                let mut right = DMatrix::<f64>::zeros(got.matrix.nrows(), 1);
                parts(hold).for_each(|(v, w)| (0..3).for_each(|i| right[(3 * v + i, 0)] += w * normal[i]));
                let gives = relative(hold, &got.solve(got.matrix.clone(), right)).dot(normal);
                if gives == 0.0 {
                    continue;
                }
                let moved: Vec<_> = got.end[0].iter().zip(&got.predicted[0]).map(|(a, b)| *a - *b).collect();
                let missing = wide(hold.missing).dot(normal);
                let left = (missing - relative(hold, &moved).dot(normal)) / missing;
                let want = 1.0 / (1.0 + f64::from(hold.stiffness) * gives);
                most = most.max(want);
                worst.see((left - want).abs(), || format!("seed {seed}: {left} of the gap is left, expected {want}"));
            }
            worst.check();
            println!("{} {advance:?}: at most {most:.3} of a gap is left", muslin::real::NAME);
            assert!(most < 0.5, "{advance:?}: {most} of a gap is left, the holds are soft beside the cloth");
        }
    }

    /// All holds are as stiff beside the cloth at their vertices, the heavier of masses and forces.
    #[test]
    fn holds_are_as_stiff_as_the_cloth_at_their_vertices_asks() {
        let mut worst = Worst::new(format!("{}: stiffness beside the cloth's", muslin::real::NAME), kit::bound(1e-4, 1e-12));
        for advance in ADVANCES {
            let got = correct(advance, Preconditioner::TwoLevel, sheet(1), holds(&mut Rng::new(1), 20), |_| false);
            let local = |hold: &Hold| {
                let normal = wide(hold.normal);
                let gives = parts(hold).map(|(v, w)| {
                    let entry = |i: usize, k: usize| got.matrix[(3 * v + i, 3 * v + k)] * normal[i] * normal[k];
                    w * w / (0..9).map(|e| entry(e / 3, e % 3)).sum::<f64>()
                });
                1.0 / gives.sum::<f64>()
            };
            let beside: Vec<_> = got.holds.iter().map(|hold| f64::from(hold.stiffness) / local(hold)).collect();
            assert!(beside[0] > 1.0, "{advance:?}: a hold is {} times as stiff as the cloth", beside[0]);
            for (k, factor) in beside.iter().enumerate() {
                worst.see((factor / beside[0] - 1.0).abs(), || format!("{advance:?}, hold {k}: {factor}, hold 0: {}", beside[0]));
            }
        }
        worst.check();
    }

    /// What is let go after a solve is solved without.
    #[test]
    fn what_is_released_after_a_solve_is_as_if_it_had_never_been_held() {
        for advance in ADVANCES {
            let mut worst = Worst::new(format!("{} {advance:?}: released", muslin::real::NAME), kit::bound(2e-4, 1e-9));
            let mut pulled = 0;
            for seed in 0..20 {
                let mut given = holds(&mut Rng::new(seed + 300), 5);
                given.iter_mut().for_each(|hold| hold.released = 0.0);
                let mut calls = 0;
                let got = correct(advance, Preconditioner::TwoLevel, sheet(seed), given.clone(), |holds| {
                    calls += 1;
                    for hold in holds.iter_mut().filter(|hold| calls == 1 && hold.impulse.dot(hold.normal) < 0.0) {
                        hold.released = 1.0;
                        pulled += 1;
                    }
                    calls == 1
                });
                assert_eq!(calls, 2, "{advance:?}, seed {seed}: asked {calls} times what to release");
                let kept: Vec<_> = got.holds.iter().filter(|hold| hold.released == 0.0).copied().collect();
                let want = correct(advance, Preconditioner::TwoLevel, sheet(seed), kept, |_| false);
                for k in 0..2 {
                    let change: Vec<_> = want.end[k].iter().zip(&want.predicted[k]).map(|(a, b)| *a - *b).collect();
                    worst.vectors(largest(&change), &got.end[k], &want.end[k], || format!("column {k}, seed {seed}"));
                }
                for hold in got.holds.iter().filter(|hold| hold.released == 1.0) {
                    assert_eq!(hold.impulse, Vec3::ZERO, "{advance:?}, seed {seed}: what is released still pushes");
                }
            }
            assert!(pulled > 10, "{advance:?}: only {pulled} holds pulled");
            worst.check();
        }
    }

    /// `G^T s G` by products and by its diagonal blocks, against its own definition.
    #[test]
    fn products_and_diagonal_blocks_are_of_one_symmetric_matrix() {
        let mut rng = Rng::new(61);
        let mut worst = Worst::new(format!("{}: product, symmetry, blocks", muslin::real::NAME), kit::bound(1e-5, 1e-13));
        for case in 0..100 {
            let mut holds = holds(&mut rng, 6);
            holds.iter_mut().for_each(|hold| hold.stiffness = rng.between(0.1, 1.0) as Real);
            let random = |rng: &mut Rng| -> Vec<Vec3> { (0..VERTICES).map(|_| vec3(rng.cube(1.0).into())).collect() };
            let [p, q, before] = [0; 3].map(|_| random(&mut rng));
            let product = |p: &[Vec3]| {
                let mut out = before.clone();
                coupling::add_product(&holds, p, &mut out);
                let change = column(&out).into_iter().zip(column(&before)).map(|(a, b)| a - b);
                change.collect::<Vec<_>>()
            };
            let (kp, kq) = (product(&p), product(&q));
            let mut want = vec![DVec3::ZERO; VERTICES as usize];
            for hold in &holds {
                let force = directions(hold) * relative(hold, &column(&p)) * f64::from(hold.stiffness);
                parts(hold).for_each(|(v, w)| want[v] += force * w);
            }
            worst.vectors(1.0, &kp, &want, || format!("product, case {case}"));
            let inner = |a: &[DVec3], b: &[Vec3]| a.iter().zip(column(b)).map(|(a, b)| a.dot(b)).sum::<f64>();
            let (there, back) = (inner(&kp, &q), inner(&kq, &p));
            worst.compare(there.abs().max(1.0), &[there], &[back], || format!("symmetry, case {case}"));
            assert!(inner(&kp, &p) >= -1e-5, "case {case}: a hold feeds {} J", inner(&kp, &p));
            let mut blocks = vec![Mat3::IDENTITY; VERTICES as usize];
            coupling::add_diagonal(&holds, &mut blocks);
            for v in 0..VERTICES as usize {
                for axis in 0..3 {
                    let mut unit = vec![Vec3::ZERO; VERTICES as usize];
                    unit[v][axis] = 1.0;
                    let block = wide(blocks[v].col(axis) - Mat3::IDENTITY.col(axis));
                    worst.vectors(1.0, &[block], &[product(&unit)[v]], || format!("block {v}, case {case}"));
                }
            }
        }
        worst.check();
    }
}
