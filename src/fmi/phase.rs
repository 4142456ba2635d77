//! The phases of an instance, and which function may be called in which phase (FMI 2.0.5, 4.2.4). Each version has a
//! table of its functions.

/// Phase of an instance. Each phase is one bit, so that a set of phases is a number. Serialised states contain the
/// position of the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Phase {
    /// After instantiation or a reset.
    Instantiated = 1,
    /// Between entering and leaving initialization mode.
    Initialization = 2,
    /// Between two steps.
    Step = 4,
    /// After the end of the simulation.
    Terminated = 8,
    /// A step could not be computed; the state is that of the last communication point.
    Failed = 16,
    /// After a fault inside this library. The instance and its states can only be freed.
    Fatal = 32,
    /// A step reached `solver.max_steps`. The state is that at the time reached.
    Interrupted = 64,
    /// Between two steps: an event is handled, or inputs jump.
    Event = 128,
    /// Co-simulation within a step, while the host's callback reads values.
    Intermediate = 256,
    /// Model exchange between two events: the host's solver integrates.
    Continuous = 512,
}

pub const INSTANTIATED: u16 = Phase::Instantiated as u16;
pub const INITIALIZATION: u16 = Phase::Initialization as u16;
pub const STEP: u16 = Phase::Step as u16;
pub const EVENT: u16 = Phase::Event as u16;
pub const INTERMEDIATE: u16 = Phase::Intermediate as u16;
pub const CONTINUOUS: u16 = Phase::Continuous as u16;
pub const TERMINATED: u16 = Phase::Terminated as u16;
/// Phases after a step that did not reach its end.
pub const FAILED: u16 = Phase::Failed as u16 | Phase::Interrupted as u16;
pub const FATAL: u16 = Phase::Fatal as u16;
/// All phases except [`Phase::Fatal`] and [`Phase::Intermediate`].
pub const ALIVE: u16 = INSTANTIATED | INITIALIZATION | STEP | EVENT | CONTINUOUS | TERMINATED | FAILED;
/// Phases in which values can be set.
pub const SETTABLE: u16 = INSTANTIATED | INITIALIZATION | STEP | EVENT | CONTINUOUS;
/// Phases in which the host's solver can read states and derivatives.
pub const SOLVABLE: u16 = INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | FAILED;
/// All phases after initialization except event mode.
pub const STEPPED: u16 = STEP | TERMINATED | FAILED;

/// Each phase with its name in messages, in the order of the bits.
const PHASES: [(Phase, &str); 10] = [
    (Phase::Instantiated, "instantiated"),
    (Phase::Initialization, "initialization mode"),
    (Phase::Step, "step mode"),
    (Phase::Terminated, "terminated"),
    (Phase::Failed, "step failed"),
    (Phase::Fatal, "fatal"),
    (Phase::Interrupted, "step interrupted"),
    (Phase::Event, "event mode"),
    (Phase::Intermediate, "intermediate update mode"),
    (Phase::Continuous, "continuous-time mode"),
];

impl Phase {
    /// Position of the bit, for serialised states.
    pub fn place(self) -> u8 {
        (self as u16).trailing_zeros() as u8
    }

    /// The phase with the bit at this position, if a state can be saved in this phase.
    pub fn at(place: u8) -> Option<Self> {
        let can_be_saved = |phase: &Phase| !matches!(phase, Phase::Fatal | Phase::Intermediate);
        PHASES.get(usize::from(place)).map(|(phase, _)| *phase).filter(can_be_saved)
    }

    /// Whether initialization mode has not ended yet.
    pub fn precedes_steps(self) -> bool {
        matches!(self, Self::Instantiated | Self::Initialization)
    }

    /// Name in messages.
    pub fn name(self) -> &'static str {
        PHASES[usize::from(self.place())].1
    }
}

/// One exported function.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// Name as exported.
    pub name: &'static str,
    legal: u16,
}

impl Function {
    /// Function of this name, legal in this set of phases.
    pub const fn new(name: &'static str, legal: u16) -> Self {
        Function { name, legal }
    }

    /// Whether the function may be called in this phase.
    #[inline]
    pub fn is_legal_in(&self, phase: Phase) -> bool {
        self.legal & phase as u16 != 0
    }

    /// The legal phases, for messages.
    pub fn legal_phases(&self) -> String {
        let names: Vec<_> =
            PHASES.iter().filter(|(phase, _)| self.is_legal_in(*phase)).map(|(_, name)| *name).collect();
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_phase_is_the_bit_of_its_index() {
        assert!(PHASES.iter().enumerate().all(|(i, (phase, _))| *phase as u16 == 1 << i));
    }
}
