//! Measures the stack: fills it with a pattern, and later counts the words that have lost the pattern.

use core::ptr::addr_of_mut;

unsafe extern "C" {
    static mut __sheap: u32;
    static mut _stack_start: u32;
}

const PATTERN: u32 = 0xA5A5_5A5A;

/// Bytes near the present end of the stack that are left alone.
const MARGIN: usize = 256;

/// Fills the free stack.
#[inline(never)]
pub fn paint() {
    let here = 0_u32;
    let end = (&raw const here as usize).saturating_sub(MARGIN);
    // SAFETY: the words between the end of the static data and the stack pointer belong to nobody.
    unsafe {
        let mut word = addr_of_mut!(__sheap);
        while (word as usize) < end {
            word.write_volatile(PATTERN);
            word = word.add(1);
        }
    }
}

/// Bytes of the stack that were used since.
#[inline(never)]
pub fn used() -> usize {
    // SAFETY: the words are read only, between the end of the static data and the start of the stack.
    unsafe {
        let (mut word, start) = (addr_of_mut!(__sheap), addr_of_mut!(_stack_start));
        while word < start && word.read_volatile() == PATTERN {
            word = word.add(1);
        }
        start as usize - word as usize
    }
}
