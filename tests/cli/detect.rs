//! `muslin detect`: the counts of every method, and refused input.

use std::path::PathBuf;

use serde_json::Value;

use crate::kit::Place;

/// Two triangles, the second 10 mm above the first.
const APART: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 0.01 0\nv 1 0.01 0\nv 0 0.01 1\nf 1 2 3\nf 4 5 6\n";
/// The same two triangles with the second 10 mm below the first.
const THROUGH: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 -0.01 0\nv 1 -0.01 0\nv 0 -0.01 1\nf 1 2 3\nf 4 5 6\n";
/// Two edges of a vertical triangle pass through a horizontal triangle.
const CROSSED: &str = "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv 0 -0.5 0\nv 0.2 0.5 0\nv -0.2 0.5 0\nf 1 2 3\nf 4 5 6\n";

fn place() -> Place {
    let place = Place::new();
    for (name, mesh) in [("apart.obj", APART), ("through.obj", THROUGH), ("crossed.obj", CROSSED)] {
        place.write(name, mesh);
    }
    place
}

#[track_caller]
pub fn detect(place: &Place, words: &str) -> Value {
    place.muslin(&format!("detect {words} --json")).expect(0).json()
}

/// A count of edge-edge pairs, then of vertex-triangle pairs.
pub fn counts(report: &Value, key: &str) -> [Option<u64>; 2] {
    ["edge_edge", "vertex_triangle"].map(|kind| report[kind][key].as_u64())
}

/// Random triangles in a small cube, as OBJ text.
pub fn soup(triangles: usize) -> String {
    let mut state = 1_u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let vertices: String = (0..triangles)
        .map(|_| {
            let corner = [random(), random(), random()];
            let mut near = || corner.map(|x| x + 0.3 * random());
            let corners = [near(), near(), near()];
            corners.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat()
        })
        .collect();
    let faces = (0..triangles).map(|t| format!("f {} {} {}\n", 3 * t + 1, 3 * t + 2, 3 * t + 3));
    vertices + &faces.collect::<String>()
}

#[test]
fn stages_include_those_before_and_leave_null_what_was_not_asked_for() {
    let place = place();
    let report = detect(&place, "apart.obj --thickness 0.012 --stage candidates");
    assert_eq!(counts(&report, "candidates"), [Some(9), Some(6)]);
    assert_eq!(counts(&report, "contacts"), [None; 2]);
    assert!(report["ms"]["candidates"].is_f64() && report["ms"]["contacts"].is_null());

    let report = detect(&place, "apart.obj --thickness 0.012");
    assert_eq!(counts(&report, "contacts"), [Some(9), Some(6)]);
    for key in ["intersections", "first_impact", "adapter"] {
        assert!(report.get(key).is_some_and(Value::is_null), "{key}: {report}");
    }
    assert_eq!((&report["backend"], &report["vertices"], &report["edges"]), (&"cpu".into(), &6.into(), &6.into()));

    let report = detect(&place, "apart.obj --next through.obj --thickness 0.012 --stage intersections --threads 2");
    assert_eq!((counts(&report, "ccd"), &report["intersections"]), ([Some(9), Some(6)], &0.into()));
    for stage in ["candidates", "contacts", "ccd", "intersections"] {
        assert!(report["ms"][stage].as_f64().is_some_and(|ms| ms >= 0.0), "{report}");
    }
}

#[test]
fn thickness_is_that_of_both_together() {
    let place = place();
    let report = detect(&place, "apart.obj --thickness 0.0098");
    assert_eq!(counts(&report, "candidates"), [Some(0); 2]);
    let report = detect(&place, "apart.obj --thickness 0");
    assert_eq!((counts(&report, "candidates"), counts(&report, "contacts")), ([Some(0); 2], [Some(0); 2]));
    // Features that touch are no contact at a thickness of 0: the distance must be less than the thickness.
    let report = detect(&place, "crossed.obj --thickness 0");
    assert_eq!((counts(&report, "candidates")[0] > Some(0), counts(&report, "contacts")), (true, [Some(0); 2]));
}

#[test]
fn meetings_on_the_way() {
    let place = place();
    let report = detect(&place, "apart.obj --next through.obj --thickness 0 --stage ccd");
    assert_eq!((counts(&report, "candidates"), counts(&report, "ccd")), ([Some(9), Some(6)], [Some(9), Some(6)]));
    let first = report["first_impact"].as_f64().unwrap();
    assert!((0.499..=0.5).contains(&first), "{first}");
    let report = detect(&place, "apart.obj --next apart.obj --thickness 0.02 --stage ccd");
    assert_eq!((counts(&report, "ccd"), &report["first_impact"]), ([Some(0); 2], &Value::Null));
}

#[test]
fn intersections_are_exact() {
    let place = place();
    let outcome = place.muslin("detect crossed.obj --thickness 0 --stage intersections --json").expect(0);
    let report = outcome.json();
    assert_eq!((&report["intersections"], counts(&report, "ccd")), (&2.into(), [None; 2]));
    assert!(outcome.stderr.is_empty(), "{outcome:?}");
}

/// The notch is nearer to the first corner than the far edge is: a fan of triangles from the first corner would
/// fold over itself.
#[test]
fn a_concave_polygon_does_not_pass_through_itself() {
    let place = Place::new();
    let corners = ["0 0 0", "4 0 0", "4 0 4", "2 0 1", "0 0 4"];
    let vertices = corners.map(|corner| format!("v {corner}\n")).concat();
    place.write("notched.obj", vertices + "f 1 2 3 4 5\n");
    place.write(
        "notched.ply",
        format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n{}\n5 0 1 2 3 4\n",
            corners.join("\n")
        ),
    );
    for file in ["notched.obj", "notched.ply"] {
        let report = detect(&place, &format!("{file} --thickness 0 --stage intersections"));
        assert_eq!((&report["triangles"], &report["intersections"]), (&3.into(), &0.into()), "{file}");
    }
}

#[test]
fn vertices_of_no_triangle_are_told() {
    let place = Place::new();
    place.write("loose.obj", format!("{APART}v 9 9 9\nv 0 0.005 0\n"));
    place.write("one.obj", format!("{APART}v 9 9 9\n"));
    let outcome = place.muslin("detect loose.obj --thickness 0.012 --json").expect(0);
    assert_eq!(outcome.stderr, "loose.obj: 2 vertices belong to no triangle and touch nothing\n");
    let report = outcome.json();
    assert_eq!((&report["vertices"], &report["loose_vertices"]), (&8.into(), &2.into()));
    assert_eq!(counts(&report, "contacts"), [Some(9), Some(6)]);
    let one = place.muslin("detect one.obj --thickness 0.012").expect(0);
    assert_eq!(one.stderr, "one.obj: 1 vertex belongs to no triangle and touches nothing\n");
    // A mesh with only loose vertices is refused.
    place.write("cloud.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\n");
    let cloud = place.muslin("detect cloud.obj --thickness 0.012").expect(2);
    assert!(cloud.stderr.contains("cloud.obj: the mesh has no triangles"), "{}", cloud.stderr);
}

#[test]
fn all_methods_agree() {
    let place = Place::new();
    place.write("soup.obj", soup(300));
    for thickness in ["0", "0.05"] {
        let of = |method: &str| {
            let report = detect(&place, &format!("soup.obj --thickness {thickness} --method {method}"));
            (report["method"].as_str().unwrap().to_owned(), counts(&report, "candidates"), counts(&report, "contacts"))
        };
        let (name, candidates, contacts) = of("grid");
        assert!(candidates.iter().all(|count| *count > Some(500)), "{candidates:?}");
        assert_eq!((name.as_str(), contacts == [Some(0); 2]), ("grid", thickness == "0"));
        for method in ["reference", "brute"] {
            assert_eq!(of(method), (method.into(), candidates, contacts), "thickness {thickness}");
        }
    }
}

#[test]
fn the_cloth_on_a_ball_is_counted_exactly() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/cloth-ball"));
    if !folder.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
        eprintln!("skipped: {} is absent", folder.display());
        return;
    }
    let place = Place::new();
    let [first, second] = ["cloth_ball92.ply", "cloth_ball93.ply"].map(|name| folder.join(name).display().to_string());
    for words in ["--method grid", "--method grid --threads 1 --stage candidates", "--method reference"] {
        let report = detect(&place, &format!("{first} --next {second} --thickness 0 {words}"));
        assert_eq!(counts(&report, "candidates"), [Some(5_197_332), Some(1_655_541)], "{words}");
    }
}

#[test]
fn a_person_gets_a_table() {
    let place = place();
    let text = place.muslin("detect apart.obj --next through.obj --thickness 0.012 --stage ccd").expect(0).stdout;
    for part in [
        "apart.obj -> through.obj: 6 vertices, 2 triangles, 6 edges",
        "thickness 0.012 m, method grid",
        "edge-edge",
        "candidates/s",
        "candidates : contacts = 1.0",
        "first impact at 0.4",
    ] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn what_cannot_be_meant() {
    let place = place();
    place.write("short.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    place.write("turned.obj", APART.replace("f 4 5 6", "f 4 6 5"));
    place.write("far.obj", APART.replace("v 1 0 0", "v 1e39 0 0"));
    place.write("bad.obj", APART.replace("f 4 5 6", "f 4 5 5"));
    for (words, parts) in [
        ("apart.obj", ["--thickness", "required"]),
        ("--thickness 1", ["MESH", "required"]),
        ("apart.obj --thickness -1", ["'-1'", "metres, zero or more"]),
        ("apart.obj --thickness nan", ["'nan'", "metres"]),
        ("apart.obj --thickness 1 --method cells", ["'cells'", "grid, reference, brute"]),
        ("apart.obj --thickness 1 --stage all", ["'all'", "intersections"]),
        ("apart.obj --thickness 1 --threads 0", ["--threads", "from 1 to"]),
        ("apart.obj --thickness 1 --stage ccd", ["--stage ccd", "--next MESH"]),
        ("none.obj --thickness 1", ["cannot read", "none.obj"]),
        ("tiny.toml --thickness 1", ["tiny.toml", ".obj or .ply"]),
        ("bad.obj --thickness 1", ["bad.obj: triangle 1", "twice"]),
        ("far.obj --thickness 1", ["far.obj: vertex 1", "single precision"]),
        ("apart.obj --thickness 1 --next none.obj", ["cannot read", "none.obj"]),
        ("apart.obj --thickness 1 --next short.obj", ["short.obj: 3 vertices and 1 triangles", "has 6 and 2"]),
        ("apart.obj --thickness 1 --next turned.obj", ["turned.obj: triangle 1", "other vertices"]),
    ] {
        let outcome = place.muslin(&format!("detect {words} --json")).expect(2);
        assert_eq!(outcome.stdout, "", "{words}");
        for part in parts {
            assert!(outcome.stderr.contains(part), "{words}: {part:?} is not in {}", outcome.stderr);
        }
    }
}
