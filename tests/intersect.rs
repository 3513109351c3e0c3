//! What meets what, and the audit made of it: against exact integers, brute force and real
//! garments, in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test intersect`; with `-- --nocapture` it prints what the
//! real meshes count. Garments need `shared/data` beside the checkout.

#[path = "intersect/floats.rs"]
mod floats;
#[path = "intersect/garments.rs"]
mod garments;
#[path = "intersect/growth.rs"]
mod growth;
#[path = "intersect/lattice.rs"]
mod lattice;
#[path = "intersect/oracle.rs"]
mod oracle;
#[path = "intersect/soups.rs"]
mod soups;
#[path = "intersect/surface.rs"]
mod surface;
