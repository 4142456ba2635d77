//! Errors of a model.
use crate::codec::record::Damaged;
use crate::integrator::IntegrationError;
use crate::mechanism::definition::DefinitionError;
use crate::mechanism::reduced::{Reduced, ReductionError};
use crate::mechanism::rigid_fem::RigidFemError;
use crate::numerics::decimal::Decimal;
use crate::numerics::table::Unresolved;
use crate::variables::Reference;
use std::fmt;

/// A refused call, which leaves the model unchanged. The text names the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum ModelError {
    /// The file is not a definition.
    Definition(DefinitionError),
    /// The present parameters give no reduced model or no start.
    Reduction(ReductionError),
    /// No variable of this kind has this reference.
    Reference {
        /// The reference.
        reference: Reference,
        /// Kind of variable that was expected.
        kind: &'static str,
        /// Number of variables.
        count: usize,
    },
    /// A value out of range.
    Value {
        /// Variable.
        name: String,
        /// The value.
        value: f64,
        /// What is allowed.
        allowed: String,
    },
    /// A text other than the allowed words.
    Text {
        /// Variable.
        name: String,
        /// The text.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// The rigid finite elements refused the mechanism or a step.
    RigidFem(RigidFemError),
    /// A feature of the reduced model that the rigid finite elements do not have.
    NotInRigidFem {
        /// Variable.
        name: String,
        /// Value of the variable.
        value: String,
        /// Remedy other than the choice of the reduced model.
        remedy: String,
    },
    /// A stop was reached in the formulation with rigid finite elements, which has no stops.
    StopPassed {
        /// Quantity that states the stop.
        name: String,
        /// Value at the stop.
        value: f64,
        /// Time from the beginning of the step [s].
        time: f64,
    },
    /// A derivative that cannot be read or set.
    Derivative {
        /// Variable or request.
        what: String,
        /// Reason and remedy.
        reason: String,
    },
    /// An output was to be set.
    Output {
        /// Variable.
        name: String,
    },
    /// An output is not smooth along the motion.
    Table {
        /// Variable.
        name: String,
        /// Position of the linkage there.
        position: String,
    },
    /// An output overflows.
    Overflow {
        /// Variable.
        name: String,
    },
    /// A step before initialisation.
    NotInitialised,
    /// A step size that is not finite and positive.
    StepSize {
        /// The step [s].
        h: f64,
    },
    /// The integration stopped.
    Integration(IntegrationError),
    /// Friction and reactions have no common solution.
    Locked {
        /// Position of the linkage there.
        position: String,
    },
    /// The start is beyond a stop.
    BeyondStop {
        /// Quantity that states the stop.
        name: String,
        /// Value at the stop.
        value: f64,
        /// Value at the start.
        start: f64,
    },
    /// The point of a lock stands still at the position of the stop, so that no force there holds the mechanism.
    LockStill {
        /// Lock.
        name: String,
        /// Stop of the lock.
        stop: String,
        /// Position of the linkage at the stop.
        position: String,
    },
    /// A record that is no snapshot of this mechanism.
    Saved {
        /// Fault of the record.
        what: String,
    },
    /// The motion leaves the traced part of the curve.
    Travel {
        /// Position of the linkage at the end of the traced part.
        position: String,
    },
}

impl ModelError {
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
            Self::Reference { reference, kind, count } => write!(
                f,
                "value reference {reference} is no {kind} variable: references run from 0 to {}, \
                 kinds are in modelDescription.xml",
                count.saturating_sub(1)
            ),
            Self::Value { name, value, allowed } => write!(f, "{name} = {}: must be {allowed}", Decimal(*value)),
            Self::Text { name, value, allowed } => write!(f, "{name} = \"{value}\": must be {allowed}"),
            Self::RigidFem(RigidFemError::Substeps { count, limit }) => write!(
                f,
                "a step would take {count:e} steps of solver.fem_step, allowed are {limit:e}: raise solver.fem_step"
            ),
            Self::RigidFem(e) => write!(f, "solver.method = \"rigid_fem\": {e}"),
            Self::NotInRigidFem { name, value, remedy } => write!(
                f,
                "{name} = {value}: solver.method = \"rigid_fem\" does not have it; {remedy}, \
                 or choose solver.method = \"reduced\""
            ),
            Self::StopPassed { name, value, time } => write!(
                f,
                "{name} = {}: this stop is reached {} s into the step, and solver.method = \"rigid_fem\" has no stops; \
                 end the run before, set the stop's enabled to false, or choose solver.method = \"reduced\"",
                Decimal(*value),
                Decimal(*time)
            ),
            Self::Derivative { what, reason } => write!(f, "{what}: {reason}"),
            Self::Output { name } => write!(f, "{name} is an output and cannot be set"),
            Self::Table { name, position } => write!(
                f,
                "{name} is not smooth near {position}, so that it cannot be told; \
                 change the lengths, or do not read it"
            ),
            Self::Overflow { name } => write!(
                f,
                "{name} is beyond the largest number under the present inputs and parameters: check their sizes"
            ),
            Self::NotInitialised => f.write_str("a step was asked for before initialisation"),
            Self::StepSize { h } => write!(f, "step size h = {} s: must be finite and > 0", Decimal(*h)),
            Self::Integration(IntegrationError::StepTooSmall { t, step }) => write!(
                f,
                "the integration stopped {} s into the step: no step above {step:.1e} s meets solver.tolerance; \
                 check the sizes of the inputs",
                Decimal(*t)
            ),
            Self::Locked { position } => write!(
                f,
                "friction locks the mechanism near {position}: the coefficients or pin radii ask for more friction than \
                 the reactions can cause; reduce them"
            ),
            Self::BeyondStop { name, value, start } => write!(
                f,
                "{name} = {}: the start, at {}, is beyond this stop; \
                 move the start or the stop, or set the stop's enabled to false",
                Decimal(*value),
                Decimal(*start)
            ),
            Self::LockStill { name, stop, position } => write!(
                f,
                "locks.{name}.at: this point stands still where {stop} is, near {position}, so the lock cannot act: \
                 name a point that moves there"
            ),
            Self::Saved { what } => write!(f, "the saved state is none of this mechanism: {what}"),
            Self::Travel { position } => {
                write!(f, "the motion has gone past the end of its travel at {position}: limit the loads or the time")
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
        Self::Saved { what: damaged.0 }
    }
}
