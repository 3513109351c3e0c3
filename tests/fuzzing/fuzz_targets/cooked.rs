//! A cooked scene whose checksum is right: it is opened and takes two steps.
#![no_main]

use harness::aligned::Aligned;
use harness::cooked::mend;
use muslin_core::cooked::{Cloth, required_bytes};
use muslin_core::dispatch::{Limited, Serial};

/// Working memory of a block that is opened here, bytes.
const MOST: usize = 1 << 22;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut block = Aligned::new(bytes);
    mend(block.all());
    let Ok(needed @ ..=MOST) = required_bytes(block.all()) else { return };
    let mut memory = Aligned::filled(needed, 0xA5);
    let Ok(mut cloth) = Cloth::open(block.all(), memory.all()) else { return };
    for _ in 0..2 {
        _ = cloth.step(&Limited::new(&Serial, 500, 100_000));
    }
});
