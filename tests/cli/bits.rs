//! The state hash that a run prints does not depend on threads.
//!
//! It does not depend on the optimiser either: the stored hashes in `tests/goldens.txt` check
//! that every build profile gives the same hash.

use crate::kit::{Place, TINY};

#[test]
fn threads_do_not_change_the_bits() {
    let place = Place::new();
    // 64x64 cells, so that every loop over elements is shared among threads.
    let wind = "\n[drag]\nlinear = 0.1\nwind = { velocity = [10, 20, 30], normal = 0.5, tangential = 0.1 }\n";
    let soft = TINY.replace("100.0", "2.0").replace("50.0", "1.0").replace("frame_rate = 20", "frame_rate = 250");
    place.write("sheet.toml", soft.replace("cells = [4, 4]", "cells = [64, 64]") + wind);
    for (precision, method) in [("f32", "backward-euler"), ("f32", "rk4"), ("f64", "bdf2"), ("f64", "symplectic-euler")]
    {
        let run = |threads: u32| {
            let summary = place.run(&format!(
                "sheet.toml --duration 0.008 --threads {threads} --precision {precision} \
                 --set integrator.method={method} --set integrator.step=0.0004"
            ));
            assert_eq!(summary["threads"], threads);
            (summary["state_hash"].clone(), place.read("out/cloth.pc2"))
        };
        let (hash, cache) = run(1);
        for threads in [2, 3, 7] {
            let (found, frames) = run(threads);
            assert_eq!(found, hash, "{precision} {method}: {threads} threads, then one");
            assert!(frames == cache, "{precision} {method} on {threads} threads: the frames differ");
        }
    }
}
