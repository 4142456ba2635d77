//! What a step tells its host without refusing it, once after the initialisation.
//!
//! In: the inputs and the state of a step, or the start. Out: one line of text, or warnings for `check`. It must not change
//! the state.
use super::{Formulation, Model};
use crate::codec::record::{Damaged, Record};
use crate::hydraulics::inputs::clipping;
use crate::inspection::Finding;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::hydraulic::command;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::linkage::{Coupling, Kind};
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::warnings::of_slack_belt;
use crate::numerics::decimal::Decimal;

/// A command of the valve that is clipped, of which a host is told once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clipped {
    /// Whether a step has met one.
    is_known: bool,
    /// The command, until it is told.
    pending: Option<f64>,
}

impl Clipped {
    /// The command that a step of size h [s] from this state is to clip, unless one was met before; None without a
    /// circuit.
    #[inline]
    pub fn look(&self, (reduced, state): (&Reduced, &Formulation), inputs: &Inputs, h: f64) -> Option<f64> {
        let drive = reduced.loading().hydraulics.as_ref().filter(|_| !self.is_known)?;
        command(drive, inputs, state.along_curve().memory.circuit()?.time.now).clipped(h)
    }

    /// A step has clipped this command.
    #[cold]
    pub fn raise(&mut self, command: f64) {
        *self = Self { is_known: true, pending: Some(command) };
    }

    /// Whether a step has met one, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.pending = None;
        record.flag("command clipped before", &mut self.is_known)
    }
}

/// Part of the natural size of a force of the mechanism below which a contact force is rounding.
const ROUNDING: f64 = 1e-9;

/// Followers that nothing but their load presses on their cams, of which a host is told once each where one lifts off.
#[derive(Clone, Debug, Default)]
pub struct LiftOff {
    /// Joints of the couplings of these cams, and whether their followers have been told to lift off.
    cams: Vec<(usize, bool)>,
    /// Whether a cam is left whose follower has not been told to lift off.
    pub watches: bool,
    /// Joint, contact force [N] and time [s] of the follower that is to be told next.
    pending: Option<(usize, f64, Option<f64>)>,
}

impl LiftOff {
    /// The cams of a mechanism that have no groove.
    pub fn new(mechanism: &Mechanism, reduced: &Reduced) -> Self {
        let linkage = reduced.linkage();
        let is_open = |joint: usize| {
            mechanism.couplings.get(&linkage.joints[joint].name).is_none_or(|cam| cam.grooved != Some(true))
        };
        let cams = linkage.couplings.iter().filter(|coupling| matches!(coupling.kind, Kind::Cam(_)));
        let cams: Vec<_> = cams.map(|coupling| (coupling.joint, false)).filter(|(joint, _)| is_open(*joint)).collect();
        Self { watches: !cams.is_empty(), cams, pending: None }
    }

    /// Nothing has been told.
    pub fn restart(&mut self) {
        self.cams.iter_mut().for_each(|(_, is_told)| *is_told = false);
        (self.watches, self.pending) = (!self.cams.is_empty(), None);
    }

    /// Become the same as another one of this mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.cams.clone_from(&other.cams);
        (self.watches, self.pending) = (other.watches, other.pending);
    }

    /// Which followers have been told to lift off, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.length("followers", self.cams.len())?;
        self.cams.iter_mut().try_for_each(|(_, is_told)| record.flag("lifted off before", is_told))?;
        (self.watches, self.pending) = (self.cams.iter().any(|(_, is_told)| !is_told), None);
        Ok(())
    }
}

impl Model {
    /// A warning that came up since the last call; None if there is none.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        let clipped = self.clipped.pending.take().map(clipping);
        clipped.or_else(|| self.lift_off.pending.take().map(|lifted| self.lifting(lifted)))
    }

    /// Look for a follower that lifts off in the present state, at the time `time` [s] of the host if it tells one. What
    /// has no value is not told.
    #[cold]
    #[inline(never)]
    pub(super) fn look_for_lift_off(&mut self, time: Option<f64>) {
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else { return };
        let lift_off = &mut self.lift_off;
        if lift_off.pending.is_some() {
            return;
        }
        let rounding = rounding(motion, reduced, &self.inputs);
        for (joint, is_told) in lift_off.cams.iter_mut().filter(|(_, is_told)| !is_told) {
            let output = Output::Reaction { joint: *joint, part: ReactionPart::Moment };
            let Ok(force) = motion.output(reduced, &self.inputs, output) else { continue };
            if force < -rounding {
                *is_told = true;
                lift_off.pending = Some((*joint, force, time));
                break;
            }
        }
        lift_off.watches = lift_off.cams.iter().any(|(_, is_told)| !is_told);
    }

    /// The words for a follower that lifts off.
    #[cold]
    fn lifting(&self, (joint, force, time): (usize, f64, Option<f64>)) -> String {
        let when = time.map_or_else(String::new, |time| format!(" at t = {} s", Decimal::rounded(time)));
        let name = self.original.reduced.linkage().joints[joint].name.as_str();
        let [message, remedy] = lifting_words(name, force, &when);
        format!("{message}; {remedy}")
    }

    /// Warnings about contacts that would part at the start: followers that lift off their cams, spans of belts that are
    /// slack. The model is left at its start; none if it has no start. What has no value is not told.
    pub fn warnings_at_start(&mut self) -> Vec<Finding> {
        let mut all = Vec::new();
        self.reset();
        if self.initialize().is_err() {
            return all;
        }
        self.look_for_lift_off(None);
        while let Some((joint, force, _)) = self.lift_off.pending.take() {
            let name = self.original.reduced.linkage().joints[joint].name.as_str();
            let [message, remedy] = lifting_words(name, force, " at the start");
            all.push(Finding::warning(format_args!("couplings.{name}"), message, remedy));
            self.look_for_lift_off(None);
        }
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else { return all };
        let belts = |coupling: &&Coupling| matches!(coupling.kind, Kind::Belt { .. });
        for joint in reduced.linkage().couplings.iter().filter(belts).map(|coupling| coupling.joint) {
            let name = reduced.linkage().joints[joint].name.as_str();
            let defined = self.original.parameter_values.mechanism().couplings.get(name);
            let pretension = defined.and_then(|belt| belt.pretension).unwrap_or(0.0);
            let output = Output::Reaction { joint, part: ReactionPart::Moment };
            let Ok(transmitted) = motion.output(reduced, &self.inputs, output) else { continue };
            if 0.5 * transmitted.abs() - pretension > rounding(motion, reduced, &self.inputs) {
                all.push(of_slack_belt(name, transmitted, pretension));
            }
        }
        all
    }
}

/// Size of a contact force that is rounding [N]: a part of the size of the loads along the curve, and of the kinetic energy
/// over the size of the mechanism.
fn rounding(motion: &mut ReducedMotion, reduced: &Reduced, inputs: &Inputs) -> f64 {
    let (scale, size, kinetic) = (reduced.scale(), reduced.linkage().size, motion.state.kinetic());
    let acceleration = motion.read(reduced, inputs, |view| view.forces()).map(|forces| forces.free);
    ROUNDING * acceleration.map_or(0.0, |acceleration| (acceleration.abs() * scale + kinetic) / size)
}

/// What is told of a follower that lifts off with this contact force [N], and the remedy.
#[cold]
fn lifting_words(name: &str, force: f64, when: &str) -> [String; 2] {
    let message = format!(
        "{name}.contact_force is {} N{when}, below 0: the follower would lift off its cam, but is held to it from here on",
        Decimal::rounded(force)
    );
    let remedy = format!(
        "press it on by a stiffer or more compressed spring, make the cam slower or its law smoother, or give \
         couplings.{name} \"grooved\": true for a cam that holds its follower in both directions"
    );
    [message, remedy]
}
