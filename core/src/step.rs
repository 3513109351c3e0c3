//! The order of a step: one driver over borrowed columns, for every host.
//!
//! predict (forces, integration) -> [`place`] -> solve (implicit methods only: contacts and elasticity) -> solve with the
//! impacts of the motion -> [`respond`](response::respond) (contacts, impacts) -> settle ->
//! [`new_crossing`](audit::new_crossing), if surfaces [touch](Outcome::Touches) -> keep the forces of contacts, commit.
//! Without contact a step consists of the first and the last phase. Each phase of contact begins with a
//! [`search`](detection::search) for candidates and their distances, where the motion needs other ones; [`await_take`]
//! awaits them. [`take`] is a function of its own, because a future can panic: when it is polled after its end.
//!
//! Backward Euler without Newton's method predicts the motion without any force and leaves its one linear solve to the
//! solve with contacts.
//!
//! The driver asks its host for more room in the columns of contact ([`ContactRoom`]), for candidates that are found
//! elsewhere ([`Dispatch::detect`]) and for a shorter step ([`Obstacle`]), for example if the [estimated
//! error](local_error) is too large, or if pins and colliders do not move straight in it. A step that fails does not
//! change the state.

use crate::audit;
use crate::broad_phase::Counts;
use crate::colliders::Colliders;
use crate::column::{self, Column};
use crate::contact::{ContactModel, ContactRoom, ContactScratch, Prediction};
use crate::detection::{self, Purpose, place};
use crate::diagnostics;
use crate::dispatch::Dispatch;
use crate::implicit_contact::{self, exchange, multiplier};
use crate::integrate::pins::Pins;
use crate::integrate::{self, IntegratorStatistics, Method, Scheme, StepInput, bdf2, local_error, next_velocity};
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3, rounding_error, sqrt};
use crate::refusal::{Cause, Obstacle};
use crate::response::{self, ContactStatistics, Outcome, Settings};
use crate::scratch::Scratch;
use crate::stage::Stage;
use crate::work_done::{self, Ledger};

/// How often the boxes around the motion are widened before the step fails.
const MOST_WIDENINGS: u32 = 6;

/// How often they are widened with the last resort of the response.
const LAST_WIDENINGS: u32 = 20;

/// Limit of candidates in one step, over all its attempts, relative to [`most_pairs`](detection::most_pairs).
const MOST_SEARCHED: u64 = 1 << 7;

/// How much farther apart than the thickness a pair at rest may be that is solved with the step, relative to the
/// thickness. The response keeps the thickness only within a tolerance.
const REST: Real = 0.2;

/// Contact in a step.
pub struct StepContact<'a, R> {
    /// What can touch.
    pub model: &'a ContactModel<'a>,
    /// The columns of contact.
    pub columns: &'a mut R,
    /// Whether the response may hold vertices back, as its last resort.
    pub hold: bool,
}

/// Counts of the work, to which a step adds.
pub struct Work<'a> {
    /// Work of the integrator.
    pub integrator: &'a mut IntegratorStatistics,
    /// Work of contact.
    pub contact: &'a mut ContactStatistics,
    /// Candidates found in this step, over all its attempts. Zero before the first one.
    pub searched: &'a mut u64,
    /// Work done on the cloth, and reactions; `None`: they are not measured.
    pub done: Option<Ledger<'a>>,
}

/// How the state came about from which a step starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum History {
    /// It is the initial state.
    #[default]
    Start,
    /// By a step that contact did not correct.
    Smooth {
        /// The length of that step, s.
        step: Real,
    },
    /// By a step, but something has changed it since, for example the host.
    Cut,
    /// By a step that contact corrected.
    Corrected,
}

impl History {
    /// Notes that the next step does not continue the last one.
    pub fn cut(&mut self) {
        if let Self::Smooth { .. } = self {
            *self = Self::Cut;
        }
    }
}

/// Takes one step and returns its [estimated error](local_error), m, if the input has a [limit](StepInput::limit) and
/// the method an estimate. Pass the `history` that the last step left. Call
/// [`Pins::set_out`](crate::integrate::pins::Pins::set_out) before the first step, to set the initial velocities of
/// pins.
///
/// Some steps are taken by backward Euler instead of the method of `input`. BDF2 needs a step before that is at least
/// half as long, without contact and without a jump of a pin's velocity in between. Implicit midpoint after contact
/// would amplify the oscillation of stiff cloth that an impulse excites. After contact, the linear solve also
/// [extrapolates](StepInput::follows_contact) smooth motions only.
pub fn take<D: Dispatch, R: ContactRoom>(
    input: &StepInput<'_, D>,
    particles: &mut Particles<'_>,
    scratch: &mut Scratch<'_>,
    mut contact: Option<StepContact<'_, R>>,
    history: &mut History,
    mut work: Work<'_>,
) -> Result<Option<Real>, Obstacle> {
    let attempt = Attempt::begin(input, particles, scratch, contact.as_ref(), *history, &mut work)?;
    let input = &attempt.input(input);
    let mut corrected = false;
    if let Some(contact) = &mut contact {
        let mut next = Next::begin(input, particles, scratch, contact);
        while let Next::Phase(phase) = next {
            let found = detection::search(contact.model, phase.purpose(), contact.columns, input.dispatch);
            next = phase.take(found, input, particles, scratch, contact, &mut work)?;
        }
        corrected = next.corrected();
    }
    attempt.end(input, particles, scratch, contact, corrected, history, work)
}

/// [`take`], but awaits candidates that are found elsewhere ([`Dispatch::detect`]).
pub async fn await_take<D: Dispatch, R: ContactRoom>(
    input: &StepInput<'_, D>,
    particles: &mut Particles<'_>,
    scratch: &mut Scratch<'_>,
    mut contact: Option<StepContact<'_, R>>,
    history: &mut History,
    mut work: Work<'_>,
) -> Result<Option<Real>, Obstacle> {
    let attempt = Attempt::begin(input, particles, scratch, contact.as_ref(), *history, &mut work)?;
    let input = &attempt.input(input);
    let mut corrected = false;
    if let Some(contact) = &mut contact {
        let mut next = Next::begin(input, particles, scratch, contact);
        while let Next::Phase(phase) = next {
            let found = detection::await_search(contact.model, phase.purpose(), contact.columns, input.dispatch).await;
            next = phase.take(found, input, particles, scratch, contact, &mut work)?;
        }
        corrected = next.corrected();
    }
    attempt.end(input, particles, scratch, contact, corrected, history, work)
}

/// A step whose motion is predicted.
struct Attempt {
    scheme: Scheme,
    /// Whether the last step was corrected by contact.
    follows_contact: bool,
    last_step: Option<Real>,
    /// How far pins and colliders move from their straight way, m.
    curved: Real,
    faults: u32,
}

impl Attempt {
    /// Predicts the motion without contact.
    fn begin<D: Dispatch, R>(
        input: &StepInput<'_, D>,
        particles: &Particles<'_>,
        scratch: &mut Scratch<'_>,
        contact: Option<&StepContact<'_, R>>,
        mut from: History,
        work: &mut Work<'_>,
    ) -> Result<Self, Obstacle> {
        let faults = column::faults();
        let is_too_long = |last| input.step > bdf2::MOST_GROWTH * last;
        let grows = matches!(from, History::Smooth { step } if is_too_long(step));
        if input.scheme.method == Method::Bdf2 && (grows || input.pins.jump(input.time)) {
            from.cut();
        }
        let scheme = Scheme { method: method(input.scheme.method, from), ..*input.scheme };
        scratch.last_step = match from {
            History::Smooth { step } if !scratch.previous_displacements.is_empty() => Some(step),
            History::Smooth { .. } | History::Start | History::Cut | History::Corrected => None,
        };
        let mut curved = 0.0;
        if let Some(limit) = input.limit {
            let colliders = contact.map(|contact| contact.model.colliders).unwrap_or_default();
            curved = deviation(input.pins, &colliders, particles.positions, input.times()) as Real;
            if curved > limit {
                work.integrator.inaccurate += 1;
                return Err(Obstacle { cause: Cause::Inaccurate, particle: 0 });
            }
        }
        let (follows_contact, last_step) = (from == History::Corrected, scratch.last_step);
        let attempt = Self { scheme, follows_contact, last_step, curved, faults };
        predict(&attempt.input(input), particles, scratch, work.integrator)?;
        Ok(attempt)
    }

    /// The input of the step, by the method that takes it.
    fn input<'a, D: Dispatch>(&'a self, input: &StepInput<'a, D>) -> StepInput<'a, D> {
        let input = StepInput { scheme: &self.scheme, follows_contact: self.follows_contact, ..*input };
        input.after(input.stage_time(self.last_step))
    }

    /// Tests the candidate state and makes it the state. Returns the estimated error.
    fn end<D: Dispatch, R: ContactRoom>(
        &self,
        input: &StepInput<'_, D>,
        particles: &mut Particles<'_>,
        scratch: &mut Scratch<'_>,
        mut contact: Option<StepContact<'_, R>>,
        corrected: bool,
        history: &mut History,
        work: Work<'_>,
    ) -> Result<Option<Real>, Obstacle> {
        if contact.is_some() {
            test_stopped(input)?;
            // The response decides by comparisons, which do not detect NaN.
            test_finite(particles, scratch)?;
        }
        let contact_model = contact.as_ref().map(|contact| contact.model);
        let mut columns = contact.as_mut().map(|contact| contact.columns.columns());
        let error = test_error(input, particles, corrected, columns.as_ref(), scratch, work.integrator)?;
        test_stopped(input)?;
        if column::faults() != self.faults {
            return Err(Obstacle { cause: Cause::Fault, particle: 0 });
        }
        if let Some(ledger) = work.done {
            work_done::in_step(input, particles, contact_model.zip(columns.as_ref()), ledger, scratch);
        }
        if let Some(columns) = columns.as_mut().filter(|_| input.scheme.method.is_implicit()) {
            keep_forces(input.step, columns);
        }
        commit(particles, scratch, work.integrator);
        *history = if corrected { History::Corrected } else { History::Smooth { step: input.step } };
        Ok(error.map(|error| error.max(self.curved)))
    }
}

/// How far pins and colliders move, between two times, from the straight and even way that a step takes them, m.
/// `positions` are those of the cloth, m.
#[cfg_attr(small, optimize(size), inline(never))]
pub(crate) fn deviation(pins: &Pins<'_>, colliders: &Colliders<'_>, positions: &[Vec3], times: [Sum; 2]) -> Sum {
    colliders.deviation(positions, times).max(pins.deviation(times))
}

/// Estimates the error of the candidate state, m, if the input asks for it.
fn test_error<D: Dispatch>(
    input: &StepInput<'_, D>,
    particles: &Particles<'_>,
    corrected: bool,
    contact: Option<&ContactScratch<'_>>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Result<Option<Real>, Obstacle> {
    let Some(limit) = input.limit else { return Ok(None) };
    let add_impulses = |out: &mut [Vec3]| {
        if let Some(contact) = contact {
            exchange::add_impulses(contact, input.step, out);
        }
    };
    let error = local_error::estimate(input, particles, corrected, add_impulses, scratch, statistics);
    if error.is_some_and(|error| error > limit || error.is_nan()) {
        statistics.inaccurate += 1;
        return Err(farthest(Cause::Inaccurate, particles, scratch));
    }
    Ok(error)
}

/// The method of a step with a history.
fn method(method: Method, history: History) -> Method {
    match method {
        Method::Bdf2 if matches!(history, History::Cut | History::Corrected) => Method::BackwardEuler,
        Method::ImplicitMidpoint if history == History::Corrected => Method::BackwardEuler,
        method => method,
    }
}

/// Writes the candidate state without contact to `scratch`.
fn predict<D: Dispatch>(
    input: &StepInput<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Result<(), Obstacle> {
    integrate::advance(input, particles, scratch, statistics);
    test_stopped(input)?;
    test_finite(particles, scratch)
}

fn test_stopped<D: Dispatch>(input: &StepInput<'_, D>) -> Result<(), Obstacle> {
    if input.dispatch.stopped() { Err(Obstacle::STOPPED) } else { Ok(()) }
}

fn test_finite(particles: &Particles<'_>, scratch: &Scratch<'_>) -> Result<(), Obstacle> {
    let velocity = |v| next_velocity(particles, scratch.velocity_changes, v);
    match diagnostics::first_non_finite(scratch.next_positions, velocity) {
        Some(particle) => Err(Obstacle { cause: Cause::NotFinite, particle }),
        None => Ok(()),
    }
}

/// The next phase between prediction and commit, which needs the pairs of a search, or their end.
enum Next {
    Phase(Phase),
    Done { corrected: bool },
}

/// A phase between prediction and commit.
enum Phase {
    /// An implicit step is solved together with its contacts.
    Solve,
    /// It is solved again with the impacts of its motion.
    SolveImpacts {
        /// Number of constraints of the first solve.
        constraints: usize,
        /// Number of contacts of the first solve.
        known: usize,
        has_begun: bool,
    },
    /// Contacts correct the motion. Searches again with wider boxes if the response leaves them.
    Respond { widened: u32 },
}

impl Next {
    fn begin<D: Dispatch, R: ContactRoom>(
        input: &StepInput<'_, D>,
        particles: &Particles<'_>,
        scratch: &Scratch<'_>,
        contact: &mut StepContact<'_, R>,
    ) -> Self {
        input.dispatch.enter(Stage::BroadPhase);
        let (times, columns) = ([input.time, input.step.into()], &mut contact.columns.columns());
        place(contact.model, times, particles.positions, scratch.next_positions, columns);
        columns.set_motion(&prediction(particles, scratch));
        let is_implicit = input.scheme.method.is_implicit();
        Self::Phase(if is_implicit { Phase::Solve } else { Phase::Respond { widened: 0 } })
    }

    /// Whether any vertex was corrected.
    fn corrected(self) -> bool {
        matches!(self, Self::Done { corrected: true })
    }
}

impl Phase {
    fn purpose(&self) -> Purpose {
        match *self {
            Self::Solve => Purpose::Solve,
            Self::SolveImpacts { .. } => Purpose::Response { widened: 0 },
            Self::Respond { widened } => Purpose::Response { widened },
        }
    }

    /// Takes the phase with the pairs found.
    fn take<D: Dispatch, R: ContactRoom>(
        self,
        found: Result<Counts, Cause>,
        input: &StepInput<'_, D>,
        particles: &Particles<'_>,
        scratch: &mut Scratch<'_>,
        contact: &mut StepContact<'_, R>,
        work: &mut Work<'_>,
    ) -> Result<Next, Obstacle> {
        let counts = found.map_err(|cause| farthest(cause, particles, scratch))?;
        let StepContact { model, columns, .. } = contact;
        let solved = match self {
            Self::Solve => solve(input, particles, scratch, model, *columns, work.integrator),
            Self::SolveImpacts { constraints, known, has_begun } => {
                let before = (constraints, known, has_begun);
                solve_impacts(input, particles, scratch, model, *columns, before, work.integrator)
            }
            Self::Respond { widened } => return respond(widened, counts, input, particles, scratch, contact, work),
        };
        let next = solved.map_err(|cause| farthest(cause, particles, scratch))?;
        test_stopped(input)?;
        Ok(Next::Phase(next))
    }
}

/// Solves an implicit step together with its contacts.
fn solve<D: Dispatch>(
    input: &StepInput<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    model: &ContactModel<'_>,
    columns: &mut impl ContactRoom,
    statistics: &mut IntegratorStatistics,
) -> Result<Phase, Cause> {
    input.dispatch.enter(Stage::Response);
    // Backward Euler predicts without gravity, which closes a gap by half of this in a step.
    let gravity = input.model.gravity.map_or(Vec3::ZERO, |gravity| gravity.acceleration);
    let fall = 2.0 * sqrt(gravity.length_squared()) * input.step * input.step;
    let margin = fall + REST * model.thickness;
    let predicted = &prediction(particles, scratch);
    with_room(columns, |contact| response::find_contacts(model, predicted, contact, input.step, margin))?;
    let contact = &mut columns.columns();
    let constraints = contact.lengths.constraints;
    exchange::add_contacts(model, contact, 0..constraints, input.step);
    let known = contact.lengths.contacts;
    let contacts = (contact.contacts.part_mut(..known), &mut *contact.lines);
    let has_begun = implicit_contact::correct(input, particles, contacts, scratch, statistics);
    contact.set_motion(&prediction(particles, scratch));
    Ok(Phase::SolveImpacts { constraints, known, has_begun })
}

/// Solves it again if its motion has impacts.
fn solve_impacts<D: Dispatch>(
    input: &StepInput<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    model: &ContactModel<'_>,
    columns: &mut impl ContactRoom,
    (constraints, known, has_begun): (usize, usize, bool),
    statistics: &mut IntegratorStatistics,
) -> Result<Phase, Cause> {
    let predicted = &prediction(particles, scratch);
    with_room(columns, |contact| response::find_impacts(model, predicted, contact, input.step, input.dispatch))?;
    let contact = &mut columns.columns();
    exchange::add_contacts(model, contact, constraints..contact.lengths.constraints, input.step);
    let contacts = (contact.contacts.part_mut(..contact.lengths.contacts), &mut *contact.lines);
    implicit_contact::resume(input, particles, contacts, known, has_begun, scratch, statistics);
    // A solve without contacts has completed its solution.
    if contact.lengths.contacts > if has_begun { 0 } else { known } {
        implicit_contact::finish(input, particles, scratch);
    }
    contact.set_motion(&prediction(particles, scratch));
    Ok(Phase::Respond { widened: 0 })
}

/// Corrects the motion of the step.
fn respond<D: Dispatch, R: ContactRoom>(
    widened: u32,
    counts: Counts,
    input: &StepInput<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    contact: &mut StepContact<'_, R>,
    work: &mut Work<'_>,
) -> Result<Next, Obstacle> {
    let StepContact { model, columns, hold } = contact;
    let (dispatch, settings) = (input.dispatch, Settings { step: input.step, hold: *hold });
    let count = (counts.vertex_triangle + counts.edge_edge) as u64;
    work.contact.candidates += count;
    dispatch.spend(0, count as u32);
    *work.searched += count;
    if *work.searched > MOST_SEARCHED * detection::most_pairs(model) as u64 {
        return Err(farthest(Cause::TooMuch, particles, scratch));
    }
    test_stopped(input)?;
    dispatch.enter(Stage::Response);
    let responded = with_room(*columns, |contact| {
        exchange::write_impulses(model, contact, input.stage_length(scratch.last_step));
        response::respond(model, &prediction(particles, scratch), contact, settings, work.contact, dispatch)
    });
    let outcome = responded.map_err(|cause| farthest(cause, particles, scratch))?;
    let columns = &mut columns.columns();
    match outcome {
        Outcome::Free => Ok(Next::Done { corrected: settle(input.step, particles, columns, scratch) }),
        Outcome::Touches => {
            let corrected = settle(input.step, particles, columns, scratch);
            match audit::new_crossing(&model.surface, columns.start, columns.end, &mut columns.room) {
                Some(crossing) => Err(Obstacle::at_crossing(model, crossing)),
                None => Ok(Next::Done { corrected }),
            }
        }
        Outcome::Collides(vertices) => Err(Obstacle::between(model, vertices)),
        Outcome::Stopped => Err(Obstacle::STOPPED),
        Outcome::LeavesBoxes if widened < if *hold { LAST_WIDENINGS } else { MOST_WIDENINGS } => {
            Ok(Next::Phase(Phase::Respond { widened: widened + 1 }))
        }
        Outcome::LeavesBoxes => Err(farthest(Cause::TooMuch, particles, scratch)),
    }
}

/// The candidate state, before contacts correct it.
fn prediction<'a>(particles: &'a Particles<'_>, scratch: &'a Scratch<'_>) -> Prediction<'a> {
    Prediction { positions: scratch.next_positions, displacements: scratch.displacements, low: particles.low_positions }
}

/// Calls a phase again with more room as long as it fails with the number of constraints that it needs room for.
pub(crate) fn with_room<T>(
    columns: &mut impl ContactRoom,
    mut phase: impl FnMut(&mut ContactScratch<'_>) -> Result<T, usize>,
) -> Result<T, Cause> {
    loop {
        match phase(&mut columns.columns()) {
            Ok(result) => return Ok(result),
            Err(constraints) if columns.grow_constraints(constraints) => {}
            Err(constraints) => return Err(Cause::Short { pairs: 0, constraints }),
        }
    }
}

/// An obstacle at the particle whose candidate state is farthest from its position.
fn farthest(cause: Cause, particles: &Particles<'_>, scratch: &Scratch<'_>) -> Obstacle {
    let moved =
        scratch.next_positions.iter().zip(&*particles.positions).map(|(&next, &now)| (next - now).length_squared());
    let farthest = moved.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
    let particle = farthest.map_or(0, |(v, _)| v as u32);
    Obstacle { cause, particle }
}

/// Copies the positions that the response corrected. The velocities change by the correction over `step`,
/// without the part that only separates surfaces. Returns whether any vertex was corrected.
fn settle(step: Real, particles: &Particles<'_>, contact: &ContactScratch<'_>, scratch: &mut Scratch<'_>) -> bool {
    let (rounds, corrections) = contact.response();
    let mut any = false;
    for (v, next) in scratch.next_positions.iter_mut().enumerate() {
        if rounds.at(v) > 0 {
            let displacement = contact.displacements.at(v);
            let moved = displacement - (particles.low_positions.at(v) + scratch.displacements.at(v));
            let change = scratch.velocity_changes.at(v) + (moved - corrections.at(v)) / step;
            scratch.velocity_changes.set(v, change);
            scratch.displacements.set(v, displacement - particles.low_positions.at(v));
            *next = contact.end.at(v);
            any = true;
        }
    }
    any
}

/// Keeps the forces of the contacts of an accepted step, from which the next one starts. `step` is its length, s.
fn keep_forces(step: Real, contact: &mut ContactScratch<'_>) {
    let constraints = contact.constraints.part(..contact.lengths.constraints);
    contact.lengths.multipliers = multiplier::write(constraints, step, contact.order, contact.multipliers);
}

/// Makes the candidate state the state. A method with history (BDF2) keeps the changes.
fn commit(particles: &mut Particles<'_>, scratch: &mut Scratch<'_>, statistics: &mut IntegratorStatistics) {
    statistics.committed += 1;
    if !scratch.previous_displacements.is_empty() {
        scratch.previous_displacements.copy_from(scratch.displacements);
        scratch.previous_velocity_changes.copy_from(scratch.velocity_changes);
    }
    let Particles { positions, velocities, low_positions, low_velocities, .. } = particles;
    let changes = scratch.displacements.iter().zip(&*scratch.next_positions);
    for ((now, low), (&change, &next)) in positions.iter_mut().zip(low_positions.iter_mut()).zip(changes) {
        *low = rounding_error(*now, *low + change, next);
        *now = next;
    }
    let changes = &*scratch.velocity_changes;
    for ((now, low), &change) in velocities.iter_mut().zip(low_velocities.iter_mut()).zip(changes) {
        let (before, change) = (*now, *low + change);
        *now += change;
        *low = rounding_error(before, change, *now);
    }
}
