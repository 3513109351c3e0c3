//! Any sequence of calls does the same to a simulation and to the cooked cloth of its scene.

use harness::live_calls::{double, single};
use harness::rng::Rng;

/// The calls of 12 seeds.
fn all(play: impl Fn(&mut Rng<'_>, u32) -> usize) {
    let done: usize = (0..12).map(|seed| play(&mut Rng::new(seed), 40)).sum();
    assert!(done > 200, "only {done} calls were carried out");
}

#[test]
fn any_calls_do_the_same_to_both_owners() {
    all(single::play);
}

#[test]
fn any_calls_do_the_same_to_both_owners_in_f64() {
    all(double::play);
}
