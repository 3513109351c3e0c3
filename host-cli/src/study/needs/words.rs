//! The result of a trial as a sentence.

use crate::study::distance::Measure;
use crate::study::terms::VariantKind;
use crate::units::length;

use super::row::{Change, Cost, Row};
use super::trial::Baseline;

/// The compared quantity, in words.
pub const fn moved(measure: Measure) -> &'static str {
    match measure {
        Measure::Positions => "cloth",
        Measure::Outline => "outline",
    }
}

/// The sentence of a row; `subject` is the term together with its simpler alternative, if it has one.
pub fn sentence(row: &Row, subject: &str, change: Option<Change>, cost: Option<Cost>, baseline: &Baseline) -> String {
    let Some(change) = change else {
        return format!("{} it {}", row.run, row.why.as_deref().unwrap_or("is not known"));
    };
    let would = row.kind == VariantKind::Added;
    let (what, finer) = (moved(baseline.measure), baseline.variant.shorter_steps_in_words());
    let less = format!(", less than {finer} does,");
    let hidden = if row.exceeds_step == Some(false) { less.as_str() } else { "" };
    let moves = match (change.max > 0.0, would) {
        (true, true) => format!("would move the {what} by {}{hidden}", extent(change, row.positions_rms)),
        (true, false) => format!("moves the {what} by {}{hidden}", extent(change, row.positions_rms)),
        (false, true) => format!("would not move the {what}"),
        (false, false) => format!("does not move the {what}"),
    };
    let cost = cost.map_or_else(
        || " and is not timed: the budget is used up".into(),
        |cost| costs(row.kind, &row.run, cost, row.same_counts == Some(true)),
    );
    // If a comma is followed by a new clause, only the semicolon stays.
    format!("{subject} {moves}{cost}").replace(",;", ";")
}

/// The change in words: RMS, largest and final value; with contact also the RMS change of the vertices.
pub fn extent(change: Change, positions: Option<f64>) -> String {
    let vertices = positions.map_or_else(String::new, |rms| format!("; vertices by {}", length(rms)));
    let [rms, max, end] = [change.rms, change.max, change.end].map(length);
    format!("{rms} (RMS; at most {max}, at the end {end}{vertices})")
}

/// The cost, as the end of a sentence. If all counts are the same, it says so: then only the clock shows a
/// difference.
fn costs(kind: VariantKind, run: &str, cost: Cost, same_counts: bool) -> String {
    let (added, dearer) = (kind == VariantKind::Added, cost.fraction >= 0.0);
    let sizes = cost.reported_sizes();
    let note = [(cost.repeats == 1).then_some("timed once"), same_counts.then_some("all counts are the same")];
    let note = note.into_iter().flatten().collect::<Vec<_>>().join("; ");
    let note = if note.is_empty() { note } else { format!(" ({note})") };
    match (added, dearer) {
        _ if !cost.is_clear() => {
            // Adding 0.0 after rounding turns -0 into 0, so that "-0" is not printed.
            let [least, most] = cost.spread.map(|fraction| (100.0 * fraction).round() + 0.0);
            let verb = if added { "cost" } else { "costs" };
            let counted = if same_counts { "can be counted or that " } else { "" };
            format!(" and {verb} nothing that {counted}the clock can tell ({least:.0} to {most:.0} % of the time)")
        }
        (true, true) => format!(" and take {}{note}", longer(&sizes)),
        (true, false) => format!(" and save {} of the time{note}", percent(&sizes)),
        (false, true) => format!(" and costs {} of the time{note}", percent(&sizes)),
        (false, false) => format!("; {run} it takes {}{note}", longer(&sizes)),
    }
}

/// How much longer a run takes than the unchanged scene; `parts` are parts of that scene's time.
fn longer(parts: &[f64]) -> String {
    if parts.iter().all(|&part| part < 1.0) {
        return format!("{} longer", percent(parts));
    }
    let times: Vec<_> = parts.iter().map(|part| format!("{:.1}", 1.0 + part)).collect();
    format!("{} times as long", times.join(" to "))
}

/// One part, or a range of parts, as percentages.
fn percent(parts: &[f64]) -> String {
    match parts {
        [part] if *part < 0.01 => "less than 1 %".into(),
        _ => {
            let percents: Vec<_> = parts.iter().map(|part| format!("{:.0}", 100.0 * part)).collect();
            format!("{} %", percents.join(" to "))
        }
    }
}

/// Joins words to a list.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).into(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_is_told_as_far_as_it_is_known() {
        let said = |kind, [least, fraction, most]: [f64; 3], repeats| {
            let range = [least, most];
            costs(kind, "without drag", Cost { fraction, range, repeats, spread: range }, false)
        };
        let cases = [
            (VariantKind::Off, [0.29, 0.31, 0.33], 3, " and costs 31 % of the time"),
            (VariantKind::Off, [0.31; 3], 1, " and costs 31 % of the time (timed once)"),
            (VariantKind::Simpler, [0.07, 0.13, 0.33], 3, " and costs 7 to 33 % of the time"),
            (
                VariantKind::Off,
                [-0.003, 0.01, 0.02],
                5,
                " and costs nothing that the clock can tell (0 to 2 % of the time)",
            ),
            (VariantKind::Off, [-0.13, -0.12, -0.11], 3, "; without drag it takes 12 % longer"),
            (VariantKind::Off, [-0.44, -0.07, -0.05], 3, "; without drag it takes 5 to 44 % longer"),
            (VariantKind::Added, [1.9, 2.0, 2.1], 3, " and take 3.0 times as long"),
            (VariantKind::Added, [-0.2, -0.2, -0.2], 3, " and save 20 % of the time"),
            (
                VariantKind::Added,
                [-0.02, 0.0, 0.02],
                3,
                " and cost nothing that the clock can tell (-2 to 2 % of the time)",
            ),
            (VariantKind::Off, [0.004, 0.005, 0.006], 3, " and costs less than 1 % of the time"),
        ];
        for (kind, fractions, repeats, words) in cases {
            assert_eq!(said(kind, fractions, repeats), words);
        }
        let same = |least| {
            let cost = Cost { fraction: 0.1, range: [0.1; 2], repeats: 5, spread: [least, 0.3] };
            costs(VariantKind::Off, "without drag", cost, true)
        };
        assert_eq!(same(0.05), " and costs 10 % of the time (all counts are the same)");
        assert_eq!(
            same(-0.05),
            " and costs nothing that can be counted or that the clock can tell (-5 to 30 % of the time)"
        );
    }
}
