//! The report of an interrupted study: its finished runs, and its results as if its budget had ended there.

use std::fs;

use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::units::time;

use super::results::Results;
use crate::export::whole::partial_name;
use crate::folder::Folder;

/// A finished run.
#[derive(Clone, Debug, Serialize)]
pub struct Finished {
    /// The run, in words.
    pub run: String,
    /// Computing time of its steps, s.
    pub wall_s: f64,
    /// How it ended, in words.
    pub ending: String,
}

/// The results of a study up to an interrupt.
pub struct SoFar {
    /// The picture, if there is anything to show.
    pub svg: Option<String>,
    /// The numbers.
    pub numbers: Value,
    /// The report as text.
    pub lines: String,
}

impl SoFar {
    /// Converts the numbers. An error means that they cannot be converted.
    pub fn new(svg: Option<String>, numbers: &impl Serialize, lines: String) -> Result<Self, Failure> {
        let numbers = serde_json::to_value(numbers).map_err(|error| Failure::Tool(error.to_string()))?;
        Ok(Self { svg, numbers, lines })
    }
}

/// The numbers of a complete study. If it went on after an interrupt, they have the number of runs that it did not
/// repeat.
#[derive(Serialize)]
pub struct Numbers<'a, T> {
    #[serde(flatten)]
    numbers: &'a T,
    #[serde(skip_serializing_if = "Option::is_none")]
    runs_before_interrupt: Option<usize>,
}

impl<T: Serialize> Numbers<'_, T> {
    /// The results of a study of which `known` of `all` runs were made before an interrupt.
    pub fn results(
        svg: Option<String>,
        numbers: &T,
        lines: &str,
        known: usize,
        all: usize,
    ) -> Result<Results, Failure> {
        let runs_before_interrupt = Some(known).filter(|&known| known > 0);
        let before = runs_before_interrupt.map(|known| {
            format!("\n\n{known} of {all} runs were made before an interrupt, and their times were measured then")
        });
        let lines = format!("{lines}{}", before.unwrap_or_default());
        Results::new(svg, &Numbers { numbers, runs_before_interrupt }, lines)
    }
}

#[derive(Serialize)]
struct Partial<'a> {
    partial: bool,
    finished: usize,
    runs: &'a [Finished],
    so_far: Option<&'a Value>,
}

/// The stem of the files of a partial report.
fn stem(name: &str) -> String {
    format!("{name}.partial")
}

/// Writes and prints the partial report of the study `name`, which has `finished` outcomes, and returns the failure
/// with which the command ends. Without outcomes there is no report.
pub fn report(
    folder: &Folder,
    name: &str,
    finished: usize,
    runs: &[Finished],
    so_far: Option<&SoFar>,
    json: bool,
    quiet: bool,
) -> Failure {
    if finished == 0 {
        return Failure::Interrupted("interrupted before a run was finished: there is nothing to report".into());
    }
    let head = format!(
        "PARTIAL: interrupted after {finished} finished runs; a missing run counts as if the budget had ended. The \
         same command goes on from these runs."
    );
    let table = runs.iter().map(|run| format!("{:<60} {:>10}  {}", run.run, time(run.wall_s), run.ending));
    let lines = [Some(head), so_far.map(|known| known.lines.clone())].into_iter().flatten();
    let lines = lines.chain([table.collect::<Vec<_>>().join("\n")]).filter(|part| !part.is_empty());
    let lines = lines.collect::<Vec<_>>().join("\n\n");
    let numbers = Partial { partial: true, finished, runs, so_far: so_far.map(|known| &known.numbers) };
    let svg = so_far.and_then(|known| known.svg.clone());
    let written = Results::new(svg, &numbers, lines).and_then(|results| {
        let written = results.write(folder, &stem(name))?;
        results.print(json, quiet, &written)
    });
    match written {
        Ok(()) => Failure::Interrupted(format!(
            "interrupted after {finished} finished runs: {} has the results so far; go on with the same command",
            folder.path().join(format!("{}.txt", stem(name))).display()
        )),
        Err(failure) => failure,
    }
}

/// Removes the partial report of an earlier call and its unfinished files: the study is complete.
pub fn remove(folder: &Folder, name: &str) {
    for kind in ["svg", "json", "txt"] {
        let file = folder.path().join(format!("{}.{kind}", stem(name)));
        // Usually neither exists, so errors are ignored.
        let _ = fs::remove_file(partial_name(&file));
        let _ = fs::remove_file(file);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complete_study_removes_unfinished_files_of_a_partial_report() {
        let kept = tempfile::tempdir().unwrap();
        let folder = Folder::take(kept.path().into()).unwrap();
        for name in ["chart.partial.svg", "chart.partial.txt.partial", "other.partial.svg.partial"] {
            fs::write(kept.path().join(name), "").unwrap();
        }
        remove(&folder, "chart");
        let left = fs::read_dir(kept.path()).unwrap().map(|entry| entry.unwrap().file_name());
        let left: Vec<_> = left.filter(|name| name.to_str().is_some_and(|name| name.contains("partial"))).collect();
        assert_eq!(left, ["other.partial.svg.partial"]);
    }
}
