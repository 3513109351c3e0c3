//! A file in the format PC2.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    _ = readers::pc2(bytes);
});
