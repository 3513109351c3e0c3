//! Reads the columns of a block, and takes room for columns from the memory of the host.

use bytemuck::{CheckedBitPattern, NoUninit, Pod};

use super::CookedError;
use crate::column::Column as _;

/// Bytes of every column begin at a multiple of this in the block.
pub(super) const STEP: usize = 8;

/// Room for a single value in the memory, bytes: the same for pointers of 32 and of 64 bits.
pub(super) const CELL: usize = 32;

/// A view whose columns lie in a block and in memory.
pub(super) trait Columns<'a>: Sized {
    /// Reads the view.
    fn open(source: &mut Source<'a>) -> Result<Self, CookedError>;
    /// Writes the view.
    #[cfg(feature = "alloc")]
    fn cook(&self, sink: &mut super::sink::Sink);
}

/// The rest of a block, and the rest of the memory.
pub(super) struct Source<'a> {
    pub block: &'a [u8],
    pub memory: &'a mut [u8],
    /// For the error where the memory is too small.
    pub needed: usize,
}

impl<'a> Source<'a> {
    /// Bytes of the block, and the gap after them.
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], CookedError> {
        let (bytes, _) = self.block.split_at_checked(count).ok_or(CookedError::Truncated)?;
        let padded = count.next_multiple_of(STEP).min(self.block.len());
        self.block = self.block.get(padded..).unwrap_or_default();
        Ok(bytes)
    }

    /// The number of entries of a column.
    fn length(&mut self) -> Result<usize, CookedError> {
        usize::try_from(self.value::<u64>()?).map_err(|_| CookedError::Malformed)
    }

    /// Room in the memory, all zero.
    fn room(&mut self, count: usize) -> Result<&'a mut [u8], CookedError> {
        let padded = count.checked_next_multiple_of(super::ALIGNMENT).ok_or(CookedError::Malformed)?;
        let memory = core::mem::take(&mut self.memory);
        let (room, rest) = memory.split_at_mut_checked(padded).ok_or(CookedError::Memory { needed: self.needed })?;
        self.memory = rest;
        let (room, _) = room.split_at_mut_checked(count).ok_or(CookedError::Malformed)?;
        room.fill(0);
        Ok(room)
    }

    /// A column that stays in the block.
    pub fn constant<T: Pod>(&mut self) -> Result<&'a [T], CookedError> {
        let length = self.length()?.checked_mul(size_of::<T>()).ok_or(CookedError::Malformed)?;
        bytemuck::try_cast_slice(self.bytes(length)?).map_err(|_| CookedError::Alignment)
    }

    /// A column of the state, copied to the memory.
    pub fn state<T: Pod>(&mut self) -> Result<&'a mut [T], CookedError> {
        let from = self.constant::<T>()?;
        let to = self.work::<T>(from.len())?;
        to.copy_from(from);
        Ok(to)
    }

    /// A work column, all zero.
    pub fn scratch<T: CheckedBitPattern + NoUninit>(&mut self) -> Result<&'a mut [T], CookedError> {
        let length = self.length()?;
        self.work(length)
    }

    fn work<T: CheckedBitPattern + NoUninit>(&mut self, length: usize) -> Result<&'a mut [T], CookedError> {
        let bytes = self.room(length.checked_mul(size_of::<T>()).ok_or(CookedError::Malformed)?)?;
        bytemuck::checked::try_cast_slice_mut(bytes).map_err(|_| CookedError::Alignment)
    }

    /// A single value in the memory, all zero.
    pub fn cell<T: CheckedBitPattern + NoUninit>(&mut self) -> Result<&'a mut T, CookedError> {
        const { assert!(size_of::<T>() <= CELL) };
        let bytes = self.room(CELL)?.get_mut(..size_of::<T>()).ok_or(CookedError::Malformed)?;
        bytemuck::checked::try_from_bytes_mut(bytes).map_err(|_| CookedError::Alignment)
    }

    /// A single value of the block.
    pub fn value<T: Pod>(&mut self) -> Result<T, CookedError> {
        bytemuck::try_pod_read_unaligned(self.bytes(size_of::<T>())?).map_err(|_| CookedError::Malformed)
    }

    /// A truth value.
    pub fn flag(&mut self) -> Result<bool, CookedError> {
        Ok(self.value::<u64>()? != 0)
    }

    /// A value that is not stored.
    pub fn fresh<T: Default>(&mut self) -> Result<T, CookedError> {
        Ok(T::default())
    }

    /// Columns of a part.
    pub fn part<T: Columns<'a>>(&mut self) -> Result<T, CookedError> {
        T::open(self)
    }
}
