//! `muslin validate`: the core in double precision, compared with known answers.

mod bisect;
mod cantilever;
mod catenary;
mod chains;
mod check;
mod compression;
mod critical;
mod derivatives;
mod elastica;
mod energy;
mod falls;
mod friction;
mod hinge;
mod lab;
mod lattice;
mod momentum;
mod net;
mod orders;
mod patch;
mod plates;
mod projection;
mod report;
mod rigidity;
mod spectra;

pub use cantilever::{CUTS, GAMMAS, TOLERANCE};
pub use elastica::drop_over_reach;
pub use hinge::cylinders;
pub use report::{Report, Row};

use std::time::Instant;

use crate::args::ValidateArguments;
use crate::failure::{Failure, print_data};
use crate::folder::Folder;
use crate::interrupt;

use super::draw;
use super::kept::Kept;
use super::partial::{self, Numbers, SoFar};
use check::Check;
use lab::{Lab, Miss};
use muslin_core_f64::dispatch::Dispatch;

/// A group of related checks.
struct Group {
    name: &'static str,
    /// Description: the measured quantities and the known answers.
    about: &'static str,
    checks: fn() -> Vec<Check>,
}

/// Every group, in the order of the report.
const GROUPS: [Group; 16] = [
    Group { name: "cantilever", about: cantilever::ABOUT, checks: cantilever::checks },
    Group { name: "hinge", about: hinge::ABOUT, checks: hinge::checks },
    Group { name: "plates", about: plates::ABOUT, checks: plates::checks },
    Group { name: "patch", about: patch::ABOUT, checks: patch::checks },
    Group { name: "derivatives", about: derivatives::ABOUT, checks: derivatives::checks },
    Group { name: "projection", about: projection::ABOUT, checks: projection::checks },
    Group { name: "compression", about: compression::ABOUT, checks: compression::checks },
    Group { name: "spectra", about: spectra::ABOUT, checks: spectra::checks },
    Group { name: "chains", about: chains::ABOUT, checks: chains::checks },
    Group { name: "catenary", about: catenary::ABOUT, checks: catenary::checks },
    Group { name: "energy", about: energy::ABOUT, checks: energy::checks },
    Group { name: "falls", about: falls::ABOUT, checks: falls::checks },
    Group { name: "momentum", about: momentum::ABOUT, checks: momentum::checks },
    Group { name: "orders", about: orders::ABOUT, checks: orders::checks },
    Group { name: "critical", about: critical::ABOUT, checks: critical::checks },
    Group { name: "friction", about: friction::ABOUT, checks: friction::checks },
];

/// Runs the requested checks and writes their results.
pub fn validate(arguments: &ValidateArguments) -> Result<(), Failure> {
    let chosen = choose(arguments.only.as_deref())?;
    if arguments.list {
        return print_data(&names(&chosen).join("\n"));
    }
    // The handler is installed before anything is written that an interrupt would leave behind.
    let lab = Lab::new(interrupt::watch()?);
    let folder = Folder::take(arguments.out.clone())?;
    let name = file_name(arguments.only.as_deref());
    let kept = Kept::of(folder.path(), &name);
    let report = run(&lab, &chosen, &kept, arguments.quiet);
    let svg = draw::master_curve(&report.rows).or_else(|| draw::rigidity(&report.rows));
    if lab.stopped() {
        let so_far = SoFar::new(svg, &report, report.lines())?;
        return Err(partial::report(
            &folder,
            &name,
            report.rows.len(),
            &[],
            Some(&so_far),
            arguments.json,
            arguments.quiet,
        ));
    }
    let results = Numbers::results(svg, &report, &report.lines(), kept.known(), report.rows.len())?;
    let written = results.write(&folder, &name)?;
    kept.forget();
    partial::remove(&folder, &name);
    results.print(arguments.json, arguments.quiet, &written)?;
    match report.verdict() {
        Some(why) => Err(Failure::Missed(why)),
        None => Ok(()),
    }
}

/// The group and the name of every check.
fn names(chosen: &[(&Group, Vec<Check>)]) -> Vec<String> {
    let of_group = |(group, checks): &(&Group, Vec<Check>)| -> Vec<String> {
        checks.iter().map(|check| format!("{:12} {}", group.name, check.name)).collect()
    };
    chosen.iter().flat_map(of_group).collect()
}

/// The stem of the files. A selection of the checks has a name of its own, so that it does not overwrite the
/// results of all checks.
fn file_name(only: Option<&str>) -> String {
    let words = only.map_or_else(Vec::new, words);
    std::iter::once("validate".into()).chain(words).collect::<Vec<_>>().join("-")
}

/// The selected checks by group: all if `only` is missing, a whole group if it is the name of one, otherwise all
/// checks whose name, preceded by the group's, contains the words of `only` in a row. It is an error if no check is
/// selected.
fn choose(only: Option<&str>) -> Result<Vec<(&'static Group, Vec<Check>)>, Failure> {
    let only = only.map(words);
    let is_group = |only: &[String]| GROUPS.iter().any(|group| only == [group.name]);
    let wanted = |group: &Group, check: &Check| match only.as_deref() {
        None => true,
        Some(only) if is_group(only) => only == [group.name],
        Some(only) => {
            let name = format!("{} {}", group.name, check.name);
            !only.is_empty() && words(&name).windows(only.len()).any(|part| part == only)
        }
    };
    let chosen: Vec<_> = GROUPS
        .iter()
        .map(|group| (group, (group.checks)().into_iter().filter(|check| wanted(group, check)).collect::<Vec<_>>()))
        .filter(|(_, checks)| !checks.is_empty())
        .collect();
    if chosen.is_empty() {
        let groups: Vec<_> = GROUPS.iter().map(|group| group.name).collect();
        return Err(Failure::Usage(format!(
            "--only {}: no check has these words in its name; the groups are {}",
            only.unwrap_or_default().join(" "),
            groups.join(", ")
        )));
    }
    Ok(chosen)
}

/// The words and numbers of a text in lower case, without the characters between them.
fn words(text: &str) -> Vec<String> {
    let between = |letter: char| !(letter.is_alphanumeric() || matches!(letter, '.' | '-'));
    text.split(between).filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

/// Runs one check after the other, until an interrupt. Checks of an interrupted call are not run again.
fn run(lab: &Lab, chosen: &[(&'static Group, Vec<Check>)], kept: &Kept, quiet: bool) -> Report {
    let started = Instant::now();
    let all = || chosen.iter().flat_map(|(group, checks)| checks.iter().map(move |check| (group, check)));
    let bar = crate::progress::bar(all().count() as u64, "{pos} of {len} {wide_bar} {msg}", quiet);
    let mut rows = Vec::new();
    for (group, check) in all() {
        bar.set_message(format!("{} {}", group.name, check.name));
        let Some(measured) = measure(lab, group, check, kept) else { break };
        rows.push(Row::new(group.name, group.about, check, measured));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Report::new(rows, started.elapsed().as_secs_f64())
}

/// The value of a check, or the reason why it has none; `None` after an interrupt.
fn measure(lab: &Lab, group: &Group, check: &Check, kept: &Kept) -> Option<Result<f64, String>> {
    let entry = kept.entry(&format!("{} {}", group.name, check.name));
    kept.find(&entry, |_| true).or_else(|| {
        let measured = match (check.measure)(lab) {
            // An interrupted measurement may have a value, but it says nothing.
            _ if lab.stopped() => return None,
            Err(Miss::Stopped) => return None,
            Err(Miss::Why(why)) => Err(why),
            Ok(value) => Ok(value),
        };
        kept.keep(&entry, &measured);
        Some(measured)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_a_part_have_names_of_their_own() {
        let names = [None, Some("hinge"), Some("Gamma 0.5"), Some("../rows [1.0, 0.5], x/y")].map(file_name);
        let expected = ["validate", "validate-hinge", "validate-gamma-0.5", "validate-..-rows-1.0-0.5-x-y"];
        assert_eq!(names, expected);
    }
}
