//! A run that diverges ends with exit code 3, reports where it diverged and keeps the frames before.

use crate::kit::{Outcome, Place, PointCache, TINY, obj};

/// A stiffness far beyond the stability limit of an explicit step of 10 ms: soon an edge is too long for cloth.
const STIFF: &str = "--set integrator.method=explicit-euler --set cloth.stretch.stiffness=1e5";

/// A stiffness with which even double precision overflows before the first frame ends.
const OVERFLOW: &str = "--set cloth.stretch.stiffness=1e30 --set duration=0.5 --set frame_rate=2";

fn diverge(place: &Place, words: &str) -> Outcome {
    let run = "run tiny.toml --out out --preview none --export obj,pc2 --set frame_rate=50";
    place.muslin(&format!("{run} {STIFF} {words}")).expect(3)
}

#[test]
fn says_which_step_particle_and_term() {
    let place = Place::new();
    for precision in ["f32", "f64"] {
        let outcome = diverge(&place, &format!("--json --precision {precision} {OVERFLOW}"));
        let summary = outcome.json();
        assert_eq!(summary["verdict"], "diverged");
        let failed = summary["steps"].as_u64().unwrap() + 1;
        assert!(outcome.stderr.contains(&format!("muslin: diverged in step {failed} at vertex ")), "{outcome:?}");
        assert!(outcome.stderr.contains("pulled hardest by stretch"), "{outcome:?}");
        assert!(outcome.stderr.contains("integrator.step"), "no advice: {outcome:?}");
        assert!(outcome.stderr.contains(", or an implicit method"), "no advice: {outcome:?}");
    }
}

#[test]
fn an_edge_too_long_for_cloth_is_a_divergence() {
    let place = Place::new();
    for precision in ["f32", "f64"] {
        let outcome = diverge(&place, &format!("--json --precision {precision}"));
        let summary = outcome.json();
        assert_eq!(summary["verdict"], "diverged");
        let failed = summary["steps"].as_u64().unwrap();
        assert!(failed.is_multiple_of(2), "frames end by two steps: {summary}");
        let taken = failed as f64 * summary["step_s"].as_f64().unwrap();
        assert!((summary["simulated_s"].as_f64().unwrap() - taken).abs() < 1e-6 * taken, "{summary}");
        let said = format!("muslin: diverged in step {failed}: an edge is ");
        assert!(outcome.stderr.contains(&said) && outcome.stderr.contains("integrator.step"), "{outcome:?}");
        let [frames, end] = [&summary["stretch"]["max_of_all_frames"], &summary["stretch"]["max"]];
        assert!(end.as_f64().unwrap() > 10.0 && frames == end, "{summary}");
        assert!(!outcome.stderr.contains("more than cloth does"), "one message is enough: {outcome:?}");
    }
}

/// All positions stay finite and bounded here, but the cloth oscillates violently without end.
#[test]
fn an_implicit_method_that_flings_cloth_about_is_a_divergence() {
    let place = Place::new();
    let step =
        "integrator.step=0.016666666666666666 --set integrator.error=0 --set integrator.method=implicit-midpoint";
    let words = format!("run skirt --set cloth.tube.cells=[60,14] --set {step} --duration 2 --preview none --json");
    let summaries = [60, 10, 1].map(|rate| {
        let outcome = place.muslin(&format!("{words} --set frame_rate={rate}")).expect(3);
        let summary = outcome.json();
        assert_eq!(summary["verdict"], "diverged");
        let longest = summary["stretch"]["max_of_all_frames"].as_f64().unwrap();
        assert!((10.0..100.0).contains(&longest), "{summary}");
        let said = format!("an edge is {longest:.0} times as long as at rest");
        assert!(outcome.stderr.contains(&said), "{said} is not in {}", outcome.stderr);
        assert!(!outcome.stderr.contains("implicit method"), "it is one already: {}", outcome.stderr);
        summary
    });
    let [steps, hash] = ["steps", "state_hash"].map(|key| summaries.each_ref().map(|summary| &summary[key]));
    assert!(steps.iter().all(|&same| same == steps[0]), "frames decide when it diverges: {steps:?}");
    assert!(hash.iter().all(|&same| same == hash[0]), "frames decide how it diverges: {hash:?}");
}

/// Several times the rest length is valid: rubber breaks at eight times its rest length.
#[test]
fn cloth_that_its_weight_draws_to_several_times_its_length_is_fine() {
    let place = Place::new();
    let soft = "--set cloth.stretch.stiffness=0.25 --set cloth.stretch.damping=0.2 --set cloth.shear.stiffness=0.25";
    let summary = place.run(&format!("tiny.toml {soft} --duration 1"));
    let longest = summary["stretch"]["max_of_all_frames"].as_f64().unwrap();
    assert!((3.0..10.0).contains(&longest), "{summary}");
    assert_eq!(summary["verdict"], "ok");
}

/// A start state that is already stretched beyond the limit is not a divergence of the method.
#[test]
fn a_start_drawn_out_a_thousandfold_runs() {
    let place = Place::new();
    let square = |side: f64| format!("v 0 0 0\nv {side} 0 0\nv {side} 0 {side}\nv 0 0 {side}\nf 1 2 3\nf 1 3 4\n");
    place.write("rest.obj", square(0.1));
    place.write("drawn.obj", square(100.0));
    let scene =
        TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", "mesh = \"rest.obj\"\nstate = \"drawn.obj\"");
    let scene = scene.replace("corners = [0, 1]", "vertices = [0]");
    place.write("drawn.toml", &scene);
    let words = "--json --preview none --set integrator.newton=20 --precision f64";
    let summary = place.muslin(&format!("run drawn.toml {words}")).expect(0).json();
    assert!(summary["stretch"]["max_of_all_frames"].as_f64().unwrap() > 999.0, "{summary}");
    assert!(summary["stretch"]["max"].as_f64().unwrap() < 100.0, "it is not drawn back: {summary}");
    // The run also succeeds if a moving pin first stretches the cloth slightly farther.
    place.write(
        "drawn.toml",
        scene.replace("vertices = [0] }", "vertices = [0] }\nmotion = { keys = [[0.0, 0, 0, 0], [0.1, -9, 0, 0]] }"),
    );
    let soft = "--set cloth.stretch.stiffness=0.001 --set cloth.shear.stiffness=0.001";
    let farther = place.muslin(&format!("run drawn.toml {words} {soft}")).expect(0).json();
    let [before, after] = [&summary, &farther].map(|run| run["stretch"]["max_of_all_frames"].as_f64().unwrap());
    assert!(after > 1.01 * before, "drawn {after}, which is not farther than {before}");
}

/// Nothing moves this sheet but the rounding of its positions.
#[test]
fn energy_by_rounding_is_no_reason_for_doubt() {
    let place = Place::new();
    let at_rest = "gravity=[0,0,0] --set cloth.rotation=[37,20,10] --set cloth.position=[0.37,7.1,3.3]";
    let stiff = "cloth.stretch.stiffness=1e5 --set integrator.method=symplectic-euler --set integrator.step=1e-6";
    let summary = place.run(&format!("tiny.toml --set {at_rest} --set {stiff} --duration 0.002"));
    let [appeared, moved] = ["appeared", "moved"].map(|key| summary["energy_balance"][key].as_f64().unwrap());
    assert!(appeared > 0.5 * moved, "rounding no longer shows: {summary}");
    assert_eq!((&summary["verdict"], &summary["doubt"]), (&"ok".into(), &serde_json::Value::Null), "{summary}");
}

#[test]
fn keeps_whole_frames() {
    let place = Place::new();
    let summary = diverge(&place, "--json").json();
    let count = summary["frames"].as_u64().unwrap() as usize;
    // The step that diverges counts as a step, but its frame is not written.
    assert!(count >= 2 && summary["steps"].as_u64().unwrap() as usize / 2 == count, "{summary}");
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
    let told = diverge(&place, "").stdout;
    assert!(told.ends_with("\nverdict diverged\n"), "{told}");
}

#[test]
fn an_implicit_method_bears_it() {
    let place = Place::new();
    place.run(&format!("tiny.toml {STIFF} --set integrator.method=backward-euler"));
}
