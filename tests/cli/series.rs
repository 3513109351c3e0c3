//! `run --series`: the rows of a series, and series that a resumed run continues.

use std::fs;

use crate::kit::{Place, TINY, obj};

/// The columns of a series by name.
struct Series {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Series {
    fn read(place: &Place, name: &str) -> Self {
        let text = String::from_utf8(place.read(name)).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let rows = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect());
        Self { names, rows: rows.collect() }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let column = self.names.iter().position(|known| known == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[column]).collect()
    }
}

/// The sheet of TINY with damping, held by two groups of pins; one lifts.
fn scene() -> String {
    let motion = "motion = { keys = [[0.0, 0, 0, 0], [0.2, 0, 0.05, 0]] }";
    let two = "corners = [0] }\n\n[[cloth.pin]]\nselect = { corners = [1] }\n";
    let soft =
        TINY.replace("100.0", "20.0\ndamping = 0.001").replace("50.0", "20.0").replace("step = 0.01", "step = 0.002");
    soft.replace("corners = [0, 1] }", &format!("{two}{motion}"))
}

#[test]
fn a_row_for_each_frame_balances() {
    let place = Place::new();
    place.write("scene.toml", scene());
    for precision in ["f32", "f64"] {
        let plain = place.run(&format!("scene.toml --precision {precision}"));
        let summary = place.run(&format!("scene.toml --precision {precision} --series all.csv"));
        assert_eq!(plain["state_hash"], summary["state_hash"], "measuring changes the run");
        let series = Series::read(&place, "out/all.csv");
        assert_eq!(series.column("frame"), [0.0, 1.0, 2.0, 3.0, 4.0]);
        for (frame, row) in series.rows.iter().enumerate() {
            assert_eq!(row.len(), series.names.len());
            assert!(row.iter().filter(|x| x.is_nan()).count() == if frame == 0 { 15 } else { 0 }, "{row:?}");
        }
        let last = |name: &str| *series.column(name).last().unwrap();
        for term in ["kinetic", "stretch", "gravity"] {
            assert_eq!(last(&format!("{term}_J")), summary["energy"][term].as_f64().unwrap(), "{term}");
        }
        assert_eq!(last("work_pins_J"), summary["energy_balance"]["pins"].as_f64().unwrap());
        assert!(last("work_damping_J") < 0.0 && last("work_contacts_J") == 0.0);
        // Both pins and the weight change the momentum, in steps of 2 ms.
        let (weight, momentum) = (9.81 * summary["mass_kg"].as_f64().unwrap(), series.column("momentum_y_kg_m_per_s"));
        let pins = ["pin_0_0_force_y_N", "pin_0_1_force_y_N"].map(|name| series.column(name));
        for frame in 1..5 {
            let change = (momentum[frame] - momentum[frame - 1]) / 0.05;
            let left = change - pins[0][frame] - pins[1][frame] + weight;
            assert!(left.abs() < 0.002 / 0.05 * weight, "frame {frame}: {left} N of {weight} N");
        }
    }
}

/// Gravity that swings works on the cloth, wherever heights count from, and nothing appears.
#[test]
fn gravity_that_changes_has_its_column() {
    let place = Place::new();
    let swings = "gravity = { keys = [[0.0, 0, -9.81, 0], [0.1, 0, 9.81, 0], [0.2, 0, -9.81, 0]] }";
    let high = TINY.replace("gravity = [0.0, -9.81, 0.0]", swings).replace("[0.0, 1.0, 0.0]", "[0.0, 100.0, 0.0]");
    place.write("scene.toml", high);
    for method in ["backward-euler", "implicit-midpoint"] {
        let words = format!("--precision f64 --set integrator.method={method} --set integrator.step=0.0005");
        let summary = place.run(&format!("scene.toml {words} --series all.csv"));
        let series = Series::read(&place, "out/all.csv");
        let last = |name: &str| *series.column(name).last().unwrap();
        let [work, appeared, moved] =
            ["gravity", "appeared", "moved"].map(|key| summary["energy_balance"][key].as_f64().unwrap());
        let mass = summary["mass_kg"].as_f64().unwrap();
        assert_eq!(summary["verdict"], "ok", "{method}");
        // The summary is parsed with an error of a last digit.
        let column = last("work_gravity_J");
        assert!((column / work - 1.0).abs() < 1e-12, "{method}: {column} J in the column, {work} J in the summary");
        // Halfway, gravity has turned round at a height of 100 m.
        let turned = series.column("work_gravity_J")[2] / (-2.0 * 9.81 * 100.0 * mass);
        assert!((turned - 1.0).abs() < 0.01, "{method}: {turned}");
        assert!(moved < 9.81 * mass, "{method}: {moved} J in motion, which is more than a fall of a metre");
        assert!(appeared < 1e-3 * moved, "{method}: {appeared} of {moved} J appeared");
        let by_method = last("method_J") / moved;
        let as_expected = if method == "backward-euler" { by_method < 0.0 } else { by_method.abs() < 1e-4 };
        assert!(as_expected, "{method} added {by_method} of the energy that moved");
    }
}

/// At rest, the moment of a clamp is that of the weight with the opposite sign.
#[test]
fn the_moment_of_a_clamp_carries_the_weight() {
    let place = Place::new();
    let clamp = "box = [[-0.2, 0.9, -0.2], [-0.05, 1.1, 0.2]] }";
    let stiff = TINY.replace("1e-5", "1e-3").replace("cells = [4, 4]", "cells = [8, 8]");
    place.write("scene.toml", format!("drag = {{ linear = 8.0 }}\n{}", stiff.replace("corners = [0, 1] }", clamp)));
    let words = "--duration 6 --precision f64 --series all.csv --export obj --set integrator.step=0.005";
    let summary = place.run(&format!("scene.toml {words}"));
    let series = Series::read(&place, "out/all.csv");
    let last = |name: &str| *series.column(name).last().unwrap();
    let weight = 9.81 * summary["mass_kg"].as_f64().unwrap();
    let force = last("pin_0_0_force_y_N");
    assert!((force / weight - 1.0).abs() < 1e-3, "{force} N of {weight} N");

    let [first, end] = [0, 120].map(|frame| obj(&place.read(&format!("out/frames/frame_{frame:05}.obj"))));
    let mut moment = 0.0;
    for face in &first.1 {
        let [a, b, c] = face.map(|v| first.0[v as usize - 1].map(f64::from));
        // The sheet starts level.
        let area = 0.5 * ((b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0])).abs();
        let levers = face.iter().map(|&v| f64::from(end.0[v as usize - 1][0]) + 0.15);
        moment += 9.81 * 0.2 * area * levers.sum::<f64>() / 3.0;
    }
    let found = last("pin_0_0_moment_z_N_m");
    assert!((found / moment - 1.0).abs() < 1e-3, "{found} N m, expected {moment} N m");
}

#[test]
fn a_sheet_presses_on_its_floor() {
    let place = Place::new();
    let floor =
        "[contact]\nthickness = 0.004\n[[collider]]\nshape = \"plane\"\npoint = [0, 0.995, 0]\nnormal = [0, 1, 0]\n";
    let free = TINY.replace("[[cloth.pin]]\nselect = { corners = [0, 1] }\n", "");
    place.write("scene.toml", format!("{free}{floor}"));
    let summary = place.run("scene.toml --duration 0.5 --series all.csv");
    let series = Series::read(&place, "out/all.csv");
    let (weight, force) = (9.81 * summary["mass_kg"].as_f64().unwrap(), series.column("collider_0_force_y_N"));
    let last = force.last().unwrap() / weight;
    assert!((last - 1.0).abs() < 1e-3, "{last} of the weight");
    assert!(!series.names.contains(&"colliders_force_x_N".into()), "one collider has no total: {:?}", series.names);
    assert!(*series.column("work_contacts_J").last().unwrap() < 0.0);
}

/// The sheet hangs from two groups of pins and falls on two spheres.
#[test]
fn totals_are_the_sums_of_their_parts() {
    let place = Place::new();
    let sphere = |x: f64| format!("[[collider]]\nshape = \"sphere\"\ncenter = [{x:?}, 0.93, 0.1]\nradius = 0.05\n");
    place.write("scene.toml", format!("{}[contact]\nthickness = 0.004\n{}{}", scene(), sphere(-0.1), sphere(0.1)));
    place.run("scene.toml --series all.csv");
    let series = Series::read(&place, "out/all.csv");
    for (all, parts) in [("pins", ["pin_0_0", "pin_0_1"]), ("colliders", ["collider_0", "collider_1"])] {
        for axis in ["x", "y", "z"] {
            let force = |of: &str| series.column(&format!("{of}_force_{axis}_N"));
            let (total, [a, b]) = (force(all), parts.map(force));
            assert!(total[0].is_nan(), "frame 0 has no forces");
            for frame in 1..total.len() {
                let off = (total[frame] - (a[frame] + b[frame])).abs();
                assert!(off <= 1e-14 * (a[frame].abs() + b[frame].abs()), "{all}, {axis}, frame {frame}: {off} N off");
            }
            let carries = |force: &[f64]| force.iter().any(|force| *force > 0.0);
            assert!(axis != "y" || (carries(&a) && carries(&b)), "{all}: {a:?} and {b:?}");
        }
    }
}

#[test]
fn a_resumed_run_continues_its_series() {
    let place = Place::new();
    place.write("scene.toml", scene());
    for method in ["rk4", "backward-euler", "implicit-midpoint", "bdf2"] {
        // The last checkpoint is within a frame, at a frame, at the end.
        for every in [35, 75, 100] {
            let words = format!("scene.toml --series all.csv --set integrator.method={method}");
            place.run(&format!("{words} --checkpoint {every}"));
            let whole = place.read("out/all.csv");
            place.run(&format!("{words} --resume out/checkpoint.muslin"));
            assert!(
                place.read("out/all.csv") == whole,
                "{method}, a checkpoint every {every} steps: the series differ"
            );
        }
    }
}

#[test]
fn an_interrupted_series_is_continued_or_its_gap_is_told() {
    let place = Place::new();
    let words = "run tiny.toml --out out --preview none --series all.csv";
    place.muslin(&format!("{words} --checkpoint 12")).expect(0);
    let whole = place.read("out/all.csv");
    fs::rename(place.path("out/all.csv"), place.path("out/all.csv.partial")).unwrap();
    place.muslin(&format!("{words} --resume out/checkpoint.muslin")).expect(0);
    assert!(place.read("out/all.csv") == whole && !place.path("out/all.csv.partial").exists());

    for damage in [&b""[..], &whole[..whole.len() / 3], b"frame\n0\n"] {
        place.write("out/all.csv", damage);
        let told = place.muslin(&format!("{words} --resume out/checkpoint.muslin")).expect(0).stderr;
        assert!(told.contains("--series: out/all.csv begins with frame 3"), "{told}");
        assert_eq!(Series::read(&place, "out/all.csv").column("frame"), [3.0, 4.0]);
    }
}

#[test]
fn a_run_without_a_series_cannot_be_resumed_with_one() {
    let place = Place::new();
    place.run("tiny.toml --checkpoint 12");
    let refused = place.muslin("run tiny.toml --series all.csv --resume out/checkpoint.muslin").expect(2);
    assert!(refused.stderr.contains("run the scene from its start with --series"), "{refused:?}");
}

#[test]
fn a_new_run_removes_the_series_of_the_old_one() {
    let place = Place::new();
    place.muslin("run tiny.toml --out out --series all.csv").expect(0);
    assert!(place.path("out/all.csv").exists() && place.path("out/series.svg").exists());
    place.write("out/mine.csv", "mine");
    place.run("tiny.toml --export none");
    assert_eq!(place.files("out"), ["mine.csv", "run.json", "summary.json"]);
}

#[test]
fn a_series_has_a_plain_name() {
    let place = Place::new();
    for name in ["forces.txt", "a/b.csv", "/tmp/b.csv", "..", ".csv", "../b.csv"] {
        place.refuses(&format!("tiny.toml --series {name}"), &["a name that ends with .csv, without folders"]);
    }
}

/// Ten frames in a second: three of them are 0.3 s, not 0.30000000000000004 s, and not 0.30000001192092896 s.
#[test]
fn times_have_no_rounding_noise() {
    let place = Place::new();
    let words = "tiny.toml --series all.csv --set frame_rate=10 --duration 0.7";
    for precision in ["f32", "f64"] {
        let summary = place.run(&format!("{words} --precision {precision}"));
        let series = String::from_utf8(place.read("out/all.csv")).unwrap();
        let times: Vec<_> = series.lines().skip(1).map(|row| row.split(',').nth(1).unwrap()).collect();
        assert_eq!(times, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"], "{precision}");
        assert_eq!(summary["simulated_s"].to_string(), "0.7", "{precision}");
    }
}
