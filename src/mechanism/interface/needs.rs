//! What the value of an output follows from, and what a parameter acts on.

/// What the value of an output follows from.
#[derive(Clone, Copy)]
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
    /// Geometry and constants of these loads.
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
}

/// Nothing.
pub(super) const NONE: Needs<'static> = Needs {
    closure: false,
    joint: None,
    position: false,
    speed: false,
    inertia: false,
    masses: false,
    inputs: &[],
    loads: &[],
    lossless: false,
    marker: None,
    radius: None,
    statics: false,
    elasticity: false,
};

/// The position of every body.
pub(super) const PLACED: Needs<'static> = Needs { closure: true, position: true, ..NONE };

/// What a parameter acts on.
#[derive(Clone, Copy)]
pub(super) enum Cause {
    Joint(usize),
    Position,
    Speed,
    Inertia,
    Masses,
    Load(usize),
    /// Of the drive with this load.
    Efficiency(usize),
    Marker(usize),
    /// Of the friction joint with this load.
    Radius(usize),
    Statics,
    Elasticity,
}

impl Needs<'_> {
    /// Whether the value follows from one of the causes.
    pub fn meet(&self, causes: &[Cause]) -> bool {
        causes.iter().any(|cause| match cause {
            Cause::Joint(joint) => self.closure || self.joint == Some(*joint),
            Cause::Position => self.position,
            Cause::Speed => self.speed,
            Cause::Inertia => self.inertia,
            Cause::Masses => self.masses,
            Cause::Load(load) => self.loads.contains(load),
            Cause::Efficiency(load) => !self.lossless && self.loads.contains(load),
            Cause::Marker(marker) => self.marker == Some(*marker),
            Cause::Radius(load) => self.radius == Some(*load),
            Cause::Statics => self.statics,
            Cause::Elasticity => self.elasticity,
        })
    }
}
