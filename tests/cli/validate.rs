//! `muslin validate`: all groups of checks pass; only a part of the cantilever group is run here. The
//! expected values are compared with published digits next to the code that computes them. The cantilever at all
//! twelve values of Gamma takes minutes: run `muslin validate --only cantilever`.

use serde_json::Value;

use crate::kit::{Outcome, Place};

fn validate(place: &Place, only: &str) -> Outcome {
    let mut command = place.command("validate --json --out out --only");
    command.arg(only);
    place.finish(command)
}

/// Asserts that `only` chooses `count` checks, that all pass, and that the numbers of each row are consistent.
/// Returns the rows.
#[track_caller]
fn all_pass(only: &str, count: usize) -> Vec<Value> {
    let report = validate(&Place::new(), only).expect(0).json();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(
        (rows.len(), report["passed"].as_u64(), report["failed"].as_u64()),
        (count, Some(count as u64), Some(0))
    );
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key} of {row}"));
        let off = number("measured") - number("expected");
        let error = if row["relative"] == true { off / number("expected") } else { off };
        assert!((error - number("error")).abs() <= 1e-12 * (1.0 + error.abs()), "{row}");
        assert!(error.abs() <= number("tolerance") && row["pass"] == true, "{row}");
    }
    rows.clone()
}

#[test]
fn what_sheets_amount_to() {
    let rows = all_pass("hinge", 83);
    let range = |sheet: &str| {
        let of = rows.iter().filter(|row| {
            let name = row["name"].as_str().unwrap();
            name.starts_with(&format!("{sheet},")) && name.ends_with(", cylinder")
        });
        let factors: Vec<_> = of.map(|row| row["measured"].as_f64().unwrap()).collect();
        assert_eq!(factors.len(), 12, "{sheet}");
        [factors.iter().copied().fold(f64::INFINITY, f64::min), factors.iter().copied().fold(0.0, f64::max)]
    };
    // The rows of the other sheets pass too: they expect a rigidity that depends on the direction.
    let ranges = [
        ("equilateral", [1.0, 1.0]),
        ("equilateral in square cells", [0.84375, 1.1171875]),
        ("alternating", [5.0 / 6.0, 4.0 / 3.0]),
        ("diagonal", [0.75, 3.0]),
    ];
    for (sheet, expected) in ranges {
        let got = range(sheet);
        assert!(got.iter().zip(expected).all(|(got, want)| (got - want).abs() < 1e-9), "{sheet}: {got:?}");
    }
    all_pass("patch", 11);
    all_pass("derivatives", 15);
    all_pass("spectra", 3);
    all_pass("compression", 7);
}

/// The rigidities of the rows above, in strips, discs and tubes that the whole core bends.
#[test]
#[ignore = "slow"]
fn sheets_in_equilibrium() {
    all_pass("plates", 7);
}

#[test]
#[ignore = "slow"]
fn chains_and_oscillators() {
    all_pass("chains", 14);
    all_pass("catenary", 15);
    all_pass("energy", 30);
    all_pass("falls", 14);
}

#[test]
#[ignore = "slow"]
fn what_holds_on_many_states_and_over_many_steps() {
    all_pass("projection", 3);
    all_pass("momentum", 8);
}

#[test]
#[ignore = "slow"]
fn orders() {
    all_pass("orders", 21);
}

#[test]
#[ignore = "slow"]
fn critical_steps() {
    all_pass("critical", 50);
}

#[test]
#[ignore = "slow"]
fn friction() {
    all_pass("friction", 18);
}

/// Five values of Gamma on strips in three directions. The strips at Gamma = 200 have 142 edges along their length.
#[test]
#[ignore = "slow"]
fn some_cantilevers() {
    let published =
        [("0.1", 0.01249955), ("0.5", 0.06244446), ("2", 0.24667321), ("20", 1.86393014), ("200", 8.90677073)];
    let rows: Vec<_> = published.iter().flat_map(|(gamma, _)| all_pass(&format!("Gamma {gamma}"), 3)).collect();
    for (gamma, want) in published {
        let of = rows.iter().filter(|row| row["name"].as_str().unwrap().ends_with(&format!(", Gamma {gamma}")));
        let measured: Vec<_> = of.map(|row| row["measured"].as_f64().unwrap()).collect();
        println!("Gamma {gamma}: {measured:.6?}, published {want}");
        assert_eq!(measured.len(), 3);
        assert!(measured.iter().all(|got| (got / want - 1.0).abs() <= 0.01), "Gamma {gamma}: {measured:?}, not {want}");
    }
}

#[test]
fn results_are_written() {
    let place = Place::new();
    let outcome = validate(&place, "rows across, Gamma 0.1").expect(0);
    // Files of a partial validation have names of their own, so that they do not overwrite the full report.
    let names = ["json", "svg", "txt"].map(|kind| format!("validate-rows-across-gamma-0.1.{kind}"));
    assert_eq!(place.files("out"), names);
    let read = |kind: usize| String::from_utf8(place.read(&format!("out/{}", names[kind]))).unwrap();
    assert_eq!(read(0), outcome.stdout);
    let svg = read(1);
    for part in ["<svg", "rows across", "tolerated", "Gamma = w L^3 / D", "per cent"] {
        assert!(svg.contains(part), "{part:?} is not in the picture");
    }
    assert!(!svg.contains("rows along"), "what was not measured has no marks");
    let words = read(2);
    assert!(words.contains("rows across, Gamma 0.1") && words.trim().contains("1 of 1 checks pass"), "{words}");
}

#[test]
fn pictures_show_what_was_measured() {
    let place = Place::new();
    validate(&place, "alternating 45 degrees cylinder").expect(0);
    let name = "validate-alternating-45-degrees-cylinder";
    assert_eq!(place.files("out"), ["json", "svg", "txt"].map(|kind| format!("{name}.{kind}")));
    let svg = String::from_utf8(place.read(&format!("out/{name}.svg"))).unwrap();
    assert!(svg.contains("alternating") && !svg.contains("diagonal"), "{svg}");
    let place = Place::new();
    validate(&place, "hanging").expect(0);
    assert_eq!(place.files("out"), ["validate-hanging.json", "validate-hanging.txt"]);
}

/// The names that `--list` prints.
fn listed(words: &str) -> Vec<String> {
    let place = Place::new();
    let mut command = place.command("validate --list");
    if !words.is_empty() {
        command.args(["--only", words]);
    }
    let outcome = place.finish(command).expect(0);
    assert!(!place.path("out").exists(), "nothing is written");
    outcome.stdout.lines().map(str::to_owned).collect()
}

#[test]
fn whole_words_choose() {
    let gamma = listed("Gamma 10");
    assert!(gamma.len() == 6 && gamma.iter().all(|name| name.ends_with(", Gamma 10")), "{gamma:?}");
    assert_eq!(listed("gamma 10"), gamma);
    assert_eq!(listed("rows along Gamma 0.5"), ["cantilever   rows along, Gamma 0.5"]);
    assert_eq!(listed("cantilever rows across, order"), ["cantilever   rows across, order by the edges"]);
    // The name of a group chooses that group only, though checks of other groups contain the word.
    let energy = listed("energy");
    assert!(energy.len() == 30 && energy.iter().all(|name| name.starts_with("energy ")), "{energy:?}");
    for nothing in ["Gamma 1000000", "amma 10", "", " , "] {
        let place = Place::new();
        let mut command = place.command("validate --list --only");
        command.arg(nothing);
        place.finish(command).expect(2);
    }
}

#[test]
fn names_tell_checks_apart() {
    let mut names = listed("");
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert!(names.len() == count && count > 200, "{count} checks with {} names", names.len());
}

#[test]
fn what_is_not_there_is_bad_usage() {
    let place = Place::new();
    let outcome = validate(&place, "cantilevre").expect(2);
    for part in ["--only cantilevre", "cantilever", "hinge", "friction"] {
        assert!(outcome.stderr.contains(part), "{part:?} is not in {}", outcome.stderr);
    }
    assert!(outcome.stdout.is_empty() && !place.path("out").exists());
}
