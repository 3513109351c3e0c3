//! A NaN or an infinity in one vertex is reported as divergence; nothing panics or hangs.

use harness::both_precisions;

both_precisions! {
    use harness::torture::SCENES;
    use muslin::real::{Real, Vec3};

    #[test]
    fn what_is_no_number_diverges() {
        for name in ["folded", "capsules"] {
            let text = (SCENES.iter().find(|scene| scene.name == name).expect("in the table").text)();
            for method in ["symplectic-euler", "backward-euler", "bdf2"] {
                let text = text.replace("[integrator]", &format!("[integrator]\nmethod = \"{method}\""));
                for wrong in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, 0.9 * Real::MAX] {
                    for velocity in [false, true] {
                        let mut sim = kit::simulation(&text, &[]);
                        let (x, v) = sim.state_mut();
                        let column = if velocity { v } else { x };
                        column[17] = Vec3::new(0.0, wrong, 0.0);
                        let ended = (0..3).try_for_each(|_| sim.take_step());
                        assert!(ended.is_err(), "{name}, {method}: {wrong} in vertex 17 went on for 3 steps");
                    }
                }
            }
        }
    }
}
