//! Muslin's core: a cloth simulator as kernels over columns.
//!
//! A *muslin* is the test garment that is sewn before the real cloth is cut: as much model as the
//! question needs, and no more.
//!
//! # The flow
//!
//! Data flows in the order of these modules:
//!
//! 1. [`scene`]: a description in plain numbers, and its way into columns.
//! 2. [`mesh`]: triangles become unique edges, hinges, incidence and rest shape.
//! 3. [`particles`]: columns of positions, velocities and masses; [`motion`]: prescribed motion of
//!    pins and colliders; [`kinematic`]: motion that the host gives colliders from step to step.
//! 4. [`forces`]: only the terms that the scene lists, each with energy, force and Jacobian.
//! 5. [`integrate`]: forces become candidate positions and velocities.
//! 6. [`contact`]: the surfaces that can touch, and the columns of contact; [`colliders`]: the
//!    surfaces that are not cloth.
//! 7. [`broad_phase`]: boxes around the motion become candidates, pairs of features that may touch.
//! 8. [`narrow_phase`]: candidates become contacts, with distances and times of impact, by the
//!    distances of [`geometry`]. [`detection`] does 7 and 8 at the start of a step.
//! 9. [`implicit_contact`]: an implicit step is solved together with its contacts; [`response`]: contacts correct the
//!    motion.
//! 10. [`step`]: the only module that knows the order; it works in [`scratch`] columns sized once. [`refusal`]: why a
//!     step fails.
//! 11. [`diagnostics`]: energies, momentum, stretch, the first non-finite value, the state hash; [`work_done`]: work of
//!     pins, colliders and wind; [`balance`]: energy that this work does not explain; [`reactions`]: impulses of pins
//!     and colliders; [`audit`]: an exact test for intersections; [`untangle`]: removes the intersections of a start
//!     state; [`spectrum`]: the fastest modes, which limit the steps of explicit methods; [`warning`]: settings that do
//!     not suit a scene, and signs that a result is wrong.
//! 12. [`simulation`]: all of it owned, for hosts that allocate; [`cooked`]: all of it in one block of bytes and in memory of
//!     the host, without a heap. [`live`]: the calls by which a host drives both. `halving` divides a step that fails, for
//!     both.
//!
//! Beside the flow: [`real`] (the only module that knows the precision), [`lanes`] (four vectors at a time),
//! [`rigid_body`] (a cloth as if it were rigid), [`inverse_masses`] (for contact), `column` and `quicksort` (access to
//! columns, and a sort, that cannot panic), [`dispatch`] (how kernels use the host's threads), [`keys`] (vectors over
//! time), [`error`], [`stage`] (names of the stages, for hosts that measure time) and [`traffic`] (bytes that each stage
//! streams).
//!
//! The crate is `no_std`. With the feature `alloc` (default) it builds scenes and owns columns;
//! without it, kernels and the step work on borrowed columns. `muslin-core` is f32,
//! `muslin-core-f64` is the same source in f64.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | column | one array for one attribute of all particles, edges or triangles |
//! | feature | a vertex, an edge or a triangle of a surface |
//! | candidate | a vertex and a triangle, or two edges, whose boxes overlap |
//! | contact | a candidate nearer than the thickness |
//! | impact | a pair that meets during the motion of a step |
//! | passive | belonging to a collider |
//! | crossing | an edge and a triangle that intersect, found by the exact test |
//! | term | one kind of force: stretch springs, membrane, hinges, ... |
//! | hinge | two triangles with a common edge, and the angle between them |
//! | rest | undeformed, as in rest length |
//! | view, columns | `Hinges` borrows what `HingeColumns` owns; kernels take the borrowed one |
//!
//! # To change it
//!
//! Paths are below the root of the repository; a test checks that they exist.
//!
//! * **A force term**: one file with all that is its own, `core/src/forces/wind.rs`, or `core/src/forces/drag.rs` if
//!   it has no elements; its `mod` in `core/src/forces/mod.rs`; its row in the list of terms,
//!   `core/src/forces/model.rs`; its keys `core/src/scene/mod.rs`, their checks `core/src/scene/terms.rs` and
//!   `core/src/scene/check.rs`, its columns `core/src/scene/build.rs`; its tests `tests/forces/main.rs`.
//! * **An integrator**: its kernel `core/src/integrate/rk4.rs`; its name, order and call
//!   `core/src/integrate/mod.rs`; its limit `core/src/integrate/stability.rs`; its columns
//!   `core/src/scratch.rs`; its tests `tests/integrate/main.rs`; its row in
//!   `host-cli/manual/methods.md` and in the page's `host-wasm/web/page/methods.js`.
//! * **A pass of the response**: its kernel `core/src/response/impact_zone.rs`; its row in the list of
//!   passes `core/src/response/mod.rs`; its tests `tests/response/main.rs`.
//! * **A stage in WGSL**: the core's kernel and its mirror of the same name, such as
//!   `core/src/broad_phase/byte_boxes.rs` and `gpu/src/broad_phase/byte_boxes.wgsl`; the table of
//!   stages `gpu/src/shaders.rs` and of columns `gpu/src/slots.rs`; the order
//!   `gpu/src/schedule.rs`; its tests `tests/gpu/stages.rs`.
//! * **A built-in scene**: its file `core/scenes/flag.toml`; the table `core/src/scene/builtin.rs`;
//!   its bounds `tests/built_in.rs`; its row in `host-cli/manual/running.md`.

#![no_std]
#![forbid(unsafe_code)]
// Without an allocator, no call may panic: see `column`.
#![cfg_attr(
    not(feature = "alloc"),
    warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]
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
pub mod inverse_masses;

pub mod geometry;

pub mod broad_phase;

pub mod narrow_phase;

pub mod colliders;
pub mod contact;
pub mod detection;
pub mod implicit_contact;
pub mod response;
pub mod rigid_body;

pub mod reactions;
pub mod refusal;
pub mod step;

pub mod scratch;

pub mod cooked;

pub mod balance;
pub mod diagnostics;
#[cfg(feature = "alloc")]
pub mod warning;
pub mod work_done;

pub mod audit;

#[cfg(feature = "alloc")]
pub mod untangle;

#[cfg(feature = "alloc")]
pub mod spectrum;

pub mod live;
#[cfg(feature = "alloc")]
pub mod simulation;

mod column;
pub mod dispatch;
pub mod error;
mod halving;
pub mod keys;
pub mod kinematic;
pub mod lanes;
pub mod motion;
mod quicksort;
pub mod real;
pub mod stage;
pub mod traffic;
