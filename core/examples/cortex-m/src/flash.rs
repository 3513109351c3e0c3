//! Measures the program in flash memory, by symbols that the linker defines.

use core::ptr::addr_of;

unsafe extern "C" {
    static __stext: u32;
    static __etext: u32;
}

/// Bytes of instructions.
pub fn code() -> usize {
    addr_of!(__etext) as usize - addr_of!(__stext) as usize
}
