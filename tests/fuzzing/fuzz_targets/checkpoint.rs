//! A checkpoint of the built-in scene `ball`, and a step from it.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    _ = readers::checkpoint("ball", bytes);
});
