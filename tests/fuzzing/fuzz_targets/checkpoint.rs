//! A checkpoint of a small scene, and a step from it.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    _ = readers::checkpoint(include_str!("../small.toml"), bytes);
});
