//! The definition: what `mechanism.json` says, checked for what can be told without geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range.
//! It must not know how loops are closed or what FMI is. SI units throughout, angles in rad, anticlockwise positive.
mod error;
mod named;
mod parameter;
mod parameters;
mod place;
mod solver;
mod strict;
mod validate;

pub use error::DefinitionError;
pub use named::Named;
pub use parameter::{Flag, Parameter, Range, Role};
pub use solver::{Method, Solver};

use serde::{Deserialize, Serialize};
use strict::Strict;

/// Name of the body that does not move.
pub const GROUND: &str = "ground";

/// A whole mechanism.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
    /// Joint friction; none where absent.
    #[serde(default)]
    pub friction: Option<Friction>,
    /// Air that flows past the mechanism; none where absent.
    #[serde(default)]
    pub air: Option<Air>,
    /// Surfaces on which the air drags.
    #[serde(default)]
    pub surfaces: Named<Surface>,
    /// Stops: ends of the travel.
    #[serde(default)]
    pub stops: Named<Stop>,
    /// Locks, which hold the mechanism at a stop.
    #[serde(default)]
    pub locks: Named<Lock>,
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
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
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
    /// E A of the body as a rod between its two joints [N], > 0; asked for by [`Method::RigidFem`] only.
    #[serde(default)]
    pub axial_stiffness: Option<f64>,
    /// Further named points in the body's frame [m].
    #[serde(default)]
    pub points: Named<[f64; 2]>,
}

/// How a body's mass is spread.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Evenly between `origin` and `end`: centre at half the length, moment of inertia m l2 / 12.
    UniformRod,
}

/// Connection of two bodies.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
    /// Revolute only: radius of the pin [m], >= 0; without one the joint has no friction.
    #[serde(default)]
    pub pin_radius: Option<f64>,
    /// Coefficient of static friction in this joint [1], >= 0; that of `friction` where absent.
    #[serde(default)]
    pub static_coefficient: Option<f64>,
    /// Coefficient of kinetic friction in this joint [1], >= 0; that of `friction` where absent.
    #[serde(default)]
    pub kinetic_coefficient: Option<f64>,
}

/// Kind of a joint.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// The two points coincide.
    Revolute,
    /// The second point lies on a line through the first, fixed in the first body; the bodies do not turn relatively.
    Prismatic,
}

/// A drive: along the line between two points (positive pushes them apart), or in a joint (positive moves the second body
/// forward: anticlockwise, or along the axis).
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Marker {
    /// The point (`body.point`).
    pub at: String,
}

/// Friction in the joints ([HF08] section 4): in every revolute joint with a pin radius, and in every prismatic joint.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Whether it acts.
    #[serde(default)]
    pub enabled: bool,
    /// Coefficient of static friction mu_S [1], >= 0.
    pub static_coefficient: f64,
    /// Coefficient of kinetic friction mu_d [1], >= 0.
    pub kinetic_coefficient: f64,
    /// Slip speed V_S at which friction is static [m/s], > 0; below, it is in proportion to the speed.
    #[serde(default = "static_speed")]
    pub static_speed: f64,
    /// Slip speed V_d from which friction is kinetic [m/s], > V_S.
    #[serde(default = "one")]
    pub kinetic_speed: f64,
}

fn static_speed() -> f64 {
    0.01
}

/// Air in uniform flow. Its speed is the input `airspeed`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Air {
    /// Mass density [kg/m3], >= 0.
    pub density: f64,
    /// Direction in which the air flows, angle from the X axis [rad].
    pub flow_angle: f64,
    /// Whether the motion of the surfaces counts for the speed of the air that meets them.
    #[serde(default)]
    pub relative_wind: bool,
    /// Start value of the input `airspeed` [m/s].
    #[serde(default)]
    pub airspeed: f64,
}

/// A surface on which air drags: a strip along the line between two points of one body, or an area at a point. The drag is
/// 1/2 density |u| u c S, where u is the air's velocity relative to the surface and S the area that faces it ([HF08] (1)).
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// One end of a strip (`body.point`).
    #[serde(default)]
    pub from: Option<String>,
    /// The other end, on the same body.
    #[serde(default)]
    pub to: Option<String>,
    /// Width of a strip [m], >= 0.
    #[serde(default)]
    pub width: Option<f64>,
    /// Place of an area (`body.point`).
    #[serde(default)]
    pub at: Option<String>,
    /// The area [m2], >= 0.
    #[serde(default)]
    pub area: Option<f64>,
    /// Angle in the body's frame of the line in which a flat area lies [rad]; where absent, the area is as large from all
    /// sides.
    #[serde(default)]
    pub surface_angle: Option<f64>,
    /// Drag coefficient c [1], >= 0.
    pub drag_coefficient: f64,
}

/// A stop: an end of the travel, stated by the angle of a turning body, the position of a prismatic joint, the angle of a
/// revolute one, or the distance of two points.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Turning body.
    #[serde(default)]
    pub body: Option<String>,
    /// Joint, in place of a body.
    #[serde(default)]
    pub joint: Option<String>,
    /// One of two points (`body.point`), in place of a body.
    #[serde(default)]
    pub first: Option<String>,
    /// The other point.
    #[serde(default)]
    pub second: Option<String>,
    /// Whether the travel ends below or above the stated value.
    pub limit: Limit,
    /// Angle [rad] of the body, or of a revolute joint's second body from its first.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Position along a prismatic joint [m].
    #[serde(default)]
    pub position: Option<f64>,
    /// Distance of the two points [m].
    #[serde(default)]
    pub length: Option<f64>,
    /// Whether it is there.
    #[serde(default = "yes")]
    pub enabled: bool,
    /// Whether it is rigid; else it is a bumper, a spring and damper that only pushes.
    #[serde(default = "yes")]
    pub rigid: bool,
    /// Rigid: speed after an impact over the speed before [1], from 0 to 1.
    #[serde(default)]
    pub restitution: f64,
    /// Bumper: stiffness [N/m or N.m/rad], >= 0.
    #[serde(default)]
    pub stiffness: f64,
    /// Bumper: damping [N.s/m or N.m.s/rad], >= 0.
    #[serde(default)]
    pub damping: f64,
    /// Name of the Boolean output that tells whether the mechanism is at this stop; `<name>.reached` where absent.
    #[serde(default)]
    pub flag: Option<String>,
}

fn yes() -> bool {
    true
}

/// Which end of the travel a stop is.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The value may not fall below.
    Lower,
    /// The value may not rise above.
    Upper,
}

/// A lock: while its input `<name>.engage` is true it takes hold of the mechanism when that comes to a stop's position, and
/// holds it there by a force at a point, along the path of that point.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Lock {
    /// The stop at which it holds.
    pub stop: String,
    /// Point on which it acts (`body.point`).
    pub at: String,
    /// Start value of `<name>.engage`.
    #[serde(default)]
    pub engage: bool,
}

/// Position and speed at the start, of a turning body or of a prismatic joint.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
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

/// Default experiment of the FMU.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
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
            message: in_words(&e),
        })?;
        mechanism.check()?;
        Ok(mechanism)
    }

    fn parse(text: &str) -> Result<Self, serde_json::Error> {
        let mut json = serde_json::Deserializer::from_str(text);
        let mechanism = Self::deserialize(Strict(&mut json))?;
        json.end().map(|()| mechanism)
    }
}

/// A parser's message, for whoever writes the file.
fn in_words(error: &serde_json::Error) -> String {
    let message = error.to_string().replace("expected f64", "expected a number");
    let remedy = if message.contains("invalid type: null") { "; leave the key out if it has no value" } else { "" };
    message + remedy
}

#[cfg(test)]
mod tests;
