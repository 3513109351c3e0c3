//! Do the tests detect faults? Each mutant of the [table], a small fault, is put into a copy of the project,
//! and the suites that should find it are run: `cargo run -p muslin-tests --bin mutants [-- WORD]`; with a
//! word, only mutants with it in their description. Each takes a minute and a half, and no level of `check`
//! runs this program.
#![forbid(unsafe_code)]

mod table;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, fs};

use table::{MUTANTS, Mutant};

/// Text with which `check` reports that a suite does not compile.
const UNBUILT: &str = "cannot be built";

/// A copy of the project, and its build folder.
struct Copy {
    root: PathBuf,
    build: PathBuf,
}

impl Copy {
    /// Copies every file that git tracks, in its current state.
    fn new(root: &Path) -> Result<Self, String> {
        let folder = root.join("target/mutants");
        let copy = Self { root: folder.join("tree"), build: folder.join("build") };
        let listed = Command::new("git").args(["ls-files"]).current_dir(root).output();
        let listed = listed.map_err(|error| format!("cannot start git: {error}"))?;
        for file in String::from_utf8_lossy(&listed.stdout).lines() {
            let (from, to) = (root.join(file), copy.root.join(file));
            // Unchanged files keep their time, so that they are not rebuilt.
            if fs::read(&from).ok() != fs::read(&to).ok() {
                let folder = to.parent().unwrap_or(&copy.root);
                fs::create_dir_all(folder).and_then(|()| fs::copy(&from, &to)).map_err(|e| format!("{file}: {e}"))?;
            }
        }
        Ok(copy)
    }

    /// The first failure that `check` reports for a suite; `None` if it passes.
    fn check(&self, suite: &str, options: &str) -> Result<Option<String>, String> {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["run", "--quiet", "-p", "muslin-tests", "--bin", "check", "--"]);
        cargo.args(options.split_whitespace()).args(["--only", suite]);
        // The copy has no shared data beside it.
        cargo.env_remove("MUSLIN_REQUIRE_DATA").env("CARGO_TARGET_DIR", &self.build);
        let output = cargo.current_dir(&self.root).output();
        let output = output.map_err(|error| format!("cannot start cargo: {error}"))?;
        let told = String::from_utf8_lossy(&output.stdout);
        if told.contains(UNBUILT) || !output.status.success() && !told.contains("\nFailed\n") {
            return Err(format!("{told}\n{}", String::from_utf8_lossy(&output.stderr)));
        }
        let failed = told.split_once("\nFailed\n").and_then(|(_, failed)| failed.lines().next());
        Ok(failed.map(|line| line.trim().split(": repeat").next().unwrap_or_default().to_owned()))
    }
}

/// The level and the test that find a mutant; `None` if it is missed.
fn hunt(
    copy: &Copy,
    passed: &mut BTreeSet<(String, String)>,
    mutant: &Mutant,
) -> Result<Option<(&'static str, String)>, String> {
    let file = copy.root.join(mutant.file);
    let whole = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    if whole.matches(mutant.old).count() != 1 {
        return Err(format!("{} has {:?} not just once: put the mutant elsewhere", mutant.file, mutant.old));
    }
    let write = |text: &str| fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()));
    for (level, options, suites) in [("everyday", "", mutant.everyday), ("all", "--all", mutant.all)] {
        for suite in suites {
            control(copy, passed, suite, options)?;
            write(&whole.replace(mutant.old, mutant.new))?;
            let found = copy.check(suite, options);
            write(&whole)?;
            if let Some(test) = found? {
                return Ok(Some((level, test)));
            }
        }
    }
    Ok(None)
}

/// Checks that a suite passes without a mutant: only then does its failure show one.
fn control(copy: &Copy, passed: &mut BTreeSet<(String, String)>, suite: &str, options: &str) -> Result<(), String> {
    if !passed.insert((suite.to_owned(), options.to_owned())) {
        return Ok(());
    }
    match copy.check(suite, options)? {
        None => Ok(()),
        Some(failed) => Err(format!("without a mutant {failed} fails")),
    }
}

/// The number of mutants with a word in their description, and the number missed.
fn all(word: &str) -> Result<[usize; 2], String> {
    let copy = Copy::new(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))?;
    let ([mut count, mut missed], mut passed) = ([0; 2], BTreeSet::new());
    for mutant in MUTANTS.iter().filter(|mutant| mutant.what.contains(word)) {
        let found = hunt(&copy, &mut passed, mutant).map_err(|why| format!("{}: {why}", mutant.what))?;
        count += 1;
        missed += usize::from(found.is_none());
        let (level, test) = found.unwrap_or(("MISSED", String::new()));
        println!("| {count} | {} | `{}` | {level} | {test} |", mutant.what, mutant.file);
    }
    if count == 0 {
        Err(format!("no mutant has {word:?} in its description: see tests/mutants/table.rs"))
    } else {
        Ok([count, missed])
    }
}

fn main() -> ExitCode {
    match all(&env::args().nth(1).unwrap_or_default()) {
        Ok([count, missed]) => {
            println!("{} found, {missed} missed", count - missed);
            if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(why) => {
            eprintln!("{why}");
            ExitCode::from(2)
        }
    }
}
