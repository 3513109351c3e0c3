//! Suites of tests: their list, and their build by cargo.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::plan::Level;

/// Packages whose suites are run, and the lowest level that runs them.
const PACKAGES: [(&str, Level); 6] = [
    ("muslin-tests", Level::Everyday),
    ("muslin-cli", Level::Everyday),
    ("muslin-c", Level::All),
    ("muslin-gpu", Level::All),
    ("muslin-tests-gpu", Level::All),
    ("muslin-example-rapier", Level::All),
];

/// A target from which cargo builds a test executable.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Name of the target; for tests inside a library or a program, name of the package followed by `unit`.
    pub name: String,
    /// The lowest level that runs it.
    pub level: Level,
    package: &'static str,
    manifest: PathBuf,
    target: String,
    kind: &'static str,
}

/// All suites that cargo reports.
pub fn all(root: &Path) -> Result<Vec<Suite>, String> {
    let mut cargo = Command::new(env!("CARGO"));
    let output = cargo.args(["metadata", "--no-deps", "--format-version=1"]).current_dir(root).output();
    let output = output.map_err(|error| format!("cannot start cargo: {error}"))?;
    let metadata: Value = serde_json::from_slice(&output.stdout)
        .map_err(|_| format!("cargo metadata: {}", String::from_utf8_lossy(&output.stderr)))?;
    let mut suites = Vec::new();
    for (name, level) in PACKAGES {
        let package = list(&metadata["packages"]).iter().find(|package| package["name"] == name);
        let package = package.ok_or_else(|| format!("cargo knows no package {name}: see tests/check/suites.rs"))?;
        suites.extend(list(&package["targets"]).iter().filter_map(|target| suite(name, level, package, target)));
    }
    Ok(suites)
}

/// The packages of a level, as options of cargo, with a space before each.
pub fn packages(level: Level) -> String {
    PACKAGES.iter().filter(|(_, own)| *own <= level).map(|(name, _)| format!(" -p {name}")).collect()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn suite(name: &'static str, level: Level, package: &Value, target: &Value) -> Option<Suite> {
    let kind = ["test", "bin", "lib"].into_iter().find(|kind| target["kind"][0] == *kind);
    let kind = kind.filter(|_| target["test"] == true)?;
    let own = text(&target["name"]).to_owned();
    Some(Suite {
        name: if kind == "test" { own.clone() } else { format!("{name} unit") },
        level,
        package: name,
        manifest: text(&package["manifest_path"]).into(),
        target: own,
        kind,
    })
}

impl Suite {
    /// The command that runs one of its tests alone.
    pub fn repeat(&self, test: &str, profile: &str) -> String {
        let (package, target) = (self.package, self.target());
        format!("cargo test --profile {profile} -p {package} {target} -- --include-ignored --exact {test}")
    }

    /// The folder in which its tests run.
    pub fn folder(&self) -> &Path {
        self.manifest.parent().unwrap_or(Path::new("."))
    }

    fn target(&self) -> String {
        if self.kind == "lib" { "--lib".to_owned() } else { format!("--{} {}", self.kind, self.target) }
    }

    fn is_of(&self, artifact: &Value) -> bool {
        let target = &artifact["target"];
        artifact["manifest_path"] == *self.manifest.to_string_lossy()
            && target["name"] == *self.target
            && target["kind"][0] == self.kind
            && artifact["profile"]["test"] == true
    }
}

/// Builds suites and finds their executables; cargo's messages go to the terminal.
pub fn build<'a>(root: &Path, profile: &str, suites: &'a [Suite]) -> Result<Vec<(&'a Suite, PathBuf)>, String> {
    let level = suites.iter().map(|suite| suite.level).fold(Level::Everyday, Level::max);
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["test", "--no-run", "--message-format=json-render-diagnostics", "--profile", profile]);
    // Always builds all packages of the level: libraries are then built only once, with the union of the
    // features.
    cargo.args(packages(level).split_whitespace());
    // Of two packages with a library, cargo takes one `--lib`.
    let targets: BTreeSet<String> = suites.iter().map(Suite::target).collect();
    for target in &targets {
        cargo.args(target.split(' '));
    }
    let output = cargo.current_dir(root).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| format!("cannot start cargo: {error}"))?;
    if !output.status.success() {
        return Err("the tests cannot be built".to_owned());
    }
    let stdout = String::from_utf8_lossy(&output.stdout);
    let artifacts: Vec<Value> = stdout.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let executable = |suite: &'a Suite| {
        let own = artifacts.iter().find(|artifact| suite.is_of(artifact) && artifact["executable"].is_string());
        let own = own.ok_or_else(|| format!("cargo made no executable of the suite {}", suite.name))?;
        Ok((suite, PathBuf::from(text(&own["executable"]))))
    };
    suites.iter().map(executable).collect()
}
