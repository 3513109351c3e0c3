//! A file in the format OBJ.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    _ = readers::obj(bytes);
});
