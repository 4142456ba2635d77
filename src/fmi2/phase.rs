//! Which function may be called when: the state machine of FMI 2.0.5, 4.2.4, as one table.
//!
//! In: nothing. Out: [`Phase`] and one [`Function`] per exported function that takes an instance, with its name for
//! messages and the phases in which it is legal. The rules for single variables are in `access`.

/// Phase of an instance; each is one bit, so that a set of phases is a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated = 1,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization = 2,
    /// Between two steps.
    Step = 4,
    /// After `fmi2Terminate`.
    Terminated = 8,
    /// A step could not be computed; the state is that of the last communication point.
    Failed = 16,
    /// A fault inside this library; only `fmi2FreeInstance` is left.
    Fatal = 32,
}

const INSTANTIATED: u8 = Phase::Instantiated as u8;
const INITIALIZATION: u8 = Phase::Initialization as u8;
const STEP: u8 = Phase::Step as u8;
const TERMINATED: u8 = Phase::Terminated as u8;
const FAILED: u8 = Phase::Failed as u8;
const ALIVE: u8 = INSTANTIATED | INITIALIZATION | STEP | TERMINATED | FAILED;
const STEPPED: u8 = STEP | TERMINATED | FAILED;

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
    const fn new(name: &'static str, legal: u8) -> Self {
        Function { name, legal }
    }

    /// Whether the function may be called in this phase.
    pub fn is_legal_in(&self, phase: Phase) -> bool {
        self.legal & phase as u8 != 0
    }

    /// The legal phases, for messages.
    pub fn legal_phases(&self) -> String {
        let names: Vec<_> = PHASES.into_iter().filter(|p| self.is_legal_in(*p)).map(Phase::name).collect();
        names.join(", ")
    }
}

macro_rules! functions {
    ($($constant:ident = $name:literal: $legal:expr;)*) => {
        $(pub const $constant: Function = Function::new($name, $legal);)*
        #[cfg(test)]
        const ALL: &[Function] = &[$($constant),*];
    };
}

functions! {
    SET_DEBUG_LOGGING = "fmi2SetDebugLogging": ALIVE;
    SETUP_EXPERIMENT = "fmi2SetupExperiment": INSTANTIATED;
    ENTER_INITIALIZATION_MODE = "fmi2EnterInitializationMode": INSTANTIATED;
    EXIT_INITIALIZATION_MODE = "fmi2ExitInitializationMode": INITIALIZATION;
    TERMINATE = "fmi2Terminate": STEP | FAILED;
    RESET = "fmi2Reset": ALIVE;

    GET_REAL = "fmi2GetReal": ALIVE;
    GET_INTEGER = "fmi2GetInteger": ALIVE;
    GET_BOOLEAN = "fmi2GetBoolean": ALIVE;
    GET_STRING = "fmi2GetString": ALIVE;
    SET_REAL = "fmi2SetReal": INSTANTIATED | INITIALIZATION | STEP;
    SET_INTEGER = "fmi2SetInteger": INSTANTIATED | INITIALIZATION | STEP;
    SET_BOOLEAN = "fmi2SetBoolean": INSTANTIATED | INITIALIZATION | STEP;
    SET_STRING = "fmi2SetString": INSTANTIATED | INITIALIZATION | STEP;

    DO_STEP = "fmi2DoStep": STEP;
    CANCEL_STEP = "fmi2CancelStep": ALIVE;
    GET_STATUS = "fmi2GetStatus": STEPPED;
    GET_REAL_STATUS = "fmi2GetRealStatus": STEPPED;
    GET_INTEGER_STATUS = "fmi2GetIntegerStatus": STEPPED;
    GET_BOOLEAN_STATUS = "fmi2GetBooleanStatus": STEPPED;
    GET_STRING_STATUS = "fmi2GetStringStatus": STEPPED;
    SET_REAL_INPUT_DERIVATIVES = "fmi2SetRealInputDerivatives": INSTANTIATED | INITIALIZATION | STEP;
    GET_REAL_OUTPUT_DERIVATIVES = "fmi2GetRealOutputDerivatives": INITIALIZATION | STEPPED;

    GET_FMU_STATE = "fmi2GetFMUstate": ALIVE;
    SET_FMU_STATE = "fmi2SetFMUstate": ALIVE;
    FREE_FMU_STATE = "fmi2FreeFMUstate": ALIVE;
    SERIALIZED_FMU_STATE_SIZE = "fmi2SerializedFMUstateSize": ALIVE;
    SERIALIZE_FMU_STATE = "fmi2SerializeFMUstate": ALIVE;
    DE_SERIALIZE_FMU_STATE = "fmi2DeSerializeFMUstate": ALIVE;
    GET_DIRECTIONAL_DERIVATIVE = "fmi2GetDirectionalDerivative": INITIALIZATION | STEPPED;

    ENTER_EVENT_MODE = "fmi2EnterEventMode": ALIVE;
    NEW_DISCRETE_STATES = "fmi2NewDiscreteStates": ALIVE;
    ENTER_CONTINUOUS_TIME_MODE = "fmi2EnterContinuousTimeMode": ALIVE;
    COMPLETED_INTEGRATOR_STEP = "fmi2CompletedIntegratorStep": ALIVE;
    SET_TIME = "fmi2SetTime": ALIVE;
    SET_CONTINUOUS_STATES = "fmi2SetContinuousStates": ALIVE;
    GET_DERIVATIVES = "fmi2GetDerivatives": ALIVE;
    GET_EVENT_INDICATORS = "fmi2GetEventIndicators": ALIVE;
    GET_CONTINUOUS_STATES = "fmi2GetContinuousStates": ALIVE;
    GET_NOMINALS_OF_CONTINUOUS_STATES = "fmi2GetNominalsOfContinuousStates": ALIVE;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_distinct_bits() {
        let union = PHASES.iter().fold(0, |bits, phase| bits | *phase as u8);
        assert_eq!(union.count_ones() as usize, PHASES.len());
    }

    #[test]
    fn nothing_is_legal_after_a_fatal_fault() {
        assert!(ALL.iter().all(|function| !function.is_legal_in(Phase::Fatal)));
    }

    #[test]
    fn the_table_follows_the_standard() {
        assert_eq!(DO_STEP.legal_phases(), "step mode");
        assert_eq!(SETUP_EXPERIMENT.legal_phases(), "instantiated");
        assert_eq!(EXIT_INITIALIZATION_MODE.legal_phases(), "initialization mode");
        assert_eq!(TERMINATE.legal_phases(), "step mode, step failed");
        for setter in [SET_REAL, SET_INTEGER, SET_BOOLEAN, SET_STRING] {
            assert!(!setter.is_legal_in(Phase::Terminated));
            assert!(!setter.is_legal_in(Phase::Failed));
        }
    }
}
