//! Variables that a user connects together.
use super::Reference;

/// Variables that make up one connection, such as the force and the motion of one drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Name of the connection, the part of its variables' names before the dot.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// The variables, in the order of the connection.
    pub members: Vec<Reference>,
}
