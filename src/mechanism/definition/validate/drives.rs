//! Checks of the control and of the prescribed motion of a drive, together with other elements.
use crate::format::Faults;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::definition::loads::Actuator;

impl Mechanism {
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
