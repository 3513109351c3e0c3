//! One contact solved by itself, against the closed form of an inelastic impact with friction: along
//! n, with C the inverse masses, `N = max(0, missing) / sum W^2 n.C n`; across it what stops the
//! sliding, as far as the cone allows. Vertex with triangle and edge with edge, some of the axes
//! held.
//!
//! Run: `cargo test -p muslin-tests --test response constraint`; with `-- --nocapture` it prints the
//! worst error of every comparison beside its bound.

use harness::both_precisions;

/// Pairs of each kind.
const PAIRS: u32 = 2000;
/// Static and kinetic coefficients.
const FRICTION: [[f64; 2]; 3] = [[0.0, 0.0], [0.4, 0.4], [0.8, 0.3]];

both_precisions! {
    use super::{FRICTION, PAIRS};
    use glam::DVec3;
    use muslin::inverse_masses::InverseMasses;
    use muslin::narrow_phase::Contact;
    use muslin::real::{Real, Vec3, to_f64, vec3};
    use muslin::response::constraint::{self, Constraint};
    use muslin::response::friction::FrictionCoefficients;
    use muslin::response::impact::MOST_LEVER_RATIO;
    use harness::rng::Rng;
    use harness::worst::Worst;

    const VERTICES: usize = 6;

    fn wide(v: Vec3) -> DVec3 {
        to_f64(v).into()
    }

    fn column(v: &[Vec3]) -> Vec<DVec3> {
        v.iter().map(|&v| wide(v)).collect()
    }

    fn grip([sticks, slides]: [f64; 2]) -> FrictionCoefficients {
        FrictionCoefficients { at_rest: sticks as Real, kinetic: slides as Real }
    }

    /// Four of six vertices meet.
    struct Meeting {
        contact: Contact,
        target: Real,
        /// 1/kg.
        inverse_masses: [Real; VERTICES],
        held: [u8; VERTICES],
        moves: Vec<Vec3>,
    }

    impl Meeting {
        /// Each axis is held with probability `held`.
        fn random(rng: &mut Rng, held: f64) -> Self {
            let [a, b, c] = [0; 3].map(|_| rng.between(0.1, 1.0));
            let weights = if rng.bits().is_multiple_of(2) {
                [1.0, -a / (a + b + c), -b / (a + b + c), -c / (a + b + c)]
            } else {
                [1.0 - a, a, b - 1.0, -b]
            };
            let inverse_masses = std::array::from_fn(|_| (1.0 / rng.magnitude(1e-4, 1e-1)) as Real);
            let axes = std::array::from_fn(|_| {
                (0..3).map(|axis| u8::from(rng.between(0.0, 1.0) < held) << axis).sum()
            });
            Self {
                contact: Contact {
                    vertices: rng.pick(&[[0, 1, 2, 3], [5, 0, 3, 1], [2, 3, 4, 0]]),
                    weights: weights.map(|w| w as Real),
                    normal: vec3(rng.direction().into()),
                    gap: rng.between(-1e-3, 1e-2) as Real,
                },
                target: rng.between(0.0, 2e-3) as Real,
                inverse_masses,
                held: axes,
                moves: (0..VERTICES).map(|_| vec3(rng.cube(0.02).into())).collect(),
            }
        }

        fn mobility(&self) -> InverseMasses<'_> {
            InverseMasses { along_free: &self.inverse_masses, held: &self.held }
        }

        fn missing(&self, moves: &[Vec3]) -> f64 {
            f64::from(self.target) - f64::from(self.contact.gap) - self.relative(moves).dot(wide(self.contact.normal))
        }

        fn relative(&self, moves: &[Vec3]) -> DVec3 {
            self.parts().map(|(v, weight)| wide(moves[v]) * weight).sum()
        }

        fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
            self.contact.vertices.into_iter().zip(self.contact.weights).map(|(v, w)| (v as usize, f64::from(w)))
        }

        /// Impulses along and across the normal, and the displacements after.
        fn closed_form(&self, [at_rest, kinetic]: [f64; 2]) -> (f64, DVec3, Vec<DVec3>) {
            let normal = wide(self.contact.normal);
            let give = |v: usize, impulse: DVec3| impulse * wide(self.mobility().at(v));
            let inverse_mass = |along: DVec3| self.parts().map(|(v, w)| w * w * along.dot(give(v, along))).sum::<f64>();
            let mut moves = column(&self.moves);
            let pushed = match inverse_mass(normal) {
                along if along > 0.0 => self.missing(&self.moves).max(0.0) / along,
                _ => 0.0,
            };
            let sliding = self.relative(&self.moves) - normal * self.relative(&self.moves).dot(normal);
            let way = sliding.normalize_or_zero();
            let stops = match inverse_mass(way) {
                across if across > 0.0 => sliding.length() / across,
                _ => 0.0,
            };
            let rubbed = if stops <= at_rest * pushed { stops } else { (kinetic * pushed).min(stops) };
            for (v, weight) in self.parts() {
                moves[v] += give(v, normal * pushed - way * rubbed) * weight;
            }
            (pushed, -way * rubbed, moves)
        }

        /// Solves once and compares.
        fn check(&self, mu: [f64; 2], worst: &mut Worst) {
            let mut constraint = Constraint::new(self.contact, self.target, grip(mu), &self.mobility(), MOST_LEVER_RATIO);
            let mut moves = self.moves.clone();
            constraint::solve(&mut constraint, &self.mobility(), &mut moves);
            let (pushed, rubbed, want) = self.closed_form(mu);
            let place = || format!("friction {mu:?}, {:?}, target {}", self.contact, self.target);
            let scale = (self.missing(&self.moves).abs() + self.relative(&self.moves).length()) / f64::from(constraint.inverse_mass);
            worst.compare(scale, &[constraint.normal_impulse.into()], &[pushed], || format!("N, {}", place()));
            worst.vectors(scale, &[wide(constraint.friction_impulse)], &[rubbed], || format!("F, {}", place()));
            let furthest = want.iter().map(|v| v.length()).fold(0.0, f64::max);
            worst.vectors(furthest, &column(&moves), &want, || format!("displacements, {}", place()));
        }
    }

    /// The closed forms divide by what little an almost held pair gives way.
    #[test]
    fn a_contact_is_solved_as_the_closed_form_says() {
        for (held, what) in [(0.0, "free"), (0.3, "axes held")] {
            for mu in FRICTION {
                let mut worst = Worst::new(format!("{} {what}, friction {mu:?}", muslin::real::NAME), kit::bound(2e-5, 1e-13));
                let mut rng = Rng::new(31);
                for _ in 0..PAIRS {
                    let meeting = Meeting::random(&mut rng, held);
                    if Constraint::new(meeting.contact, 0.0, FrictionCoefficients::default(), &meeting.mobility(), MOST_LEVER_RATIO).inverse_mass == 0.0 {
                        continue;
                    }
                    // What decides between sticking and sliding must not be rounding.
                    meeting.check(mu, &mut worst);
                }
                worst.check();
            }
        }
    }

    /// All vertices free: the gap is what was asked, sliding only ever slower, nothing left to do.
    #[test]
    fn after_a_solve_the_gap_is_kept_and_a_second_one_finds_nothing_to_do() {
        let mut gaps = Worst::new(format!("{} gap beside that asked", muslin::real::NAME), kit::bound(1e-5, 1e-14));
        let mut again = Worst::new(format!("{} second solve beside the first", muslin::real::NAME), kit::bound(1e-5, 1e-14));
        let mut rng = Rng::new(32);
        let mut pushed = 0;
        for _ in 0..PAIRS {
            let meeting = Meeting::random(&mut rng, 0.0);
            let mut constraint = Constraint::new(meeting.contact, meeting.target, grip([0.4, 0.4]), &meeting.mobility(), MOST_LEVER_RATIO);
            let mut moves = meeting.moves.clone();
            let mut solve = |moves: &mut [Vec3]| {
                constraint::solve(&mut constraint, &meeting.mobility(), moves)
            };
            let (_, moved) = solve(&mut moves);
            if !moved {
                continue;
            }
            pushed += 1;
            let size = meeting.relative(&meeting.moves).length() + f64::from(meeting.contact.gap).abs();
            gaps.see(meeting.missing(&moves).abs() / size, || format!("{:?}: missing {}", meeting.contact, meeting.missing(&moves)));
            let first = moves.clone();
            solve(&mut moves);
            let apart = column(&first).iter().zip(column(&moves)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
            let furthest = column(&first).iter().map(|v| v.length()).fold(0.0, f64::max);
            again.see(apart / furthest, || format!("{:?}: moved by {apart} again", meeting.contact));
        }
        assert!(pushed > PAIRS / 4, "only {pushed} of {PAIRS} pairs pushed");
        gaps.check();
        again.check();
    }

    #[test]
    fn impulses_of_a_free_pair_are_equal_and_opposite() {
        let mut worst = Worst::new(format!("{} momentum made", muslin::real::NAME), kit::bound(2e-4, 1e-12));
        let mut rng = Rng::new(33);
        for _ in 0..PAIRS {
            let meeting = Meeting::random(&mut rng, 0.0);
            let mut constraint = Constraint::new(meeting.contact, meeting.target, grip([0.8, 0.3]), &meeting.mobility(), MOST_LEVER_RATIO);
            let mut moves = meeting.moves.clone();
            constraint::solve(&mut constraint, &meeting.mobility(), &mut moves);
            let gained = (0..VERTICES).map(|v| (wide(moves[v]) - wide(meeting.moves[v])) / f64::from(meeting.mobility().at(v).x));
            let sum: DVec3 = gained.sum();
            let impulse = wide(constraint.friction_impulse).length() + f64::from(constraint.normal_impulse);
            if impulse > 0.0 {
                // Displacements of heavy vertices round their small change.
                let rounding: f64 = (0..VERTICES).map(|v| wide(meeting.moves[v]).length() / f64::from(meeting.mobility().at(v).x)).sum();
                worst.see(sum.length() / (impulse + rounding), || format!("{:?}: {sum} of {impulse} kg m", meeting.contact));
            }
        }
        worst.check();
    }

    #[test]
    fn what_is_apart_or_held_is_not_touched() {
        let mut rng = Rng::new(34);
        let (mut apart, mut axes) = (0, 0);
        for k in 0..PAIRS {
            // Of every other pair everything is held.
            let held = if k % 2 == 0 { 0.5 } else { 1.0 };
            let meeting = Meeting::random(&mut rng, held);
            let mut constraint = Constraint::new(meeting.contact, meeting.target, grip([0.5, 0.5]), &meeting.mobility(), MOST_LEVER_RATIO);
            let mut moves = meeting.moves.clone();
            let (_, moved) = constraint::solve(&mut constraint, &meeting.mobility(), &mut moves);
            let what = format!("{} {:?}, target {}", muslin::real::NAME, meeting.contact, meeting.target);
            assert!(constraint.normal_impulse >= 0.0, "{what}: pulls by {} kg m", constraint.normal_impulse);
            if meeting.missing(&meeting.moves) < -1e-6 || held == 1.0 {
                apart += 1;
                assert!(!moved && moves == meeting.moves, "{what}: nothing to do, yet something moved");
                assert_eq!(constraint.normal_impulse, 0.0, "{what}: nothing to push, yet it pushes");
                assert_eq!(constraint.friction_impulse, Vec3::ZERO, "{what}: friction without pressure");
            }
            for (v, axis) in (0..VERTICES).flat_map(|v| [0, 1, 2].map(|axis| (v, axis))) {
                if meeting.mobility().at(v)[axis] == 0.0 || !meeting.contact.vertices.contains(&(v as u32)) {
                    axes += 1;
                    assert_eq!(moves[v][axis], meeting.moves[v][axis], "{what}: vertex {v} is held along axis {axis}");
                }
            }
        }
        assert!(apart > PAIRS / 2 && axes > PAIRS, "{apart} pairs apart and {axes} axes held were seen");
    }

    /// A contact never sucks: parted by others after it pushed, it takes back its impulse and no more.
    #[test]
    fn a_contact_that_is_parted_later_takes_its_impulse_back() {
        let mut worst = Worst::new(format!("{} displacements without the impulse", muslin::real::NAME), kit::bound(2e-4, 1e-12));
        let mut rng = Rng::new(35);
        let mut pushed = 0;
        for _ in 0..PAIRS {
            let meeting = Meeting::random(&mut rng, 0.1);
            let mut constraint = Constraint::new(meeting.contact, meeting.target, grip([0.4, 0.2]), &meeting.mobility(), MOST_LEVER_RATIO);
            let mut moves = meeting.moves.clone();
            constraint::solve(&mut constraint, &meeting.mobility(), &mut moves);
            if constraint.normal_impulse <= 0.0 {
                continue;
            }
            pushed += 1;
            let before = constraint;
            let part = |moves: &mut [Vec3]| {
                for (&v, weight) in meeting.contact.vertices.iter().zip(meeting.contact.weights) {
                    moves[v as usize] += meeting.contact.normal * weight;
                }
            };
            part(&mut moves);
            let furthest = column(&moves).iter().map(|v| v.length()).fold(0.0, f64::max);
            constraint::solve(&mut constraint, &meeting.mobility(), &mut moves);
            let what = format!("{} {:?}", muslin::real::NAME, before);
            assert_eq!(constraint.normal_impulse, 0.0, "{what}: still pushes what is parted");
            assert_eq!(constraint.friction_impulse, Vec3::ZERO, "{what}: still rubs what is parted");
            let mut want = meeting.moves.clone();
            part(&mut want);
            worst.vectors(furthest, &column(&moves), &column(&want), || what.clone());
        }
        assert!(pushed > PAIRS / 4, "only {pushed} of {PAIRS} pairs pushed");
        worst.check();
    }
}
