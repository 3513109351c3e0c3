//! The cheapest runs: for each error, and as a front.

use super::report::{Row, Winner};

/// For each power of ten that some run reaches: the cheapest run with at most this error in either precision, and
/// the next one by another approach. `least` is the smallest error that the reference resolves.
pub fn of(rows: &[Row], least: f64) -> Vec<Winner> {
    (1..=12).map_while(|digits| at(rows, least, 10f64.powi(-digits))).collect()
}

fn at(rows: &[Row], least: f64, error: f64) -> Option<Winner> {
    let near_enough = rows.iter().filter(|row| row.error_at_most(least).is_some_and(|rms| rms <= error));
    let mut best: Vec<&Row> = Vec::new();
    for row in near_enough {
        // Keeps the cheapest run of each approach in either precision.
        match best.iter_mut().find(|other| other.approach() == row.approach()) {
            Some(other) if row.wall_s < other.wall_s => *other = row,
            Some(_) => {}
            None => best.push(row),
        }
    }
    best.sort_by(|a, b| a.wall_s.total_cmp(&b.wall_s));
    let winner = *best.first()?;
    Some(Winner {
        error,
        method: winner.method,
        precision: winner.precision,
        step: winner.step,
        allowed_error_m: winner.allowed_error_m,
        solver: winner.solver,
        wall_s: winner.wall_s,
        next: best.get(1).map(|row| (row.approach(), row.wall_s / winner.wall_s)),
    })
}

/// The runs that no cheaper run equals in error, from the cheapest to the most exact.
pub fn front(rows: &[Row], least: f64) -> Vec<&Row> {
    let mut ranked: Vec<_> = rows.iter().filter_map(|row| Some((row.error_at_most(least)?, row))).collect();
    ranked.sort_by(|(a, own), (b, other)| own.wall_s.total_cmp(&other.wall_s).then(a.total_cmp(b)));
    let mut nearest = f64::INFINITY;
    let improves = |(error, row): (f64, _)| (error < nearest).then(|| (nearest = error, row).1);
    ranked.into_iter().filter_map(improves).collect()
}
