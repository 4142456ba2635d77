//! Errors of the rigid-link finite elements.
use crate::numerics::decimal::Decimal;
use std::fmt;

/// Error of the rigid-link finite elements. Its text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum RigidFemError {
    /// A prismatic joint: an element has two revolute joints.
    Prismatic {
        /// Name of the joint.
        joint: String,
    },
    /// A moving body that is not a binary link.
    Nodes {
        /// Name of the body.
        body: String,
        /// Number of different points with joints.
        count: usize,
    },
    /// An axial stiffness E A that is not finite and > 0.
    AxialStiffness {
        /// Name of the body.
        body: String,
        /// The value [N].
        value: f64,
    },
    /// A node can move without moving any mass: its acceleration is indeterminate.
    Massless {
        /// Name of the lightest body at the node.
        body: String,
        /// Mass of the body [kg].
        mass: f64,
    },
    /// A drive with losses: its force jumps where the motion reverses.
    Efficiency {
        /// Name of the drive.
        drive: String,
        /// Efficiency of the drive [1].
        value: f64,
    },
    /// A step that is not finite and > 0.
    StepSize {
        /// Name of the step, `h` or `h_fem`.
        name: &'static str,
        /// The value [s].
        value: f64,
    },
    /// A step of too many substeps.
    Substeps {
        /// Number of substeps.
        count: f64,
        /// Largest allowed number.
        limit: f64,
    },
    /// The equilibrium iterations of a step did not converge, or a force became infinite.
    Equilibrium {
        /// The step [s].
        h: f64,
        /// Last correction of a node's position [m].
        correction: f64,
        /// Correction at which the iterations end [m].
        limit: f64,
    },
    /// The strain of a rod is too large for a rigid link.
    Strain {
        /// Name of the body.
        body: String,
        /// Strain [1].
        strain: f64,
        /// Largest allowed absolute value [1].
        limit: f64,
        /// The step [s].
        h: f64,
    },
    /// The iterations for the static strain at the start did not converge.
    Stretch {
        /// Last correction of a node's position [m].
        correction: f64,
        /// Correction at which the iterations end [m].
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
