//! The board: memory that is taken once, a count of instructions, messages to the host, and the end.

use core::cell::UnsafeCell;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};

/// Instructions in a tick of the timer: its clock has 25 MHz, and QEMU counts a nanosecond for each instruction.
const INSTRUCTIONS: u64 = 40;

/// Bits of the timer.
const TICKS: u32 = 0x00ff_ffff;

/// Bytes that begin where cooked scenes and their memory must.
#[repr(align(32))]
pub struct Aligned<T: ?Sized>(pub T);

/// Defines the parts of a scene that the build script has cooked: `BLOCK` in flash memory, `HASHES` of its states at the start
/// and after each step, and `ROOM` of `MEMORY` bytes for its work.
macro_rules! scene {
    ($name:literal) => {
        include!(concat!(env!("OUT_DIR"), "/", $name, ".rs"));

        static BLOCK: &$crate::board::Aligned<[u8]> =
            &$crate::board::Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/", $name, ".bin")));

        const MEMORY: usize = match muslin_core::cooked::required_bytes(&BLOCK.0) {
            Ok(bytes) => bytes,
            Err(_) => panic!("the scene was cooked by another version"),
        };

        static ROOM: $crate::board::Once<[u8; MEMORY]> = $crate::board::Once::new([0; MEMORY]);
    };
}
pub(crate) use scene;

/// Memory that one owner takes once.
pub struct Once<T> {
    memory: UnsafeCell<Aligned<T>>,
    is_taken: AtomicBool,
}

// SAFETY: only the first caller of `take` gets the memory.
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    pub const fn new(memory: T) -> Self {
        Self { memory: UnsafeCell::new(Aligned(memory)), is_taken: AtomicBool::new(false) }
    }

    /// The memory.
    #[expect(clippy::mut_from_ref, reason = "only the first caller gets it")]
    pub fn take(&'static self) -> &'static mut T {
        if self.is_taken.swap(true, Ordering::Relaxed) {
            stop(format_args!("the memory is taken twice"));
        }
        // SAFETY: no other call comes here.
        unsafe { &mut (*self.memory.get()).0 }
    }
}

/// Counts instructions.
pub struct Counter;

impl Counter {
    pub fn start() -> Self {
        let Some(board) = cortex_m::Peripherals::take() else { stop(format_args!("the timer is taken twice")) };
        let mut timer = board.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(TICKS);
        timer.clear_current();
        timer.enable_counter();
        Self
    }

    /// Does a task and returns the number of its instructions, which is below 671 million.
    pub fn count<T>(&self, task: impl FnOnce() -> T) -> (T, u64) {
        let before = SYST::get_current();
        let done = task();
        let ticks = before.wrapping_sub(SYST::get_current()) & TICKS;
        (done, u64::from(ticks) * INSTRUCTIONS)
    }
}

/// Ends with a message of a failure.
pub fn stop(why: core::fmt::Arguments<'_>) -> ! {
    hprintln!("{}", why);
    end(debug::EXIT_FAILURE)
}

/// Ends.
pub fn end(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    stop(format_args!("{info}"))
}
