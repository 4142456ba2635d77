//! Vectors of the plane: array variables in addition to the scalars that are their elements.
use super::Reference;

/// Two Real outputs of one owner and unit, along x and y, as one variable. FMI 3.0 has it; FMI 2.0 has scalars alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vector {
    /// Structured name, such as `joint1.reaction`.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// The scalars, in the order in which values are serialised.
    pub elements: [Reference; 2],
}
