//! Control of a drive: gains, start values of the commands, limits of the force.
use super::Mechanism;
use crate::format::{Faults, Range, Role, either, keys, number};
use crate::variables::Unit::{
    Metre, MetrePerSecond, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetrePerRadianSecond, NewtonMetrePerSecond,
    NewtonMetreSecondPerRadian, NewtonPerMetre, NewtonPerMetreSecond, NewtonPerSecond, NewtonSecondPerMetre, Radian,
    RadianPerSecond, Second,
};

/// Most states of the controllers of a mechanism.
pub const MOST_CONTROL_STATES: usize = 5;
/// Most states of a mechanism without hydraulics: sigma, sigma_dot and the states of controllers.
pub const MOST_STATES: usize = 2 + MOST_CONTROL_STATES;

/// A state of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlState {
    /// The integral part of the force.
    Integral,
    /// The force, which follows that of the controller with a delay.
    Force,
}

keys! {
    /// The object `control` describes a controller of a drive. The force of the drive is force + position_gain *
    /// (command - x) + speed_gain * (command_speed - dx/dt) + integral part, limited to the range from min_force to
    /// max_force. In the formula of the controller, x is the length, position or angle of the drive, and force is the
    /// input `<name>.force` or `<name>.torque`. The controller of a drive is continuous and has no sampling time.
    pub struct Control: Copy {
        /// Position gain of the controller [N/m or N.m/rad], >= 0. The input `<name>.command` is the commanded length,
        /// position or angle of the drive.
        position_gain: Option<f64> => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Law, "Position gain of the controller");
        /// Speed gain of the controller [N.s/m or N.m.s/rad], >= 0. The input `<name>.command_speed` is the commanded
        /// speed of the drive.
        speed_gain: Option<f64> => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Law, "Speed gain of the controller");
        /// Integral gain of the controller [N/(m.s) or N.m/(rad.s)], >= 0. The integral part of the drive force changes
        /// at the rate integral_gain * (command - x), where x is the length, position or angle of the drive. The key
        /// `integral_gain` is allowed only together with `position_gain`.
        integral_gain: Option<f64> => either([NewtonPerMetreSecond, NewtonMetrePerRadianSecond], Range::NonNegative)
            .parameter(Role::Law, "Integral gain of the controller").brief();
        /// Time constant with which the integral part follows the drive force while the drive force is at a limit
        /// (anti-windup by back-calculation) [s], > 0. Default: position_gain / integral_gain.
        tracking_time: Option<f64> => number(Second, Range::Positive)
            .parameter(Role::Law, "Tracking time of the integral part in the controller").brief();
        /// Integral part of the drive force at the start of the run [N or N.m].
        start_integral: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::CircuitStart, "Integral part of the force of @ at the start of the \
                run").absent("0").brief();
        /// Time constant T with which the force F of the drive follows the force F_controller of the controller [s], >
        /// 0: dF/dt = (F_controller - F) / T. For an electric motor, `force_time_constant` is the time constant of the
        /// current control. Without the key `force_time_constant` the force of the drive follows the force of the
        /// controller without delay.
        force_time_constant: Option<f64> => number(Second, Range::Positive)
            .parameter(Role::Law, "Time constant of the force").brief();
        /// Largest size of the time derivative dF/dt of the drive force F [N/s or N.m/s], > 0. The key `max_force_rate`
        /// is allowed only together with `force_time_constant`.
        max_force_rate: Option<f64> => either([NewtonPerSecond, NewtonMetrePerSecond], Range::Positive)
            .parameter(Role::Law, "Largest rate of change of the force").brief();
        /// Force of the drive at the start of the run [N or N.m]. Default: the force of the controller at the start of
        /// the run. The key `start_force` is allowed only together with `force_time_constant`.
        start_force: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::CircuitStart, "Force of @ at the start of the run").brief();
        /// Start value of the input `<name>.command` [m or rad]. The key `command` is allowed only together with
        /// `position_gain`.
        command: Option<f64> => either([Metre, Radian], Range::Finite).absent("0");
        /// Start value of the input `<name>.command_speed` [m/s or rad/s]. The key `command_speed` is allowed only
        /// together with `speed_gain`.
        command_speed: Option<f64> => either([MetrePerSecond, RadianPerSecond], Range::Finite).absent("0");
        /// Smallest force or torque of the drive [N or N.m]. Without the key `min_force` the force of the drive has no
        /// lower limit.
        min_force: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::Law, "Smallest force or torque");
        /// Largest force or torque of the drive [N or N.m]. Without the key `max_force` the force of the drive has no
        /// upper limit.
        max_force: Option<f64> => either([Newton, NewtonMetre], Range::Finite)
            .parameter(Role::Law, "Largest force or torque");
    }
}

/// Faults of the control of a drive, which has a force-speed curve, a hydraulic circuit or a prescribed motion or not.
pub(super) fn check_control(
    key: &str,
    control: &Control,
    [points, hydraulics, motion]: [bool; 3],
    faults: &mut Faults,
) {
    let key = format!("{key}.control");
    let mut refuse = |key: String, message: String| faults.refuse(key, message);
    for (name, is_given, what) in [
        ("points", points, "a force-speed curve"),
        ("hydraulics", hydraulics, "a hydraulic circuit"),
        ("motion", motion, "a prescribed motion"),
    ] {
        if is_given {
            refuse(key.clone(), format!("a drive with a controller cannot have {what}: remove `control` or `{name}`"));
        }
    }
    let Control { position_gain, speed_gain, integral_gain, command, command_speed, .. } = *control;
    if position_gain.or(speed_gain).is_none() {
        refuse(key.clone(), "a controller needs a gain: add `position_gain` or `speed_gain`".into());
    }
    let (no_position, no_speed) = (position_gain.is_none(), speed_gain.is_none());
    let (no_integral, no_delay) = (integral_gain.is_none(), control.force_time_constant.is_none());
    for (name, value, needed, is_alone) in [
        ("command", command, "position_gain", no_position),
        ("command_speed", command_speed, "speed_gain", no_speed),
        ("integral_gain", integral_gain, "position_gain", no_position),
        ("tracking_time", control.tracking_time, "integral_gain", no_integral),
        ("start_integral", control.start_integral, "integral_gain", no_integral),
        ("max_force_rate", control.max_force_rate, "force_time_constant", no_delay),
        ("start_force", control.start_force, "force_time_constant", no_delay),
    ] {
        if value.is_some() && is_alone {
            let what = if name.starts_with("command") { "command" } else { "key" };
            let kind = if needed.ends_with("gain") { "gain" } else { "time constant" };
            refuse(format!("{key}.{name}"), format!("this {what} needs a {kind}: add `{needed}`, or remove `{name}`"));
        }
    }
}

impl Control {
    /// Its states, each with its key, in the order in which the states of a mechanism are counted.
    pub fn states(&self) -> impl Iterator<Item = (ControlState, &'static str)> + use<> {
        let integral = self.integral_gain.map(|_| (ControlState::Integral, "integral_gain"));
        let force = self.force_time_constant.map(|_| (ControlState::Force, "force_time_constant"));
        integral.into_iter().chain(force)
    }
}

impl Mechanism {
    /// The states of all controllers, with the names and the controllers of their drives.
    pub fn control_states(&self) -> impl Iterator<Item = (&str, &Control, ControlState)> {
        let controls = self.actuators.iter().filter_map(|(name, drive)| Some((name, drive.control.as_ref()?)));
        controls.flat_map(|(name, control)| control.states().map(move |(state, _)| (name, control, state)))
    }

    /// Whether inputs decide the force of a drive at the start.
    pub fn has_forces_by_inputs(&self) -> bool {
        self.control_states().any(|(_, control, state)| state == ControlState::Force && control.start_force.is_none())
    }

    /// Faults of the states of the controller of a drive with this name, together with other elements.
    pub(super) fn check_control_states(&self, name: &str, faults: &mut Faults) {
        let before = self.control_states().take_while(|(other, ..)| *other != name).count();
        let states = self.actuators.get(name).and_then(|drive| drive.control.as_ref()).map(Control::states);
        for (index, (state, key)) in (before..).zip(states.into_iter().flatten()) {
            let mut refuse = |message: String| {
                faults.refuse(format!("actuators.{name}.control.{key}"), message);
            };
            if index >= MOST_CONTROL_STATES {
                refuse(format!(
                    "the controllers of a mechanism can have at most {MOST_CONTROL_STATES} of the keys \
                     `integral_gain` and `force_time_constant`: remove `{key}`"
                ));
            }
            if self.has_hydraulics() {
                refuse(format!(
                    "a mechanism with the key `hydraulics` cannot have the key `{key}`: remove `{key}` or \
                     `hydraulics`"
                ));
            }
            if let Some((_, other, _)) = self.motion_drive() {
                refuse(format!(
                    "the drive {other} has a prescribed motion, which excludes the key `{key}`: remove `{key}` or \
                     actuators.{other}.motion"
                ));
            }
            if self.start.equilibrium && state == ControlState::Integral {
                refuse(format!(
                    "`start` cannot be `equilibrium` with an integral part, because the integral part is constant \
                     only at the command: give a start position in `start`, and the force that holds the mechanism \
                     there in `start_integral` (`cargo fmu check` prints the holding force of {name}), or remove \
                     `integral_gain`"
                ));
            }
        }
    }
}
