//! The results of a sweep as a table, one row per run.

use crate::summary::percent;
use crate::units::time;

use super::Task;
use super::ledger::Runs;

/// The table of all runs that have results.
pub fn lines(tasks: &[Task], runs: &Runs) -> String {
    let Some(first) = tasks.first() else { return "no runs".into() };
    let varied = first.point.varied().iter().map(|change| change.key.as_str());
    let head = ["index"].into_iter().chain(varied).chain(["precision", "verdict", "steps", "wall", "stretch"]);
    let mut rows: Vec<Vec<String>> = vec![head.map(String::from).collect()];
    rows.extend(tasks.iter().filter_map(|task| row(task, runs)));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..rows[0].len()).map(width).collect();
    let lines = rows.iter().map(|row| {
        let cells: Vec<_> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        cells.join("  ").trim_end().to_owned()
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn row(task: &Task, runs: &Runs) -> Option<Vec<String>> {
    let line = runs.get(&task.key)?;
    let values = task.point.varied().iter().map(|change| match change.value.as_str() {
        Some(word) => word.into(),
        None => change.value.to_string(),
    });
    // A run that diverged has no result: of it only the number of steps is told.
    let result = |figure: Option<String>| figure.filter(|_| line.verdict != "diverged").unwrap_or_else(|| "-".into());
    let [wall, stretch] = [Some(time(line.wall_s)), line.stretch.max_of_all_frames.map(percent)].map(result);
    let came_to = [line.verdict.clone(), line.steps.to_string(), wall, stretch];
    let precision = task.point.precision.name().to_owned();
    Some([task.point.index.to_string()].into_iter().chain(values).chain([precision]).chain(came_to).collect())
}
