//! A sequence of live calls, to a simulation and to the cooked cloth of its scene: both do the same. A damaged snapshot of
//! the cloth is refused, or steps from it end.
#![no_main]

use harness::live_calls::single;
use harness::rng::Rng;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let steps = (bytes.len() / 8).min(20) as u32;
    single::play(&mut Rng::of(bytes), 3, steps);
});
