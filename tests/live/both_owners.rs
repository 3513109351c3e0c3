//! Any sequence of calls does the same to a simulation and to the cooked cloth of its scene.

use harness::live_calls::{double, single};
use harness::rng::Rng;

/// The calls of 8 seeds.
fn all(play: impl Fn(&mut Rng<'_>, u32, u32) -> usize) {
    let done: usize = (0..8).map(|seed| play(&mut Rng::new(seed), 12, 30)).sum();
    assert!(done > 100, "only {done} calls were carried out");
}

#[test]
fn any_calls_do_the_same_to_both_owners() {
    all(single::play);
}

#[test]
fn any_calls_do_the_same_to_both_owners_in_f64() {
    all(double::play);
}
