//! Errors of a model.
use crate::codec::record::Damaged;
use crate::integrator::IntegrationError;
use crate::mechanism::definition::{DefinitionError, Fault, listed};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::resolved::NO_HYDRAULICS;
use crate::mechanism::reduced::{End, Reduced, ReductionError, if_degrees};
use crate::mechanism::rigid_fem::RigidFemError;
use crate::numerics::decimal::Decimal;
use crate::numerics::table::Unresolved;
use crate::variables::Reference;
use std::fmt;

/// A refused call, which leaves the model unchanged. The text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum ModelError {
    /// The file is not a definition.
    Definition(DefinitionError),
    /// The present parameters give no reduced model or no start.
    Reduction(ReductionError),
    /// No variable of this kind has this reference; `own`: name and kind of the variable that has it, `count`: number
    /// of variables.
    Reference { reference: Reference, own: Option<(String, &'static str)>, kind: &'static str, count: usize },
    /// A value out of the range that `allowed` states.
    Value { name: String, value: f64, allowed: String },
    /// A text other than the allowed words.
    Text { name: String, value: String, allowed: String },
    /// The rigid finite elements refused the mechanism or a step.
    RigidFem(RigidFemError),
    /// A feature of the reduced model that the rigid finite elements do not have: a variable, its value, and the remedy
    /// other than the choice of the reduced model.
    NotInRigidFem { name: String, value: String, remedy: String },
    /// A stop was reached in the formulation with rigid finite elements, which has no stops: its quantity, the value at
    /// the stop, and the time from the beginning of the step [s].
    StopPassed { name: String, value: f64, time: f64 },
    /// A derivative that cannot be read or set, with reason and remedy.
    Derivative { what: String, reason: String },
    /// A parameter was to be set that follows from others: its expression, and the names of those that decide it.
    Calculated { name: String, text: String, names: Vec<String> },
    /// Parameters whose values make that of an expression one that it must not have.
    Follows { set: Vec<(String, f64)>, fault: Box<Fault> },
    /// An output was to be set.
    Output { name: String },
    /// An output is not smooth along the motion, near this position of the linkage.
    Table { name: String, position: String },
    /// What a step ends with is beyond the largest number.
    Overflow { name: String },
    /// A step before initialisation.
    NotInitialised,
    /// Integral parts of controllers in a library without their code.
    NoHydraulics,
    /// A step size [s] that is not finite and positive.
    StepSize { h: f64 },
    /// The integration stopped.
    Integration(IntegrationError),
    /// The integration of a mechanism with a hydraulic circuit stopped; `circuit`: the pressures there, in words.
    Stuck { error: IntegrationError, circuit: String },
    /// Friction and reactions have no common solution; `joint`: where most of the friction is.
    Locked { position: String, joint: String },
    /// The start is beyond a stop: its quantity, the values at the stop and at the start.
    BeyondStop { name: String, value: f64, start: f64 },
    /// The mechanism has no stable equilibrium to start at: the position near which it was sought, reason and remedy.
    NoEquilibrium { near: String, reason: String, remedy: &'static str },
    /// More bumpers are enabled than a mechanism may have.
    TooManyBumpers { count: usize, limit: usize },
    /// The point of a lock stands still at the position of the stop, so that no force there holds the mechanism.
    LockStill { name: String, stop: String, position: String },
    /// A record that is no snapshot of this mechanism, with its fault.
    Saved { what: String },
    /// The motion goes past the end of its travel, with what is the matter there and the remedy.
    Travel { position: String, reason: String },
    /// The cylinder of a drive does not have this length [m] at the start: its name, least and largest length.
    Stroke { name: String, length: f64, lengths: [f64; 2] },
    /// The absolute pressure of a chamber has come to 0.
    Vacuum { chamber: &'static str },
    /// A prescribed motion that the mechanism cannot make: the quantity of its drive, the value asked for, the time
    /// from the beginning of the step [s], and why not, with limit and remedy.
    Prescribed { name: String, value: f64, time: f64, why: String },
    /// Forces were to move a mechanism without masses: its moving bodies.
    Massless { bodies: String },
    /// An input so large that its load or its work overflows: its name and largest size in the step.
    LoadOverflow { name: String, value: f64 },
    /// A step met `solver.max_steps`: the time from its beginning to the state reached [s], and what took so many
    /// steps. The model is in that state.
    Interrupted { time: f64, why: String },
}

/// Unit of an angle, a length or a position by its name.
pub fn unit_of(name: &str) -> &'static str {
    if name.ends_with(".angle") { "rad" } else { "m" }
}

impl ModelError {
    /// Whether a step gave this error after it had begun: the model is in the state before the step, but its
    /// integration starts anew. Any other error, [`Self::Interrupted`] apart, refuses a step before it begins.
    pub fn ends_step(&self) -> bool {
        match self {
            Self::Integration(_) | Self::Locked { .. } | Self::Travel { .. } | Self::StopPassed { .. } => true,
            Self::Prescribed { .. }
            | Self::Overflow { .. }
            | Self::Stroke { .. }
            | Self::Vacuum { .. }
            | Self::Stuck { .. } => true,
            Self::RigidFem(error) => matches!(error, RigidFemError::Equilibrium { .. } | RigidFemError::Strain { .. }),
            _ => false,
        }
    }

    /// [`Self::Massless`] of this linkage.
    #[cold]
    pub fn massless(linkage: &Linkage) -> Self {
        let names: Vec<&str> = linkage.bodies.iter().skip(1).map(|body| &*body.name).collect();
        Self::Massless { bodies: listed(&names) }
    }

    /// [`Self::Travel`] at a sigma beyond the end of this stretch.
    #[cold]
    pub fn travel((stretch, end): (&Reduced, End), sigma: f64) -> Self {
        let reason = match end {
            End::OfTravel => "reduce the loads, or end the run earlier".into(),
            End::OfNumbers => format!(
                "at {:.0e} m from the guess ({:.0e} times the size of the largest body), the rounding errors of \
                 positions are larger than the mechanism; reduce the loads, end the run earlier, or add a stop",
                stretch.curve().farthest * stretch.linkage().size,
                stretch.curve().farthest
            ),
            End::Failed(error @ ReductionError::EndsMeet { .. }) => error.to_string(),
            End::Failed(error) => {
                format!("{error}; or reduce the loads, end the run earlier, or add a stop before this position")
            }
        };
        Self::Travel { position: stretch.curve().describe(sigma, 0.0), reason }
    }

    /// [`Self::Table`] at a point of the curve after so many whole revolutions.
    pub fn table(reduced: &Reduced, name: &str, at: &Unresolved, revolutions: f64) -> Self {
        Self::Table { name: name.into(), position: reduced.curve().describe(at.sigma, revolutions) }
    }
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definition(e) => e.fmt(f),
            Self::Reduction(e) => e.fmt(f),
            Self::Reference { reference, own: Some((name, own)), kind, .. } => {
                write!(
                    f,
                    "{name} (value reference {reference}) is a {own} variable, not a {kind} variable: call the \
                     function for {own} variables"
                )
            }
            Self::Reference { reference, kind, count, .. } => write!(
                f,
                "value reference {reference} is not a {kind} variable: references run from 0 to {}; \
                 modelDescription.xml states the type of each variable",
                count.saturating_sub(1)
            ),
            Self::Value { name, value, allowed } => write!(f, "{name} = {}: must be {allowed}", Decimal(*value)),
            Self::Text { name, value, allowed } => write!(f, "{name} = \"{value}\": must be {allowed}"),
            Self::RigidFem(RigidFemError::Substeps { count, limit }) => write!(
                f,
                "the communication step needs {count:e} internal steps of solver.fem_step, but solver.max_steps \
                 allows {limit:e}: use shorter communication steps, or increase solver.fem_step or solver.max_steps"
            ),
            Self::RigidFem(e) => write!(f, "solver.method = \"rigid_fem\": {e}"),
            Self::NotInRigidFem { name, value, remedy } if value.is_empty() => write!(
                f,
                "{name}: solver.method = \"rigid_fem\" does not support this key; {remedy}, or choose solver.method = \
                 \"reduced\""
            ),
            Self::NotInRigidFem { name, value, remedy } => write!(
                f,
                "{name} = {value}: solver.method = \"rigid_fem\" does not support this value; {remedy}, or choose \
                 solver.method = \"reduced\""
            ),
            Self::StopPassed { name, value, time } => write!(
                f,
                "{name} = {} {}: the mechanism reaches this stop {} s after the start of the step, but solver.method \
                 = \"rigid_fem\" has no stops; end the run earlier, set `enabled` of the stop to false, or choose \
                 solver.method = \"reduced\"",
                Decimal(*value),
                unit_of(name),
                Decimal(*time)
            ),
            Self::Derivative { what, reason } => write!(f, "{what}: {reason}"),
            Self::Calculated { name, text, names } => {
                let remedy = match names.as_slice() {
                    [] => "change this number in the definition file".to_owned(),
                    names => format!("set {}", names.join(" or ")),
                };
                write!(f, "{name} is calculated from \"{text}\" and cannot be set: {remedy}")
            }
            Self::Follows { set, fault } => {
                let set: Vec<String> =
                    set.iter().map(|(name, value)| format!("{name} = {}", Decimal(*value))).collect();
                let Fault { name, text, value, allowed, because } = &**fault;
                write!(
                    f,
                    "{}: {name} = \"{text}\" would become {}, but must be {allowed}{because}; set other values, or \
                     set values that belong together in one call",
                    set.join(", "),
                    Decimal(*value)
                )
            }
            Self::Output { name } => write!(f, "{name} is an output and cannot be set: set an input or a parameter"),
            Self::Table { name, position } => write!(
                f,
                "{name} has no value near {position}: as a function of the position of the mechanism, {name} is \
                 not smooth there (for example a kink or a jump); change the lengths, or do not read this variable"
            ),
            Self::Overflow { name } => write!(
                f,
                "{name} is larger than the largest number, 1.8e308, with the present inputs and parameters: check the \
                    values of the inputs and parameters"
            ),
            Self::NotInitialised => {
                f.write_str("doStep was called before the initialisation: initialise the instance first")
            }
            Self::NoHydraulics => f.write_str(NO_HYDRAULICS),
            Self::StepSize { h } => write!(f, "step size h = {} s: must be finite and > 0", Decimal(*h)),
            Self::Integration(IntegrationError::StepTooSmall { t, step }) => write!(
                f,
                "the integration stopped {} s after the start of the communication step: no integration step longer \
                 than {step:.1e} s is accurate to solver.tolerance; check the values of the inputs",
                Decimal(*t)
            ),
            Self::Locked { position, joint } => write!(
                f,
                "friction locks the mechanism near {position}, mainly in {joint}: the joint forces cause more friction \
                 than any load can overcome; reduce the coefficients or pin radii, or add a stop before this position"
            ),
            Self::BeyondStop { name, value, start } => write!(
                f,
                "stops.{name} = {} {unit}: the start, at {} {unit}, is beyond this stop; move the start or the stop, \
                 or set `enabled` of the stop to false{}",
                Decimal::rounded(*value),
                Decimal::rounded(*start),
                if name.ends_with(".angle") { if_degrees(*start) } else { String::new() },
                unit = unit_of(name)
            ),
            Self::NoEquilibrium { near, reason, remedy } => {
                write!(f, "start.equilibrium: there is no stable equilibrium in reach of {near}: {reason}; {remedy}")
            }
            Self::TooManyBumpers { count, limit } => write!(
                f,
                "stops: {count} bumpers are enabled, but at most {limit} are allowed; for some bumpers, set \
                 `enabled` to false or `rigid` to true"
            ),
            Self::LockStill { name, stop, position } => write!(
                f,
                "locks.{name}.at: this point does not move at the position of {stop}, near {position}, so the lock \
                 cannot hold the mechanism: use a point that moves at the stop"
            ),
            Self::Saved { what } => write!(
                f,
                "the saved state does not belong to this mechanism: {what}; restore a state that was saved with this \
                 mechanism"
            ),
            Self::Stroke { name, length, lengths: [least, most] } => write!(
                f,
                "{name} = {} m at the start: the cylinder allows {} m (cylinder.closed_length) to {} m \
                 (cylinder.closed_length + cylinder.stroke); use another closed length or stroke, or another start",
                Decimal::rounded(*length),
                Decimal::rounded(*least),
                Decimal::rounded(*most)
            ),
            Self::Vacuum { chamber } => write!(
                f,
                "the absolute pressure of {chamber} fell to 0: oil without air has no pressure below 0; set \
                 fluid.air_fraction above 0, or increase anticavitation.conductance"
            ),
            Self::Stuck { error: IntegrationError::StepTooSmall { t, step }, circuit } => write!(
                f,
                "the integration stopped {} s after the start of the communication step: no integration step longer \
                 than {step:.1e} s is accurate to solver.tolerance, at {circuit}; check the values of the inputs",
                Decimal(*t)
            ),
            Self::LoadOverflow { name, value } => write!(
                f,
                "{name} = {}: with inputs of this magnitude, a load or the work of a load exceeds the largest number, \
                 {:.1e}; set a smaller value",
                Decimal(*value),
                f64::MAX
            ),
            Self::Prescribed { name, value, time, why } => {
                write!(f, "{name} = {} {} is prescribed", Decimal::rounded(*value), unit_of(name))?;
                if *time > 0.0 {
                    write!(f, " {} s after the start of the step", Decimal::rounded(*time))?;
                }
                write!(f, ": {why}")
            }
            Self::Massless { bodies } => write!(
                f,
                "no body has a mass, so forces cannot move the mechanism: give a mass to one of {bodies}, or \
                 prescribe the motion of a drive (key `motion` in `actuators`)"
            ),
            Self::Interrupted { why, .. } => f.write_str(why),
            Self::Travel { position, reason } => {
                write!(f, "the mechanism moved past the end of its travel at {position}: {reason}")
            }
        }
    }
}

impl std::error::Error for ModelError {}

impl From<ReductionError> for ModelError {
    fn from(e: ReductionError) -> Self {
        Self::Reduction(e)
    }
}

impl From<RigidFemError> for ModelError {
    fn from(e: RigidFemError) -> Self {
        Self::RigidFem(e)
    }
}

impl From<DefinitionError> for ModelError {
    fn from(e: DefinitionError) -> Self {
        Self::Definition(e)
    }
}

impl From<Damaged> for ModelError {
    fn from(damaged: Damaged) -> Self {
        Self::Saved { what: damaged.0.into() }
    }
}
