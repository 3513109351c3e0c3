//! Measures the program in flash memory, by symbols that the linker defines.

use core::ptr::addr_of;

unsafe extern "C" {
    static __vector_table: u32;
    static __stext: u32;
    static __etext: u32;
    static __sdata: u32;
    static __edata: u32;
    static __sidata: u32;
}

/// Bytes of instructions.
pub fn code() -> usize {
    addr_of!(__etext) as usize - addr_of!(__stext) as usize
}

/// Bytes of all: the vectors, instructions, constants, among them the scene, and the start values of variables.
pub fn all() -> usize {
    let variables = addr_of!(__edata) as usize - addr_of!(__sdata) as usize;
    addr_of!(__sidata) as usize + variables - addr_of!(__vector_table) as usize
}
