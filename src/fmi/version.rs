//! The properties of an FMI version that an instance needs.
//!
//! In: nothing. Out: words of messages, and whether vectors exist. Must not know: which versions exist.
use crate::variables::Kind;

/// A version of FMI.
#[derive(Clone, Copy, Debug)]
pub struct Version {
    type_of: fn(Kind) -> &'static str,
    has_vectors: bool,
}

impl Version {
    /// A version whose only variables are those of the component. `type_of` gives the name of the type of each kind.
    pub const fn of_scalars(type_of: fn(Kind) -> &'static str) -> Self {
        Self { type_of, has_vectors: false }
    }

    /// A version in which the time and vectors are also variables.
    pub const fn with_vectors(type_of: fn(Kind) -> &'static str) -> Self {
        Self { type_of, has_vectors: true }
    }

    /// Whether the time and vectors are variables.
    pub fn has_vectors(&self) -> bool {
        self.has_vectors
    }

    /// Name of the type of variables of a kind, for messages.
    pub fn type_of(&self, kind: Kind) -> &'static str {
        (self.type_of)(kind)
    }
}
