//! The definition of a mechanism: the content of `mechanism.json`, with all checks that need no geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range; the
//! list of its parameters. It must not know how loops are closed, nor FMI. SI units throughout, angles in rad,
//! anticlockwise positive.
mod between;
mod bodies;
mod cams;
mod characteristics;
mod contact;
mod control;
mod couplings;
mod drawing;
mod experiment;
mod expressions;
mod interpolation;
mod loads;
mod masses;
mod motion;
mod named_parameter;
mod refusal;
mod slots;
mod validate;
mod warnings;

pub use crate::format::{DefinitionError, Experiment, Named, Range, Role, Visit};
pub use between::{Between, PLACES};
pub use bodies::{Body, Drawn, Friction, FrictionLaw, Joint, JointKind, Marker, Shape};
pub use cams::{CamLaw, CamSegment, Follower};
pub use contact::{Limit, Lock, Stop};
pub use control::{Control, ControlState, MOST_CONTROL_STATES, MOST_STATES};
pub use couplings::{Coupling, CouplingKind, Side};
pub use drawing::{AngleUnit, LengthUnit, Units};
pub use experiment::{Method, Solver, Start};
pub use expressions::{Calculated, Expressions, Fault, Unclear};
pub use interpolation::Interpolation;
pub use loads::{Actuator, Air, Force, Gas, Gravity, Screw, Spring, Surface, Torque};
pub use masses::{Massless, listed};
pub use motion::{PrescribedMotion, ProfileKind};
pub use named_parameter::{NamedParameter, Shared, SharedContents};
pub use validate::allow_hydraulics;

use crate::format::{self, About, Aside, Element, Faults, Flag, Key, either, element, keys, line, number};
use crate::hydraulics::definition::Circuit;
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::variables::Unit;

/// The elements of a definition for its schema and reference: the whole first, those of a circuit apart.
pub const ELEMENTS: [Element; 29] = [
    Element::of::<Mechanism>(""),
    Element::of::<About>("about"),
    Element::of::<Shared>("parameters_from"),
    Element::of::<SharedContents>("shared_parameters"),
    Element::of::<NamedParameter>("parameter"),
    Element::of::<Units>("units"),
    Element::of::<Gravity>("gravity"),
    Element::of::<Body>("body"),
    Element::of::<Drawn>("drawn"),
    Element::of::<Joint>("joint"),
    Element::of::<Coupling>("coupling"),
    Element::of::<CamSegment>("cam_segment"),
    Element::of::<Actuator>("actuator"),
    Element::of::<Screw>("screw"),
    Element::of::<Control>("control"),
    Element::of::<PrescribedMotion>("motion"),
    Element::of::<Force>("force"),
    Element::of::<Torque>("torque"),
    Element::of::<Spring>("spring"),
    Element::of::<Gas>("gas"),
    Element::of::<Marker>("marker"),
    Element::of::<Friction>("friction"),
    Element::of::<Air>("air"),
    Element::of::<Surface>("surface"),
    Element::of::<Stop>("stop"),
    Element::of::<Lock>("lock"),
    Element::of::<Start>("start"),
    Element::of::<Solver>("solver"),
    Element::of::<Experiment>("experiment"),
];

/// Name of the body that does not move.
pub const GROUND: &str = "ground";

/// Largest miss of a crossing that is put right, relative to the size of the mechanism, where the file does not say.
pub const SNAP: f64 = 1e-6;
keys! {
    /// The file mechanism.json defines a planar linkage with one degree of freedom. Numbers in mechanism.json are in SI
    /// units. Angles are in rad and count anticlockwise.
    pub struct Mechanism {
        /// Path of the JSON schema. A text editor uses the JSON schema to complete and check the keys. The FMU does not
        /// use the key `$schema`.
        schema as "$schema": Option<String>;
        /// Name of the FMU: a letter, then letters, digits or underscores.
        name: String => element().required();
        /// Description of the model, one line of text.
        description: String => line();
        /// Author, copyright and licence of the model, for the file `modelDescription.xml` of the FMU.
        about: About => Key::PLAIN.brief();
        /// Path of a file with named parameters that several mechanisms share, relative to the folder of the mechanism
        /// file.
        shared as "parameters_from": Option<Shared> => Key::PLAIN.brief();
        /// Named parameters for use in expressions. Each named parameter is a number, an expression, or an object with
        /// value and unit.
        parameters: Named<NamedParameter> => Key::PLAIN.brief();
        /// Parameters whose values are expressions of others.
        expressions: Expressions => Key { is_written_only: true, ..Key::PLAIN }.brief();
        /// Units that the file has stated, once all angles and lengths are in SI units.
        file_units: Aside<Units> => Aside::<Units>::KEY;
        /// Expressions of numbers that are no parameters whose unit is unclear.
        unclear: Aside<Vec<Unclear>> => Aside::<Vec<Unclear>>::KEY;
        /// What has been left out because no body has a mass.
        massless: Aside<Massless> => Aside::<Massless>::KEY;
        /// Units of the angles and lengths in the mechanism file. Default: SI units.
        units: Option<Units> => Key::PLAIN.brief();
        /// Uniform gravity. Without the key `gravity` there is no gravity.
        gravity: Option<Gravity>;
        /// Rigid bodies by name. The body `ground`, which does not move, is required.
        bodies: Named<Body> => Key::PLAIN.required();
        /// Joints by name. All joints and couplings together must leave one degree of freedom.
        joints: Named<Joint> => Key::PLAIN.required();
        /// Gears, racks, belts and cams by name.
        couplings: Named<Coupling> => Key::PLAIN.brief();
        /// Drives by name. Each drive has the input `<name>.force` or `<name>.torque`, and outputs such as the length,
        /// the speed and the reduced mass at the drive.
        actuators: Named<Actuator>;
        /// Hydraulic network that drives the mechanism: the content of a `network.json`. Each cylinder of the network
        /// moves the actuator that has the same name as the cylinder. The FMU integrates mechanism and network as one
        /// system.
        hydraulics: Option<HydraulicSystem> => Key::PLAIN.brief();
        /// Forces on points by name, with components in the mechanism frame.
        forces: Named<Force>;
        /// Torques on bodies by name.
        torques: Named<Torque>;
        /// Springs and dampers by name, between two points or in a joint.
        springs: Named<Spring>;
        /// Markers by name: points whose position, velocity and acceleration are outputs.
        markers: Named<Marker>;
        /// Friction in the joints. Without the key `friction` there is no friction.
        friction: Option<Friction>;
        /// Air flow past the mechanism. Without the key `air` there is no drag.
        air: Option<Air>;
        /// Surfaces on which the air exerts drag, by name. The key `surfaces` is allowed only together with the key
        /// `air`.
        surfaces: Named<Surface>;
        /// Stops by name. A stop limits the travel of the mechanism.
        stops: Named<Stop>;
        /// Locks by name. A lock holds the mechanism at a stop while the input `<name>.engage` is true.
        locks: Named<Lock>;
        /// Position and speed at the start, or the word `equilibrium`. With the word `equilibrium` the run starts at
        /// the stable equilibrium that is nearest to the position in `guess`.
        start: Start => Key::PLAIN.required();
        /// Rough angle of each turning body, and rough position of each prismatic joint and slot, by name [m or rad].
        /// The guess selects one of the possible assemblies of the links. Bodies with the key `drawn` need no guess.
        guess: Named<f64> => either([Unit::Metre, Unit::Radian], Range::Coordinate);
        /// Tolerance for change points (positions from which two different motions are possible), relative to the size
        /// of the mechanism [1], from 0 to 0.01. If rounded lengths miss a change point by less than `snap`, the
        /// program corrects the lengths. The corrected mechanism passes exactly through the change point. With `snap` =
        /// 0 the program corrects no lengths.
        snap: Option<f64> => number(Unit::One, Range::Snap).absent("1e-6").brief();
        /// true: the FMU has two additional outputs, the eigenfrequency and the damping ratio of small motions about
        /// the present state.
        linearisation: bool => Key::PLAIN.brief();
        /// Settings of the time integration of the mechanism.
        solver: Solver;
        /// Default experiment of the FMU: stop time and step size.
        experiment: Experiment;
    }
}

impl Mechanism {
    /// Largest miss of a crossing that is put right, relative to the size of the mechanism; 0: none is.
    pub fn snap(&self) -> f64 {
        self.snap.unwrap_or(SNAP)
    }

    /// Whether friction, where it is enabled, holds at rest.
    pub fn sticks(&self) -> bool {
        let loses = self.couplings.iter().any(|(_, coupling)| coupling.efficiency.is_some());
        let rubs = self.joints.iter().any(|(_, joint)| joint.frictionloss.is_some());
        let locks = self.actuators.iter().any(|(_, drive)| drive.locks_itself());
        loses || rubs || locks || self.friction.is_some_and(|friction| friction.law == FrictionLaw::Stick)
    }

    /// Refuse a `snap` that is no small part of the mechanism.
    fn check_snap(&self) -> Result<(), DefinitionError> {
        self.snap.map_or(Ok(()), |snap| Range::Snap.check("snap", snap))
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
        let mut owners: Vec<String> =
            groups.into_iter().filter(|(_, has)| *has).map(|(group, _)| format!("{group}.{name}")).collect();
        if let Some(network) = &self.hydraulics {
            network.elements(&mut |group, element| {
                if element == name {
                    owners.push(format!("hydraulics.{group}.{name}"));
                }
            });
        }
        match owners.as_slice() {
            [first, second, ..] => {
                let message =
                    format!("{first} and {second} both have the variable {variable}: rename one of the two elements");
                DefinitionError::key(second, message)
            }
            [one] => DefinitionError::key(
                one,
                format!("another element also has the variable {variable}: rename one of the two elements"),
            ),
            [] => DefinitionError::key(variable, "two elements have a variable of this name: rename one element"),
        }
    }

    /// The drive with a hydraulic circuit, by its index, with its name and the circuit; none if no drive has one.
    pub fn hydraulic_drive(&self) -> Option<(usize, &str, &Circuit)> {
        let mut drives = self.actuators.iter().enumerate();
        drives.find_map(|(index, (name, actuator))| Some((index, name, actuator.hydraulics.as_ref()?)))
    }

    /// Whether a hydraulic circuit or a hydraulic network drives the mechanism.
    pub fn has_hydraulics(&self) -> bool {
        self.hydraulics.is_some() || self.hydraulic_drive().is_some()
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
            let turns = actuator.between().is_some_and(|place| place.is_rotary(joints));
            let is_rotary = turns || actuator.screw.is_some();
            actuator.parameters(name, is_rotary, visit);
        });
        self.hydraulics.iter_mut().for_each(|network| network.element_parameters(visit));
        self.forces.iter_mut().filter(|(_, f)| f.constant).for_each(|(name, force)| force.parameters(name, visit));
        self.torques.iter_mut().filter(|(_, t)| t.constant).for_each(|(name, torque)| torque.parameters(name, visit));
        self.springs.iter_mut().for_each(|(name, spring)| {
            let is_rotary = spring.between().is_some_and(|place| place.is_rotary(joints));
            spring.parameters(name, is_rotary, visit);
        });
        self.friction.iter_mut().for_each(|friction| friction.parameters(visit));
        self.air.iter_mut().for_each(|air| air.parameters(visit));
        self.surfaces.iter_mut().for_each(|(name, surface)| surface.parameters(name, visit));
        self.stops.iter_mut().for_each(|(name, stop)| stop.parameters(name, visit));
        let stops = &self.stops;
        self.locks.iter_mut().for_each(|(name, lock)| {
            let is_rotary = stops.get(&lock.stop).is_some_and(|stop| stop.angle.is_some());
            lock.parameters(name, is_rotary, visit);
        });
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

impl Mechanism {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        allow_hydraulics();
        Self::checked(text)
    }

    /// [`Self::from_json`], with hydraulics only if [`allow_hydraulics`] was called.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn checked(text: &str) -> Result<Self, DefinitionError> {
        let (mechanism, faults) = Self::with_faults(text).unwrap_or_else(|faults| (Self::default(), faults));
        faults.first()?;
        Ok(mechanism)
    }

    /// Read a definition, with all faults that show without geometry, keys that nobody knows among them.
    ///
    /// # Errors
    /// All faults for which the text cannot be read as a mechanism.
    pub fn with_faults(text: &str) -> Result<(Self, Faults), Faults> {
        let (mut mechanism, mut faults) = Self::read(text);
        // The FMU has the name of the mechanism.
        faults.forgive(|fault| fault.path() == "hydraulics" && *fault.fault() == format::Fault::Missing("name"));
        if !faults.are_of_unknown_keys() {
            return Err(faults);
        }
        mechanism.find_faults(&mut faults);
        faults.rename(|path| mechanism.path_in_file(path));
        mechanism.index_expressions();
        Ok((mechanism, faults))
    }
}

#[cfg(test)]
mod tests;
