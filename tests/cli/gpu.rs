//! `--backend gpu` and `muslin devices`: the GPU counts equal the CPU counts, and the message without an adapter.

use serde_json::Value;

use crate::detect::{counts, detect, soup};
use crate::kit::{Place, PointCache};

/// Whether there is a graphics adapter; with `MUSLIN_REQUIRE_GPU=1` a missing adapter fails the test.
fn is_there(place: &Place) -> bool {
    let devices = place.muslin("devices --json").expect(0).json();
    let any = !devices["adapters"].as_array().unwrap().is_empty();
    if !any {
        assert_ne!(std::env::var("MUSLIN_REQUIRE_GPU").as_deref(), Ok("1"), "{devices}");
        eprintln!("skipped: a driver is installed, but there is no graphics adapter");
    }
    any
}

/// Asserts that the report has the times of the detection stages, and `last` at its end. Does nothing if an adapter has
/// no timestamps.
fn assert_times(place: &Place, stages: &Value, last: &str) {
    let devices = place.muslin("devices --json").expect(0).json();
    if devices["adapters"].as_array().unwrap().iter().any(|adapter| adapter["timestamps"] == false) {
        return;
    }
    let names: Vec<_> = stages.as_array().unwrap().iter().map(|stage| stage["stage"].as_str().unwrap()).collect();
    let expected = ["broad_phase/bounds", "broad_phase/sort", "broad_phase/pairs"];
    assert!(expected.iter().all(|name| names.contains(name)), "{names:?}");
    assert!(names.last().is_some_and(|name| name.starts_with(last)), "{names:?} do not end with {last}");
    let total: f64 = stages.as_array().unwrap().iter().map(|stage| stage["ms"].as_f64().unwrap()).sum();
    assert!(total > 0.0, "{stages}");
}

#[test]
#[ignore = "takes a graphics driver"]
fn it_counts_what_the_processor_counts() {
    let place = Place::new();
    if !is_there(&place) {
        return;
    }
    place.write("soup.obj", soup(300));
    let lines = soup(300);
    let moved = lines.lines().map(|line| match line.strip_prefix("v ") {
        Some(place) => {
            let [x, y, z] = [0, 1, 2].map(|k| place.split(' ').nth(k).unwrap().parse::<f64>().unwrap());
            format!("v {} {y} {}\n", 0.9 * x + 0.1 * y, z - 0.2 * x)
        }
        None => format!("{line}\n"),
    });
    place.write("moved.obj", moved.collect::<String>());
    for words in ["--thickness 0", "--thickness 0.05", "--next moved.obj --thickness 0.01 --stage intersections"] {
        let of = |backend: &str| detect(&place, &format!("soup.obj {words} --backend {backend}"));
        let [cpu, gpu] = ["cpu", "gpu"].map(of);
        for key in ["candidates", "contacts"] {
            assert_eq!(counts(&cpu, key), counts(&gpu, key), "{words}: {key}");
        }
        // Times of impact are never late on either backend. The GPU doubles the reserve for rounding, so it may find
        // a few more impacts.
        for (cpu, gpu) in counts(&cpu, "ccd").into_iter().zip(counts(&gpu, "ccd")) {
            assert_eq!(cpu.is_some(), gpu.is_some());
            let (cpu, gpu) = (cpu.unwrap_or(0), gpu.unwrap_or(0));
            assert!(cpu <= gpu && gpu <= cpu + cpu / 100 + 2, "{words}: {gpu} meet, on the processor {cpu}");
        }
        assert_eq!(cpu["intersections"], gpu["intersections"]);
        assert!(gpu["adapter"].is_string() && gpu["ms"]["gpu"].is_f64() && gpu["ms"]["candidates"].is_null(), "{gpu}");
        assert!(cpu["ms"]["gpu_stages"].is_null(), "{cpu}");
        assert_times(&place, &gpu["ms"]["gpu_stages"], "narrow_phase");
    }
}

/// A sheet that falls on a ball and folds over it.
const DROP: &str = r#"name = "drop"
duration = 0.4
frame_rate = 50
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [12, 12] }
position = [0.0, 0.17, 0.0]
density = 0.2
stretch = { model = "spring", stiffness = 50.0 }

[[collider]]
shape = "sphere"
center = [0.0, 0.0, 0.0]
radius = 0.12

[contact]
thickness = 0.004

[integrator]
step = 0.005
"#;

#[test]
#[ignore = "takes a graphics driver"]
fn a_run_is_repeatable_and_nothing_passes_through() {
    let place = Place::new();
    if !is_there(&place) {
        return;
    }
    place.write("drop.toml", DROP);
    let of = |words: &str| {
        let run =
            place.muslin(&format!("run drop.toml --audit --preview none --export pc2 --json {words}")).expect(0).json();
        (run, PointCache::parse(&place.read("out/drop/cloth.pc2")).frames)
    };
    let [(once, frames), (again, _), (cpu, expected)] = ["--backend gpu", "--backend gpu", "--backend cpu"].map(of);
    assert_eq!(once["state_hash"], again["state_hash"], "twice the same on one adapter");
    assert!(once["backend"] == "gpu" && once["adapter"].is_string() && cpu["adapter"].is_null(), "{once}");
    assert!(cpu["gpu_stage_ms"].is_null(), "{cpu}");
    // A step needs candidates only.
    assert_times(&place, &once["gpu_stage_ms"], "shared/candidates");
    let contacts = |run: &Value| run["contacts"]["proximity"].as_u64().unwrap_or_else(|| panic!("{run}"));
    println!("{} contacts, on the processor {}", contacts(&once), contacts(&cpu));
    assert!(contacts(&once) > 100, "{once}");
    // The processor measures the device's candidates, and sorts the contacts.
    assert!(frames == expected, "the frames are the same, bit for bit");
    assert_eq!(once["state_hash"], cpu["state_hash"], "as on the processor");
}

#[test]
#[ignore = "takes a graphics driver"]
fn a_person_gets_a_table_of_it() {
    let place = Place::new();
    if is_there(&place) {
        place.write("soup.obj", soup(30));
        let table = place.muslin("detect soup.obj --thickness 0.05 --backend gpu").expect(0).stdout;
        assert!(table.contains("all on the GPU") && !table.contains("thread(s)"), "{table}");
        let devices = place.muslin("devices").expect(0).stdout;
        assert!(devices.starts_with("cpu  ") && devices.contains("\ngpu  "), "{devices}");
    }
}

#[test]
fn the_other_methods_are_refused() {
    let place = Place::new();
    place.write("soup.obj", soup(3));
    let refused = place.muslin("detect soup.obj --thickness 0 --backend gpu --method brute").expect(2);
    assert!(refused.stderr.contains("only has the grid"), "{}", refused.stderr);
}

/// Environment variables name the driver files; a path that does not exist leaves no adapter.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_it_says_what_to_install() {
    let place = Place::new();
    place.write("soup.obj", soup(3));
    let without = |words: &str| {
        let mut command = place.command(words);
        command.env("VK_DRIVER_FILES", "/none").env("VK_ICD_FILENAMES", "/none");
        place.finish(command)
    };
    let failed = without("detect soup.obj --thickness 0 --backend gpu").expect(4);
    for words in ["no adapter", "mesa-vulkan-drivers", "--backend cpu"] {
        assert!(failed.stderr.contains(words), "{words:?} is not in {}", failed.stderr);
    }
    let devices = without("devices --json").expect(0).json();
    assert_eq!(devices["adapters"], Value::Array(Vec::new()));
    assert!(without("devices").expect(0).stdout.contains("mesa-vulkan-drivers"));
}
