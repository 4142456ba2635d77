//! Why a hydraulic model refuses a call, or cannot make a step.
use foundation::codec::record::Damaged;
use foundation::format::DefinitionError;
use foundation::numerics::decimal::Decimal;
use std::fmt;

/// A refused call, or a step that could not be made. The text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum HydraulicsError {
    /// The definition, or the present parameters, are out of range.
    Definition(DefinitionError),
    /// No variable of this kind has this reference.
    Reference { reference: u32, kind: &'static str, own: Option<(String, &'static str)>, count: usize },
    /// An output cannot be set.
    Output { name: String },
    /// A value out of range.
    Value { name: String, value: f64, allowed: String },
    /// A text that is none of the allowed words.
    Text { name: String, value: String, allowed: String },
    /// A derivative that does not exist.
    Derivative { what: String, reason: String },
    /// A step of this size is none.
    StepSize { h: f64 },
    /// No step before the initialisation.
    NotInitialised,
    /// The actuator is shorter or longer than the cylinder allows.
    Travel { length: f64, lengths: [f64; 2] },
    /// The speed of the actuator [m/s] leads within a step to a length that the cylinder does not have.
    Overrun { speed: f64, length: f64, lengths: [f64; 2] },
    /// The absolute pressure of a chamber has come to 0, `time` [s] after the beginning of the step.
    Vacuum { chamber: &'static str, time: f64 },
    /// No step of the integration meets the tolerance, `time` [s] after the beginning of the step; `what`: the state
    /// there, in words.
    Stuck { time: f64, what: String },
    /// An energy of the circuit is beyond the largest number, `time` [s] after the beginning of the step.
    Overflow { time: f64 },
    /// The step met `solver.max_steps`, `time` [s] after its beginning.
    Interrupted { time: f64, why: String },
    /// A saved state that cannot be read.
    Damaged(Damaged),
}

impl HydraulicsError {
    /// Whether a step began that could not be made; else it was refused before it began.
    pub fn ends_step(&self) -> bool {
        matches!(self, Self::Vacuum { .. } | Self::Stuck { .. } | Self::Overflow { .. })
    }
}

impl From<DefinitionError> for HydraulicsError {
    fn from(error: DefinitionError) -> Self {
        Self::Definition(error)
    }
}

impl From<Damaged> for HydraulicsError {
    fn from(error: Damaged) -> Self {
        Self::Damaged(error)
    }
}

impl std::error::Error for HydraulicsError {}

impl fmt::Display for HydraulicsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definition(error) => error.fmt(f),
            Self::Reference { reference, kind, own: Some((name, own)), .. } => {
                write!(f, "value reference {reference} is the variable {name} of the type {own}, not {kind}")
            }
            Self::Reference { reference, kind, own: None, count } => {
                write!(
                    f,
                    "value reference {reference} is not a {kind} variable; there are {count} variables, numbered from \
                     0"
                )
            }
            Self::Output { name } => write!(f, "{name} is an output and cannot be set: set an input or a parameter"),
            Self::Value { name, value, allowed } => write!(f, "{name} = {}: must be {allowed}", Decimal(*value)),
            Self::Text { name, value, allowed } => write!(f, "{name} = \"{value}\": must be {allowed}"),
            Self::Derivative { what, reason } => write!(f, "{what}: {reason}"),
            Self::StepSize { h } => write!(f, "step size {} s: must be finite and greater than 0", Decimal(*h)),
            Self::NotInitialised => {
                f.write_str("doStep was called before the initialisation; initialise the FMU first")
            }
            Self::Travel { length, lengths: [least, most] } => write!(
                f,
                "actuator.length = {} m: the cylinder allows {} m (cylinder.closed_length) to {} m \
                 (cylinder.closed_length + cylinder.stroke); connect actuator.reduced_mass and preview.force_mean, so \
                 that the actuator can stop the motion at the end of the cylinder, or use a longer stroke",
                Decimal::rounded(*length),
                Decimal::rounded(*least),
                Decimal::rounded(*most)
            ),
            Self::Overrun { speed, length, lengths: [least, most] } => write!(
                f,
                "actuator.speed = {} m/s, with its derivatives, gives actuator.length = {} m within the step: the \
                 cylinder allows {} m (cylinder.closed_length) to {} m (cylinder.closed_length + cylinder.stroke); \
                 check the speed and its derivatives, or use a shorter step",
                Decimal::rounded(*speed),
                Decimal::rounded(*length),
                Decimal::rounded(*least),
                Decimal::rounded(*most)
            ),
            Self::Vacuum { chamber, time } => write!(
                f,
                "{} s after the start of the step, the absolute pressure of {chamber} fell to 0: oil without air has \
                 no absolute pressure below 0; set fluid.air_fraction above 0, or increase anticavitation.conductance",
                Decimal::rounded(*time)
            ),
            Self::Stuck { time, what } => write!(
                f,
                "the integration stopped {} s after the start of the step, because no integration step reaches \
                 solver.tolerance; at this time {what}; check the inputs, or increase solver.tolerance",
                Decimal::rounded(*time)
            ),
            Self::Overflow { time } => write!(
                f,
                "an energy of the circuit exceeds the largest number, 1.8e308 J, {} s after the start of the step: \
                 check the values of pressures, flows, conductances and friction",
                Decimal::rounded(*time)
            ),
            Self::Interrupted { why, .. } => f.write_str(why),
            Self::Damaged(Damaged(reason)) => write!(f, "the saved state does not belong to this model: {reason}"),
        }
    }
}
