//! Cooked scenes: all columns of a scene in one block of bytes, which a host opens where it lies, for example in flash
//! memory, and steps in memory that it gives, without a heap.
//!
//! A block begins with a header. The columns follow in the order of `columns.rs`, each with its length. Constant columns
//! stay in the block. The columns of the state are copied to the memory of the host, and room for the work columns is
//! taken from it. Numbers are little-endian, in the precision of the crate.

mod check;
pub mod cloth;
mod columns;
mod snapshot;
mod source;
pub(crate) mod stored;

#[cfg(feature = "alloc")]
mod cook;
#[cfg(feature = "alloc")]
mod sink;

pub use cloth::Cloth;
#[cfg(feature = "alloc")]
pub use cook::{Room, cook};

use bytemuck::{Pod, Zeroable};

use crate::real::Real;

/// Alignment of a block and of the memory for its work, bytes.
pub const ALIGNMENT: usize = 32;

/// The first bytes of a block.
const MAGIC: u64 = u64::from_le_bytes(*b"MuslinCl");

/// Changes with every change of the columns.
const VERSION: u32 = 6;

/// The beginning of a block.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Header {
    magic: u64,
    version: u32,
    /// Bytes of a scalar.
    scalar: u32,
    /// Length of the block with this header, bytes.
    length: u64,
    /// Working memory, bytes.
    memory: u64,
    /// Of the header with a checksum of zero, and of the bytes after it.
    checksum: u64,
    /// Number of vertices of the cloth.
    vertices: u64,
    reserved: [u64; 2],
}

impl Header {
    /// The checksum of a block with this header and these columns.
    fn checksum_with(&self, columns: &[u8]) -> u64 {
        let blank = Self { checksum: 0, ..*self };
        checksum(columns) ^ checksum(bytemuck::bytes_of(&blank))
    }
}

const HEADER: usize = size_of::<Header>();

impl Header {
    /// Reads the beginning of a block; `None` if the block is shorter.
    const fn read(block: &[u8]) -> Option<Self> {
        let Some([magic, format, length, memory, checksum, vertices, a, b]) = block.as_chunks().0.first_chunk() else {
            return None;
        };
        let format = u64::from_le_bytes(*format);
        Some(Self {
            magic: u64::from_le_bytes(*magic),
            version: format as u32,
            scalar: (format >> 32) as u32,
            length: u64::from_le_bytes(*length),
            memory: u64::from_le_bytes(*memory),
            checksum: u64::from_le_bytes(*checksum),
            vertices: u64::from_le_bytes(*vertices),
            reserved: [u64::from_le_bytes(*a), u64::from_le_bytes(*b)],
        })
    }
}

/// Reason why a cooked scene cannot be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CookedError {
    /// The bytes are not a cooked scene.
    NotCooked,
    /// It was cooked by another version of the crate.
    Version(
        /// The version found.
        u32,
    ),
    /// It was cooked in another precision.
    Precision,
    /// It does not have the length that it says.
    Truncated,
    /// Bytes have changed since it was cooked.
    Checksum,
    /// The bytes, or the memory, do not begin at a multiple of [`ALIGNMENT`].
    Alignment,
    /// The memory is too small.
    Memory {
        /// Bytes needed.
        needed: usize,
    },
    /// A number in it cannot be, for example the index of a vertex.
    Malformed,
    /// The processor stores numbers in another order of bytes.
    BigEndian,
}

impl core::fmt::Display for CookedError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotCooked => write!(f, "the bytes are not a cooked scene; make one with `muslin cook`"),
            Self::Version(found) => {
                write!(f, "the scene was cooked in format {found}, this program reads format {VERSION}; cook it again")
            }
            Self::Precision => {
                write!(f, "the scene was cooked in another precision; this program uses {}", crate::real::NAME)
            }
            Self::Truncated => write!(f, "the cooked scene does not have the length that it says"),
            Self::Checksum => write!(f, "the cooked scene is damaged: its checksum is wrong"),
            Self::Alignment => {
                write!(f, "the cooked scene and the memory must begin at a multiple of {ALIGNMENT} bytes")
            }
            Self::Memory { needed } => write!(f, "the scene needs {needed} bytes of memory"),
            Self::Malformed => write!(f, "the cooked scene has a number that cannot be; cook it again"),
            Self::BigEndian => write!(f, "cooked scenes work on little-endian processors only"),
        }
    }
}

impl core::error::Error for CookedError {}

/// Working memory that a cooked scene needs, bytes. It reads the header alone.
pub const fn required_bytes(block: &[u8]) -> Result<usize, CookedError> {
    match header(block) {
        Ok(header) => Ok(header.memory as usize),
        Err(error) => Err(error),
    }
}

/// Number of vertices of a cooked scene. It reads the header alone.
pub const fn vertices(block: &[u8]) -> Result<usize, CookedError> {
    match header(block) {
        Ok(header) => Ok(header.vertices as usize),
        Err(error) => Err(error),
    }
}

/// Whether a block is as it was cooked: reads its header and compares its checksum. [`Cloth::open`] checks its numbers too.
pub fn is_whole(block: &[u8]) -> Result<(), CookedError> {
    let header = header(block)?;
    let columns = block.get(HEADER..).unwrap_or_default();
    if header.checksum_with(columns) == header.checksum { Ok(()) } else { Err(CookedError::Checksum) }
}

/// The header of a block, if the block is one that this crate reads.
const fn header(block: &[u8]) -> Result<Header, CookedError> {
    if cfg!(target_endian = "big") {
        return Err(CookedError::BigEndian);
    }
    let Some(header) = Header::read(block) else { return Err(CookedError::NotCooked) };
    if header.magic != MAGIC {
        return Err(CookedError::NotCooked);
    }
    if header.version != VERSION {
        return Err(CookedError::Version(header.version));
    }
    if header.scalar as usize != size_of::<Real>() {
        return Err(CookedError::Precision);
    }
    if header.length != block.len() as u64 {
        return Err(CookedError::Truncated);
    }
    Ok(header)
}

/// Checksum of bytes: FNV-1a over words.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let add = |sum: u64, word: u64| {
        let product = (sum ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        product ^ product >> 32
    };
    let sum = words.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &word| add(sum, u64::from_le_bytes(word)));
    rest.iter().fold(sum, |sum, &byte| add(sum, byte.into()))
}
