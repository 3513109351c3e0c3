//! Intersections of edges and triangles, and the audit built on them, against exact integers, brute force and
//! real garments, in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test intersect`; with `-- --nocapture` it prints the counts for the
//! real meshes. The garments need `shared/data` beside the checkout.

mod floats;
mod garments;
mod growth;
mod lattice;
mod oracle;
mod soups;
mod surface;
