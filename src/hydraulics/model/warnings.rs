//! Warnings of a step to its host, each once after the initialisation.
//!
//! In: the inputs and the state of a step. Out: one line of text. It must not change the state.
use crate::circuit::Point;
use crate::inputs::{Input, Inputs, clipping};
use crate::outputs::stable_step;
use crate::state::{Blind, Setting, State};
use foundation::codec::record::{Damaged, Record};
use foundation::numerics::decimal::Decimal;

/// Kinds of warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warning {
    /// The command is clipped.
    Clipped,
    /// The length contradicts the speed.
    Drift,
    /// The step is not the one that `preview.horizon` announced.
    Horizon,
    /// The step is longer than a coupling without preview stands.
    Unstable,
    /// Near a toggle no motion is foreseen.
    Toggle,
    /// No motion was found with the element.
    Unforeseen,
}

const KINDS: usize = 6;
/// Number of kinds, the first ones, that follow from the steps alone.
const BY_STEPS: usize = 3;
/// Difference of lengths that no coupling explains, beside the way of a step [m].
const DRIFT: f64 = 1e-3;

/// Warnings raised, each with two numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Warnings {
    raised: [bool; KINDS],
    pending: [bool; KINDS],
    numbers: [[f64; 2]; KINDS],
    /// Steps since the initialisation.
    steps: u64,
}

impl Warnings {
    /// Raise a warning, unless it was raised before.
    pub fn raise(&mut self, warning: Warning, numbers: [f64; 2]) {
        let index = warning as usize;
        if !self.raised[index] {
            (self.raised[index], self.pending[index], self.numbers[index]) = (true, true, numbers);
        }
    }

    /// What the steps have raised and when it is looked for, written or read. What depends on the outputs that a host
    /// has read is not part of it, and may be raised again.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.pending = [false; KINDS];
        self.raised[BY_STEPS..].fill(false);
        self.raised[..BY_STEPS].iter_mut().try_for_each(|raised| record.flag("warned before", raised))?;
        record.count("steps since the initialisation", &mut self.steps)
    }

    /// A step is made.
    pub fn count_step(&mut self) {
        self.steps += 1;
    }

    /// Whether any may still be raised by [`watch`].
    pub fn may_raise(&self) -> bool {
        !(self.raised[0] && self.raised[1] && self.raised[3])
    }

    /// Whether one is to be told.
    pub fn any(&self) -> bool {
        self.pending.contains(&true)
    }

    /// The line of those to be told.
    #[cold]
    pub fn take(&mut self) -> Option<String> {
        let kinds = [
            Warning::Clipped,
            Warning::Drift,
            Warning::Horizon,
            Warning::Unstable,
            Warning::Toggle,
            Warning::Unforeseen,
        ];
        let mut lines = Vec::new();
        for kind in kinds {
            let index = kind as usize;
            if std::mem::take(&mut self.pending[index]) {
                lines.push(text(kind, self.numbers[index]));
            }
        }
        (!lines.is_empty()).then(|| lines.join("; "))
    }
}

fn text(kind: Warning, numbers: [f64; 2]) -> String {
    let [one, two] = numbers.map(Decimal::rounded);
    match kind {
        Warning::Clipped => clipping(numbers[0]),
        Warning::Drift => format!(
            "actuator.length = {one} m, but the integral of actuator.speed is {two} m: connect both inputs to the same \
             drive, and with long steps also set the time derivatives of actuator.speed"
        ),
        Warning::Horizon => format!(
            "the size of the step is {two} s, but preview.horizon is {one} s: the motion was predicted again with the \
             size of this step; set preview.horizon to the size of the next step"
        ),
        Warning::Unstable => format!(
            "the outputs preview.* are not used, and the step of {two} s is longer than coupling.stable_step = {one} \
             s: the force grows from step to step; use a shorter step, or connect preview.force or preview.force_mean \
             to the mechanism"
        ),
        Warning::Toggle => format!(
            "actuator.reduced_mass = {one} kg changes by more than half within a step of {two} s, for example near a \
             dead centre of the actuator: no motion is predicted for this step; use shorter steps near this position"
        ),
        Warning::Unforeseen => format!(
            "no motion can be predicted with actuator.reduced_mass = {one} kg and actuator.holding_force = {two} N: \
             the output preview.force is the present force of the actuator; check the reduced mass and the holding \
             force"
        ),
    }
}

/// Raise why no motion is foreseen over a step of size h.
pub fn blind(warnings: &mut Warnings, blind: Blind, inputs: &Inputs, h: f64) {
    let mass = inputs.get(Input::Mass);
    match blind {
        Blind::NoMass => {}
        Blind::Toggle => warnings.raise(Warning::Toggle, [mass, h]),
        Blind::Failed => warnings.raise(Warning::Unforeseen, [mass, inputs.get(Input::Load)]),
    }
}

/// Raise what a step of size h gives reason for. `begin`: the point of the laws at its beginning; `previewed`: whether
/// the host uses the foreseen motion.
pub fn watch(
    warnings: &mut Warnings,
    setting: &Setting<'_>,
    (state, begin): (&State, &dyn Fn() -> Point<f64>),
    h: f64,
    previewed: bool,
) {
    let inputs = setting.inputs;
    if let Some(largest) = setting.command(state.time()).clipped(h) {
        warnings.raise(Warning::Clipped, [largest, 0.0]);
    }
    if let Some([arrival, way]) = state.arrival {
        let length = inputs.get(Input::Length);
        if (length - arrival).abs() > DRIFT + way {
            warnings.raise(Warning::Drift, [length, arrival]);
        }
    }
    let mass = inputs.get(Input::Mass);
    // The eigenvalues cost as much as the step.
    if !previewed && mass > 0.0 && warnings.steps.is_power_of_two() && !warnings.raised[Warning::Unstable as usize] {
        let stable = stable_step(setting.laws, &begin(), mass);
        if stable > 0.0 && h > stable {
            warnings.raise(Warning::Unstable, [stable, h]);
        }
    }
}
