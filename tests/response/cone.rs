//! Friction stays on its cone: the law alone, and every constraint of a solved pile.
//!
//! Run: `cargo test -p muslin-tests --test response cone`.

use harness::both_precisions;

/// Three sheets thrown onto one another and a ball.
const PILE: &str = r#"
    name = "pile"
    duration = 1.0
    [[cloth]]
    grid = { size = [0.1, 0.1], cells = [8, 8] }
    density = 0.2
    [[cloth]]
    grid = { size = [0.1, 0.1], cells = [7, 7] }
    density = 0.3
    position = [0.01, 0.002, 0.0]
    [[cloth]]
    grid = { size = [0.1, 0.1], cells = [6, 6], pattern = "diagonal" }
    density = 0.1
    position = [0.0, 0.004, 0.01]
    [contact]
    thickness = 0.003
    friction = { static = 0.6, kinetic = 0.4 }
    [[collider]]
    shape = "sphere"
    center = [0, -0.1, 0]
    radius = 0.097
    friction = 0.2
"#;

both_precisions! {
    use super::PILE;
    use muslin::contact::{ContactScratchColumns, Prediction};
    use muslin::dispatch::Serial;
    use muslin::real::{Real, Vec3, to_f64, vec3};
    use muslin::response::friction::Law;
    use muslin::response::{self, Settings, ContactStatistics};
    use muslin::detection;
    use glam::DVec3;
    use harness::rng::Rng;

    fn random_law(rng: &mut Rng) -> Law {
        let kinetic = rng.between(0.0, 1.0) as Real;
        let at_rest = kinetic + rng.between(0.0, 0.5) as Real;
        let stribeck = rng.pick(&[0.0, 0.2, 2.0]);
        Law { at_rest, kinetic, stribeck, viscous: rng.pick(&[0.0, 0.3]) }
    }

    #[test]
    fn the_coefficient_is_that_of_the_formula() {
        let mut rng = Rng::new(3);
        for _ in 0..1000 {
            let (law, speed) = (random_law(&mut rng), rng.magnitude(1e-4, 10.0));
            let [rest, kinetic, limit, viscous] =
                [law.at_rest, law.kinetic, law.stribeck, law.viscous].map(f64::from);
            let decayed = if limit > 0.0 { (-(speed / limit).powi(2)).exp() } else { 0.0 };
            let want = kinetic + (rest - kinetic) * decayed + viscous * speed;
            let got = f64::from(law.sliding(speed as Real));
            assert!((got - want).abs() <= kit::bound(4e-6, 1e-14) * want, "{law:?} at {speed} m/s: {got}, expected {want}");
        }
    }

    #[test]
    fn an_impulse_sticks_within_the_static_cone_and_else_slides_without_turning_back() {
        let mut rng = Rng::new(4);
        for _ in 0..10_000 {
            let (law, speed) = (random_law(&mut rng), rng.magnitude(1e-3, 5.0));
            let (wanted, normal) = (rng.direction() * rng.magnitude(1e-3, 10.0), rng.magnitude(1e-3, 10.0));
            let got = DVec3::from(to_f64(law.coefficients(speed as Real).limit(vec3(wanted.into()), normal as Real)));
            let cone = f64::from(law.at_rest) * normal;
            let slid = f64::from(law.sliding(speed as Real)) * normal;
            let want = if wanted.length() <= cone { wanted.length() } else { slid.min(wanted.length()) };
            let what = format!("{law:?}, wanted {wanted}, normal {normal}, speed {speed}");
            let digits = kit::bound(1e-5, 1e-14);
            assert!((got.length() - want).abs() <= digits * want, "{what}: {}, expected {want}", got.length());
            assert!(got.cross(wanted).length() <= digits * want * wanted.length(), "{what}: turned aside to {got}");
        }
    }

    /// The largest friction over normal impulse of each law.
    fn steepest(seed: u64) -> [f64; 2] {
        let built = kit::build(PILE);
        let touching = built.contact.as_ref().expect("the pile touches");
        let model = touching.view();
        let mut rng = Rng::new(seed);
        let from = &built.particles.positions;
        let to: Vec<Vec3> = from.iter().map(|&x| x + vec3((rng.cube(0.002) - DVec3::Y * 0.002).into())).collect();
        let mut columns = ContactScratchColumns::build(&model, 2_000_000);
        let mut scratch = columns.view();
        detection::place(&model, [0.0, 0.001], from, &to, &mut scratch);
        detection::sweep(&model, 0.01, &mut scratch);
        detection::detect(&model, &mut scratch, &Serial).expect("nothing stops the search");
        let displacements: Vec<_> = to.iter().zip(from).map(|(to, from)| *to - *from).collect();
        let prediction = Prediction { positions: &to, displacements: &displacements, low: &[] };
        let settings = Settings { step: 0.001, hold: false };
        response::respond(&model, &prediction, &mut scratch, settings, &mut ContactStatistics::default(), &Serial).expect("there is room");
        let mut steepest = [0.0_f64; 2];
        for constraint in scratch.constraints.iter() {
            let [normal, across] =
                [f64::from(constraint.normal_impulse), DVec3::from(to_f64(constraint.friction_impulse)).length()];
            assert!(normal >= 0.0, "seed {seed}: a contact pulls by {normal} kg m");
            assert!(normal > 0.0 || across == 0.0, "seed {seed}: {across} kg m of friction without pressure");
            if normal > 0.0 {
                let law = usize::from(constraint.coefficients.at_rest < 0.4);
                steepest[law] = steepest[law].max(across / normal);
            }
        }
        steepest
    }

    #[test]
    fn no_constraint_of_a_pile_leaves_its_cone() {
        let mut worst = [0.0_f64; 2];
        for seed in 0..20 {
            let steepest = steepest(seed);
            worst = [0, 1].map(|law| worst[law].max(steepest[law]));
        }
        println!("{}: friction over normal impulse at most {worst:.6?}, cones 0.6 and 0.2", muslin::real::NAME);
        let room = 1.0 + kit::bound(1e-5, 1e-12);
        assert!(worst[0] > 0.3 && worst[1] > 0.1, "the pile hardly rubs: {worst:?}");
        assert!(worst[0] <= 0.6 * room && worst[1] <= 0.2 * room, "friction over normal impulse {worst:?}");
    }
}
