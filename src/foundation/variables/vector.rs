//! Vectors of the plane: array variables in addition to the scalars that are their elements.
use super::Reference;

/// Two Real outputs along x and y with the same owner and unit, as one variable. Exists only in FMI 3.0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vector {
    /// Structured name, such as `joint1.reaction`.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// The scalars, in the order in which values are serialised.
    pub elements: [Reference; 2],
}
