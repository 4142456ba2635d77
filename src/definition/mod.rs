//! The definition: what `mechanism.json` says, checked for what can be told without geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range.
//! It must not know how loops are closed or what FMI is. SI units throughout, angles in rad, anticlockwise positive.
mod error;
mod named;
mod parameters;
mod place;
mod validate;

pub use error::DefinitionError;
pub use named::Named;
pub use parameters::{Parameter, Range, Role};

use serde::Deserialize;

/// Name of the body that does not move.
pub const GROUND: &str = "ground";

/// A whole mechanism.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Mechanism {
    /// Where an editor finds the schema of this format; not read.
    #[serde(rename = "$schema", default)]
    pub schema: Option<String>,
    /// Name of the FMU, a C identifier.
    pub name: String,
    /// One line of text.
    #[serde(default)]
    pub description: String,
    /// Uniform gravity; none where absent.
    #[serde(default)]
    pub gravity: Option<Gravity>,
    /// Bodies; [`GROUND`] among them.
    pub bodies: Named<Body>,
    /// Joints between bodies.
    pub joints: Named<Joint>,
    /// Drives: forces along the line between two points, forces or torques in a joint.
    #[serde(default)]
    pub actuators: Named<Actuator>,
    /// Forces at a point, in the mechanism frame.
    #[serde(default)]
    pub forces: Named<Force>,
    /// Torques on a body.
    #[serde(default)]
    pub torques: Named<Torque>,
    /// Springs and dampers, between two points or in a joint.
    #[serde(default)]
    pub springs: Named<Spring>,
    /// Points whose position, velocity and acceleration are outputs.
    #[serde(default)]
    pub markers: Named<Marker>,
    /// Position and speed at the start.
    pub start: Start,
    /// Rough angle [rad] of each turning body and position [m] of each prismatic joint: which assembly is meant.
    pub guess: Named<f64>,
    /// Integration settings.
    #[serde(default)]
    pub solver: Solver,
    /// Default experiment.
    #[serde(default)]
    pub experiment: Experiment,
}

/// Uniform gravity: the acceleration load_factor * acceleration along -(cos up_angle, sin up_angle).
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration of free fall [m/s2], >= 0.
    pub acceleration: f64,
    /// Angle of the upward direction from the X axis [rad].
    pub up_angle: f64,
    /// Start value of the input `load_factor` [1].
    #[serde(default = "one")]
    pub load_factor: f64,
}

fn one() -> f64 {
    1.0
}

/// A rigid body, with a frame: the origin and the x axis, along which `length` leads to the point `end`.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Rigidly fixed with its origin at this point (`body.point`) of another body.
    #[serde(default)]
    pub fixed_to: Option<String>,
    /// Angle of a fixed body's x axis from the other body's [rad]; 0 where absent.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Distance from the point `origin` to the point `end` [m], > 0.
    #[serde(default)]
    pub length: Option<f64>,
    /// Mass [kg], >= 0; 0 where absent.
    #[serde(default)]
    pub mass: Option<f64>,
    /// How the mass is spread; a point mass at `center` with the moment of inertia `inertia` where absent.
    #[serde(default)]
    pub shape: Option<Shape>,
    /// Centre of mass in the body's frame [m]; the origin where absent.
    #[serde(default)]
    pub center: Option<[f64; 2]>,
    /// Moment of inertia about the centre of mass [kg.m2], >= 0; 0 where absent.
    #[serde(default)]
    pub inertia: Option<f64>,
    /// Further named points in the body's frame [m].
    #[serde(default)]
    pub points: Named<[f64; 2]>,
}

/// How a body's mass is spread.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Evenly between `origin` and `end`: centre at half the length, moment of inertia m l2 / 12.
    UniformRod,
}

/// Connection of two bodies.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Kind of joint.
    #[serde(rename = "type")]
    pub kind: JointKind,
    /// Point (`body.point`) of the first-named body: the one whose force on the second is the reaction.
    pub first: String,
    /// Point (`body.point`) of the second-named body.
    pub second: String,
    /// Prismatic only: direction of sliding in the first body's frame [rad]; 0 where absent.
    #[serde(default)]
    pub axis_angle: Option<f64>,
    /// Prismatic only: angle of the second body's x axis from the first's [rad]; 0 where absent.
    #[serde(default)]
    pub angle: Option<f64>,
}

/// Kind of a joint.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// The two points coincide.
    Revolute,
    /// The second point lies on a line through the first, fixed in the first body; the bodies do not turn relatively.
    Prismatic,
}

/// A drive: along the line between two points (positive pushes them apart), or in a joint (positive moves the second body
/// forward: anticlockwise, or along the axis).
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// One end (`body.point`).
    #[serde(default)]
    pub first: Option<String>,
    /// The other end (`body.point`).
    #[serde(default)]
    pub second: Option<String>,
    /// The joint, in place of the two ends.
    #[serde(default)]
    pub joint: Option<String>,
    /// Start value of the input `<name>.force` [N]; not in a revolute joint.
    #[serde(default)]
    pub force: Option<f64>,
    /// Start value of the input `<name>.torque` [N.m]; in a revolute joint only.
    #[serde(default)]
    pub torque: Option<f64>,
    /// [CK16] eq. (5): part of the power that reaches the mechanism when it is driven; the same part of the power that
    /// flows back reaches the drive. 0 < eta <= 1; 1 where absent.
    #[serde(default)]
    pub efficiency: Option<f64>,
}

/// A force at a point, in the mechanism frame.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Point of application (`body.point`).
    pub at: String,
    /// Start values of `<name>.force_x` and `<name>.force_y` [N].
    #[serde(default)]
    pub force: [f64; 2],
    /// Whether these are parameters; inputs where absent.
    #[serde(default)]
    pub constant: bool,
}

/// A torque on a body.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Torque {
    /// Body on which it acts.
    pub on: String,
    /// Start value of `<name>.torque` [N.m].
    #[serde(default)]
    pub torque: f64,
    /// Whether this is a parameter; an input where absent.
    #[serde(default)]
    pub constant: bool,
}

/// A spring and damper: between two points it pulls them together with preload + stiffness (length - free_length) +
/// damping d(length)/dt; in a joint it turns the second body back with preload + stiffness (angle - free_angle) +
/// damping d(angle)/dt, angle being the second body's less the first's.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// One end (`body.point`).
    #[serde(default)]
    pub first: Option<String>,
    /// The other end (`body.point`).
    #[serde(default)]
    pub second: Option<String>,
    /// The joint, in place of the two ends.
    #[serde(default)]
    pub joint: Option<String>,
    /// Stiffness [N/m or N.m/rad], >= 0.
    #[serde(default)]
    pub stiffness: f64,
    /// Damping [N.s/m or N.m.s/rad], >= 0; none where absent.
    #[serde(default)]
    pub damping: Option<f64>,
    /// Length without force but the preload [m], >= 0; between two points, or along a prismatic joint.
    #[serde(default)]
    pub free_length: Option<f64>,
    /// Angle without torque but the preload [rad]; in a revolute joint.
    #[serde(default)]
    pub free_angle: Option<f64>,
    /// Force or torque at the free length or angle [N or N.m]; 0 where absent.
    #[serde(default)]
    pub preload: Option<f64>,
}

/// A point whose position, velocity and acceleration are outputs.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Marker {
    /// The point (`body.point`).
    pub at: String,
}

/// Position and speed at the start, of a turning body or of a prismatic joint.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Turning body that states the start.
    #[serde(default)]
    pub body: Option<String>,
    /// Its angle [rad].
    #[serde(default)]
    pub angle: Option<f64>,
    /// Prismatic joint that states the start.
    #[serde(default)]
    pub joint: Option<String>,
    /// Its position [m].
    #[serde(default)]
    pub position: Option<f64>,
    /// Its speed [rad/s or m/s].
    #[serde(default)]
    pub speed: f64,
}

/// Integration settings.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Relative tolerance of the integration [1].
    pub tolerance: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Self { tolerance: 1e-9 }
    }
}

/// Default experiment of the FMU.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Stop time [s], > 0; the start time is 0.
    pub stop_time: f64,
    /// Preferred communication step [s], > 0.
    pub step_size: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, step_size: 1e-3 }
    }
}

impl Mechanism {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message that names the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut mechanism = Self::parse(text).map_err(|e| DefinitionError::Malformed {
            key: place::key_at(text, e.line(), e.column()),
            message: e.to_string(),
        })?;
        mechanism.check()?;
        Ok(mechanism)
    }

    fn parse(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }
}

#[cfg(test)]
mod tests;
