//! What the value of an output follows from.

/// What the value of an output follows from.
#[derive(Clone, Copy, Default)]
pub(super) struct Needs<'a> {
    /// The geometry of every joint, and so the coordinates at the start.
    pub closure: bool,
    /// The geometry of this joint, which places the body that states the start.
    pub joint: Option<usize>,
    /// The stated start position.
    pub position: bool,
    /// The stated start speed.
    pub speed: bool,
    /// The kinetic energy at given rates.
    pub inertia: bool,
    /// Mass, centre of mass and inertia of each body.
    pub masses: bool,
    /// Inputs, by index.
    pub inputs: &'a [usize],
    /// Geometry and constants of these loads, ascending.
    pub loads: &'a [usize],
    /// Whether efficiencies of drives do not count among the constants of loads.
    pub lossless: bool,
    /// Point of this marker.
    pub marker: Option<usize>,
    /// Pin radius of the friction joint with this load.
    pub radius: Option<usize>,
    /// Static friction of the joints.
    pub statics: bool,
    /// The stretch of bodies as rods.
    pub elasticity: bool,
    /// The laws of the hydraulic circuit and its pressures at the start.
    pub circuit: bool,
}

/// What the position of every body follows from.
pub(super) fn placed() -> Needs<'static> {
    Needs { closure: true, position: true, ..Needs::default() }
}
