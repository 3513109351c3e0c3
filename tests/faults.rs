//! A fault of Muslin does not end the program that embeds it: where an index is out of range, a step is refused, and the
//! state stays. With debug assertions it panics, so that tests name the line.
//!
//! Run: `cargo test --release -p muslin-tests --test faults`.

use muslin_core::contact::NoContact;
use muslin_core::dispatch::Serial;
use muslin_core::forces::Model;
use muslin_core::forces::spring::Springs;
use muslin_core::integrate::pins::Pins;
use muslin_core::integrate::{IntegratorStatistics, Method, Scheme, StepInput};
use muslin_core::particles::Particles;
use muslin_core::real::Vec3;
use muslin_core::refusal::{Cause, Obstacle};
use muslin_core::response::ContactStatistics;
use muslin_core::scratch::Scratch;
use muslin_core::step::{self, History, StepContact, Work};

/// A step of two vertices and a spring from the first to `other`. Returns its result and the positions after it.
fn step_with_spring_to(other: u32) -> (Result<Option<f32>, Obstacle>, [Vec3; 2]) {
    let springs = Springs { offsets: &[0, 1, 1], others: &[other], rest: &[1.0], stiffness: &[100.0], damping: &[] };
    let mut positions = [Vec3::ZERO, Vec3::X * 2.0];
    let [mut velocities, mut low_positions, mut low_velocities] = [[Vec3::ZERO; 2]; 3];
    let mut particles = Particles {
        positions: &mut positions,
        velocities: &mut velocities,
        low_positions: &mut low_positions,
        low_velocities: &mut low_velocities,
        masses: &[1.0; 2],
        inverse_masses: &[1.0; 2],
    };
    let [next_positions, displacements, velocity_changes] = &mut [[Vec3::ZERO; 2]; 3];
    let mut scratch = Scratch { next_positions, displacements, velocity_changes, ..Scratch::default() };
    let input = StepInput {
        model: Model { stretch_springs: Some(springs), ..Model::default() },
        pins: &Pins::default(),
        masses: &[1.0; 2],
        inverse_masses: &[1.0; 2],
        time: 0.0,
        step: 0.01,
        scheme: &Scheme::fixed(Method::SymplecticEuler, 0.01),
        follows_contact: false,
        limit: None,
        has_contact: false,
        dispatch: &Serial,
    };
    let (integrator, contact) = (&mut IntegratorStatistics::default(), &mut ContactStatistics::default());
    let work = Work { integrator, contact, searched: &mut 0, done: None };
    let none = None::<StepContact<'_, NoContact>>;
    let taken = step::take(&input, &mut particles, &mut scratch, none, &mut History::default(), work);
    (taken, positions)
}

#[test]
#[cfg_attr(debug_assertions, should_panic(expected = "an index is out of range"))]
fn an_index_out_of_range_is_refused_and_the_state_stays() {
    let (taken, positions) = step_with_spring_to(7);
    assert_eq!(taken.map_err(|obstacle| obstacle.cause), Err(Cause::Fault));
    assert_eq!(positions, [Vec3::ZERO, Vec3::X * 2.0]);
    // The fault of one step does not stop the next one.
    let (taken, positions) = step_with_spring_to(1);
    assert_eq!(taken, Ok(None));
    assert!(positions[0].x > 0.0, "{positions:?}");
}
