//! What a term is worth, as a sentence.

use crate::study::distance::Measure;
use crate::study::units::length;

use super::row::{Change, Cost, Row};
use super::terms::Deed;

/// What moves, as people call it.
pub const fn moved(measure: Measure) -> &'static str {
    match measure {
        Measure::Positions => "cloth",
        Measure::Outline => "outline",
    }
}

/// A row in words; `subject` is the term with what it stands beside.
pub fn sentence(row: &Row, subject: &str, change: Option<Change>, cost: Option<Cost>, measure: Measure) -> String {
    let Some(change) = change else {
        return format!("{} it {}", row.run, row.why.as_deref().unwrap_or("is not known"));
    };
    let would = row.deed == Deed::Added;
    let what = moved(measure);
    let hidden = if row.told == Some(false) { ", less than half the step does," } else { "" };
    let moves = match (change.max > 0.0, would) {
        (true, true) => format!("would move the {what} by {}{hidden}", extent(change, row.positions_rms)),
        (true, false) => format!("moves the {what} by {}{hidden}", extent(change, row.positions_rms)),
        (false, true) => format!("would not move the {what}"),
        (false, false) => format!("does not move the {what}"),
    };
    let cost = cost.map_or_else(|| " and is not timed: the budget is used up".into(), |cost| costs(row, cost));
    // Before a new clause one comma is enough.
    format!("{subject} {moves}{cost}").replace(",;", ";")
}

/// How far, in its three measures; with contact also the vertices.
pub fn extent(change: Change, positions: Option<f64>) -> String {
    let vertices = positions.map_or_else(String::new, |rms| format!("; vertices by {}", length(rms)));
    let [rms, max, end] = [change.rms, change.max, change.end].map(length);
    format!("{rms} (RMS; at most {max}, at the end {end}{vertices})")
}

/// What it costs, as the end of a sentence.
fn costs(row: &Row, cost: Cost) -> String {
    let Cost { fraction, range: [least, most], .. } = cost;
    let once = if cost.repeats == 1 { " (timed once)" } else { "" };
    let share = percent(fraction);
    match row.deed {
        _ if !cost.is_clear() => {
            let verb = if row.deed == Deed::Added { "cost" } else { "costs" };
            let [least, most] = [least, most].map(|fraction| 100.0 * fraction);
            format!(" and {verb} nothing that the clock can tell ({least:.0} to {most:.0} % of the time)")
        }
        Deed::Added if fraction >= 0.0 => format!(" and take {}{once}", longer(fraction)),
        Deed::Added => format!(" and save {share} of the time{once}"),
        _ if fraction >= 0.0 => format!(" and costs {share} of the time{once}"),
        _ => format!("; {} it takes {}{once}", row.run, longer(-fraction)),
    }
}

/// How much more a run takes than the scene as it is, by a part of its time.
fn longer(part: f64) -> String {
    if part < 1.0 { format!("{} longer", percent(part)) } else { format!("{:.1} times as long", 1.0 + part) }
}

/// The size of a part.
fn percent(part: f64) -> String {
    let percent = 100.0 * part.abs();
    if percent < 1.0 { "less than 1 %".into() } else { format!("{percent:.0} %") }
}

/// Words as a list.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).into(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}
