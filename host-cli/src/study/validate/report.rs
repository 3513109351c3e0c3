//! The report of `muslin validate`: numbers and text.

use serde::Serialize;

use super::check::{Check, Tolerance};

/// The result of one check.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Group of the check.
    pub group: &'static str,
    #[serde(skip)]
    about: &'static str,
    /// Name of the check.
    pub name: String,
    /// Unit of the values; empty if they have no unit.
    pub unit: &'static str,
    /// The known answer.
    pub expected: f64,
    /// The value of the core; `None` if nothing was measured.
    pub measured: Option<f64>,
    /// Error of the measured value: a part of the expected value if `relative`, otherwise a difference.
    pub error: Option<f64>,
    /// The largest error that passes.
    pub tolerance: f64,
    /// Whether errors are parts of the expected value.
    pub relative: bool,
    /// Whether the error is within the tolerance.
    pub pass: bool,
    /// Why nothing was measured.
    pub why: Option<String>,
}

impl Row {
    /// The result of a check, from its measured value or from the reason why nothing was measured.
    pub fn new(group: &'static str, about: &'static str, check: &Check, measured: Result<f64, String>) -> Self {
        let value = measured.as_ref().ok().copied();
        let error = value.map(|value| check.tolerance.error(check.expected, value));
        Self {
            group,
            about,
            name: check.name.clone(),
            unit: check.unit,
            expected: check.expected,
            measured: value,
            error,
            tolerance: check.tolerance.bound(),
            relative: matches!(check.tolerance, Tolerance::Relative(_)),
            // NaN does not pass.
            pass: error.is_some_and(|error| error.abs() <= check.tolerance.bound()),
            why: measured.err(),
        }
    }

    /// An error in the form of the report: per cent or a plain number.
    fn scaled(&self, error: f64) -> String {
        match self.relative {
            // Tolerances near rounding are not shown in per cent.
            true if self.tolerance >= 1e-4 => format!("{:.3} %", 100.0 * error),
            _ => format!("{error:.1e}"),
        }
    }

    /// One line of the report; `wide` is the width of the widest name in its group.
    fn line(&self, wide: usize) -> String {
        let Self { name, unit, expected, why, .. } = self;
        let verdict = if self.pass { "pass" } else { "FAIL" };
        let found = match (self.measured, self.error) {
            (Some(measured), Some(error)) => format!("{:>14} {:>11}", number(measured), self.scaled(error)),
            _ => format!("{:>26}", "nothing"),
        };
        let why = why.as_ref().map_or_else(String::new, |why| format!(": {why}"));
        let tolerance = self.scaled(self.tolerance);
        format!("  {name:<wide$} {unit:<6} {:>14} {found} {tolerance:>9}  {verdict}{why}", number(*expected))
    }
}

/// A number with seven digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => format!("{value:.7}"),
        _ => format!("{value:.6e}"),
    }
}

/// The report, `validate --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// All checks.
    pub rows: Vec<Row>,
    /// Number of checks that pass.
    pub passed: usize,
    /// Number of checks that fail.
    pub failed: usize,
    /// Computing time of the checks, s.
    pub study_s: f64,
}

impl Report {
    /// The report of checks that took `study_s` seconds.
    pub fn new(rows: Vec<Row>, study_s: f64) -> Self {
        let passed = rows.iter().filter(|row| row.pass).count();
        Self { passed, failed: rows.len() - passed, rows, study_s }
    }

    /// Summary of the failures, which names the first one; `None` if all checks pass.
    pub fn verdict(&self) -> Option<String> {
        let first = self.rows.iter().find(|row| !row.pass)?;
        let value = first.measured.map_or_else(|| "nothing".into(), number);
        Some(format!(
            "{} of {} checks fail, first {} {}: expected {} within {}, measured {value}",
            self.failed,
            self.rows.len(),
            first.group,
            first.name,
            number(first.expected),
            first.scaled(first.tolerance)
        ))
    }

    /// The report as text.
    pub fn lines(&self) -> String {
        let mut lines = Vec::new();
        for rows in self.rows.chunk_by(|a, b| a.group == b.group) {
            let wide = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
            let [unit, expected, measured, error, tolerance] = ["unit", "expected", "measured", "error", "tolerance"];
            lines.push(format!("{}: {}\n", rows[0].group, rows[0].about));
            lines.push(format!("  {:<wide$} {unit:<6} {expected:>14} {measured:>14} {error:>11} {tolerance:>9}", ""));
            lines.extend(rows.iter().map(|row| row.line(wide)));
            lines.push(String::new());
        }
        lines.push(format!("{} of {} checks pass; {:.0} s", self.passed, self.rows.len(), self.study_s));
        lines.join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(expected: f64, bound: f64, measured: Result<f64, String>) -> Row {
        let check = Check::absolute(format!("{expected} and {measured:?}"), expected, bound, |_| Ok(0.0));
        Row::new("group", "about", &check, measured)
    }

    #[test]
    fn a_row_passes_within_its_tolerance_only() {
        assert!(row(1.0, 0.25, Ok(1.25)).pass && row(1.0, 0.25, Ok(0.75)).pass);
        let broken = || Err("it broke".into());
        for measured in [Ok(1.2501), Ok(0.7499), Ok(f64::NAN), Ok(f64::INFINITY), broken()] {
            assert!(!row(1.0, 0.25, measured.clone()).pass, "{measured:?}");
        }
        let relative = Check::relative("relative", 4.0, 0.25, |_| Ok(0.0));
        assert_eq!(Row::new("group", "about", &relative, Ok(5.0)).error, Some(0.25));
    }

    #[test]
    fn the_first_that_fails_is_named() {
        let good = || row(1.0, 0.5, Ok(1.0));
        assert_eq!(Report::new(vec![good()], 0.0).verdict(), None);
        let report = Report::new(vec![good(), row(2.0, 0.5, Ok(3.0)), row(4.0, 0.5, Err("it broke".into()))], 0.0);
        let verdict = report.verdict().unwrap();
        assert!(verdict.starts_with("2 of 3 checks fail, first group 2 and Ok(3.0): expected 2"), "{verdict}");
        let lines = report.lines();
        assert!(lines.contains("FAIL: it broke") && lines.ends_with("1 of 3 checks pass; 0 s"), "{lines}");
    }
}
