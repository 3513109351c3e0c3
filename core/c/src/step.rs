//! Steps within a budget.

use muslin_core::dispatch::{Limited, Serial};
use muslin_core::refusal::{Cause, StepError};

use crate::handle::{MuslinCloth, change, given};
use crate::status::MuslinStatus;

/// The work after which a step is given up, at the next place where it can be. It does not depend on the machine.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MuslinBudget {
    /// Iterations of the linear solver, and rounds of the response to contacts after the first.
    pub iterations: u32,
    /// Pairs of features that the response has to test.
    pub candidates: u32,
}

/// The work of a step, whether or not it succeeded.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct MuslinReport {
    /// Iterations of the linear solver, and rounds of the response to contacts after the first.
    pub iterations: u32,
    /// Pairs of features that the response had to test.
    pub candidates: u32,
    /// Contacts that push.
    pub contacts: u32,
    /// Times that the step, or a part of it, was halved because surfaces would have collided; 0 if it was over its budget.
    pub halved: u32,
    /// The vertex where a step diverged or surfaces met. Otherwise it has no meaning.
    pub vertex: u32,
    /// Candidates of each kind that need room; 0 if there is enough.
    pub candidates_needed: u32,
    /// Contacts that need room; 0 if there is enough.
    pub contacts_needed: u32,
}

/// Takes one step of the length that the scene has. A step that fails leaves the state as it was, except that pins whose
/// time has come have begun. `budget` may be null: then there is no limit. `report` may be null.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `budget` and `report` are null or point to such structs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_step(
    cloth: *mut MuslinCloth,
    budget: *const MuslinBudget,
    report: *mut MuslinReport,
) -> MuslinStatus {
    // Null pointers are aligned.
    if !budget.is_aligned() || !report.is_aligned() {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: the caller says that it is null or points to a budget.
    let MuslinBudget { iterations, candidates } =
        unsafe { given(budget) }.unwrap_or(MuslinBudget { iterations: u32::MAX, candidates: u32::MAX });
    let mut done = MuslinReport::default();
    // SAFETY: the caller's promise is that of `change`.
    let status = unsafe {
        change(cloth, |own| {
            let limited = Limited::new(&Serial, iterations, candidates);
            let halved = own.cloth.contact_statistics().rejected;
            let taken = own.cloth.step(&limited);
            [done.iterations, done.candidates] = limited.spent();
            done.halved = own.cloth.contact_statistics().rejected.saturating_sub(halved) as u32;
            done.contacts = muslin_core::live::Live::touches(&own.cloth).count() as u32;
            taken.inspect_err(|failed| note(failed, &mut done))?;
            Ok(())
        })
    };
    if !report.is_null() {
        // SAFETY: the pointer is not null, and the caller says that it points to a report.
        unsafe { report.write(done) };
    }
    status
}

fn note(failed: &StepError, report: &mut MuslinReport) {
    report.vertex = failed.particle;
    if let Cause::Short { pairs, constraints } = failed.cause {
        (report.candidates_needed, report.contacts_needed) = (pairs as u32, constraints as u32);
    }
}
