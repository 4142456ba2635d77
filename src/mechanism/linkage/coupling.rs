//! What a coupling is: its bodies, its law, how it transmits its force.
use super::cam::Cam;
use super::law::Law;

/// A coupling of two bodies. Its joint has the centre of the first wheel or cam and the centre of the second wheel or
/// follower, or the point of the rack or follower in its prismatic joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Index of its joint.
    pub joint: usize,
    /// Index of the body on which the first wheel is hinged, and the second is hinged or slides.
    pub carrier: usize,
    /// u1 less the angle of the first body relative to the carrier [rad].
    pub shift: f64,
    /// Motion of the second body.
    pub second: Second,
    /// Law F.
    pub law: Law,
    /// Residual for u2 = 1 [m].
    pub scale: f64,
    /// How the force is transmitted.
    pub kind: Kind,
}

/// Motion of the second body of a coupling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Second {
    /// It turns: u2 is its angle relative to the carrier plus `shift` [rad].
    Angle {
        /// u2 less the angle of the second body relative to the carrier [rad].
        shift: f64,
    },
    /// It slides: u2 is `sign` times the position of a prismatic joint, its displacement along the joint's axis [m].
    Position {
        /// Index of the joint.
        joint: usize,
        /// Index of the coordinate that is the joint's position.
        coordinate: usize,
        /// 1 if the carrier is the joint's first body, -1 if it is the second.
        sign: f64,
    },
}

/// How a coupling transmits its force.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Teeth in contact at the pitch point on the line between the centres, with a common tangent of the pitch curves
    /// that is across this line for a constant ratio.
    Gears,
    /// Teeth in contact at the pitch point at the foot of the first wheel's centre on the pitch line of the rack.
    Rack,
    /// Two spans of a belt that touch pulleys of these radii [m].
    Belt {
        /// Radii of the first and the second pulley [m].
        radii: [f64; 2],
        /// Whether the spans cross between the pulleys.
        crossed: bool,
    },
    /// A disc cam and its follower, in contact along the normal of the profile. The contact pulls too, as in a groove.
    Cam(Cam),
}
