//! Simplification of the choice: leaves out terms that the tolerance does not need, and loosens the solver.

use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::median::median;
use crate::study::terms::{self, Term, VariantKind};
use crate::study::trajectory::Ending;
use crate::study::variant::Variant;

use super::pilot::Pilot;
use super::row::Row;

/// Smallest saving that justifies an additional error, as a part of the time.
const WORTH: f64 = 0.05;

/// Number of pairs of runs that time a saving. Runs longer than `LONG`, s, are timed in one pair only.
const PAIRS: usize = 5;
const LONG: f64 = 2.0;

/// Factor by which the solver is loosened, as long as that saves time.
const LOOSER: f64 = 10.0;

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
    let is_implicit = found.row.variant.method.is_implicit();
    names.retain(|term| term.kind != VariantKind::Added && (is_implicit || term.name != terms::NEWTON));
    names.sort_by_key(|term| !term.part_of.is_empty());
    for name in names {
        // The term as it is now: a simplification of another term may have changed it.
        let now = modelled(&found.scene).into_iter().find(|term| (term.name, term.kind) == (name.name, name.kind));
        if let Some(term) = now {
            let terms = [found.row.terms.clone(), vec![term.run]].concat();
            let scene = found.scene.changed(&term.edits)?;
            let variant = found.row.variant;
            found = attempt(pilot, found, scene, variant, &terms)?.0;
        }
    }
    Ok(found)
}

/// Loosens the solver as far as that saves time.
fn loosen(pilot: &mut Pilot<'_>, mut found: Candidate) -> Result<Candidate, Failure> {
    loop {
        let (scene, terms) = (found.scene.clone(), found.row.terms.clone());
        let variant = Variant { looser: LOOSER * found.row.variant.looser, ..found.row.variant };
        if !variant.is_as_loose_as_asked(&scene) {
            return Ok(found);
        }
        let (next, saves) = attempt(pilot, found, scene, variant, &terms)?;
        if !saves {
            return Ok(next);
        }
        found = next;
    }
}

/// Another scene or variant in place of the choice if it still meets the tolerance and saves time; otherwise the choice
/// unchanged. Also returns whether it saves time. `terms` are the words for the changes of the scene.
fn attempt(
    pilot: &mut Pilot<'_>,
    found: Candidate,
    scene: SceneFile,
    variant: Variant,
    terms: &[String],
) -> Result<(Candidate, bool), Failure> {
    let longest = pilot.left();
    if longest <= 0.0 {
        return Ok((found, false));
    }
    let row = pilot.weigh(&scene, variant, terms, longest)?;
    if !row.meets() {
        return Ok((found, false));
    }
    let place = pilot.considered.len() - 1;
    let saves = saved(pilot, &found, &scene, place)?.is_some_and(|saved| saved > WORTH);
    let row = pilot.considered[place].clone();
    Ok(if saves { (Candidate { scene, row }, true) } else { (found, false) })
}

/// The part of its time that the choice saves as the run at `place`, of another scene or variant: the median of pairs
/// of runs. `None` if there was no time for a pair.
fn saved(pilot: &mut Pilot<'_>, found: &Candidate, scene: &SceneFile, place: usize) -> Result<Option<f64>, Failure> {
    let variant = pilot.considered[place].variant;
    let pairs = if found.row.wall_s > LONG { 1 } else { pilot.study.repeats(PAIRS) };
    let mut parts = Vec::new();
    for _ in 0..pairs {
        let as_is = pilot.fly(&found.scene, &found.row.variant, f64::INFINITY)?;
        let other = pilot.fly(scene, &variant, f64::INFINITY)?;
        if [&as_is, &other].iter().all(|run| run.ending == Ending::Complete) {
            pilot.considered[place].timed(other.wall);
            parts.push(1.0 - other.wall / as_is.wall);
        }
    }
    Ok((!parts.is_empty()).then(|| median(parts)))
}
