//! `muslin bench`.
use crate::args::BenchArguments;
use crate::failure::Failure;

/// Measures.
pub fn bench(_: &BenchArguments) -> Result<(), Failure> {
    Ok(())
}
