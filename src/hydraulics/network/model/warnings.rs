//! What a step tells its host without refusing it, each once after the initialisation.
//!
//! In: the inputs and the state of a step. Out: one line of text. It must not change the state.
use super::Parameters;
use crate::network::laws::empty_words;
use crate::network::layout::{Input, Part};
use crate::network::state::{Foreseen, Setting, State, Toggle};
use foundation::codec::record::{Damaged, Record};
use foundation::numerics::decimal::Decimal;

/// Kinds of warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Warning {
    /// A command is clipped.
    Clipped,
    /// The step is not the one that `preview.horizon` announced.
    Horizon,
    /// An accumulator has no oil left.
    Empty,
    /// Near a toggle no motion is foreseen.
    Toggle,
}

/// Number of kinds.
const KINDS: usize = 4;
/// Number of kinds, the first ones, that follow from the steps alone.
const BY_STEPS: usize = 3;

/// Warnings raised, each with an index of what it is about and two numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Warnings {
    raised: [bool; KINDS],
    pending: [bool; KINDS],
    about: [(usize, [f64; 2]); KINDS],
}

impl Warnings {
    fn raise(&mut self, warning: Warning, index: usize, numbers: [f64; 2]) {
        let kind = warning as usize;
        if !self.raised[kind] {
            (self.raised[kind], self.pending[kind], self.about[kind]) = (true, true, (index, numbers));
        }
    }

    /// What the steps have raised, written or read. What depends on the outputs that a host has read is not part of it.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.pending = [false; KINDS];
        self.raised[BY_STEPS..].fill(false);
        self.raised[..BY_STEPS].iter_mut().try_for_each(|raised| record.flag("warned before", raised))
    }

    /// Whether one is to be told.
    pub fn any(&self) -> bool {
        self.pending.contains(&true)
    }

    /// Raise what a foreseen motion gives reason for.
    pub fn foreseen(&mut self, setting: &Setting<'_>, foreseen: &Foreseen) {
        if let Some(Toggle(cylinder)) = foreseen.toggle {
            self.raise(Warning::Toggle, cylinder, [setting.get(cylinder, Part::Mass), foreseen.h]);
        }
    }

    /// Raise that a step of size h was announced as another one.
    pub fn horizon(&mut self, said: f64, h: f64) {
        self.raise(Warning::Horizon, 0, [said, h]);
    }

    /// Raise what a step of size h from this state gives reason for.
    pub fn watch(&mut self, setting: &Setting<'_>, state: &State, h: f64) {
        let layout = &setting.laws.layout;
        if !self.raised[Warning::Clipped as usize] {
            for index in layout.command(0)..layout.open(0) {
                let path = setting.inputs.polynomial(index);
                let largest = [0.0, 0.5, 1.0]
                    .map(|part| path.at(part * h))
                    .into_iter()
                    .fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
                if let (true, Input::Command(valve)) = (largest.abs() > 1.0, layout.input(index)) {
                    self.raise(Warning::Clipped, valve, [largest, 0.0]);
                }
            }
        }
        if let (false, Some((accumulator, charge))) =
            (self.raised[Warning::Empty as usize], setting.laws.empty_accumulator(&state.y))
        {
            self.raise(Warning::Empty, accumulator, charge);
        }
    }

    /// The line of those to be told.
    #[cold]
    pub fn take(&mut self, parameters: &Parameters) -> Option<String> {
        let mut lines = Vec::new();
        for kind in [Warning::Clipped, Warning::Horizon, Warning::Empty, Warning::Toggle] {
            let own = kind as usize;
            if std::mem::take(&mut self.pending[own]) {
                lines.push(text(parameters, kind, self.about[own]));
            }
        }
        (!lines.is_empty()).then(|| lines.join("; "))
    }
}

fn text(parameters: &Parameters, kind: Warning, (index, numbers): (usize, [f64; 2])) -> String {
    let [one, two] = numbers.map(Decimal::rounded);
    let system = &parameters.definition;
    let name = |names: Vec<&str>| names.get(index).copied().unwrap_or_default().to_owned();
    match kind {
        Warning::Clipped => {
            format!(
                "{}.command is {one}: the command was clipped to the range from -1 to 1",
                name(system.valves.names())
            )
        }
        Warning::Horizon => format!(
            "the size of the step is {two} s, but preview.horizon is {one} s: the motion was predicted again with the \
             size of this step; set preview.horizon to the size of the next step, or to 0 if all steps are equal"
        ),
        Warning::Empty => empty_words(&name(system.accumulators.names()), numbers),
        Warning::Toggle => format!(
            "{}.reduced_mass = {one} kg changes by more than half within a step of {two} s, for example near a dead \
             centre of the cylinder: no motion is predicted for this step, and the inputs length and speed prescribe \
             the motion of the cylinder; use shorter steps near this position",
            name(system.cylinders.names())
        ),
    }
}
