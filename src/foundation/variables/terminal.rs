//! Variables that a user connects together.
use super::{Reference, Variable};

/// Variables of one connection, such as the force and the motion of one drive. In a connection of two terminals of the
/// same kind, members with equal names are connected, if both terminals have them. Each pair is an output and an input
/// of one quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Name of the connection: the part of its variables' names before the dot.
    pub name: String,
    /// Quantity that states the position of the drive: `length`, `position` or `angle`. Terminals of different kinds do
    /// not fit.
    pub kind: String,
    /// One line of text.
    pub description: String,
    /// The variables, in the order of the connection.
    pub members: Vec<Member>,
}

/// A variable of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name, which equals the name of the connected member.
    pub name: String,
    /// The variable.
    pub variable: Reference,
}

impl Member {
    /// The member for a variable, named by the last part of the variable's name.
    pub fn of(reference: Reference, variable: &Variable) -> Self {
        Self { name: variable.quantity().to_owned(), variable: reference }
    }
}
