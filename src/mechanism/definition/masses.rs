//! A definition in which no body has a mass: what it cannot have, and what has no effect in it.
//!
//! In: a definition whose keys are sound. Out: faults of what needs masses; the definition without what has no effect,
//! so that nothing that needs masses becomes a variable. It must not know how the motion is found without masses.
use super::experiment::Method;
use super::{GROUND, Mechanism};
use crate::format::{Faults, Named};
use crate::inspection::Finding;

/// Most bodies that a remedy names.
const NAMED: usize = 6;

/// What a definition without masses has left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Massless {
    /// Whether no body has a mass, so that the motion can be prescribed only.
    is_massless: bool,
    /// Keys that have no effect, as paths.
    idle: Vec<String>,
}

/// Names in words, of many the first.
pub fn listed(names: &[&str]) -> String {
    match names.len() {
        0..=NAMED => names.join(", "),
        count => format!("{} and {} more", names[..NAMED].join(", "), count - NAMED),
    }
}

impl Mechanism {
    /// Whether no body has a mass or an inertia, so that only the motion itself can be computed.
    pub fn is_massless(&self) -> bool {
        self.massless.is_massless
    }

    /// The bodies to which a mass can be given, in words.
    pub fn bodies_without_mass(&self) -> String {
        let moving = self.bodies.iter().filter(|(name, body)| *name != GROUND && body.fixed_to.is_none());
        listed(&moving.map(|(name, _)| name).collect::<Vec<_>>())
    }

    /// Whether a number may give a body, the screw of a drive or the rotor of a joint a mass or an inertia.
    fn has_masses(&self) -> bool {
        let bodies = self.bodies.iter().any(|(_, body)| [body.mass, body.inertia].into_iter().any(|m| m > Some(0.0)));
        let screws = self.actuators.iter().filter_map(|(_, drive)| drive.screw).any(|s| s.reflected_mass() > 0.0);
        let rotors = self.joints.iter().any(|(_, joint)| joint.armature > Some(0.0));
        let ends = [".mass", ".inertia", ".armature"];
        let is_inertial = |key: &str| !key.starts_with("parameters") && ends.iter().any(|end| key.ends_with(end));
        bodies || screws || rotors || self.expressions.iter().any(|one| is_inertial(&one.key))
    }

    /// Refuse what needs masses where no body has one, and leave out what then has no effect.
    pub(super) fn settle_masses(&mut self, faults: &mut Faults) {
        if self.has_masses() || !faults.are_of_unknown_keys() {
            return;
        }
        self.massless.is_massless = true;
        let remedy = format_args!("no body has a mass: give a mass to one of {}", self.bodies_without_mass());
        let mut refuse = |key: &str, what: &str, or: &str| {
            faults.refuse(key, format!("{what} needs masses, but {remedy}, or {or}"));
        };
        if self.hydraulics.is_some() {
            refuse("hydraulics", "a hydraulic network", "remove this key and prescribe the motion of a drive");
        }
        if let Some((_, name, _)) = self.hydraulic_drive() {
            let key = format!("actuators.{name}.hydraulics");
            refuse(&key, "a hydraulic circuit", "remove this key and prescribe the motion of a drive");
        }
        if self.solver.method == Some(Method::RigidFem) {
            refuse("solver.method", "\"rigid_fem\"", "remove this key");
            self.solver.method = None;
        }
        if self.start.equilibrium {
            refuse("start", "an equilibrium", "give a start position");
        }
        self.leave_out();
        let gone = self.forget_expressions();
        if let Some((key, name)) = gone {
            let message = format_args!("this expression uses {name}, which has no effect: {remedy}, or write a number");
            faults.refuse(key, message);
        }
    }

    /// Leave out, and note, what has no effect without masses.
    fn leave_out(&mut self) {
        fn take<T>(idle: &mut Vec<String>, key: String, value: &mut Option<T>) {
            idle.extend(value.take().map(|_| key));
        }
        fn clear<T>(idle: &mut Vec<String>, group: &str, elements: &mut Named<T>) {
            idle.extend(elements.names().into_iter().map(|name| format!("{group}.{name}")));
            *elements = Named::default();
        }
        let idle = &mut self.massless.0.idle;
        take(idle, "gravity".into(), &mut self.gravity);
        take(idle, "friction".into(), &mut self.friction);
        take(idle, "air".into(), &mut self.air);
        take(idle, "solver.method".into(), &mut self.solver.method);
        self.solver.fem_step = None;
        clear(idle, "forces", &mut self.forces);
        clear(idle, "torques", &mut self.torques);
        clear(idle, "surfaces", &mut self.surfaces);
        clear(idle, "locks", &mut self.locks);
        if std::mem::take(&mut self.linearisation) {
            idle.push("linearisation".into());
        }
        for (name, drive) in self.actuators.iter_mut() {
            let key = |key: &str| format!("actuators.{name}.{key}");
            take(idle, key("force"), &mut drive.force);
            take(idle, key("torque"), &mut drive.torque);
            take(idle, key("efficiency"), &mut drive.efficiency);
            take(idle, key("points"), &mut drive.points);
            take(idle, key("control"), &mut drive.control);
            (drive.command, drive.backward_efficiency) = (None, None);
            if std::mem::take(&mut drive.by_body) {
                idle.push(key("by_body"));
            }
            if let Some(motion) = &mut drive.motion
                && !std::mem::replace(&mut motion.enabled, true)
            {
                idle.push(key("motion.enabled"));
            }
        }
        for (name, coupling) in self.couplings.iter_mut() {
            take(idle, format!("couplings.{name}.efficiency"), &mut coupling.efficiency);
            take(idle, format!("couplings.{name}.pretension"), &mut coupling.pretension);
            coupling.backward_efficiency = None;
            (coupling.static_coefficient, coupling.kinetic_coefficient) = (None, None);
        }
        for (name, joint) in self.joints.iter_mut() {
            take(idle, format!("joints.{name}.frictionloss"), &mut joint.frictionloss);
            take(idle, format!("joints.{name}.surface_speed"), &mut joint.surface_speed);
            (joint.pin_radius, joint.static_coefficient, joint.kinetic_coefficient) = (None, None, None);
        }
        for (name, body) in self.bodies.iter_mut() {
            (body.mass, body.inertia) = (None, None);
            take(idle, format!("bodies.{name}.shape"), &mut body.shape);
            take(idle, format!("bodies.{name}.center"), &mut body.center);
            take(idle, format!("bodies.{name}.axial_stiffness"), &mut body.axial_stiffness);
        }
    }

    /// Warnings about what has no effect without masses.
    pub(super) fn warn_of_masses(&self, all: &mut Vec<Finding>) {
        if !self.is_massless() {
            return;
        }
        let bodies = self.bodies_without_mass();
        for key in &self.massless.idle {
            let remedy = format_args!("remove this key, or add the key `mass` to one of the bodies {bodies}");
            all.push(Finding::warning(key, "this key has no effect, because no body has a mass", remedy));
        }
        if self.motion_drive().is_none() {
            let message = "no body has a mass and no drive has the key `motion`, so nothing moves the mechanism in a \
                run";
            let remedy = format_args!(
                "add the key `motion` to a drive in `actuators`, or add the key `mass` to one of the bodies {bodies}"
            );
            all.push(Finding::warning("bodies", message, remedy));
        }
    }
}
