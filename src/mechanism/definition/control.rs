//! Control of a drive: gains, start values of the commands, limits of the force.
use super::loads::Actuator;
use super::refusal::refused;
use crate::format::{Faults, Range, Role, either, keys};
use crate::variables::Unit::{
    Metre, MetrePerSecond, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetreSecondPerRadian, NewtonPerMetre,
    NewtonSecondPerMetre, Radian, RadianPerSecond,
};

keys! {
    /// The object `control` describes a controller of a drive. The force of the drive is force + position_gain *
    /// (command - x) + speed_gain * (command_speed - dx/dt), limited to the range from min_force to max_force. Here x
    /// is the length, position or angle of the drive, and force is the input `<name>.force` or `<name>.torque`. The
    /// control law is part of the equation of motion, so the controller is continuous and has no sampling time.
    pub struct Control: Copy {
        /// Position gain [N/m or N.m/rad], >= 0. The input `<name>.command` is the commanded length, position or angle
        /// of the drive.
        position_gain: Option<f64> => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Law, "Position gain");
        /// Speed gain [N.s/m or N.m.s/rad], >= 0. The input `<name>.command_speed` is the commanded speed of the drive.
        speed_gain: Option<f64> => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Law, "Speed gain");
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
    let mut refuse = |key: String, message: String| faults.keep::<()>(refused(key, message));
    for (name, is_given, what) in [
        ("points", drive.points.is_some(), "a force-speed curve"),
        ("hydraulics", drive.hydraulics.is_some(), "a hydraulic circuit"),
        ("motion", drive.motion.is_some(), "a prescribed motion"),
    ] {
        if is_given {
            refuse(key.clone(), format!("a drive with a controller cannot have {what}: remove control or {name}"));
        }
    }
    let Control { position_gain, speed_gain, command, command_speed, .. } = *control;
    if position_gain.or(speed_gain).is_none() {
        refuse(key.clone(), "a controller needs a gain: add position_gain or speed_gain".into());
    }
    for (name, gain, is_alone) in [
        ("command", "position_gain", command.is_some() && position_gain.is_none()),
        ("command_speed", "speed_gain", command_speed.is_some() && speed_gain.is_none()),
    ] {
        if is_alone {
            refuse(format!("{key}.{name}"), format!("this command needs a gain: add {gain}, or remove {name}"));
        }
    }
}
