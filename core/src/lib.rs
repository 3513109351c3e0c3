//! Muslin's core: a cloth simulator as kernels over columns.
//!
//! A *muslin* is the test garment sewn before the real cloth is cut: as much model as the
//! question needs, and no more. Data flows in the order of the modules:
//!
//! 1. [`scene`]: a plain description becomes cloth, pins and the list of modelled terms.
//! 2. [`mesh`]: triangles become unique edges, hinges, incidence and rest shape.
//! 3. [`particles`]: columns of positions, velocities and masses.
//! 4. [`forces`]: only the terms that the scene lists, each with energy, force and Jacobian.
//! 5. [`integrate`]: forces become candidate positions and velocities.
//! 6. [`step`]: the phases of a step in their order, in [`scratch`] columns sized once.
//! 7. [`diagnostics`]: energies, momentum, stretch, the first non-finite value, the state hash;
//!    [`audit`]: whether anything passes through anything, exactly; [`untangle`]: start states that
//!    do, made free of it; [`spectrum`]: its fastest modes, which limit the steps of explicit methods.
//! 8. [`simulation`]: all of it owned, for hosts that allocate.
//!
//! The crate is `no_std`. With the feature `alloc` (default) it builds scenes and owns columns;
//! without it, kernels and the step work on borrowed ones. Threads belong to the host
//! ([`dispatch`]); only [`real`] knows the precision: `muslin-core` is f32, `muslin-core-f64` the
//! same sources in f64.

#![no_std]
#![forbid(unsafe_code)]
// Set for the page alone, where set-up is made small and not fast.
#![cfg_attr(small, feature(optimize_attribute))]
#![cfg_attr(
    double,
    expect(clippy::useless_conversion, clippy::unnecessary_cast, reason = "conversions to double, of doubles")
)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
pub mod scene;

pub mod mesh;

pub mod particles;

pub mod forces;

pub mod integrate;

pub mod geometry;

pub mod broad_phase;

pub mod narrow_phase;

pub mod colliders;
pub mod contact;
pub mod response;

pub mod step;

pub mod scratch;

pub mod diagnostics;

pub mod audit;

#[cfg(feature = "alloc")]
pub mod untangle;

#[cfg(feature = "alloc")]
pub mod spectrum;

#[cfg(feature = "alloc")]
pub mod simulation;

pub mod dispatch;
pub mod error;
pub mod motion;
pub mod real;
pub mod stage;
pub mod traffic;
