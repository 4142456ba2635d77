//! The state of motion in the formulation of `solver.method`.
//!
//! In: a start, a reduced model, inputs. Out: a state of motion. It must not know steps.
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::fem_motion::RigidFemMotion;
use crate::mechanism::motion::state::{Start, State};
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::reduced::Reduced;

/// The state of motion in the formulation that solver.method chose.
#[derive(Clone, Debug)]
pub enum Formulation {
    /// By the reduced model, along the curve. Apart, as a model is moved by value on the stack of a host's thread.
    Reduced(Box<ReducedMotion>),
    /// By rigid finite elements.
    RigidFem(Box<RigidFemMotion>),
}

impl Formulation {
    /// By the reduced model, at a start.
    #[inline(never)]
    pub fn reduced(
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<Self, ModelError> {
        Ok(Self::Reduced(Box::new(ReducedMotion::at_start(start, reduced, mechanism, inputs)?)))
    }

    /// By rigid finite elements, at a start.
    #[inline(never)]
    pub fn rigid_fem(
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<Self, ModelError> {
        Ok(Self::RigidFem(Box::new(RigidFemMotion::at_start(start, reduced, mechanism, inputs)?)))
    }

    /// The state along the curve; that of the finite elements where it fits best.
    pub fn along_curve(&self) -> &State {
        match self {
            Self::Reduced(motion) => &motion.state,
            Self::RigidFem(motion) => &motion.rigid.state,
        }
    }
}
