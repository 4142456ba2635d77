//! Variables that a user connects together.
use super::{Reference, Variable};

/// Variables that make up one connection, such as the force and the motion of one drive. Two terminals of one kind
/// connect their members of the same names, as far as both have them: each pair is an output and an input of one
/// quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Name of the connection, the part of its variables' names before the dot.
    pub name: String,
    /// Quantity that says where the drive is: `length`, `position` or `angle`. Terminals with another one do not fit.
    pub kind: String,
    /// One line of text.
    pub description: String,
    /// The variables, in the order of the connection.
    pub members: Vec<Member>,
}

/// A variable of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name by which it meets its counterpart.
    pub name: String,
    /// The variable.
    pub variable: Reference,
}

impl Member {
    /// The member that a variable is under the last part of its name.
    pub fn of(reference: Reference, variable: &Variable) -> Self {
        Self { name: variable.quantity().to_owned(), variable: reference }
    }
}
