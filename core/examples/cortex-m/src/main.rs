//! Firmware for a Cortex-M7 without a heap: it opens a cooked scene in flash memory, takes steps with contact, and compares
//! each state with that of the machine that cooked it.
//!
//! `cargo run --release` in this folder runs it in QEMU (`qemu-system-arm`).
#![no_std]
#![no_main]

mod flash;
mod stack;

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use muslin_core::cooked::{Cloth, required_bytes};
use muslin_core::diagnostics::StateHash;
use muslin_core::dispatch::Serial;

include!(concat!(env!("OUT_DIR"), "/expected.rs"));

#[repr(align(32))]
struct Aligned<T: ?Sized>(T);

static BLOCK: &Aligned<[u8]> = &Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/cloth.bin")));

/// Memory of the scene, bytes.
const MEMORY: usize = match required_bytes(&BLOCK.0) {
    Ok(bytes) => bytes,
    Err(_) => panic!("the scene was cooked by another version"),
};

/// Memory that one owner takes once.
struct Once<T>(UnsafeCell<Aligned<T>>);

// SAFETY: the firmware has one thread and takes the memory once, in `main`.
unsafe impl<T> Sync for Once<T> {}

static ROOM: Once<[u8; MEMORY]> = Once(UnsafeCell::new(Aligned([0; MEMORY])));

/// Instructions in a tick of the timer: its clock has 25 MHz, and QEMU counts a nanosecond for each instruction.
const INSTRUCTIONS: u32 = 40;

#[entry]
fn main() -> ! {
    stack::paint();
    // SAFETY: `main` runs once, and nothing else names the memory.
    let memory = unsafe { &mut (*ROOM.0.get()).0 };
    let mut timer = cortex_m::Peripherals::take().expect("it is taken once").SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(0x00ff_ffff);
    timer.clear_current();
    timer.enable_counter();
    // By reference: to move a cloth needs 2 kB more of stack.
    match &mut Cloth::open(&BLOCK.0, memory) {
        Ok(cloth) => run(cloth),
        Err(error) => stop(format_args!("cannot open the scene: {error}")),
    }
}

/// Takes the steps and prints what they needed.
fn run(cloth: &mut Cloth<'_>) -> ! {
    let (mut hash, mut most) = (StateHash::default(), 0);
    for (step, &expected) in HASHES.iter().enumerate() {
        if step > 0 {
            let before = SYST::get_current();
            if let Err(failed) = cloth.step(&Serial) {
                stop(format_args!("{failed}"));
            }
            most = most.max(before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff);
        }
        hash.add(cloth.positions(), cloth.velocities());
        if hash.0 != expected {
            stop(format_args!("the state differs first after step {step}: {:016x}, not {expected:016x}", hash.0));
        }
    }
    hprintln!(
        "{} vertices, {} steps, hash {:016x}, as on the machine that cooked them",
        cloth.positions().len(),
        HASHES.len() - 1,
        hash.0
    );
    hprintln!("{} contacts", cloth.contact_statistics().proximity);
    hprintln!("flash: code {} bytes, scene {} bytes", flash::code(), BLOCK.0.len());
    hprintln!("RAM: memory {} bytes, stack {} bytes", MEMORY, stack::used());
    hprintln!("at most {} instructions in a step", u64::from(most) * u64::from(INSTRUCTIONS));
    end(debug::EXIT_SUCCESS)
}

fn stop(why: core::fmt::Arguments<'_>) -> ! {
    hprintln!("{}", why);
    end(debug::EXIT_FAILURE)
}

fn end(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    stop(format_args!("{info}"))
}
