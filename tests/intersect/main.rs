//! What meets what, and the audit made of it: against exact integers, brute force and real
//! garments, in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test intersect`; with `-- --nocapture` it prints what the
//! real meshes count. Garments need `shared/data` beside the checkout.

mod floats;
mod garments;
mod growth;
mod lattice;
mod oracle;
mod soups;
mod surface;
