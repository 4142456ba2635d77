//! Drives, with the laws by which their motion sizes a part of their force.
//!
//! In: a definition of a drive. Out: its law, with the names of the commands. It must not know the state.
use crate::mechanism::definition::{self, Actuator, ControlState, DefinitionError, MOST_CONTROL_STATES};
use crate::mechanism::loads::laws::control::{Acting, Control, Integral};
use crate::numerics::decimal::Decimal;
use crate::numerics::dual::Number;
use crate::numerics::monotone::monotone;
use crate::numerics::piecewise::Piecewise;
use std::ops::Range;

/// Efficiency of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Efficiency {
    /// Where power flows into the mechanism [1].
    pub forward: f64,
    /// Where power flows back [1].
    pub backward: f64,
}

impl Efficiency {
    /// The efficiency of a drive, if its definition states one. The loss of a screw that locks itself is friction.
    pub(super) fn of(drive: &Actuator) -> Option<Self> {
        if drive.locks_itself() {
            return None;
        }
        let (forward, backward) = (drive.efficiency, drive.backward_efficiency);
        let forward_or = forward.unwrap_or(1.0);
        forward.or(backward).map(|_| Self { forward: forward_or, backward: backward.unwrap_or(forward_or) })
    }
}

/// A drive of the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Name.
    pub name: String,
    /// Whether the drive turns a joint or a screw; else it moves along a line.
    pub is_rotary: bool,
    /// Efficiency [1], [CK16] eq. (5); None where the definition states none.
    pub efficiency: Option<Efficiency>,
    /// Law by which the motion of the drive sizes a part of its force.
    pub law: Option<DriveLaw>,
}

/// Law of a drive: a force that commands and the motion of the drive size is added to the force of its input.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveLaw {
    /// Index of the load that it sizes, which is like that of the drive. The input of the same index is the first
    /// command. The loads of the other commands, which follow, have the size 0.
    pub load: usize,
    /// What sizes the load.
    pub kind: DriveLawKind,
    /// Indices of the integral part and of the force among the states of all controllers; none without this state.
    pub states: [Option<usize>; 2],
}

/// What sizes the load of a drive's law.
#[derive(Clone, Debug, PartialEq)]
pub enum DriveLawKind {
    /// The command [1] times a force [N or N.m] over the speed of the drive [m/s or rad/s].
    Curve(Piecewise),
    /// A controller.
    Control(Control),
}

impl DriveLaw {
    /// The law of a drive whose first command is the input with this index; none without a curve and a controller.
    ///
    /// # Errors
    /// The limits of the force exclude each other.
    pub(super) fn new(name: &str, drive: &Actuator, load: usize) -> Result<Option<Self>, DefinitionError> {
        if let Some(curve) = drive.points.as_ref().and_then(|points| monotone(points)) {
            return Ok(Some(Self { load, kind: DriveLawKind::Curve(curve), states: [None; 2] }));
        }
        let Some(control) = drive.control else { return Ok(None) };
        let definition::Control { position_gain, speed_gain, min_force, max_force, .. } = control;
        if let (Some(least), Some(most)) = (min_force, max_force)
            && least >= most
        {
            let allowed = format!("greater than min_force = {}", Decimal(least));
            let key = format_args!("actuators.{name}.control.max_force");
            return Err(DefinitionError::value(key, Decimal(most), allowed));
        }
        let integral = integral_of(name, &control)?;
        let delay = control.force_time_constant;
        let change = delay.zip(control.max_force_rate).map(|(time, rate)| time * rate);
        let limits = [min_force, max_force, change.map(|most| -most), change];
        let control = Control { position_gain, speed_gain, integral, delay, limits };
        Ok(Some(Self { load, kind: DriveLawKind::Control(control), states: [None; 2] }))
    }

    /// Names of the inputs that are the commands of the law of a drive with this name.
    pub(super) fn inputs(&self, name: &str) -> impl Iterator<Item = String> {
        let is_speed = |index: usize| self.control().is_some_and(|c| index > 0 || c.position_gain.is_none());
        let word = move |index| if is_speed(index) { "command_speed" } else { "command" };
        (0..self.commands().len()).map(move |index| format!("{name}.{}", word(index)))
    }

    /// Indices of the inputs that are its commands, and of their loads.
    pub fn commands(&self) -> Range<usize> {
        let count = match &self.kind {
            DriveLawKind::Curve(_) => 1,
            DriveLawKind::Control(control) => control.commands(),
        };
        self.load..self.load + count
    }

    /// Size of the force at rest for each unit of a command.
    pub fn force_of_command(&self, input: usize) -> f64 {
        match &self.kind {
            DriveLawKind::Curve(force) => force.at(0.0)[0].abs(),
            DriveLawKind::Control(Control { position_gain: Some(gain), .. }) if input == self.load => *gain,
            DriveLawKind::Control(control) => control.speed_gain.unwrap_or(0.0),
        }
    }

    /// Curve of the force over the speed; none of a controller.
    pub fn curve(&self) -> Option<&Piecewise> {
        if let DriveLawKind::Curve(force) = &self.kind { Some(force) } else { None }
    }

    /// The controller; none of a curve.
    pub fn control(&self) -> Option<&Control> {
        if let DriveLawKind::Control(control) = &self.kind { Some(control) } else { None }
    }

    /// Force of the drive at rest before the limits, without its integral part, with the force `own` of its input [N or
    /// N.m], and two time derivatives of it: `input` are those of an input, x is the displacement of the drive [m or
    /// rad].
    pub fn at_rest(&self, own: [f64; 3], input: impl Fn(usize) -> [f64; 3], x: f64) -> [f64; 3] {
        std::array::from_fn(|order| {
            let (command, x) = (|k: usize| input(self.load + k)[order], if order == 0 { x } else { 0.0 });
            match &self.kind {
                DriveLawKind::Curve(force) => own[order] + command(0) * force.at(0.0)[0],
                DriveLawKind::Control(control) => control.demanded(own[order], command, [x, 0.0], 0.0),
            }
        })
    }

    /// F_u of a controller, with `own`, `command` and `motion` as for [`Self::force`] and its integral part.
    pub fn followed(&self, own: f64, command: impl Fn(usize) -> f64, motion: [f64; 2], states: &[f64]) -> Option<f64> {
        let integral = self.states[ControlState::Integral as usize].map(|k| states[k]);
        let command = |k| command(self.load + k);
        Some(self.control()?.acting(own, command, motion, Some([integral, None]), |_, margin| margin).force)
    }

    /// Force that it adds to the force `own` of the drive's input [N or N.m], with the rates of its states: `command`
    /// is the size of an input, `motion` the displacement and the speed of the drive, `states` are those of all
    /// controllers, `margin` is as in [`Control::acting`].
    #[inline]
    pub fn force<T: Number>(
        &self,
        own: T,
        command: impl Fn(usize) -> T,
        motion: [T; 2],
        states: Option<&[T; MOST_CONTROL_STATES]>,
        margin: impl FnMut(usize, f64) -> f64,
    ) -> Acting<T> {
        match &self.kind {
            DriveLawKind::Curve(force) => {
                let force = command(self.load) * motion[1].compose(force.at(motion[1].value()));
                Acting { force, rates: [T::constant(0.0); 2] }
            }
            DriveLawKind::Control(control) => {
                let states = states.map(|all| self.states.map(|state| state.map(|k| all[k])));
                let acting = control.acting(own, |k| command(self.load + k), motion, states, margin);
                Acting { force: acting.force - own, ..acting }
            }
        }
    }
}

/// The integral part of a controller; none without one.
///
/// # Errors
/// The default of its tracking time is 0.
fn integral_of(name: &str, control: &definition::Control) -> Result<Option<Integral>, DefinitionError> {
    let definition::Control { position_gain, integral_gain, tracking_time, .. } = *control;
    let Some(gain) = integral_gain else { return Ok(None) };
    let default = if gain == 0.0 { 0.0 } else { gain / position_gain.unwrap_or(0.0) };
    let is_limited = control.min_force.or(control.max_force).or(control.max_force_rate).is_some();
    let tracking = if is_limited { tracking_time.map_or(default, |time| 1.0 / time) } else { 0.0 };
    if tracking.is_finite() {
        return Ok(Some(Integral { gain, tracking }));
    }
    let message = "the default of this key, `position_gain` / `integral_gain`, is too small, because `position_gain` \
        is too small: give `tracking_time` or a larger `position_gain`, or remove the limits of the force and of its \
        rate";
    Err(DefinitionError::key(format_args!("actuators.{name}.control.tracking_time"), message.to_owned()))
}
