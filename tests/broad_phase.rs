//! The broad phase finds exactly the candidates: the grid of control bits, the reference cell and
//! brute force name the same pairs, in f32 and in f64, each once; and the pairs of a real mesh are
//! as many as an exact count elsewhere says.
//!
//! Run: `cargo test -p muslin-tests --test broad_phase`. Caught so far by changing the code: see
//! the comments of `stages` and `agree`. How fast it is:
//! `cargo test --release -p muslin-tests --test broad_phase -- --ignored --nocapture speed`.

#[path = "broad_phase/agree.rs"]
mod agree;
#[path = "broad_phase/capacity.rs"]
mod capacity;
#[path = "broad_phase/case.rs"]
mod case;
#[path = "broad_phase/chapter.rs"]
mod chapter;
#[path = "broad_phase/cloth_ball.rs"]
mod cloth_ball;
#[path = "broad_phase/methods.rs"]
mod methods;
#[path = "broad_phase/ownership.rs"]
mod ownership;
#[path = "broad_phase/speed.rs"]
mod speed;
#[path = "broad_phase/stages.rs"]
mod stages;
