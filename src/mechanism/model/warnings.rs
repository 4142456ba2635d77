//! Warnings of a step to its host, each once after the initialisation.
//!
//! In: the inputs and the state of a step, or the start. Out: one line of text, or warnings for `check`. It must not
//! change the state.
use super::{Formulation, Model};
use crate::codec::record::{Damaged, Record};
use crate::hydraulics::inputs::clipping;
use crate::hydraulics::network::laws::empty_words;
use crate::inspection::Finding;
use crate::mechanism::definition::{CouplingKind, Mechanism};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::ports::command;
use crate::mechanism::linkage::{Coupling, Kind};
use crate::mechanism::loads::resolved::NetworkDrives;
use crate::mechanism::motion::state::State;
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::warnings::{of_jump, of_near_misses, of_slack_belt};
use crate::numerics::decimal::Decimal;

/// A command of the valve that is clipped, of which a host is told once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clipped {
    /// Whether a step has met one.
    is_known: bool,
    /// The command, with the index of its input if it is one of a network, until it is told.
    pending: Option<(Option<usize>, f64)>,
}

impl Clipped {
    /// The command that a step of size h [s] from this state is to clip, with the index of its input if it is one of a
    /// network, unless one was met before; None without hydraulics.
    #[inline]
    pub fn look(
        &self,
        (reduced, state): (&Reduced, &Formulation),
        inputs: &Inputs,
        h: f64,
    ) -> Option<(Option<usize>, f64)> {
        if self.is_known {
            return None;
        }
        let loading = reduced.loading();
        if let Some(network) = &loading.network {
            return clipped_command(network, inputs, h).map(|(input, command)| (Some(input), command));
        }
        let drive = loading.hydraulics.as_ref()?;
        command(drive, inputs, state.along_curve().memory.circuit()?.time.now).clipped(h).map(|command| (None, command))
    }

    /// A step has clipped this command.
    #[cold]
    pub fn raise(&mut self, command: (Option<usize>, f64)) {
        *self = Self { is_known: true, pending: Some(command) };
    }

    /// Whether a step has met one, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        if record.reads() {
            self.pending = None;
        }
        record.flag("command clipped before", &mut self.is_known)
    }
}

/// The first command of a network that is beyond its limits at the beginning or at the end of a step of size h [s], by
/// the index of its input.
fn clipped_command(network: &NetworkDrives, inputs: &Inputs, h: f64) -> Option<(usize, f64)> {
    let layout = &network.laws.layout;
    (layout.command(0)..layout.open(0)).find_map(|index| {
        let input = network.first_input + index;
        let largest = inputs.size_at(input, h);
        (largest > 1.0).then_some((index, largest.copysign(inputs.reals[input])))
    })
}

/// Part of the natural size of a force of the mechanism below which a contact force is rounding.
const ROUNDING: f64 = 1e-9;

/// What is watched after each step, and of which a host is told once each: contacts that only pressure keeps closed, of
/// followers on cams without a groove and of belts, where one parts; accumulators, where one contains no oil.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    contacts: Vec<Contact>,
    accumulators: Option<Accumulators>,
    /// Whether a contact is left that has not parted, or no accumulator was empty.
    pub watches: bool,
}

/// The accumulators of the network.
#[derive(Clone, Copy, Debug, Default)]
struct Accumulators {
    /// Whether one was empty.
    was_empty: bool,
    /// The one that is empty, with its pressure and its precharge pressure [Pa], until the host is told.
    pending: Option<(usize, [f64; 2])>,
}

/// A contact that only pressure keeps closed.
#[derive(Clone, Copy, Debug)]
struct Contact {
    /// Joint of the coupling.
    joint: usize,
    has_parted: bool,
    /// Contact force or transmitted force [N] and time [s] at which it has parted, until the host is told.
    pending: Option<(f64, Option<f64>)>,
}

impl Watched {
    /// The cams of a mechanism that have no groove, and its belts.
    pub fn new(mechanism: &Mechanism, reduced: &Reduced) -> Self {
        let linkage = reduced.linkage();
        let can_part = |coupling: &&Coupling| match coupling.kind {
            Kind::Cam(_) => {
                let defined = mechanism.couplings.get(&linkage.joints[coupling.joint].name);
                defined.is_none_or(|cam| cam.grooved != Some(true))
            }
            Kind::Belt { .. } => true,
            _ => false,
        };
        let contact = |coupling: &Coupling| Contact { joint: coupling.joint, has_parted: false, pending: None };
        let contacts: Vec<_> = linkage.couplings.iter().filter(can_part).map(contact).collect();
        let has_accumulators = mechanism.hydraulics.as_ref().is_some_and(|network| !network.accumulators.is_empty());
        let accumulators = has_accumulators.then(Accumulators::default);
        let mut watched = Self { contacts, accumulators, watches: false };
        watched.restart();
        watched
    }

    fn update(&mut self) {
        let is_left = self.accumulators.is_some_and(|accumulators| !accumulators.was_empty);
        self.watches = is_left || self.contacts.iter().any(|contact| !contact.has_parted);
    }

    /// Nothing has been told.
    pub fn restart(&mut self) {
        self.contacts.iter_mut().for_each(|contact| (contact.has_parted, contact.pending) = (false, None));
        self.accumulators = self.accumulators.map(|_| Accumulators::default());
        self.update();
    }

    /// Become the same as another one of this mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.contacts.clone_from(&other.contacts);
        self.accumulators = other.accumulators;
        self.watches = other.watches;
    }

    /// Which contacts have parted and whether an accumulator was empty, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.length("contacts that part", self.contacts.len())?;
        self.contacts.iter_mut().try_for_each(|contact| {
            if record.reads() {
                contact.pending = None;
            }
            record.flag("parted before", &mut contact.has_parted)
        })?;
        if let Some(accumulators) = &mut self.accumulators {
            if record.reads() {
                accumulators.pending = None;
            }
            record.flag("accumulator empty before", &mut accumulators.was_empty)?;
        }
        self.update();
        Ok(())
    }

    /// Whether the warning has not been reported to the host yet.
    #[inline]
    fn is_pending(&self) -> bool {
        self.accumulators.is_some_and(|accumulators| accumulators.pending.is_some())
            || self.contacts.iter().any(|contact| contact.pending.is_some())
    }

    /// A contact that has parted, with its force [N] and time [s], of which the host is not told yet.
    fn take(&mut self) -> Option<(usize, f64, Option<f64>)> {
        self.contacts.iter_mut().find_map(|contact| {
            let (force, time) = contact.pending.take()?;
            Some((contact.joint, force, time))
        })
    }
}

/// Pretension of the belt of this joint [N]; None of another coupling.
fn pretension(mechanism: &Mechanism, reduced: &Reduced, joint: usize) -> Option<f64> {
    let defined = mechanism.couplings.get(&reduced.linkage().joints[joint].name)?;
    (defined.kind == CouplingKind::Belt).then_some(defined.pretension.unwrap_or(0.0))
}

impl Model {
    /// A warning that came up since the last call; None if there is none.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        if self.clipped.pending.is_some() || self.watched.is_pending() { self.find_warning() } else { None }
    }

    #[cold]
    #[inline(never)]
    fn find_warning(&mut self) -> Option<String> {
        let clipped = self.clipped.pending.take().map(|(input, command)| {
            let network = self.original.reduced.loading().network.as_ref();
            match input.zip(network).and_then(|(input, network)| network.inputs.get(input)) {
                Some(name) => {
                    let command = Decimal::rounded(command);
                    format!("{name} is {command}: the command was clipped to the range from -1 to 1")
                }
                None => clipping(command),
            }
        });
        let accumulators = self.watched.accumulators.as_mut();
        let empty = accumulators.and_then(|accumulators| accumulators.pending.take()).and_then(|(index, charge)| {
            let network = self.parameter_values.mechanism().hydraulics.as_ref()?;
            Some(empty_words(network.accumulators.names().get(index)?, charge))
        });
        clipped.into_iter().chain(empty).reduce(|one, other| [one, other].join("; ")).or_else(|| {
            let (joint, force, time) = self.watched.take()?;
            let when = time.map_or_else(String::new, |time| format!(" at t = {} s", Decimal::rounded(time)));
            let [message, remedy] = self.parted(joint, force, &when);
            Some(format!("{message}; {remedy}"))
        })
    }

    /// Look for a contact that parts in the present state, at the time `time` [s] of the host if it tells one. What has
    /// no value is not told.
    #[cold]
    #[inline(never)]
    pub(super) fn watch_contacts(&mut self, time: Option<f64>) {
        if self.watched.contacts.iter().all(|contact| contact.has_parted) {
            return;
        }
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else { return };
        let (rounding, mechanism) = (rounding(motion, reduced, &self.inputs), self.parameter_values.mechanism());
        for contact in self.watched.contacts.iter_mut().filter(|contact| !contact.has_parted) {
            let output = Output::Reaction { joint: contact.joint, part: ReactionPart::Moment };
            let Ok(force) = motion.output(reduced, &self.inputs, output) else { continue };
            let tension = pretension(mechanism, reduced, contact.joint);
            if tension.map_or(-force, |tension| 0.5 * force.abs() - tension) > rounding {
                (contact.has_parted, contact.pending) = (true, Some((force, time)));
            }
        }
        self.watched.update();
    }

    /// Look for an accumulator that contains no oil in the present state.
    pub(super) fn watch_accumulators(&mut self) {
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&self.state, &self.reduced) else { return };
        let network = reduced.loading().network.as_ref().zip(motion.state.memory.network_values());
        if let (Some(accumulators), Some((network, values))) = (&mut self.watched.accumulators, network)
            && !accumulators.was_empty
            && let Some(empty) = network.laws.empty_accumulator(values)
        {
            *accumulators = Accumulators { was_empty: true, pending: Some(empty) };
            self.watched.update();
        }
    }

    fn name_of_joint(&self, joint: usize) -> &str {
        &self.original.reduced.linkage().joints[joint].name
    }

    /// The words for a contact that parts under this contact force or transmitted force [N], and the remedy.
    #[cold]
    fn parted(&self, joint: usize, force: f64, when: &str) -> [String; 2] {
        match pretension(self.parameter_values.mechanism(), &self.original.reduced, joint) {
            Some(tension) => of_slack_belt(self.name_of_joint(joint), force, tension, when),
            None => lifting_words(self.name_of_joint(joint), force, when),
        }
    }

    /// Warnings about contacts that would part at the start: followers that lift off their cams, spans of belts that
    /// are slack. The model is left at its start; none if it has no start. What has no value is not told.
    pub fn warnings_at_start(&mut self) -> Vec<Finding> {
        let mut all = Vec::new();
        self.reset();
        if self.initialize().is_err() {
            return all;
        }
        self.watch_contacts(None);
        while let Some((joint, force, _)) = self.watched.take() {
            let [message, remedy] = self.parted(joint, force, " at the start");
            let is_belt = pretension(self.parameter_values.mechanism(), &self.original.reduced, joint).is_some();
            let key = if is_belt { ".pretension" } else { "" };
            let path = format!("couplings.{}{key}", self.name_of_joint(joint));
            all.push(Finding::warning(path, message, remedy));
        }
        all
    }
}

/// Size of a contact force that is rounding [N]: a part of the size of the loads along the curve, and of the kinetic
/// energy over the size of the mechanism.
fn rounding(motion: &mut ReducedMotion, reduced: &Reduced, inputs: &Inputs) -> f64 {
    let (scale, size, kinetic) = (reduced.scale(), reduced.linkage().size, motion.state.kinetic());
    let acceleration = motion.read(reduced, inputs, |view| view.forces().map(|forces| forces.free));
    ROUNDING * acceleration.map_or(0.0, |acceleration| (acceleration.abs() * scale + kinetic) / size)
}

/// What is told of a follower that lifts off with this contact force [N], and the remedy.
#[cold]
fn lifting_words(name: &str, force: f64, when: &str) -> [String; 2] {
    let message = format!(
        "{name}.contact_force is {} N{when}, below 0: the follower would lift off its cam; from this time on the \
         computation keeps follower and cam in contact",
        Decimal::rounded(force)
    );
    let remedy = format!(
        "use a stiffer or more compressed spring, a slower cam or a smoother law, or write couplings.{name} \
         \"grooved\": true for a cam that guides its follower in both directions"
    );
    [message, remedy]
}

/// Warnings for which the start is sought.
#[inline(never)]
pub(super) fn warnings_at_start(mechanism: &Mechanism, reduced: &Reduced, inputs: &Inputs) -> Vec<Finding> {
    let mut found = Vec::new();
    if !reduced.curve().near.misses.is_empty()
        && let Ok(state) = State::at_start(reduced, mechanism, inputs)
    {
        found.extend(of_near_misses(mechanism, reduced, &state.travel));
    }
    let jump = State::jump_at_start(reduced, mechanism, inputs);
    found.extend(jump.and_then(|jump| of_jump(mechanism, jump)));
    found
}
