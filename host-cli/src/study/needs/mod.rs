//! `muslin needs`: the change that each term of a scene makes, and its cost.

mod report;
mod row;
mod trial;
mod words;

use crate::args::NeedsArguments;
use crate::failure::Failure;

use super::terms::{self, Term, VariantKind};
use super::{Study, draw};
use report::Hidden;
pub use report::Needs;
pub use row::{Row, Verdict};
use trial::{Baseline, Trial};

/// Runs the command.
pub fn needs(arguments: &NeedsArguments) -> Result<(), Failure> {
    Study::run("needs", &arguments.study, run)
}

fn run(study: &Study<'_>) -> Result<(), Failure> {
    let baseline = Baseline::fly(study)?;
    let terms = terms::of(&study.scene.desc, &baseline.mean_edges);
    let mut trials: Vec<_> = terms.into_iter().map(Trial::new).collect();
    trial::run(study, &baseline, &mut trials)?;
    let hidden = hidden(study, &baseline, &trials)?;
    let needs = report::of(study, &baseline, &trials, hidden);
    study.finish(&draw::needs(&needs), &needs, &needs.lines())?;
    match needs.rows.iter().filter(|row| row.verdict == Verdict::Unfinished).count() {
        0 => Ok(()),
        late => Err(Failure::Diverged(format!(
            "the budget of {} s is used up: {late} of {} runs are missing; take a larger --budget, a shorter \
             --duration or a coarser cloth by --set",
            study.arguments.budget,
            needs.rows.len()
        ))),
    }
}

/// Finds the terms whose change is smaller than the step's own error, and runs the scene without all of them if
/// there are several.
fn hidden(study: &Study<'_>, baseline: &Baseline, trials: &[Trial]) -> Result<Hidden, Failure> {
    let is_hidden = |trial: &&Trial| {
        let row = Row::of(baseline, trial);
        row.exceeds_step == Some(false) && row.kind != VariantKind::Added
    };
    let hidden: Vec<&Trial> = trials.iter().filter(is_hidden).collect();
    let is_part = |trial: &Trial| hidden.iter().any(|other| trial.term.part_of.contains(&other.term.name));
    let (parts, whole): (Vec<&Trial>, Vec<&Trial>) = hidden.iter().copied().partition(|trial| is_part(trial));
    let without_them = match whole.as_slice() {
        [] => None,
        [only] => Some(Row::of(baseline, only)),
        several => {
            let mut trial = Trial::new(Term::together(several.iter().map(|trial| &trial.term)));
            trial::run(study, baseline, std::slice::from_mut(&mut trial))?;
            Some(Row::of(baseline, &trial))
        }
    };
    let is_still = |trial: &&&Trial| Row::of(baseline, trial).change_max == Some(0.0);
    Ok(Hidden {
        terms: whole.iter().map(|trial| trial.term.name).collect(),
        still: whole.iter().filter(is_still).map(|trial| trial.term.name).collect(),
        parts: parts.iter().map(|trial| trial.term.name).collect(),
        without_them,
    })
}
