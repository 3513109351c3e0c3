//! A file in the format PLY.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    _ = readers::ply(bytes);
});
