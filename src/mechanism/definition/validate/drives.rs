//! Checks of drives: their keys, their control and their prescribed motion, together with other elements.
use crate::format::Faults;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::definition::characteristics::check_drive;
use crate::mechanism::definition::control::check_control;
use crate::mechanism::definition::loads::Actuator;
use crate::mechanism::definition::refusal::refused;

/// Why no cylinder and no screw acts in a slot.
pub(super) const CURVED: &str = "this element acts along a straight line, but a slot is curved: name a prismatic joint \
    or two points";

impl Mechanism {
    /// Faults of all drives.
    pub(super) fn check_drives(&self, faults: &mut Faults) {
        for (name, a) in self.actuators.iter() {
            let key = format!("actuators.{name}");
            let Some(is_rotary) = faults.keep(self.check_between(&key, a.between())) else { continue };
            if a.screw.is_some() {
                let mut refuse = |message: &str| faults.refuse(format_args!("{key}.screw"), message);
                if is_rotary {
                    refuse(
                        "a screw acts along a line: give the keys \"first\" and \"second\", or name a prismatic joint",
                    );
                }
                if a.hydraulics.is_some() {
                    refuse(
                        "an actuator cannot have both a screw and a hydraulic circuit: remove `screw` or \
                        `hydraulics`",
                    );
                }
            }
            if a.locks_itself() && a.screw.is_none_or(|screw| screw.reflected_mass() == 0.0) {
                let message = "the efficiency is 0, but only a screw with an inertia can lock itself: add the key \
                               `screw` with an inertia, or give an efficiency above 0";
                faults.keep::<()>(refused(format_args!("{key}.backward_efficiency"), message));
            }
            for (k, is_given) in [("screw", a.screw.is_some()), ("hydraulics", a.hydraulics.is_some())] {
                if is_given && self.is_in_slot(a) {
                    faults.refuse(format_args!("{key}.{k}"), CURVED);
                }
            }
            let turns = is_rotary || a.screw.is_some();
            let (asked, other) = if turns { ("torque", a.force) } else { ("force", a.torque) };
            if other.is_some() {
                let message = "a drive in a revolute joint, between two bodies or with a screw has a torque; all other \
                               drives have a force";
                faults.refuse(&key, format!("give {asked}: {message}"));
            }
            if let Some(circuit) = &a.hydraulics {
                let mut refuse = |message: &str| faults.refuse(format_args!("{key}.hydraulics"), message);
                if is_rotary {
                    refuse(
                        "a cylinder acts along a line: give the keys \"first\" and \"second\", or name a prismatic \
                         joint",
                    );
                }
                if a.force.is_some() {
                    refuse("the hydraulic circuit computes the force, which is an output: remove the key `force`");
                }
                if a.efficiency.or(a.backward_efficiency).is_some() {
                    refuse(
                        "the losses of a hydraulic drive are the friction of its seals: remove the key \
                        `efficiency`",
                    );
                }
                if let Some((_, other, _)) = self.hydraulic_drive().filter(|(_, other, _)| *other != name) {
                    refuse(&format!(
                        "{other} already has a hydraulic circuit, but only one drive can have a circuit: remove one of \
                         the two circuits"
                    ));
                }
                circuit.find_faults(faults);
            }
            faults.keep(check_drive(&key, a));
            if let Some(control) = &a.control {
                let others = [a.points.is_some(), a.hydraulics.is_some(), a.motion.is_some()];
                check_control(&key, control, others, faults);
            }
            self.check_control_states(name, faults);
            self.check_motion(name, a, faults);
        }
    }

    /// Faults of the motion of a drive, if it has one.
    pub(super) fn check_motion(&self, name: &str, drive: &Actuator, faults: &mut Faults) {
        let Some(motion) = &drive.motion else { return };
        let key = format!("actuators.{name}.motion");
        if self.has_hydraulics() {
            let message = match self.hydraulic_drive() {
                Some((_, other, _)) => format!(
                    "actuators.{other} has a hydraulic circuit, which excludes a prescribed motion: remove the \
                     circuit, or remove this motion"
                ),
                None => "the hydraulic network excludes a prescribed motion: remove `hydraulics`, or remove this \
                    motion"
                    .into(),
            };
            faults.refuse(&key, message);
        }
        if let Some((_, other, _)) = self.motion_drive().filter(|(_, other, _)| *other != name) {
            let message = format_args!(
                "the drive {other} already has a prescribed motion, which moves the whole mechanism: remove one of the \
                 two motions"
            );
            faults.refuse(&key, message);
        }
        if self.start.equilibrium && motion.enabled {
            let message = "`start` cannot be `equilibrium` with a prescribed motion, because every position is then an \
                           equilibrium: give a position in `start`, or write \"enabled\": false in `motion`";
            faults.refuse(&key, message);
        }
        motion.check(&key, faults);
    }
}
