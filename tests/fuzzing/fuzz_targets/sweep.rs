//! A sweep of built-in scenes.
#![no_main]

use muslin_cli::readers;

libfuzzer_sys::fuzz_target!(|text: &str| {
    // A path could name any file of this machine.
    if !text.contains(['/', '\\']) {
        _ = readers::sweep(text);
    }
});
