//! Legal phases of each function: the table of FMI 2.0.5, 4.2.4, written independently of `src/fmi2`.

/// Phases of the standard's state machine that an FMU without asynchronous steps can be in.
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

/// Functions that take an instance, with the phases of [`PHASES`] in which they may be called: `x` by the standard, `+`
/// beyond it, `.` never. The standard's footnotes about single variables are in the calls themselves.
///
/// Beyond the standard, as hosts do it: inputs and parameters are read while instantiated, a failed instance may be
/// terminated and asked for its status; a function that is never served is refused for that reason in every phase.
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
    // Model exchange: never, by an instance that is for co-simulation.
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

/// Functions without an instance, and the end of one: legal always.
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
