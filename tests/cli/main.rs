//! Tests the command line as scripts see it: commands, options, exit codes, messages and files, as
//! the interface contract lists them. Run with `cargo test -p muslin-cli --test cli`.
//!
//! It has caught: step counts that overflowed, grids that were allocated until memory ran out,
//! `--threads 0`, a scene name whose path left `out/`, point caches cut off by a resumed run,
//! hash chains that differed after an interrupt before the first step, panics on a closed stderr.

mod bad_mesh;
mod bad_scene;
mod bad_usage;
mod bits;
mod built_in;
mod chart;
mod choose;
mod contact;
mod cook;
mod damage;
#[path = "../../host-cli/src/preview/decode.rs"]
mod decode;
mod detect;
mod divergence;
mod folders;
mod full_disk;
mod gpu;
mod hindsight;
mod inputs;
mod interrupt;
mod interrupt_study;
mod kit;
mod limit;
#[cfg(unix)]
mod manual_commands;
mod manual_scene;
mod memory;
mod needs;
mod options;
mod outputs;
mod picture;
mod rest;
mod resume;
mod series;
mod stability;
mod streams;
mod sweep;
mod sweep_files;
mod sweep_shared;
mod validate;
mod verdict;
