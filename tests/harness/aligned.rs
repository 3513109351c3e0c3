//! Bytes at an alignment, as cooked scenes and their memory need them.

/// Bytes that begin at a multiple of 32.
pub struct Aligned {
    bytes: Vec<u8>,
    start: usize,
}

impl Aligned {
    const ALIGNMENT: usize = 32;

    /// A copy of bytes.
    pub fn new(bytes: &[u8]) -> Self {
        let mut own = Self::filled(bytes.len(), 0);
        own.all().copy_from_slice(bytes);
        own
    }

    /// So many equal bytes.
    pub fn filled(length: usize, byte: u8) -> Self {
        let bytes = vec![byte; length + Self::ALIGNMENT];
        let start = bytes.as_ptr().align_offset(Self::ALIGNMENT);
        Self { bytes, start }
    }

    /// The bytes.
    pub fn all(&mut self) -> &mut [u8] {
        let end = self.bytes.len() - Self::ALIGNMENT + self.start;
        &mut self.bytes[self.start..end]
    }
}
