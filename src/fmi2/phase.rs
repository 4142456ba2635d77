//! Which function of FMI 2.0 may be called when: the state machine of FMI 2.0.5, 4.2.4, as one table.
//!
//! In: nothing. Out: one [`Function`] per exported function that takes an instance, but those of model exchange.

use crate::fmi::phase::{ALIVE, FAILED, Function, INITIALIZATION, INSTANTIATED, STEP, STEPPED};

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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::phase::Phase;

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
