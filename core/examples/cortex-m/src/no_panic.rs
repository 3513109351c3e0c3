//! Proves that no call of the core panics: it links only if the panic handler can be left out.
//!
//! `cargo build --release --bin no-panic` in this folder. If it fails, the linker names a function from which a panic can be
//! reached.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use muslin_core::cooked::{Cloth, required_bytes};
use muslin_core::dispatch::{Limited, Serial};

#[repr(align(32))]
struct Aligned<T: ?Sized>(T);

static BLOCK: &Aligned<[u8]> = &Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/cloth.bin")));

#[entry]
fn main() -> ! {
    // Nothing is known of the scene.
    let block = black_box(&BLOCK.0);
    let mut memory = Aligned([0; 1 << 10]);
    black_box(required_bytes(block).is_ok());
    if let Ok(mut cloth) = Cloth::open(block, black_box(&mut memory.0)) {
        black_box(cloth.step(&Limited::new(&Serial, black_box(100), black_box(100))).is_ok());
        black_box((cloth.positions(), cloth.velocities()));
    }
    loop {
        cortex_m::asm::wfi();
    }
}

unsafe extern "C" {
    /// Exists nowhere.
    fn a_panic_can_be_reached() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: a program that calls it does not link.
    unsafe { a_panic_can_be_reached() }
}
