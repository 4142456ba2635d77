//! What a check of a key returns.

use crate::format::DefinitionError;
use std::fmt;

pub(super) type Check = Result<(), DefinitionError>;

pub(super) fn refused<T>(key: impl fmt::Display, message: impl fmt::Display) -> Result<T, DefinitionError> {
    Err(DefinitionError::key(key, message))
}
