//! `muslin choose`: its choice has the error that it reports, measured by a reference of another method.
//! Times are never asserted. Where they would decide the outcome, costs are computed from counts.

use serde_json::Value;
use toml::Table;

use crate::kit::{Place, PointCache, STIFF, TINY, obj, soft_in_air};

/// A sheet of springs only: it has no term that could be left out.
const SPRINGS: &str = r#"# Nothing but springs.
name = "springs"
duration = 0.3 # s
frame_rate = 40
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
density = 0.2
stretch = { model = "spring", stiffness = 50.0 }
pin = [{ select = { corners = [0, 1] } }]

# How it is run.
[integrator]
step = 0.02 # s
newton = 1
"#;

pub const METHODS: [&str; 7] =
    ["explicit-euler", "symplectic-euler", "midpoint", "rk4", "backward-euler", "implicit-midpoint", "bdf2"];
pub const EXPLICIT: &[&str] = METHODS.split_at(4).0;

/// Allowed error of the reference itself, as a fraction of the tolerance.
const OWN: f64 = 1.0 / 16.0;

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The choice for a scene. Asserts that the errors of all rows agree with their verdicts.
#[track_caller]
fn choose(place: &Place, words: &str) -> Value {
    let choice = place.muslin(&format!("choose --out out --json {words}")).expect(0).json();
    let tolerance = number(&choice["tolerance"]);
    for row in choice["considered"].as_array().unwrap() {
        let (error, verdict) = (row["error"].as_f64(), row["verdict"].as_str().unwrap());
        match verdict {
            "meets" => assert!(error.unwrap() <= tolerance, "{row}"),
            "misses" => assert!(error.unwrap() > tolerance, "{row}"),
            _ => assert!(error.is_none() && row["why"].is_string() && ["failed", "dear"].contains(&verdict), "{row}"),
        }
    }
    let written: Vec<_> =
        choice["considered"].as_array().unwrap().iter().filter(|row| row["as_written"] == true).collect();
    assert_eq!(written.len(), 1, "{written:?}");
    for row in choice["considered"].as_array().unwrap() {
        let allowed = row["allowed_error"].as_f64().is_none_or(|error| error <= tolerance);
        assert!(allowed || row["as_written"] == true, "{row} allows a step more than {tolerance} m");
        assert_eq!(row["error"].is_null(), row["stretch"].is_null(), "{row}");
    }
    assert!(choice["chosen"]["allowed_error"].as_f64().is_none_or(|error| error <= tolerance), "{choice}");
    let is_chosen = |row: &Value| {
        ["method", "precision", "step", "allowed_error", "solver_tolerance", "terms"]
            .iter()
            .all(|k| row[k] == choice["chosen"][k])
    };
    let chosen =
        choice["considered"].as_array().unwrap().iter().find(|row| is_chosen(row) && row["verdict"] == "meets");
    assert_eq!(chosen.unwrap()["error"], choice["predicted"]["error"], "the choice was considered");
    for error in [&choice["predicted"]["error"], &choice["measured"]["error"]] {
        assert!(number(error) <= tolerance, "{error} is more than {tolerance}");
    }
    choice
}

/// Area per vertex, m^2: a third of the total area of its triangles.
pub fn areas((vertices, triangles): (Vec<[f32; 3]>, Vec<[u32; 3]>)) -> Vec<f64> {
    let mut areas = vec![0.0; vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| vertices[corner as usize - 1].map(f64::from));
        let [u, v] = [b, c].map(|end| [0, 1, 2].map(|i| end[i] - a[i]));
        let cross = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            u[j] * v[k] - u[k] * v[j]
        });
        let area = 0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt();
        triangle.iter().for_each(|&corner| areas[corner as usize - 1] += area / 3.0);
    }
    areas
}

/// The point cache of a run (its start and 20 moments) and the areas of its vertices, m^2.
fn moments(place: &Place, words: &str) -> (PointCache, Vec<f64>) {
    place.run(&format!("{words} --export pc2,obj"));
    let cache = PointCache::parse(&place.read("out/cloth.pc2"));
    assert_eq!(cache.frames.len(), 21);
    (cache, areas(obj(&place.read("out/frames/frame_00000.obj"))))
}

/// RMS distance over the 20 moments and over the vertices, weighted by area, m.
pub fn rms(a: &PointCache, b: &PointCache, areas: &[f64]) -> f64 {
    let sum: f64 = (a.frames.iter().zip(&b.frames).skip(1))
        .flat_map(|(a, b)| a.iter().zip(b).zip(areas))
        .map(|((a, b), area)| area * (0..3).map(|i| f64::from(a[i] - b[i]).powi(2)).sum::<f64>())
        .sum();
    (sum / (20.0 * areas.iter().sum::<f64>())).sqrt()
}

#[test]
fn the_scene_that_it_writes_is_within_the_tolerance() {
    let place = Place::new();
    place.write("soft.toml", soft_in_air(1e-6));
    let choice = choose(&place, "soft.toml --cost counts --tolerance 1mm --write chosen.toml");
    assert_eq!(choice["tolerance"], 1e-3);
    let written = String::from_utf8(place.read("chosen.toml")).unwrap();
    let terms = choice["chosen"]["terms"].as_array().unwrap();
    assert!(!terms.is_empty(), "the scene has terms that need not be modelled: {choice}");
    for term in terms {
        let line = format!("# Changed, because it is faster within the tolerance: {}.\n", term.as_str().unwrap());
        assert!(written.contains(&line), "{line:?} is not in {written}");
    }
    assert!(!written.contains("nothing is checked"), "the study ran to the scene's end: {written}");
    let precision = choice["chosen"]["precision"].as_str().unwrap();
    let (run, areas) = moments(&place, &format!("chosen.toml --set frame_rate=50 --precision {precision}"));
    let exact = "--set frame_rate=50 --precision f64 --set integrator.method=rk4 --set integrator.step=1e-4";
    let (reference, _) = moments(&place, &format!("soft.toml {exact}"));
    let (error, told) = (rms(&run, &reference, &areas), number(&choice["measured"]["error"]));
    println!("told {told}, by RK4 {error}");
    assert!((error - told).abs() <= OWN * 1e-3, "told {told}, by RK4 {error}");
    // The comparison can fail: the unchanged scene misses the tolerance.
    let (as_it_is, _) = moments(&place, "soft.toml --set frame_rate=50");
    let off = rms(&as_it_is, &reference, &areas);
    assert!(off > 1e-3);
    let rows = choice["considered"].as_array().unwrap();
    let row = rows.iter().find(|row| row["as_written"] == true).unwrap();
    assert!(row["verdict"] == "misses" && (number(&row["error"]) - off).abs() <= OWN * 1e-3, "{off}: {row}");
    let run: Value = serde_json::from_slice(&place.read("out/summary.json")).unwrap();
    assert_eq!(row["stretch"], run["stretch"]["max_of_all_frames"], "its frames are the moments");

    let words = String::from_utf8(place.read("out/choose.txt")).unwrap();
    // The run wrote into the same folder; the files of the study must still be there.
    assert!(words.contains("Chosen: "));
    assert_eq!(words.lines().filter(|line| line.ends_with("misses it, the scene as written")).count(), 1, "{words}");
    let page = String::from_utf8(place.read("out/study.html")).unwrap();
    assert!(page.contains("What to choose") && page.contains(">tolerance<"), "the page shows the picture");
}

#[test]
fn where_it_is_soft_rk4_wins_and_double_precision_is_for_fine_tolerances_only() {
    let place = Place::new();
    place.write("soft.toml", soft_in_air(1e-6));
    let [coarse, fine] =
        ["5mm", "20nm"].map(|tolerance| choose(&place, &format!("soft.toml --cost counts --tolerance {tolerance}")));
    assert!(number(&coarse["chosen"]["step"]) >= number(&fine["chosen"]["step"]));
    let rows = fine["considered"].as_array().unwrap();
    let cheapest = |is_wanted: &dyn Fn(&Value) -> bool| {
        let meet = rows.iter().filter(|row| row["verdict"] == "meets" && is_wanted(&row["method"]));
        meet.map(|row| number(&row["wall_s"])).min_by(f64::total_cmp).unwrap_or_else(|| panic!("{rows:?}"))
    };
    let [rk4, others] = [cheapest(&|method| method == "rk4"), cheapest(&|method| method != "rk4")];
    println!("RK4 costs {rk4} s, the best of the others {others} s");
    assert!(2.0 * rk4 < others, "RK4 costs {rk4} s, the best of the others {others} s");
    assert_eq!(
        fine["chosen"]["solver_tolerance"].is_null(),
        EXPLICIT.contains(&fine["chosen"]["method"].as_str().unwrap())
    );
    let tried = |choice: &Value, method: &str, precision: &str| {
        let rows = choice["considered"].as_array().unwrap();
        rows.iter().any(|row| row["method"] == method && row["precision"] == precision)
    };
    for choice in [&coarse, &fine] {
        assert!(METHODS.iter().all(|method| tried(choice, method, "f32")), "{choice}");
    }
    // In single precision rounding limits the error of BDF2 to a value above 20 nm and far below 5 mm.
    assert!(tried(&fine, "bdf2", "f64") && !tried(&coarse, "bdf2", "f64"));
}

#[test]
fn what_it_writes_is_the_scene_with_another_integrator() {
    let place = Place::new();
    place.write("springs.toml", SPRINGS);
    let choice =
        choose(&place, "springs.toml --set drag.linear=0 --duration 0.2 --tolerance 0.1cm --write chosen.toml");
    let is_term = |words: &&Value| !words.as_str().unwrap().contains("solver");
    assert_eq!(choice["chosen"]["terms"].as_array().unwrap().iter().find(is_term), None);
    let table = |text: &str| toml::from_str::<Table>(text).unwrap();
    let written = String::from_utf8(place.read("chosen.toml")).unwrap();
    let head =
        "# Chosen by muslin choose for the first 0.2 s, to within 1.0 mm.\n# From 0.2 s to its end at 0.3 s nothing is";
    assert!(written.starts_with(head), "{written}");
    assert!(written.contains("\n# --set drag.linear=0\n"), "{written}");
    for comment in ["# Nothing but springs.\n", "duration = 0.3 # s\n", "# How it is run.\n", " # s\nnewton = 1\n"] {
        assert!(written.contains(comment), "{comment:?} is not in {written}");
    }
    // The written scene keeps the duration of the original scene, not the duration of the study.
    let (mut before, mut after) = (table(SPRINGS), table(&written));
    let integrator = after.remove("integrator").unwrap();
    before.remove("integrator");
    before.insert("drag".into(), toml::from_str::<Table>("linear = 0").unwrap().into());
    assert_eq!(before, after);
    assert_eq!(integrator["method"].as_str(), choice["chosen"]["method"].as_str());
    assert_eq!(integrator["step"].as_float(), choice["chosen"]["step"].as_f64());
    assert_eq!(integrator["newton"].as_integer(), Some(1));
    let refused = place.muslin("choose springs.toml --tolerance 1cm --write ./springs.toml").expect(2);
    assert!(refused.stderr.contains("this is the scene file itself"), "{}", refused.stderr);
    assert_eq!(place.read("springs.toml"), SPRINGS.as_bytes());
    // No step is longer than a frame. `run_step` is the step that a run takes to divide its frames evenly.
    let [step, taken] = ["step", "run_step"].map(|key| number(&choice["chosen"][key]));
    assert!(taken <= step && step <= 1.0 / 40.0, "{step}, taken {taken}");
    let run = place.run("chosen.toml");
    assert!((number(&run["steps"]) * taken - 0.3).abs() < 1e-9, "{} steps of {taken}", run["steps"]);
    assert_eq!(choice["longest_step"], 0.2 / 20.0);
}

#[test]
fn by_counts_the_whole_study_is_the_same_every_time() {
    let place = Place::new();
    let words = "choose tiny.toml --cost counts --tolerance 2mm --json --quiet --out";
    let [once, again] = ["once", "again"].map(|out| place.muslin(&format!("{words} {out}")).expect(0).stdout);
    assert_eq!(once, again);
    place.same_files("once", "again");
    assert!(once.contains("\"machine\": \"none: by counts\""), "{once}");
}

/// A strip that is held at one end falls, snaps taut and swings: only the snap needs short steps.
const SNAP: &str = r#"name = "snap"
duration = 0.6
frame_rate = 40
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.5, 0.1], cells = [10, 2] }
rotation = [0.0, 0.0, -90.0]
density = 0.2
stretch = { model = "membrane", stiffness = 5000.0, damping = 0.001 }
shear = { stiffness = 1000.0 }
pin = [{ select = { edge = "left" }, motion = { keys = [[0.5, 0.0, 0.0, 0.0], [0.52, 0.1, 0.0, 0.0]] } }]
"#;

#[test]
fn error_control_is_chosen_where_few_steps_must_be_short() {
    let place = Place::new();
    place.write("snap.toml", SNAP);
    let choice = choose(&place, "snap.toml --cost counts --tolerance 5mm --write chosen.toml");
    let error = number(&choice["chosen"]["allowed_error"]);
    assert!(choice["chosen"]["solver_tolerance"].is_null(), "the solver follows the allowed error: {choice}");
    let words = String::from_utf8(place.read("out/choose.txt")).unwrap();
    assert!(words.contains("a step, the longest"), "{words}");
    let run = place.muslin("run chosen.toml --out run --preview none --json").expect(0).json();
    assert_eq!(run["error_control"]["error_m"], error, "{run}");
    let (longest, shortest) = (number(&run["step_s"]), number(&run["error_control"]["shortest_s"]));
    assert!(shortest < 0.5 * longest, "steps of {shortest} to {longest} s");
}

/// The scene as it is written meets the tolerance and is the cheapest run with all terms, but by luck: a single step may
/// be off by more than the tolerance.
#[test]
fn no_step_is_allowed_a_larger_error_than_the_tolerance() {
    let place = Place::new();
    place.write("snap.toml", SNAP);
    let choice = choose(&place, "snap.toml --cost counts --tolerance 20mm --set integrator.error=0.03");
    let rows = choice["considered"].as_array().unwrap().iter();
    let meet = rows.filter(|row| row["verdict"] == "meets" && row["terms"].as_array().unwrap().is_empty());
    let cheapest = meet.min_by(|a, b| number(&a["wall_s"]).total_cmp(&number(&b["wall_s"]))).unwrap();
    assert!(cheapest["as_written"] == true && cheapest["allowed_error"] == 0.03, "{cheapest}");
    let words = String::from_utf8(place.read("out/choose.txt")).unwrap();
    let line = "meets it; not proposed, because it allows a step a larger error, the scene as written";
    assert!(words.contains(line), "{words}");
}

#[test]
fn with_contact_the_outline_is_judged() {
    let place = Place::new();
    let ball = "\n[[collider]]\nshape = \"sphere\"\ncenter = [0.0, 0.8, 0.0]\nradius = 0.15\n\
                [contact]\nthickness = 0.004\n";
    place.write("drop.toml", format!("{}{ball}", TINY.replace("[[cloth.pin]]\nselect = { corners = [0, 1] }\n", "")));
    let choice = choose(&place, "drop.toml --cost counts --tolerance 5mm");
    assert_eq!(choice["measure"], "outline");
    assert_eq!(choice["reference"]["method"], "backward-euler");
    // With contact no other method confirms the reference, so the report gives the nearest run of another method.
    let nearest = &choice["nearest_other"];
    assert!(nearest["method"] != "backward-euler" && number(&nearest["error"]) > 0.0, "{nearest}");
    let words = String::from_utf8(place.read("out/choose.txt")).unwrap();
    assert!(words.contains("backward-euler confirms its own reference only"), "{words}");
}

#[test]
fn a_tolerance_that_nothing_meets_is_refused_with_the_best_that_can_be_had() {
    let place = Place::new();
    let refused =
        place.muslin("choose tiny.toml --tolerance 1e-15 --cost counts --budget 0.2 --write chosen.toml").expect(3);
    for part in ["tiny", "the smallest tolerance that it can judge is", "--budget", "--duration"] {
        assert!(refused.stderr.contains(part), "{part:?} is not in {}", refused.stderr);
    }
    assert_eq!(refused.stdout, "");
    assert_eq!(place.files("."), ["tiny.toml"]);
}

/// A budget that is too small is refused because of the time, not because a step fails. The refusal names a larger
/// budget, and one that it calls enough is not refused.
#[test]
fn the_budget_that_a_refusal_calls_enough_is_enough() {
    let place = Place::new();
    let (mut budget, mut is_enough) = (1e-4, false);
    for _ in 0..8 {
        let outcome = place.muslin(&format!("choose tiny.toml --cost counts --tolerance 0.5mm --budget {budget}"));
        if is_enough {
            outcome.expect(0);
            return;
        }
        let refused = outcome.expect(3).stderr;
        assert!(!refused.contains("fail"), "no step fails, but with {budget} s: {refused}");
        let (_, advice) = refused.split_once("or a --budget of ").unwrap_or_else(|| panic!("{budget} s: {refused}"));
        is_enough = advice.contains(", which is enough");
        let (number, rest) = advice.split_once(' ').unwrap();
        let unit = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6)].into_iter().find(|(name, _)| rest.starts_with(name));
        let advised = unit.unwrap().1 * number.parse::<f64>().unwrap();
        assert!(advised > budget, "{advised} is not more than {budget}: {refused}");
        budget = advised;
    }
    panic!("no budget was called enough, up to {budget} s");
}

/// The time of a run that fails is the cost of no result: the table says "diverged" and gives no number.
#[test]
fn a_run_that_diverges_has_no_time() {
    let place = Place::new();
    place.write("stiff.toml", STIFF);
    let choice = choose(&place, "stiff.toml --cost counts --tolerance 10mm --set integrator.method=symplectic-euler");
    let failed = choice["considered"].as_array().unwrap().iter().filter(|row| row["verdict"] == "failed").count();
    assert!(failed > 0, "{choice}");
    let words = String::from_utf8(place.read("out/choose.txt")).unwrap();
    let lines: Vec<_> = words.lines().filter_map(|line| line.split_once("  diverged: ")).collect();
    assert_eq!(lines.len(), failed, "{words}");
    for (figures, _) in lines {
        assert!(matches!(figures.split_whitespace().rev().collect::<Vec<_>>()[..], ["-", "-", ..]), "{figures}");
    }
}

#[test]
fn what_is_no_tolerance_is_refused() {
    let place = Place::new();
    for text in ["1inch", "-0.001", "0", "nan", "inf", "mm", "1,5mm"] {
        let refused = place.muslin(&format!("choose tiny.toml --tolerance {text}")).expect(2);
        assert!(refused.stderr.contains("a length above zero"), "{}", refused.stderr);
    }
    let large = place.muslin("choose tiny.toml --tolerance 1m").expect(2);
    assert!(large.stderr.contains("the cloth's diagonal is 0.42 m"), "{}", large.stderr);
    assert!(place.muslin("choose tiny.toml").expect(2).stderr.contains("--tolerance"));
    assert_eq!(place.files("."), ["tiny.toml"]);
}

#[test]
fn a_scene_that_names_files_stays_beside_them() {
    let place = Place::new();
    place.run("tiny.toml --duration 0 --export obj");
    place.write("sheet.obj", place.read("out/frames/frame_00000.obj"));
    let [before, after] = ["grid = ", "position = "].map(|key| TINY.find(key).unwrap());
    place.write("mesh.toml", format!("{}mesh = \"sheet.obj\"\n{}", &TINY[..before], &TINY[after..]));
    std::fs::create_dir(place.path("other")).unwrap();
    let refused = place.muslin("choose mesh.toml --tolerance 1cm --write other/chosen.toml").expect(2);
    assert!(refused.stderr.contains("sheet.obj") && refused.stderr.contains("its own folder"), "{}", refused.stderr);
    assert!(place.files("other").is_empty());
    place.muslin("choose mesh.toml --tolerance 1cm --write chosen.toml --out study --quiet").expect(0);
    place.run("chosen.toml");
}
