//! Errors of the rigid-link finite elements.
use crate::numerics::decimal::Decimal;
use std::fmt;

/// Error of the rigid-link finite elements. Its text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum RigidFemError {
    /// A prismatic joint: an element has two revolute joints.
    Prismatic { joint: String },
    /// A drive with a screw: masses are those of elements.
    Screw,
    /// A coupling: an element has two revolute joints.
    Coupling { coupling: String },
    /// A moving body that is not a binary link: joints hold it at `count` different points.
    Nodes { body: String, count: usize },
    /// An axial stiffness E A [N] that is not finite and > 0.
    AxialStiffness { body: String, value: f64 },
    /// A node can move without moving any mass, so that its acceleration is indeterminate: the lightest body at the
    /// node and its mass [kg].
    Massless { body: String, mass: f64 },
    /// A drive with losses, here its efficiency [1]: its force jumps where the motion reverses.
    Efficiency { drive: String, value: f64 },
    /// A step, `h` or `h_fem` [s], that is not finite and > 0.
    StepSize { name: &'static str, value: f64 },
    /// A step of too many substeps.
    Substeps { count: f64, limit: f64 },
    /// The equilibrium iterations of a step h [s] did not converge, or a force became infinite: the last correction of
    /// a node's position [m], and that at which the iterations end.
    Equilibrium { h: f64, correction: f64, limit: f64 },
    /// The strain [1] of a rod is too large for a rigid link, in steps of h [s].
    Strain { body: String, strain: f64, limit: f64, h: f64 },
    /// The iterations for the static strain at the start did not converge: the last correction of a node's position
    /// [m], and that at which the iterations end.
    Stretch { correction: f64, limit: f64 },
}

impl fmt::Display for RigidFemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Prismatic { joint } => write!(
                f,
                "{joint} is prismatic, but rigid finite elements support revolute joints only; choose solver.method = \
                 \"reduced\""
            ),
            Self::Screw => {
                write!(
                    f,
                    "a drive has a screw or a joint has an armature, which rigid finite elements do not support; \
                    choose solver.method = \"reduced\""
                )
            }
            Self::Coupling { coupling } => write!(
                f,
                "{coupling} couples two bodies, but rigid finite elements support no gears, racks, belts and cams; \
                 choose solver.method = \"reduced\""
            ),
            Self::Nodes { body, count } => write!(
                f,
                "{body} has joints at {count} points, but a rigid finite element must have joints at exactly 2 points; \
                 choose solver.method = \"reduced\""
            ),
            Self::AxialStiffness { body, value } => {
                let value = Decimal(*value);
                write!(f, "axial stiffness of {body} = {value} N: must be finite and > 0; give E A of the rod in N")
            }
            Self::Massless { body, mass } => write!(
                f,
                "mass of {body} = {mass} kg: one of its joints can move by stretching rods alone, without moving a \
                 mass; give {body} a mass away from its pivot, or choose solver.method = \"reduced\""
            ),
            Self::Efficiency { drive, value } => write!(
                f,
                "efficiency of {drive} = {value}: rigid finite elements support no losses in drives; set the \
                 efficiency to 1, or choose solver.method = \"reduced\""
            ),
            Self::StepSize { name, value } => {
                write!(f, "step size {name} = {} s: must be finite and > 0", Decimal(*value))
            }
            Self::Substeps { count, limit } => {
                write!(
                    f,
                    "the communication step needs {count:e} internal steps of solver.fem_step, but at most {limit:e} \
                     are allowed: increase solver.fem_step"
                )
            }
            Self::Equilibrium { h, correction, limit } => write!(
                f,
                "the elastic bodies have no equilibrium at the end of a step of {h:e} s: the iteration still moves a \
                 node by {correction:e} m, but at most {limit:e} m are allowed; use a smaller step or check the values \
                 of the inputs"
            ),
            Self::Strain { body, strain, limit, h } => write!(
                f,
                "{body} is stretched by {strain:.2e} of its length, but at most {limit} is allowed, at steps of \
                 {h:e} s: the steps are too long and the body vibrates, or the loads are too large for its axial \
                 stiffness; use smaller steps or a larger axial stiffness"
            ),
            Self::Stretch { correction, limit } => write!(
                f,
                "no static equilibrium of the elastic bodies at the start: the iteration still moves a node by \
                 {correction:e} m, but at most {limit:e} m are allowed; use a larger axial stiffness or smaller \
                 loads"
            ),
        }
    }
}

impl std::error::Error for RigidFemError {}
