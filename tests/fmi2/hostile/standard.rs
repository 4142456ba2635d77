//! Legal phases of each function: the table of FMI 2.0.5, 4.2.4, written independently of `src/fmi2`.

/// Phases of the standard's state machine for an FMU without asynchronous steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// "instantiated".
    Instantiated,
    /// "initialization mode".
    Initialization,
    /// "stepComplete".
    Step,
    /// "error": `fmi2DoStep` has returned `fmi2Error`.
    Failed,
    /// "terminated".
    Terminated,
}

pub const PHASES: [Phase; 5] =
    [Phase::Instantiated, Phase::Initialization, Phase::Step, Phase::Failed, Phase::Terminated];

/// Functions that take an instance, with the phases of [`PHASES`] in which they may be called: `x` according to the
/// standard, `+` in addition to it, `.` never. The calls themselves contain the standard's footnotes about single
/// variables.
///
/// In addition to the standard, as hosts need it: inputs and parameters can be read while instantiated, and a failed
/// instance can be terminated and asked for its status. A function that the FMU does not support returns an error in
/// every phase.
pub const TABLE: &[(&str, &str)] = &[
    ("fmi2SetDebugLogging", "xxxxx"),
    ("fmi2SetupExperiment", "x...."),
    ("fmi2EnterInitializationMode", "x...."),
    ("fmi2ExitInitializationMode", ".x..."),
    ("fmi2Terminate", "..x+."),
    ("fmi2Reset", "xxxxx"),
    ("fmi2GetReal", "+xxxx"),
    ("fmi2GetInteger", "+xxxx"),
    ("fmi2GetBoolean", "+xxxx"),
    ("fmi2GetString", "+xxxx"),
    ("fmi2SetReal", "xxx.."),
    ("fmi2SetInteger", "xxx.."),
    ("fmi2SetBoolean", "xxx.."),
    ("fmi2SetString", "xxx.."),
    ("fmi2GetFMUstate", "xxxxx"),
    ("fmi2SetFMUstate", "xxxxx"),
    ("fmi2FreeFMUstate", "xxxxx"),
    ("fmi2SerializedFMUstateSize", "xxxxx"),
    ("fmi2SerializeFMUstate", "xxxxx"),
    ("fmi2DeSerializeFMUstate", "xxxxx"),
    ("fmi2GetDirectionalDerivative", ".xxxx"),
    ("fmi2SetRealInputDerivatives", "xxx.."),
    ("fmi2GetRealOutputDerivatives", ".+xxx"),
    ("fmi2DoStep", "..x.."),
    ("fmi2CancelStep", "....."),
    ("fmi2GetStatus", "..x+x"),
    ("fmi2GetRealStatus", "..x+x"),
    ("fmi2GetIntegerStatus", "..x+x"),
    ("fmi2GetBooleanStatus", "..x+x"),
    ("fmi2GetStringStatus", "..x+x"),
    // Functions of model exchange: an instance for co-simulation rejects them.
    ("fmi2EnterEventMode", "....."),
    ("fmi2NewDiscreteStates", "....."),
    ("fmi2EnterContinuousTimeMode", "....."),
    ("fmi2CompletedIntegratorStep", "....."),
    ("fmi2SetTime", "....."),
    ("fmi2SetContinuousStates", "....."),
    ("fmi2GetDerivatives", "....."),
    ("fmi2GetEventIndicators", "....."),
    ("fmi2GetContinuousStates", "....."),
    ("fmi2GetNominalsOfContinuousStates", "....."),
];

/// Functions without an instance, and `fmi2FreeInstance`: always legal.
pub const ALWAYS: [&str; 4] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];

/// Whether a function may be called in a phase.
pub fn is_legal(function: &str, phase: Phase) -> bool {
    let (_, row) = TABLE.iter().find(|(name, _)| *name == function).unwrap();
    row.as_bytes()[phase as usize] != b'.'
}

#[test]
fn the_standard_has_44_functions() {
    assert_eq!(TABLE.len() + ALWAYS.len(), 44);
    assert!(TABLE.iter().all(|(_, row)| row.len() == PHASES.len()));
}
