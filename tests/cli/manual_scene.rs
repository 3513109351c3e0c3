//! The tables of keys in the manual of scenes agree with the code, and its complete scene hangs.

use std::collections::BTreeSet;

use muslin_core::scene::SceneDesc;
use toml::{Table, Value};

use crate::kit::{Place, blocks};

const MANUAL: &str = include_str!("../../host-cli/manual/scene.md");

/// A scene with every section that has a table, each with its required keys only. It is read, not built.
const ALL: &str = r#"
duration = 1.0
[[cloth]]
density = 0.1
grid = { size = [1.0, 1.0], cells = [1, 1] }
tube = { radius = 1.0, height = 1.0, cells = [3, 1] }
disc = { radius = 1.0, rings = 1 }
stretch = { model = "membrane", stiffness = 1.0 }
shear = { stiffness = 1.0 }
bend = { model = "hinge" }
spin = { axis = [0.0, 1.0, 0.0], rate = 1.0 }
pin = [{ select = {}, motion = { turn = { axis = [0.0, 1.0, 0.0], rate = 1.0 } } }]
load = [{ select = {}, force = [0.0, 1.0, 0.0] }]
mass = [{ select = {} }]
start = [{ select = {}, velocity = [0.0, 1.0, 0.0] }]
seam = [{ stiffness = 1.0 }]
[[collider]]
shape = "sphere"
[contact]
thickness = 0.01
[drag]
wind = { velocity = [1.0, 0.0, 0.0], normal = 1.0 }
[integrator]
"#;

/// A row of a table of keys: its section, a key, and the default as the manual writes it.
type Row = (&'static str, &'static str, &'static str);

/// The text between the first pair of backticks.
fn quoted(cell: &str) -> Option<&str> {
    cell.split('`').nth(1)
}

/// The rows of all tables of keys.
fn rows() -> Vec<Row> {
    let (_, keys) = MANUAL.split_once("## Keys and defaults").expect("the manual has a chapter of keys");
    let (keys, _) = keys.split_once("\n## ").expect("another chapter follows");
    let mut section = "";
    let mut rows = Vec::new();
    for line in keys.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        match cells[2] {
            "default" => section = quoted(cells[1]).unwrap(),
            default => rows.extend(cells[1].split(", ").map(|key| (section, quoted(key).unwrap(), default))),
        }
    }
    rows
}

/// The scene [`ALL`] with a key of a section, the first one where there are several.
fn with(section: &str, key: &str, value: Value) -> Table {
    let mut scene: Table = toml::from_str(ALL).unwrap();
    let names = section.split('.').filter(|name| *name != "scene");
    let table = names.fold(&mut scene, |table, name| match table.get_mut(name) {
        Some(Value::Array(all)) => all[0].as_table_mut().unwrap(),
        Some(Value::Table(table)) => table,
        other => panic!("{section}: {other:?}"),
    });
    table.insert(key.into(), value);
    scene
}

fn read(scene: Table) -> Result<String, String> {
    scene.try_into::<SceneDesc>().map(|scene| format!("{scene:?}")).map_err(|error| error.to_string())
}

#[test]
fn the_defaults_of_the_manual_are_those_of_the_code() {
    let absent = read(toml::from_str(ALL).unwrap()).unwrap();
    let mut compared = 0;
    for (section, key, default) in rows() {
        if let Some(default) = default.strip_prefix('`').and_then(|rest| rest.strip_suffix('`')) {
            let value: Table = toml::from_str(&format!("x = {default}")).unwrap();
            // A list that is a part of `ALL` for the sake of its own table is not absent there.
            if !(default == "[]" && ALL.contains(key)) {
                assert_eq!(
                    read(with(section, key, value["x"].clone())).unwrap(),
                    absent,
                    "{section}.{key} = {default}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 20, "only {compared} defaults were found in the manual");
    let scene = |integrator: &str| toml::from_str::<SceneDesc>(&format!("{}{integrator}", ALL)).unwrap().integrator;
    let usual = scene("");
    assert_eq!((usual.step(), usual.error()), (1.0 / 60.0, Some(0.001)));
    assert_eq!((scene("step = 0.01").error(), usual.residual()), (None, 1e-4));
    assert_eq!(scene("method = \"rk4\"").step(), 0.005);
}

/// The names that the message on an unknown key gives.
#[test]
fn the_tables_of_the_manual_have_every_key() {
    let rows = rows();
    let sections: BTreeSet<_> = rows.iter().map(|(section, ..)| *section).collect();
    for section in sections {
        let listed: BTreeSet<_> = rows.iter().filter(|row| row.0 == section).map(|row| row.1).collect();
        let message = read(with(section, "unknown_key", true.into())).unwrap_err();
        let (_, names) = message.split_once("expected ").unwrap_or_else(|| panic!("{section}: {message}"));
        let names = names.lines().next().unwrap_or_default();
        let known: BTreeSet<_> = names.split('`').skip(1).step_by(2).collect();
        assert_eq!(listed, known, "keys of {section} in the manual, and in the code");
    }
}

#[test]
fn the_sheet_of_the_manual_hangs() {
    let place = Place::new();
    let scene = blocks(MANUAL, "toml").into_iter().find(|block| block.contains("\"hung\"")).expect("the scene");
    place.write("hung.toml", scene);
    let run = place.run("hung.toml");
    assert_eq!((&run["verdict"], &run["at_rest"]), (&"ok".into(), &true.into()), "{run}");
    assert!(run["simulated_s"].as_f64().unwrap() < 5.0, "{run}");
    assert!((1.0..1.05).contains(&run["stretch"]["max_of_all_frames"].as_f64().unwrap()), "{run}");
}

/// Methods for energy, by the table of the manual: on a stiff sheet without damping implicit midpoint is not to be
/// trusted with a long step, whatever the solve; symplectic Euler keeps the energy.
#[test]
fn energy_of_a_stiff_sheet_is_kept_as_the_manual_says() {
    let place = Place::new();
    let stiff = r#"duration = 1.0
frame_rate = 50
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [12, 12] }
density = 0.2
stretch = { model = "membrane", stiffness = 5000.0 }
shear = { stiffness = 1000.0 }
bend = { model = "hinge", rigidity = 2e-5 }
pin = [{ select = { corners = [0, 1] } }]
"#;
    place.write("stiff.toml", stiff);
    let run = |method: &str, step: &str, newton: u32, code: i32| {
        let words = format!(
            "run stiff.toml --out out --precision f64 --export none --preview none --series s.csv --json \
             --set integrator.error=0 --set integrator.method={method} --set integrator.step={step} \
             --set integrator.newton={newton}"
        );
        place.muslin(&words).expect(code).json()
    };
    for newton in [1, 20] {
        let midpoint = run("implicit-midpoint", "0.01", newton, 3);
        assert_eq!(midpoint["verdict"], "diverged", "newton = {newton}: {midpoint}");
    }
    let symplectic = run("symplectic-euler", "5e-5", 1, 0);
    let [added, moved] = ["method", "moved"].map(|key| symplectic["energy_balance"][key].as_f64().unwrap());
    assert!(added.abs() < 0.01 * moved, "{added} J of {moved} J");
    assert_eq!(run("bdf2", "0.005", 20, 0)["verdict"], "ok");
}
