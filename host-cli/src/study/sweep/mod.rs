//! `muslin sweep`: a scene over a grid of overrides, with one line of results per run.

mod file;
mod grid;
mod ledger;
mod line;
mod table;

use std::path::{Path, PathBuf};

use crate::args::SweepArguments;
use crate::failure::{Failure, print_data, print_note};
use crate::interrupt;
use crate::limits;
use crate::pool::Pool;
use crate::progress;

pub use file::Sweep;
use grid::Point;
use ledger::{Ledger, Runs};

/// Most runs of one verdict that the summary names.
const MOST_NAMED: usize = 8;

/// A run and the key of its line.
#[derive(Clone)]
struct Task {
    point: Point,
    key: String,
}

/// A sweep before its first run, and the lines that its file has.
struct Prepared {
    sweep: Sweep,
    tasks: Vec<Task>,
    done: Runs,
}

/// Reads the sweep and builds all scenes whose runs are left, so that an error appears immediately and not hours later.
fn prepare(arguments: &SweepArguments) -> Result<Prepared, Failure> {
    let sweep = Sweep::read(&arguments.sweep)?;
    let tasks = plan(&sweep, arguments)?;
    let done = ledger::peek(&out(arguments))?;
    let mut left = tasks.iter().filter(|task| !done.contains_key(&task.key));
    left.try_for_each(|task| line::build(&sweep, task).map(drop))?;
    Ok(Prepared { sweep, tasks, done })
}

/// Runs a sweep or a shard of it.
pub fn sweep(arguments: &SweepArguments) -> Result<(), Failure> {
    let stop = interrupt::watch()?;
    let own = arguments.clone();
    let Some(prepared) = interrupt::until(&stop, move || prepare(&own))? else {
        return Err(Failure::Interrupted("interrupted while the scenes were built; nothing is written".into()));
    };
    let Prepared { sweep, tasks, done } = prepared?;
    let left = || tasks.iter().filter(|task| !done.contains_key(&task.key));
    let out = out(arguments);
    let pool =
        Pool::new(Some(arguments.threads)).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let mut ledger = Ledger::open(&out)?;
    let before = tasks.len() - left().count();
    if before > 0 && !arguments.quiet {
        print_note(&format!("{before} of {} done before", tasks.len()));
    }
    let bar = progress::bar(tasks.len() as u64, "{elapsed_precise} {bar:24} {pos}/{len} {wide_msg}", arguments.quiet);
    bar.set_position(before as u64);
    let ran: Result<(), Failure> = left().try_for_each(|task| {
        bar.set_message(task.point.name());
        if !ledger.has(&task.key)? {
            let line = line::of(&sweep, task, &pool, &stop)?;
            ledger.append(&task.key, &line)?;
        }
        bar.inc(1);
        Ok(())
    });
    bar.finish_and_clear();
    ran?;
    finish(arguments, &out, &tasks, &ledger.runs)
}

/// The tasks of this shard. The changes of all runs are checked, including the runs of other shards.
fn plan(sweep: &Sweep, arguments: &SweepArguments) -> Result<Vec<Task>, Failure> {
    let mut tasks = Vec::new();
    for index in 0..sweep.count()? {
        let point = sweep.point(index);
        let (desc, _) = sweep.scene.describe(&point.changes)?;
        limits::check(&desc).map_err(|why| refused(sweep, &point, &why))?;
        if arguments.shard.is_none_or(|shard| shard.takes(index)) {
            let key = point.key(&sweep.scene.with(&point.changes)?);
            tasks.push(Task { point, key });
        }
    }
    Ok(tasks)
}

fn refused(sweep: &Sweep, point: &Point, why: &str) -> Failure {
    Failure::Usage(format!("{}: the run with {}: {why}", sweep.label, point.name()))
}

/// The results file: the requested one, or a file in `out` named after the sweep and the shard.
fn out(arguments: &SweepArguments) -> PathBuf {
    let stem = arguments.sweep.file_stem().unwrap_or_default().to_string_lossy();
    match (&arguments.out, arguments.shard) {
        (Some(out), _) => out.clone(),
        (None, Some(shard)) => format!("out/{stem}.{}-of-{}.jsonl", shard.number, shard.count).into(),
        (None, None) => format!("out/{stem}.jsonl").into(),
    }
}

/// Reports the results of all runs, including the runs of earlier calls.
fn finish(arguments: &SweepArguments, out: &Path, tasks: &[Task], runs: &Runs) -> Result<(), Failure> {
    if arguments.quiet {
        return Ok(());
    }
    print_data(&table::lines(tasks, runs))?;
    let with = |verdict: &str| -> Vec<&Task> {
        tasks.iter().filter(|task| runs.get(&task.key).is_some_and(|line| line.verdict == verdict)).collect()
    };
    let [diverged, doubtful] = ["diverged", "doubtful"].map(with);
    let doubts = if doubtful.is_empty() { String::new() } else { format!(", {} doubtful", doubtful.len()) };
    print_note(&format!("{}: {} runs, {} of them diverged{doubts}", out.display(), tasks.len(), diverged.len()));
    for (verdict, tasks) in [("diverged", diverged), ("doubtful", doubtful)] {
        tasks.iter().take(MOST_NAMED).for_each(|task| print_note(&format!("{verdict}: {}", task.point.name())));
        if let Some(more) = tasks.len().checked_sub(MOST_NAMED).filter(|&more| more > 0) {
            print_note(&format!("{verdict}: {more} more, which the table shows"));
        }
    }
    Ok(())
}
