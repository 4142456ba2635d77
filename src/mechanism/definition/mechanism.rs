//! A whole mechanism as the file states it, and the list of its parameters.
use super::Visit;
use super::bodies::{Body, Friction, FrictionLaw, Joint, JointKind, Marker};
use super::contact::{Lock, Stop};
use super::couplings::Coupling;
use super::drawing::Units;
use super::experiment::{Solver, Start};
use super::expressions::{Expressions, Unclear};
use super::loads::{Actuator, Air, Force, Gravity, Spring, Surface, Torque};
use super::motion::PrescribedMotion;
use super::named_parameter::{NamedParameter, Shared};
use crate::format::{About, DefinitionError, Experiment, Flag, Named};
use crate::hydraulics::definition::Circuit;
use crate::numerics::decimal::Decimal;
use serde::{Deserialize, Serialize};

/// Name of the body that does not move.
pub const GROUND: &str = "ground";

/// Largest miss of a crossing that is put right, relative to the size of the mechanism, where the file does not say.
pub const SNAP: f64 = 1e-6;
/// Largest `snap`.
const LARGEST_SNAP: f64 = 0.01;

/// A whole mechanism.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Mechanism {
    /// Location of the schema, for editors; not read here.
    #[serde(rename = "$schema")]
    pub schema: Option<String>,
    /// Name of the model, a C identifier.
    pub name: String,
    /// One line of text.
    #[serde(default)]
    pub description: String,
    /// Author, copyright and licence.
    #[serde(default, skip_serializing_if = "About::is_default")]
    pub about: About,
    /// Named parameters that several definitions share; none where absent.
    #[serde(rename = "parameters_from", default, skip_serializing_if = "Option::is_none")]
    pub shared: Option<Shared>,
    /// Named parameters, which expressions read.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub parameters: Named<NamedParameter>,
    /// Parameters whose values are expressions of others.
    #[serde(skip_deserializing, skip_serializing_if = "Expressions::is_empty")]
    pub expressions: Expressions,
    /// Units that the file has stated, once all angles and lengths are in SI units.
    #[serde(skip)]
    pub file_units: Units,
    /// Expressions of numbers that are no parameters whose unit is unclear.
    #[serde(skip)]
    pub unclear: Vec<Unclear>,
    /// Units of the file's angles and lengths; None once all are in SI units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// Uniform gravity; none where absent.
    pub gravity: Option<Gravity>,
    /// Bodies; [`GROUND`] among them.
    pub bodies: Named<Body>,
    /// Joints between bodies.
    pub joints: Named<Joint>,
    /// Couplings between bodies: gears, racks, belts.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub couplings: Named<Coupling>,
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
    pub friction: Option<Friction>,
    /// Air flow past the mechanism; none where absent.
    pub air: Option<Air>,
    /// Surfaces with drag.
    #[serde(default)]
    pub surfaces: Named<Surface>,
    /// Stops: ends of the travel.
    #[serde(default)]
    pub stops: Named<Stop>,
    /// Locks, which hold the mechanism at a stop.
    #[serde(default)]
    pub locks: Named<Lock>,
    /// Position and speed at the start.
    #[serde(deserialize_with = "Start::read")]
    pub start: Start,
    /// Rough angle [rad] of each turning body and position [m] of each prismatic joint, which select the assembly;
    /// those of drawn bodies follow.
    #[serde(default)]
    pub guess: Named<f64>,
    /// Largest miss of a crossing of branches, relative to the size of the mechanism, that is put right; [`SNAP`] where
    /// absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub snap: Option<f64>,
    /// Whether eigenfrequency and damping ratio of small motions are outputs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub linearisation: bool,
    /// Integration settings.
    #[serde(default)]
    pub solver: Solver,
    /// Default experiment.
    #[serde(default)]
    pub experiment: Experiment,
}

impl Mechanism {
    /// Largest miss of a crossing that is put right, relative to the size of the mechanism; 0: none is.
    pub fn snap(&self) -> f64 {
        self.snap.unwrap_or(SNAP)
    }

    /// Whether friction, where it is enabled, holds at rest.
    pub fn sticks(&self) -> bool {
        let loses = self.couplings.iter().any(|(_, coupling)| coupling.efficiency.is_some());
        loses || self.friction.is_some_and(|friction| friction.law == FrictionLaw::Stick)
    }

    /// Refuse a `snap` that is no small part of the mechanism.
    pub(super) fn check_snap(&self) -> Result<(), DefinitionError> {
        match self.snap {
            Some(snap) if !(0.0..=LARGEST_SNAP).contains(&snap) => {
                let allowed = format!("from 0 to {LARGEST_SNAP}, a part of the mechanism's size");
                Err(DefinitionError::value("snap", Decimal(snap), allowed))
            }
            _ => Ok(()),
        }
    }

    /// The error for a variable that two elements give, which are named.
    pub fn named_twice(&self, variable: &str) -> DefinitionError {
        let name = variable.split('.').next().unwrap_or_default();
        let groups = [
            ("parameters", self.parameters.get(name).is_some()),
            ("bodies", self.bodies.get(name).is_some()),
            ("joints", self.joints.get(name).is_some()),
            ("couplings", self.couplings.get(name).is_some()),
            ("actuators", self.actuators.get(name).is_some()),
            ("forces", self.forces.get(name).is_some()),
            ("torques", self.torques.get(name).is_some()),
            ("springs", self.springs.get(name).is_some()),
            ("markers", self.markers.get(name).is_some()),
            ("surfaces", self.surfaces.get(name).is_some()),
            ("stops", self.stops.get(name).is_some()),
            ("locks", self.locks.get(name).is_some()),
        ];
        let owners: Vec<String> =
            groups.into_iter().filter(|(_, has)| *has).map(|(group, _)| format!("{group}.{name}")).collect();
        match owners.as_slice() {
            [first, second, ..] => {
                let message = format!("{first} and {second} both give the variable {variable}: rename one");
                DefinitionError::key(second, message)
            }
            [one] => {
                DefinitionError::key(one, format!("another element gives the variable {variable} too: rename one"))
            }
            [] => DefinitionError::key(variable, "two elements give a variable of this name: rename one"),
        }
    }

    /// The drive with a hydraulic circuit, by its index, with its name and the circuit; none if no drive has one.
    pub fn hydraulic_drive(&self) -> Option<(usize, &str, &Circuit)> {
        let mut drives = self.actuators.iter().enumerate();
        drives.find_map(|(index, (name, actuator))| Some((index, name, actuator.hydraulics.as_ref()?)))
    }

    /// The drive whose motion can be prescribed, by its index, with its name and the motion; none if no drive has one.
    pub fn motion_drive(&self) -> Option<(usize, &str, &PrescribedMotion)> {
        let mut drives = self.actuators.iter().enumerate();
        drives.find_map(|(index, (name, actuator))| Some((index, name, actuator.motion.as_ref()?)))
    }

    /// Call `visit` with every numeric parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut Visit) {
        let joints = &mut self.joints;
        self.shared.iter_mut().for_each(|shared| shared.parameters(visit));
        self.parameters.iter_mut().for_each(|(name, parameter)| parameter.parameters("parameters.", name, visit));
        self.gravity.iter_mut().for_each(|gravity| gravity.parameters(visit));
        self.bodies.iter_mut().for_each(|(name, body)| body.parameters(name, visit));
        joints.iter_mut().for_each(|(name, joint)| joint.parameters(name, visit));
        self.couplings.iter_mut().for_each(|(name, coupling)| coupling.parameters(name, visit));
        self.actuators.iter_mut().for_each(|(name, actuator)| {
            let joint = actuator.joint.as_ref().and_then(|joint| joints.get(joint));
            let is_rotary = joint.is_some_and(|joint| joint.kind == JointKind::Revolute) || actuator.screw.is_some();
            actuator.parameters(name, is_rotary, visit);
        });
        self.forces.iter_mut().filter(|(_, f)| f.constant).for_each(|(name, force)| force.parameters(name, visit));
        self.torques.iter_mut().filter(|(_, t)| t.constant).for_each(|(name, torque)| torque.parameters(name, visit));
        self.springs.iter_mut().for_each(|(name, spring)| {
            let joint = spring.joint.as_ref().and_then(|joint| joints.get(joint));
            spring.parameters(name, joint.is_some_and(|joint| joint.kind == JointKind::Revolute), visit);
        });
        self.friction.iter_mut().for_each(|friction| friction.parameters(visit));
        self.air.iter_mut().for_each(|air| air.parameters(visit));
        self.surfaces.iter_mut().for_each(|(name, surface)| surface.parameters(name, visit));
        self.stops.iter_mut().for_each(|(name, stop)| stop.parameters(name, visit));
        self.start.parameters(visit);
        self.solver.parameters(visit);
    }

    /// Call `visit` with every Boolean parameter and its value.
    pub fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        self.friction.iter_mut().for_each(|friction| friction.flags(visit));
        self.air.iter_mut().for_each(|air| air.flags(visit));
        self.stops.iter_mut().for_each(|(name, stop)| stop.flags(name, visit));
        self.solver.flags(visit);
    }
}
