//! The broad phase finds exactly the candidates: the grid of control bits, the reference cell and brute force
//! report the same pairs, in f32 and in f64, each once; for a real mesh their number equals an exact count from
//! other software.
//!
//! Run: `cargo test -p muslin-tests --test broad_phase`. Its speed:
//! `cargo test -p muslin-tests --test broad_phase --release -- --ignored --nocapture long_form`.
//!
//! Each of these changes to the code has made it fail: covers without sqrt(2), or compared with <; cells of 1.5
//! diameters; a mask without its last bit; no skipping, or skipping also at the lowest type; phantom cells on
//! the wrong side; home cells that are not first; bytes that a pair can overflow; a digit of the sort left out;
//! a wrong bit in the tables of ownership or of shared corners; boxes compared with <; phantom cells of smaller
//! triangles left out.

mod agree;
mod capacity;
mod chapter;
mod cloth_ball;
mod methods;
mod ownership;
mod speed;
mod stages;
mod stopped;
