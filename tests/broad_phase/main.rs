//! The broad phase finds exactly the candidates: the grid of control bits, the reference cell and
//! brute force name the same pairs, in f32 and in f64, each once; and the pairs of a real mesh are
//! as many as an exact count elsewhere says.
//!
//! Run: `cargo test -p muslin-tests --test broad_phase`. How fast it is:
//! `cargo test -p muslin-tests --test broad_phase --release -- --ignored --nocapture long_form`.
//!
//! Each of these changes to the code has made it fail: covers without sqrt(2), or compared with <;
//! cells of 1.5 diameters; a mask without its last bit; no skipping, or also at the lowest type;
//! phantoms on the wrong side; homes that do not come first; bytes that a pair can overrun; a
//! digit of the sort left out; a wrong bit in the tables of ownership or of shared corners; boxes
//! compared with <; phantoms of smaller triangles left out.

mod agree;
mod capacity;
mod chapter;
mod cloth_ball;
mod methods;
mod ownership;
mod speed;
mod stages;
