//! The report: time of every step and suite, the slowest tests, skipped tests, failures.

use std::collections::BTreeSet;
use std::fmt;
use std::time::{Duration, Instant};

/// Number of slowest tests that are listed.
const SLOWEST: usize = 10;

/// Prefix of the line by which a test reports that something it needs is absent.
const SKIPPED: &str = "skipped: ";

/// How a test ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It ran and passed.
    Passed,
    /// It ran and failed.
    Failed,
    /// It is slow: only the full level runs it.
    LeftOut,
    /// It ended early, because this machine lacks a driver, a program or input.
    Skipped,
}

/// One test.
#[derive(Clone, Debug)]
pub struct Test {
    /// Name with its modules.
    pub name: String,
    /// Its time, s.
    pub seconds: f64,
    /// How it ended.
    pub ending: Ending,
    /// What it printed.
    pub output: String,
}

/// Result of a command or of a suite.
#[derive(Clone, Debug)]
pub struct Outcome {
    name: String,
    time: Duration,
    /// The tests of a suite; empty for a command.
    pub tests: Vec<Test>,
    /// Failures, each with the first step to fix it.
    pub failures: Vec<String>,
    /// Reasons why parts were not tested.
    pub skipped: Vec<String>,
    /// Whether it counts as a check: a build does not.
    pub counts: bool,
}

/// Results of all steps.
#[derive(Debug)]
pub struct Report {
    started: Instant,
    outcomes: Vec<Outcome>,
    skipped: BTreeSet<String>,
    skipped_steps: usize,
}

impl Outcome {
    /// A passed outcome that took `time`.
    pub fn new(name: String, time: Duration) -> Self {
        Self { name, time, tests: Vec::new(), failures: Vec::new(), skipped: Vec::new(), counts: true }
    }

    /// Adds a failure.
    pub fn failed(mut self, why: String) -> Self {
        self.failures.push(why);
        self
    }

    fn count(&self, ending: Ending) -> usize {
        self.tests.iter().filter(|test| test.ending == ending).count()
    }

    /// Counts of passed, failed, left out and skipped; a command counts as one.
    fn counts(&self) -> [usize; 4] {
        if self.tests.is_empty() {
            let failed = usize::from(!self.failures.is_empty());
            return [usize::from(self.counts) * (1 - failed), failed, 0, 0];
        }
        [self.count(Ending::Passed), self.failures.len(), self.count(Ending::LeftOut), self.count(Ending::Skipped)]
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>7.1} s", self.time.as_secs_f64())?;
        let [passed, failed, left_out, skipped] = self.counts();
        if !self.tests.is_empty() {
            write!(f, "{passed:>5} passed")?;
            if left_out > 0 {
                write!(f, ", {left_out} left out")?;
            }
            if skipped > 0 {
                write!(f, ", {skipped} skipped")?;
            }
        }
        if failed > 0 { write!(f, "  {failed} FAILED") } else { Ok(()) }
    }
}

impl Report {
    /// An empty report.
    pub fn new() -> Self {
        Self { started: Instant::now(), outcomes: Vec::new(), skipped: BTreeSet::new(), skipped_steps: 0 }
    }

    /// Adds an outcome.
    pub fn add(&mut self, outcome: Outcome) {
        self.skipped.extend(outcome.tests.iter().flat_map(|test| reasons(&test.output)).map(str::to_owned));
        self.skipped.extend(outcome.skipped.iter().cloned());
        if outcome.tests.is_empty() && outcome.failures.is_empty() {
            println!("    passed in {:.1} s", outcome.time.as_secs_f64());
        }
        for failure in outcome.failures.iter().filter(|_| outcome.tests.is_empty()) {
            println!("    FAILED: {failure}");
        }
        self.outcomes.push(outcome);
    }

    /// Records a step that cannot be run here.
    pub fn skipped(&mut self, name: &str, why: &str) {
        println!("    skipped: {why}");
        self.skipped_steps += 1;
        self.skipped.insert(format!("{name}: {why}"));
    }

    /// Whether nothing failed.
    pub fn passed(&self) -> bool {
        self.outcomes.iter().all(|outcome| outcome.failures.is_empty())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nTime of each step and suite")?;
        for outcome in &self.outcomes {
            writeln!(f, "    {:<40}{outcome}", outcome.name)?;
        }
        let tests = self.outcomes.iter().flat_map(|outcome| outcome.tests.iter().map(move |test| (outcome, test)));
        let mut tests: Vec<_> = tests.collect();
        tests.sort_by(|(_, a), (_, b)| b.seconds.total_cmp(&a.seconds));
        if !tests.is_empty() {
            writeln!(f, "\nThe slowest tests")?;
        }
        for (suite, test) in tests.iter().take(SLOWEST) {
            writeln!(f, "    {:>7.1} s  {} {}", test.seconds, suite.name, test.name)?;
        }
        if !self.skipped.is_empty() {
            writeln!(f, "\nNot tested here")?;
        }
        self.skipped.iter().try_for_each(|why| writeln!(f, "    {why}"))?;
        let failures = self.outcomes.iter().flat_map(|outcome| outcome.failures.iter().map(move |why| (outcome, why)));
        let failures: Vec<_> = failures.collect();
        if !failures.is_empty() {
            writeln!(f, "\nFailed")?;
        }
        for (outcome, why) in &failures {
            writeln!(f, "    {}: {why}", outcome.name)?;
        }
        let sum = |k: usize| self.outcomes.iter().map(|outcome| outcome.counts()[k]).sum::<usize>();
        writeln!(f, "\nin {:.0} s", self.started.elapsed().as_secs_f64())?;
        write!(f, "{} passed, {} failed", sum(0), sum(1))?;
        if sum(2) > 0 {
            write!(f, ", {} left out (slow: add `-- --all`)", sum(2))?;
        }
        writeln!(f, ", {} skipped", sum(3) + self.skipped_steps)
    }
}

/// The reasons for an early end that a test's output gives.
pub fn reasons(output: &str) -> impl Iterator<Item = &str> {
    output.lines().filter_map(|line| line.strip_prefix(SKIPPED))
}
