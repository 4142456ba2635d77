//! Control of a drive: gains, start values of the commands, limits of the force.
use super::Mechanism;
use super::loads::Actuator;
use crate::format::{Faults, Range, Role, either, keys, number};
use crate::variables::Unit::{
    Metre, MetrePerSecond, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetrePerRadianSecond,
    NewtonMetreSecondPerRadian, NewtonPerMetre, NewtonPerMetreSecond, NewtonSecondPerMetre, Radian, RadianPerSecond,
    Second,
};

/// Most drives whose controller has an integral part.
pub const MOST_INTEGRALS: usize = 5;
/// Most states of a mechanism without hydraulics: sigma, sigma_dot and integral parts.
pub const MOST_STATES: usize = 2 + MOST_INTEGRALS;

keys! {
    /// The object `control` describes a controller of a drive. The force of the drive is force + position_gain *
    /// (command - x) + speed_gain * (command_speed - dx/dt) + integral part, limited to the range from min_force to
    /// max_force. Here x is the length, position or angle of the drive, and force is the input `<name>.force` or
    /// `<name>.torque`. The controller is continuous and has no sampling time.
    pub struct Control: Copy {
        /// Position gain [N/m or N.m/rad], >= 0. The input `<name>.command` is the commanded length, position or angle
        /// of the drive.
        position_gain: Option<f64> => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Law, "Position gain");
        /// Speed gain [N.s/m or N.m.s/rad], >= 0. The input `<name>.command_speed` is the commanded speed of the drive.
        speed_gain: Option<f64> => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Law, "Speed gain");
        /// Integral gain [N/(m.s) or N.m/(rad.s)], >= 0. The integral part of the force changes at the rate
        /// integral_gain * (command - x). The key `integral_gain` is allowed only together with `position_gain`.
        integral_gain: Option<f64> => either([NewtonPerMetreSecond, NewtonMetrePerRadianSecond], Range::NonNegative)
            .parameter(Role::Law, "Integral gain").brief();
        /// Time constant with which the integral part follows the force while the force is at a limit (anti-windup by
        /// back-calculation) [s], > 0. Default: position_gain / integral_gain.
        tracking_time: Option<f64> => number(Second, Range::Positive)
            .parameter(Role::Law, "Tracking time of the integral part").brief();
        /// Integral part of the force at the start [N or N.m].
        start_integral: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::CircuitStart, "Integral part of the force at the start").absent("0").brief();
        /// Start value of the input `<name>.command` [m or rad]. The key `command` is allowed only together with
        /// `position_gain`.
        command: Option<f64> => either([Metre, Radian], Range::Finite).absent("0");
        /// Start value of the input `<name>.command_speed` [m/s or rad/s]. The key `command_speed` is allowed only
        /// together with `speed_gain`.
        command_speed: Option<f64> => either([MetrePerSecond, RadianPerSecond], Range::Finite).absent("0");
        /// Smallest force or torque of the drive [N or N.m]. Without the key `min_force` the force has no lower limit.
        min_force: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::Law, "Smallest force or torque");
        /// Largest force or torque of the drive [N or N.m]. Without the key `max_force` the force has no upper limit.
        max_force: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::Law, "Largest force or torque");
    }
}

/// Faults of the control of a drive, if it has one.
pub(super) fn check_control(key: &str, drive: &Actuator, faults: &mut Faults) {
    let Some(control) = &drive.control else { return };
    let key = format!("{key}.control");
    let mut refuse = |key: String, message: String| faults.refuse(key, message);
    for (name, is_given, what) in [
        ("points", drive.points.is_some(), "a force-speed curve"),
        ("hydraulics", drive.hydraulics.is_some(), "a hydraulic circuit"),
        ("motion", drive.motion.is_some(), "a prescribed motion"),
    ] {
        if is_given {
            refuse(key.clone(), format!("a drive with a controller cannot have {what}: remove control or {name}"));
        }
    }
    let Control { position_gain, speed_gain, integral_gain, command, command_speed, .. } = *control;
    if position_gain.or(speed_gain).is_none() {
        refuse(key.clone(), "a controller needs a gain: add position_gain or speed_gain".into());
    }
    for (name, gain, is_alone) in [
        ("command", "position_gain", command.is_some() && position_gain.is_none()),
        ("command_speed", "speed_gain", command_speed.is_some() && speed_gain.is_none()),
        ("integral_gain", "position_gain", integral_gain.is_some() && position_gain.is_none()),
        ("tracking_time", "integral_gain", control.tracking_time.is_some() && integral_gain.is_none()),
        ("start_integral", "integral_gain", control.start_integral.is_some() && integral_gain.is_none()),
    ] {
        if is_alone {
            let what = if name.starts_with("command") { "command" } else { "key" };
            refuse(format!("{key}.{name}"), format!("this {what} needs a gain: add {gain}, or remove {name}"));
        }
    }
}

impl Mechanism {
    /// Drives whose controller has an integral part, with their names.
    pub fn integrating_drives(&self) -> impl Iterator<Item = (&str, &Control)> {
        let drives = self.actuators.iter().filter_map(|(name, drive)| Some((name, drive.control.as_ref()?)));
        drives.filter(|(_, control)| control.integral_gain.is_some())
    }

    /// Faults of the integral part of the controller of a drive with this name, together with other elements.
    pub(super) fn check_integral(&self, name: &str, faults: &mut Faults) {
        let Some(index) = self.integrating_drives().position(|(other, _)| other == name) else { return };
        let mut refuse = |message: String| {
            faults.refuse(format!("actuators.{name}.control.integral_gain"), message);
        };
        if index >= MOST_INTEGRALS {
            refuse(format!(
                "at most {MOST_INTEGRALS} drives of a mechanism can have an integral part: remove integral_gain"
            ));
        }
        if self.has_hydraulics() {
            refuse("hydraulics exclude an integral part of a controller: remove integral_gain or hydraulics".into());
        }
        if let Some((_, other, _)) = self.motion_drive() {
            refuse(format!(
                "the drive {other} has a prescribed motion, which excludes an integral part of a controller: remove \
                 integral_gain or actuators.{other}.motion"
            ));
        }
        if self.start.equilibrium {
            refuse(format!(
                "`start` cannot be `equilibrium` with an integral part, which is in balance only at the command: give \
                 a start position in `start`, and the force that holds the mechanism there in start_integral (`cargo \
                 fmu check` prints the holding force of {name}), or remove integral_gain"
            ));
        }
    }
}
