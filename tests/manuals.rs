//! The manuals agree with the code: the scene runs, every built-in name is mentioned, and every link has a
//! target.
//!
//! Run: `cargo test -p muslin-tests --test manuals`. Their Rust code is compiled and run by
//! `cargo test -p muslin-tests-harness --doc`; a unit test of `muslin-cli` reads their commands.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use harness::kit::single;
use muslin_core::integrate::Method;
use muslin_core::scene::BUILT_IN;
use muslin_core::simulation::Simulation;

const SCENE: &str = include_str!("../host-cli/manual/scene.md");
const RUNNING: &str = include_str!("../host-cli/manual/running.md");
const METHODS: &str = include_str!("../host-cli/manual/methods.md");

/// All manuals, relative to the root of the project.
const MANUALS: [&str; 17] = [
    "README.md",
    "core/README.md",
    "core/manual/driving.md",
    "core/manual/no_heap.md",
    "core/c/README.md",
    "gpu/README.md",
    "host-cli/README.md",
    "host-cli/manual/cost.md",
    "host-cli/manual/detect.md",
    "host-cli/manual/methods.md",
    "host-cli/manual/running.md",
    "host-cli/manual/scene.md",
    "host-cli/manual/studies.md",
    "host-cli/manual/sweep.md",
    "host-cli/manual/validate.md",
    "host-wasm/README.md",
    "tests/README.md",
];

#[test]
fn the_scene_runs() {
    let text = SCENE.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("there is a scene");
    let scene = single::scene(text);
    let mut cloth = Simulation::new(&scene, &[]).expect("the scene of the manual builds");
    for _ in 0..10 {
        cloth.take_step().expect("the scene of the manual stays finite");
    }
}

#[test]
fn all_that_is_built_in_is_named() {
    let missing = |manual: &str, names: &[&'static str]| -> Vec<_> {
        names.iter().copied().filter(|name| !manual.contains(&format!("`{name}`"))).collect()
    };
    let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| *name).collect();
    let scenes = missing(RUNNING, &names);
    assert!(scenes.is_empty(), "running.md does not name {scenes:?}; add a line to its table");
    let methods = missing(METHODS, &Method::ALL.map(Method::name));
    assert!(methods.is_empty(), "methods.md does not name {methods:?}; add a line to its table");
}

#[test]
fn the_readme_names_the_rust_that_rustup_fetches() {
    let toolchain = read(&root().join("rust-toolchain.toml"));
    let channel = toolchain.lines().find_map(|line| line.strip_prefix("channel = \"")?.strip_suffix('"'));
    let named = format!("It fetches Rust {} by itself", channel.expect("a version is pinned"));
    assert!(read(&root().join("README.md")).contains(&named), "README.md does not say: {named}");
}

#[test]
fn every_manual_is_listed() {
    let root = root();
    let in_folder = |folder: &str| {
        let entries = std::fs::read_dir(root.join(folder)).expect("the folder exists").flatten();
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|end| end == "md")).collect()
    };
    let folders = ["", "core", "core/c", "core/manual", "gpu", "host-cli", "host-cli/manual", "host-wasm", "tests"];
    let found: BTreeSet<PathBuf> = folders.into_iter().flat_map(|folder| -> Vec<_> { in_folder(folder) }).collect();
    let mut listed: BTreeSet<PathBuf> = MANUALS.iter().map(|manual| root.join(manual)).collect();
    listed.insert(root.join("CHANGELOG.md"));
    let unlisted: Vec<_> = found.difference(&listed).collect();
    assert!(unlisted.is_empty(), "add {unlisted:?} to MANUALS");
}

#[test]
fn every_link_leads_somewhere() {
    let root = root();
    let mut broken = Vec::new();
    for manual in MANUALS {
        let folder = root.join(manual).parent().expect("a manual lies in a folder").to_path_buf();
        for link in links(&read(&root.join(manual))).filter(|link| !link.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { root.join(manual) } else { folder.join(file) };
            let leads = target.exists() && (heading.is_empty() || anchors(&read(&target)).contains(heading));
            if !leads {
                broken.push(format!("{manual}: {link}"));
            }
        }
    }
    assert!(broken.is_empty(), "these lead nowhere: {broken:#?}");
}

/// The map in `core/src/lib.rs` names every module, and only files that exist.
#[test]
fn the_map_of_the_core_is_whole() {
    let (root, text) = (root(), read(&root().join("core/src/lib.rs")));
    let (map, code) = text.split_once("#![no_std]").expect("the map stands before the code");
    let modules = code.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    let missing: Vec<_> = modules.filter(|module| !map.contains(&format!("[`{module}`]"))).collect();
    assert!(missing.is_empty(), "the map of core/src/lib.rs does not name {missing:?}");
    let paths: Vec<_> = map.split('`').skip(1).step_by(2).filter(|code| code.contains('/')).collect();
    let gone: Vec<_> = paths.iter().filter(|path| !root.join(path).exists()).collect();
    assert!(paths.len() > 20 && gone.is_empty(), "core/src/lib.rs names files that do not exist: {gone:?}");
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The targets of Markdown links.
fn links(text: &str) -> impl Iterator<Item = String> {
    text.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned)
}

/// The headings in the form that links use.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |c: char| (c.is_alphanumeric() || c == '-' || c == '_').then(|| c.to_ascii_lowercase());
    headings
        .map(|heading| heading.chars().filter_map(|c| if c == ' ' { Some('-') } else { kept(c) }).collect())
        .collect()
}
