//! `muslin stability`: where each method fails, on maps of its step against stiffness and damping.

mod cell;
mod limits;
mod map;
mod report;
mod share;
mod words;

use muslin_core::integrate::Method;

use crate::args::StabilityArguments;
use crate::failure::Failure;

use super::{Study, draw};
use cell::Subject;
pub use cell::Verdict;
use map::Ground;
pub use report::{Axis, Map, Row};

/// Newton iterations of the additional subject, whose steps are solved until they converge.
const CONVERGED: u32 = 20;

/// Runs the command.
pub fn stability(arguments: &StabilityArguments) -> Result<(), Failure> {
    Study::run("stability", &arguments.study, |study| run(study, &subjects(&arguments.methods)))
}

fn run(study: &Study<'_>, subjects: &[Subject]) -> Result<(), Failure> {
    let grounds = map::grounds(study)?;
    let mut rows = map::run(study, subjects, &grounds, &grounds[..1])?;
    let limits = limits::measure(study, subjects, &grounds[0], &rows)?;
    rows.extend(map::run(study, subjects, &grounds, &grounds[1..])?);
    map::run_rest(study, subjects, &grounds[1..], &mut rows)?;
    let map = report::summarise(study, &grounds, rows, limits);
    study.finish(&draw::stability(&map), &map, &map.lines())?;
    match map.missing() {
        0 => Ok(()),
        missing => Err(Failure::Diverged(format!(
            "{} s are not enough for {missing} of {} runs; the finished runs are written: take fewer --methods, a \
             coarser cloth by --set, or a larger --budget",
            study.arguments.budget,
            map.all().count()
        ))),
    }
}

/// The subjects: each requested method with one iteration, and backward Euler also with Newton's method.
fn subjects(asked: &[Method]) -> Vec<Subject> {
    let wanted = |method: &Method| asked.is_empty() || asked.contains(method);
    let once = Method::ALL.into_iter().filter(wanted).map(|method| Subject { method, newton: 1 });
    let converged = Subject { method: Method::BackwardEuler, newton: CONVERGED };
    once.chain(Some(converged).filter(|subject| wanted(&subject.method))).collect()
}

impl Ground {
    /// The longest step that theory allows, s: 0 if every step gains energy, `None` if every step is stable.
    fn theory(&self, method: Method) -> Option<f64> {
        muslin_core::integrate::stability::longest_step(&self.modes, method)
    }
}
