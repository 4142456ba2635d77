//! The linkage: bodies, joints and loop equations in the coordinates of a spanning tree.
//!
//! In: a checked definition. Out: positions, rates and accelerations of every body for given coordinates, and the
//! residuals of the joints that close the loops. It must not know the motion of masses, loads, curves or time.
//!
//! Bodies that are fixed to one another are one body here. Bodies connected by prismatic joints share one angle. The
//! coordinates q are the angles of these groups [rad], then the positions of the prismatic joints of the tree, then
//! those of the slots [m].
mod build;
mod cam;
mod contact;
mod couple;
mod coupled;
mod coupling;
mod knots;
mod law;
mod loops;
mod motion;
mod outline;
mod points;
mod precise;
mod rotor;
mod slot;
mod structure;

pub use cam::{Cam, Guide};
pub use contact::Contact;
pub use coupling::{Coupling, Kind, Second};
pub use knots::Knotted;
pub use law::Law;
pub use loops::Side;
pub use motion::{Arms, Positions, Rates};
pub use outline::Outline;
pub use rotor::Thrust;
pub use slot::Slot;
pub use structure::{Body, Branch, Freedom, GROUND, Joint, Line, Linkage, Loop, Point, Rotor, Stroke};

#[cfg(test)]
mod tests;
