//! What the rigid-link finite elements refuse.
use crate::numerics::decimal::Decimal;
use std::fmt;

/// Why there is no finite element model, or no step. The text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum RigidFemError {
    /// A prismatic joint: an element has two pins.
    Prismatic {
        /// Name of the joint.
        joint: String,
    },
    /// A moving body that is no binary link.
    Nodes {
        /// Name of the body.
        body: String,
        /// Number of different points at which joints hold it.
        count: usize,
    },
    /// An axial stiffness E A that is not finite and > 0.
    AxialStiffness {
        /// Name of the body.
        body: String,
        /// The value [N].
        value: f64,
    },
    /// A node can move without moving any mass: its accelerations would be anything.
    Massless {
        /// Name of the lightest body there.
        body: String,
        /// Its mass [kg].
        mass: f64,
    },
    /// A drive that loses power: its force jumps where the motion turns back.
    Efficiency {
        /// Name of the drive.
        drive: String,
        /// Its efficiency [1].
        value: f64,
    },
    /// A step that is no step.
    StepSize {
        /// Which one, `h` or `h_fem`.
        name: &'static str,
        /// The value [s].
        value: f64,
    },
    /// A step is divided into too many.
    Substeps {
        /// Their number.
        count: f64,
        /// Largest number allowed.
        limit: f64,
    },
    /// The equilibrium iterations of a step did not converge, or a force became infinite.
    Equilibrium {
        /// The step [s].
        h: f64,
        /// Last correction of a node's position [m].
        correction: f64,
        /// Below this it would have converged [m].
        limit: f64,
    },
    /// A rod is stretched or pressed further than a rigid link may be.
    Strain {
        /// Name of the body.
        body: String,
        /// Change of its length by its length [1].
        strain: f64,
        /// Largest amount allowed [1].
        limit: f64,
        /// The step [s].
        h: f64,
    },
    /// No static stretch of the rods was found at the start.
    Stretch {
        /// Last correction of a node's position [m].
        correction: f64,
        /// Below this it would have converged [m].
        limit: f64,
    },
}

impl fmt::Display for RigidFemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Prismatic { joint } => write!(
                f,
                "{joint} is prismatic: rigid finite elements take revolute joints only; choose the reduced model"
            ),
            Self::Nodes { body, count } => write!(
                f,
                "{body} is held by joints at {count} points: a rigid finite element has exactly 2 of them; choose the reduced model"
            ),
            Self::AxialStiffness { body, value } => {
                let value = Decimal(*value);
                write!(f, "axial stiffness of {body} = {value} N: must be finite and > 0; state E A of the rod")
            }
            Self::Massless { body, mass } => write!(
                f,
                "mass of {body} = {mass} kg: one of its joints can move by a stretch of the rods alone, without moving any mass; \
                 give {body} a mass off its pivot or choose the reduced model"
            ),
            Self::Efficiency { drive, value } => write!(
                f,
                "efficiency of {drive} = {value}: rigid finite elements know no losses in drives; set it to 1 or choose the reduced model"
            ),
            Self::StepSize { name, value } => {
                write!(f, "step size {name} = {} s: must be finite and > 0", Decimal(*value))
            }
            Self::Substeps { count, limit } => {
                write!(f, "a step would take {count:e} steps of h_fem, allowed are {limit:e}: raise h_fem")
            }
            Self::Equilibrium { h, correction, limit } => write!(
                f,
                "no equilibrium at the end of a step of {h:e} s: the iterations still move a node by {correction:e} m, allowed are {limit:e} m; \
                 take a smaller step or check the sizes of the inputs"
            ),
            Self::Strain { body, strain, limit, h } => write!(
                f,
                "{body} is stretched by {strain:.2e} of its length where {limit} is allowed, at steps of {h:e} s: either the steps \
                 are too long and its vibration grows, or the loads are too large for its axial stiffness; take smaller steps or \
                 raise the axial stiffness"
            ),
            Self::Stretch { correction, limit } => write!(
                f,
                "no static stretch at the start: the iterations still move a node by {correction:e} m, allowed are {limit:e} m; \
                 raise the axial stiffness or lower the loads"
            ),
        }
    }
}

impl std::error::Error for RigidFemError {}
