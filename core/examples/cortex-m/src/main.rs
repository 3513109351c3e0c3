//! Firmware for a Cortex-M7 without a heap: it opens a cooked scene in flash memory, takes steps with contact, and compares
//! each state with that of the machine that cooked it.
//!
//! `cargo run --release` in this folder runs it in QEMU (`qemu-system-arm`).
#![no_std]
#![no_main]

mod board;
mod flash;
mod stack;

use board::{Counter, end, stop};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use muslin_core::cooked::Cloth;
use muslin_core::diagnostics::StateHash;
use muslin_core::dispatch::Serial;

board::scene!("cloth");

#[entry]
fn main() -> ! {
    stack::paint();
    // By reference: to move a cloth needs 2 kB more of stack.
    match &mut Cloth::open(&BLOCK.0, ROOM.take()) {
        Ok(cloth) => run(cloth, &Counter::start()),
        Err(error) => stop(format_args!("cannot open the scene: {error}")),
    }
}

/// Takes the steps, and prints their memory and their instructions.
fn run(cloth: &mut Cloth<'_>, counter: &Counter) -> ! {
    let (mut hash, mut most, mut all) = (StateHash::default(), 0, 0);
    for (step, &expected) in HASHES.iter().enumerate() {
        if step > 0 {
            let (taken, instructions) = counter.count(|| cloth.step(&Serial));
            if let Err(failed) = taken {
                stop(format_args!("{failed}"));
            }
            (most, all) = (instructions.max(most), all + instructions);
        }
        hash.add(cloth.positions(), cloth.velocities());
        if hash.0 != expected {
            stop(format_args!("the state differs first after step {step}: {:016x}, not {expected:016x}", hash.0));
        }
    }
    let (vertices, steps) = (cloth.positions().len(), HASHES.len() - 1);
    hprintln!("{} vertices, {} steps, hash {:016x}, as on the machine that cooked them", vertices, steps, hash.0);
    hprintln!("{} contacts in all steps", cloth.contact_statistics().proximity);
    hprintln!("flash: code {} bytes, scene {} bytes, in all {} bytes", flash::code(), BLOCK.0.len(), flash::all());
    hprintln!("RAM: memory {} bytes, stack {} bytes", MEMORY, stack::used());
    hprintln!("instructions in a step: {} on average, at most {}", all / steps.max(1) as u64, most);
    end(debug::EXIT_SUCCESS)
}
