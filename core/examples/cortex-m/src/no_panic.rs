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
use muslin_core::kinematic::Pose;
use muslin_core::live::Live as _;

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
        call_all(&mut cloth);
    }
    loop {
        cortex_m::asm::wfi();
    }
}

/// Every call of a cloth.
fn call_all(cloth: &mut Cloth<'_>) {
    black_box(cloth.step(&Limited::new(&Serial, black_box(100), black_box(100))).is_ok());
    let (number, vector, pose) = (black_box(1), black_box([1.0; 3]), black_box(Pose::IDENTITY));
    black_box((cloth.positions(), cloth.velocities(), cloth.triangles(), cloth.time(), cloth.origin()));
    black_box(cloth.move_collider(number, pose, 0.1).is_ok());
    black_box(cloth.collider_pose(number).is_ok());
    black_box(cloth.take_impulse(number).is_ok());
    black_box(cloth.deform_collider(number, black_box(&[[1.0; 3]]), 0.1).is_ok());
    black_box(cloth.switch_off(number).is_ok());
    black_box(cloth.switch_on(number).is_ok());
    black_box(cloth.move_to(number, vector, 0.1).is_ok());
    black_box(cloth.attach(number, number).is_ok());
    black_box(cloth.release(number));
    black_box(cloth.set_gravity(vector).is_ok());
    black_box(cloth.set_wind(vector).is_ok());
    black_box(cloth.set_force(number, vector).is_ok());
    black_box(cloth.push(number, vector).is_ok());
    black_box(cloth.teleport(pose, black_box(&[1])).is_ok());
    black_box(cloth.touches().count());
    black_box(cloth.point(number, vector).is_ok());
    black_box(cloth.hit(vector, vector).is_ok());
    let mut snapshot = [0; 1 << 10];
    black_box(cloth.snapshot_bytes());
    black_box(cloth.snapshot(black_box(&mut snapshot)).is_ok());
    black_box(cloth.go_back(black_box(&snapshot)).is_ok());
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
