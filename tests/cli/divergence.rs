//! A run that diverges ends with exit code 3, says where, and keeps the frames before.

use crate::kit::{Outcome, Place, PointCache, obj};

/// Far beyond what an explicit step of 10 ms bears.
const STIFF: &str = "--set integrator.method=explicit-euler --set cloth.stretch.stiffness=1e5";

fn diverge(place: &Place, words: &str) -> Outcome {
    let run = "run tiny.toml --out out --preview none --export obj,pc2 --set frame_rate=50";
    place.muslin(&format!("{run} {STIFF} {words}")).expect(3)
}

#[test]
fn says_which_step_particle_and_term() {
    let place = Place::new();
    for precision in ["f32", "f64"] {
        let outcome = diverge(&place, &format!("--json --precision {precision}"));
        let summary = outcome.json();
        assert_eq!(summary["verdict"], "diverged");
        let failed = summary["steps"].as_u64().unwrap() + 1;
        assert!(outcome.stderr.contains(&format!("muslin: diverged in step {failed} at particle ")), "{outcome:?}");
        assert!(outcome.stderr.contains("pulled hardest by stretch"), "{outcome:?}");
        assert!(outcome.stderr.contains("integrator.step"), "no advice: {outcome:?}");
    }
}

#[test]
fn keeps_whole_frames() {
    let place = Place::new();
    let summary = diverge(&place, "--json").json();
    let count = summary["frames"].as_u64().unwrap() as usize;
    assert!(count >= 2 && summary["steps"].as_u64().unwrap() as usize / 2 + 1 == count, "{summary}");
    let cache = PointCache::parse(&place.read("out/cloth.pc2"));
    assert_eq!((cache.frames.len(), place.files("out/frames").len()), (count, count));
    for (k, frame) in cache.frames.iter().enumerate() {
        let (vertices, faces) = obj(&place.read(&format!("out/frames/frame_{k:05}.obj")));
        assert_eq!((&vertices, faces.len()), (frame, 36));
        assert!(vertices.as_flattened().iter().all(|x| x.is_finite()), "frame {k}");
    }
    assert_eq!(serde_json::from_slice::<serde_json::Value>(&place.read("out/summary.json")).unwrap(), summary);
    let leftovers: Vec<_> = place.files("out").into_iter().filter(|file| file.contains("partial")).collect();
    assert!(leftovers.is_empty(), "{leftovers:?}");
}

#[test]
fn a_person_reads_it_once() {
    let place = Place::new();
    let outcome = diverge(&place, "");
    assert_eq!(outcome.stderr.matches("diverged").count(), 1);
    assert_eq!(diverge(&place, "--quiet").stdout, "");
}

#[test]
fn an_implicit_method_bears_it() {
    let place = Place::new();
    place.run(&format!("tiny.toml {STIFF} --set integrator.method=backward-euler"));
}
