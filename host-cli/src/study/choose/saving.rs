//! Simplification of the choice: leaves out terms that the tolerance does not need, and loosens the solver.

use toml::Value;

use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::median::median;
use crate::study::terms::{self, Edit, Term, VariantKind};
use crate::study::trajectory::Ending;

use super::pilot::Pilot;
use super::row::Row;

/// Smallest saving that justifies an additional error, as a part of the time.
const WORTH: f64 = 0.05;

/// Number of pairs of runs that time a saving. Runs longer than `LONG`, s, are timed in one pair only.
const PAIRS: usize = 5;
const LONG: f64 = 2.0;

/// Factors by which the solver's tolerance is loosened, tried in turn.
const LOOSER: [f64; 3] = [10.0, 100.0, 1000.0];

/// A choice: the simplified scene and how it is run.
pub struct Candidate {
    /// The scene with its original method and step.
    pub scene: SceneFile,
    /// Its pilot run.
    pub row: Row,
}

impl Candidate {
    /// The choice with the scene as it was given.
    pub fn new(study: &Study<'_>, row: Row) -> Self {
        Self { scene: study.scene.clone(), row }
    }
}

/// Leaves out the terms that are not needed one after the other, whole terms before their parts.
pub fn leave_out(pilot: &mut Pilot<'_>, mut found: Candidate, mean_edges: &[f64]) -> Result<Candidate, Failure> {
    if found.row.variant.tolerance(&found.scene).is_some() {
        found = loosen(pilot, found)?;
    }
    let modelled = |scene: &SceneFile| terms::of(&scene.desc, mean_edges);
    let mut names: Vec<Term> = modelled(&found.scene);
    names.retain(|term| term.kind != VariantKind::Added);
    names.sort_by_key(|term| !term.part_of.is_empty());
    for name in names {
        // The term as it is now: a simplification of another term may have changed it.
        let now = modelled(&found.scene).into_iter().find(|term| (term.name, term.kind) == (name.name, name.kind));
        if let Some(term) = now {
            let terms = [found.row.terms.clone(), vec![term.run]].concat();
            found = attempt(pilot, found, &terms, &term.edits)?;
        }
    }
    Ok(found)
}

/// Loosens the solver as far as that saves time.
fn loosen(pilot: &mut Pilot<'_>, found: Candidate) -> Result<Candidate, Failure> {
    let residual = found.scene.desc.integrator.residual();
    let mut loosest = found;
    for factor in LOOSER {
        let terms = [format!("with a solver {factor} times as loose")];
        let edits = [("integrator.tolerance".into(), Some(Value::Float(factor * residual)))];
        loosest = attempt(pilot, loosest, &terms, &edits)?;
        if loosest.row.terms != terms {
            break;
        }
    }
    Ok(loosest)
}

/// Applies the edits if the choice still meets the tolerance and saves time; otherwise returns it unchanged. `terms` are
/// the words for all its changes.
fn attempt(pilot: &mut Pilot<'_>, found: Candidate, terms: &[String], edits: &[Edit]) -> Result<Candidate, Failure> {
    let longest = pilot.left();
    if longest <= 0.0 {
        return Ok(found);
    }
    let scene = found.scene.changed(edits)?;
    let row = pilot.weigh(&scene, found.row.variant, terms, longest)?;
    if !row.meets() {
        return Ok(found);
    }
    let place = pilot.considered.len() - 1;
    let saved = saved(pilot, &found, &scene, place)?;
    let row = pilot.considered[place].clone();
    Ok(if saved.is_some_and(|saved| saved > WORTH) { Candidate { scene, row } } else { found })
}

/// The part of its time that the choice saves with another scene, whose pilot run is at `place`: the median of
/// pairs of runs. `None` if there was no time for a pair.
fn saved(pilot: &mut Pilot<'_>, found: &Candidate, scene: &SceneFile, place: usize) -> Result<Option<f64>, Failure> {
    let pairs = if found.row.wall_s > LONG { 1 } else { pilot.study.repeats(PAIRS) };
    let mut parts = Vec::new();
    for _ in 0..pairs {
        let as_is = pilot.fly(&found.scene, &found.row.variant, f64::INFINITY)?;
        let without = pilot.fly(scene, &found.row.variant, f64::INFINITY)?;
        if [&as_is, &without].iter().all(|run| run.ending == Ending::Complete) {
            pilot.considered[place].timed(without.wall);
            parts.push(1.0 - without.wall / as_is.wall);
        }
    }
    Ok((!parts.is_empty()).then(|| median(parts)))
}
