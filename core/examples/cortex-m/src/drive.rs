//! Firmware that drives the cloth: it moves the ball before every step, holds a vertex and lets it go, takes its steps within
//! a budget, and goes on after a step that fails.
//!
//! `cargo run --release --bin drive` in this folder runs it in QEMU (`qemu-system-arm`).
#![no_std]
#![no_main]

mod ball;
mod board;
mod stack;

use ball::Ball;
use board::{Counter, end, stop};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use muslin_core::cooked::Cloth;
use muslin_core::diagnostics::StateHash;
use muslin_core::dispatch::{Limited, Serial};
use muslin_core::refusal::Cause;

board::scene!("driven");

/// Iterations and candidates of a step that its time allows.
const BUDGET: [u32; 2] = [80, 10_000];

#[entry]
fn main() -> ! {
    stack::paint();
    match &mut Cloth::open(&BLOCK.0, ROOM.take()) {
        Ok(cloth) => run(cloth, &Counter::start()),
        Err(error) => stop(format_args!("cannot open the scene: {error}")),
    }
}

fn run(cloth: &mut Cloth<'_>, counter: &Counter) -> ! {
    let seconds = f64::from(cloth.step_length());
    let (mut ball, mut hash, mut budget) = (Ball::new(), StateHash::default(), BUDGET);
    let (mut late, mut refused, mut most) = (0, 0, [0; 2]);
    hash.add(cloth.positions(), cloth.velocities());
    // A tick of the clock of a machine.
    while (cloth.steps() as usize) < HASHES.len() - 1 {
        if let Err(error) = ball.lead(cloth, cloth.steps() as usize, seconds) {
            stop(format_args!("{error}"));
        }
        let limit = Limited::new(&Serial, budget[0], budget[1]);
        let (taken, instructions) = counter.count(|| cloth.step(&limit));
        if instructions > most[0] {
            most = [instructions, limit.spent()[0].into()];
        }
        match taken {
            Ok(()) => {
                ball.go_on(seconds);
                budget = BUDGET;
                hash.add(cloth.positions(), cloth.velocities());
            }
            // The cloth stands still until the next tick, which may take longer.
            Err(failed) if failed.cause == Cause::Stopped => {
                late += 1;
                budget = budget.map(|most| 2 * most);
            }
            Err(failed) => {
                hprintln!("{}: the ball turns back", failed);
                refused += 1;
                ball.speed = -ball.speed;
            }
        }
    }
    if Some(&hash.0) != HASHES.last() {
        stop(format_args!("the last state differs: {:016x}", hash.0));
    }
    hprintln!("{} steps, hash {:016x}, as on the machine that cooked them", cloth.steps(), hash.0);
    hprintln!("over the budget: {} ticks, refused: {} steps", late, refused);
    hprintln!("at most {} instructions in a tick, for {} iterations", most[0], most[1]);
    hprintln!("RAM: memory {} bytes, stack {} bytes", MEMORY, stack::used());
    end(debug::EXIT_SUCCESS)
}
