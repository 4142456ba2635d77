//! What an instance must know of the version of FMI that its host speaks.
//!
//! In: nothing. Out: the words of messages, which variables there are. It must not know which versions there are.
use crate::variables::Kind;

/// A version of FMI.
#[derive(Clone, Copy, Debug)]
pub struct Version {
    type_of: fn(Kind) -> &'static str,
    has_vectors: bool,
}

impl Version {
    /// A version in which variables of a kind have types of these names, and the component's are all there are.
    pub const fn of_scalars(type_of: fn(Kind) -> &'static str) -> Self {
        Self { type_of, has_vectors: false }
    }

    /// A version in which the time and vectors are variables too.
    pub const fn with_vectors(type_of: fn(Kind) -> &'static str) -> Self {
        Self { type_of, has_vectors: true }
    }

    /// Whether the time and vectors are variables.
    pub fn has_vectors(&self) -> bool {
        self.has_vectors
    }

    /// Name of the type that variables of a kind have, for messages.
    pub fn type_of(&self, kind: Kind) -> &'static str {
        (self.type_of)(kind)
    }
}
