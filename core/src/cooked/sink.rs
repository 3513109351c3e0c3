//! Writes the columns of a block, and counts the memory that they will need.

use alloc::vec::Vec;

use bytemuck::Pod;

use super::ALIGNMENT;
use super::source::{CELL, Columns, STEP};

/// The bytes of a block after its header.
#[derive(Default)]
pub(super) struct Sink {
    pub block: Vec<u8>,
    /// Working memory, bytes.
    pub memory: usize,
}

impl Sink {
    fn bytes(&mut self, bytes: &[u8]) {
        self.block.extend_from_slice(bytes);
        self.block.resize(self.block.len().next_multiple_of(STEP), 0);
    }

    fn length(&mut self, length: usize) {
        self.value(&(length as u64));
    }

    /// A column that stays in the block.
    pub fn constant<T: Pod>(&mut self, column: &[T]) {
        self.length(column.len());
        self.bytes(bytemuck::cast_slice(column));
    }

    /// A column of the state.
    pub fn state<T: Pod>(&mut self, column: &[T]) {
        self.constant(column);
        self.memory += size_of_val(column).next_multiple_of(ALIGNMENT);
    }

    /// A work column.
    pub fn scratch<T>(&mut self, column: &[T]) {
        self.length(column.len());
        self.memory += size_of_val(column).next_multiple_of(ALIGNMENT);
    }

    /// A single value in the memory.
    pub fn cell<T>(&mut self, _: &T) {
        self.memory += CELL.next_multiple_of(ALIGNMENT);
    }

    /// A single value of the block.
    pub fn value<T: Pod>(&mut self, value: &T) {
        self.bytes(bytemuck::bytes_of(value));
    }

    /// A truth value.
    pub fn flag(&mut self, value: &bool) {
        self.value(&u64::from(*value));
    }

    /// A value that is not stored.
    pub fn fresh<T>(&mut self, _: &T) {}

    /// Columns of a part.
    pub fn part<'a, T: Columns<'a>>(&mut self, part: &T) {
        part.cook(self);
    }
}
