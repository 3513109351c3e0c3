//! Proves that no call of the core panics: it links only if the panic handler can be left out.
//!
//! `cargo build --release --bin no-panic` in this folder. If it fails, the linker names a function from which a panic can be
//! reached.
#![no_std]
#![no_main]

use core::fmt::{self, Write};
use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use muslin_core::cooked::{Cloth, required_bytes, vertices};
use muslin_core::diagnostics::{self, StateHash};
use muslin_core::dispatch::{Limited, Serial};
use muslin_core::geometry::normals::write_normals;
use muslin_core::kinematic::Pose;
use muslin_core::live::Live as _;
use muslin_core::real::Vec3;

#[repr(align(32))]
struct Aligned<T: ?Sized>(T);

static BLOCK: &Aligned<[u8]> = &Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/cloth.bin")));

#[entry]
fn main() -> ! {
    // Nothing is known of the scene.
    let block = black_box(&BLOCK.0);
    let mut memory = Aligned([0; 1 << 10]);
    black_box((required_bytes(block).is_ok(), vertices(block).is_ok()));
    match Cloth::open(block, black_box(&mut memory.0)) {
        Ok(mut cloth) => call_all(&mut cloth),
        Err(error) => show(&error),
    }
    loop {
        cortex_m::asm::wfi();
    }
}

/// Takes the words of errors and drops them.
struct Nowhere;

impl Write for Nowhere {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        black_box(text);
        Ok(())
    }
}

fn show(error: &dyn fmt::Display) {
    black_box(write!(Nowhere, "{error}").is_ok());
}

/// Every call of a cloth.
fn call_all(cloth: &mut Cloth<'_>) {
    let limited = Limited::new(&Serial, black_box(100), black_box(100));
    if let Err(error) = cloth.step(&limited) {
        show(&error);
    }
    black_box(limited.spent());
    read_all(cloth);
    let (number, vector, pose) = (black_box(1), black_box([1.0; 3]), black_box(Pose::IDENTITY));
    if let Err(error) = cloth.move_collider(number, pose, 0.1) {
        show(&error);
    }
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

/// Every call that reads.
fn read_all(cloth: &Cloth<'_>) {
    black_box((cloth.positions(), cloth.velocities(), cloth.triangles(), cloth.time(), cloth.origin()));
    black_box((cloth.step_length(), cloth.steps(), cloth.scheme(), cloth.estimated_error()));
    black_box((cloth.statistics(), cloth.contact_statistics()));
    black_box((cloth.pins().held().count(), cloth.colliders()));
    let mut normals = [Vec3::ZERO; 4];
    write_normals(cloth.positions(), cloth.triangles(), black_box(&mut normals));
    let mut hash = StateHash::default();
    hash.add(cloth.positions(), cloth.velocities());
    black_box(hash);
    black_box(diagnostics::first_non_finite(cloth.positions(), |_| Vec3::ZERO));
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
