//! The phases of an instance, and what a version's table of functions is made of.
//!
//! In: nothing. Out: [`Phase`], sets of phases as bits, and [`Function`]. Each version has a table of its functions;
//! the rules for single variables are in `access`.

/// Phase of an instance; each is one bit, so that a set of phases is a number. The numbers stand in serialised states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
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
    /// A fault inside this library; the instance can only be freed.
    Fatal = 32,
}

pub const INSTANTIATED: u8 = Phase::Instantiated as u8;
pub const INITIALIZATION: u8 = Phase::Initialization as u8;
pub const STEP: u8 = Phase::Step as u8;
pub const TERMINATED: u8 = Phase::Terminated as u8;
pub const FAILED: u8 = Phase::Failed as u8;
/// All phases but the last.
pub const ALIVE: u8 = INSTANTIATED | INITIALIZATION | STEP | TERMINATED | FAILED;
/// Phases in which values can be set.
pub const SETTABLE: u8 = INSTANTIATED | INITIALIZATION | STEP;
/// All phases after initialization.
pub const STEPPED: u8 = STEP | TERMINATED | FAILED;

const PHASES: [Phase; 6] =
    [Phase::Instantiated, Phase::Initialization, Phase::Step, Phase::Terminated, Phase::Failed, Phase::Fatal];

impl Phase {
    /// The phase of this number, if there is one that a state can be saved in.
    pub fn of_bit(bit: u8) -> Option<Self> {
        PHASES.into_iter().find(|phase| *phase as u8 == bit && *phase != Phase::Fatal)
    }

    /// Name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "instantiated",
            Phase::Initialization => "initialization mode",
            Phase::Step => "step mode",
            Phase::Terminated => "terminated",
            Phase::Failed => "step failed",
            Phase::Fatal => "fatal",
        }
    }
}

/// One exported function.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// Name as exported.
    pub name: &'static str,
    legal: u8,
}

impl Function {
    /// Function of this name, legal in this set of phases.
    pub const fn new(name: &'static str, legal: u8) -> Self {
        Function { name, legal }
    }

    /// Whether the function may be called in this phase.
    #[inline]
    pub fn is_legal_in(&self, phase: Phase) -> bool {
        self.legal & phase as u8 != 0
    }

    /// The legal phases, for messages.
    pub fn legal_phases(&self) -> String {
        let names: Vec<_> = PHASES.into_iter().filter(|p| self.is_legal_in(*p)).map(Phase::name).collect();
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_distinct_bits() {
        let union = PHASES.iter().fold(0, |bits, phase| bits | *phase as u8);
        assert_eq!(union.count_ones() as usize, PHASES.len());
    }
}
