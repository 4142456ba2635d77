//! The saved state of a motion by rigid finite elements.
//!
//! In: a motion, or a record. Out: the fields that decide its next steps, and the motion again. It must not know
//! outputs.
use super::{RigidFemMotion, fem_step, finite_elements};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem};
use crate::mechanism::{motion::SavedState, outputs::ReducedMotion};
use std::sync::Arc;

/// The fields of a [`RigidFemMotion`] from which all others follow.
#[derive(Clone, Debug)]
pub struct SavedRigidFem {
    fem: Arc<RigidFem>,
    fem_step: f64,
    state: rigid_fem::State,
    applied: Vec<f64>,
    reference: f64,
    slack: Vec<f64>,
    rigid: SavedState,
    steps: u64,
}

impl RigidFemMotion {
    /// The fields that decide the next steps.
    pub fn saved(&self) -> SavedRigidFem {
        SavedRigidFem {
            fem: Arc::clone(&self.fem),
            fem_step: self.fem_step,
            state: self.state.clone(),
            applied: self.applied.clone(),
            reference: self.reference,
            slack: self.slack.clone(),
            rigid: self.rigid.state.saved.clone(),
            steps: self.steps,
        }
    }

    /// [`Self::saved`] in the place of another one, without allocation.
    pub fn save(&self, saved: &mut SavedRigidFem) {
        saved.fem.clone_from(&self.fem);
        saved.state.copy_from(&self.state);
        saved.applied.clone_from(&self.applied);
        saved.slack.clone_from(&self.slack);
        (saved.fem_step, saved.reference, saved.steps) = (self.fem_step, self.reference, self.steps);
        saved.rigid.copy_from(&self.rigid.state);
    }

    /// A motion that continues as the saved one did, under these inputs.
    ///
    /// # Errors
    /// As [`ReducedMotion::from_saved`].
    pub fn from_saved(saved: &SavedRigidFem, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        Ok(Self {
            scratch: saved.fem.scratch(),
            fem: Arc::clone(&saved.fem),
            fem_step: saved.fem_step,
            present: saved.state.clone(),
            balanced: false,
            before: (saved.state.accelerations.clone(), saved.applied.clone()),
            applied: saved.applied.clone(),
            sizes: reduced.sizes(&inputs.reals),
            reactions: (false, vec![Reaction::default(); reduced.linkage().joints.len()]),
            reference: saved.reference,
            slack: saved.slack.clone(),
            rigid: ReducedMotion::from_saved(&saved.rigid, reduced, inputs)?,
            steps: saved.steps,
            state: saved.state.clone(),
        })
    }

    /// [`Self::from_saved`] in place, with the same reduced model; without allocation if the finite elements are the
    /// same.
    ///
    /// # Errors
    /// As [`Self::from_saved`]; nothing has changed.
    pub fn restore(&mut self, saved: &SavedRigidFem, reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
        self.rigid.restore(&saved.rigid, reduced, Some(&inputs.reals))?;
        self.fem.clone_from(&saved.fem);
        self.state.copy_from(&saved.state);
        self.applied.copy_from_slice(&saved.applied);
        self.slack.copy_from_slice(&saved.slack);
        (self.fem_step, self.reference, self.steps) = (saved.fem_step, saved.reference, saved.steps);
        let loads = reduced.loading().inputs.len();
        self.sizes[..loads].copy_from_slice(&inputs.reals[..loads]);
        (self.balanced, self.reactions.0) = (false, false);
        Ok(())
    }
}

impl SavedRigidFem {
    /// Read a saved state for these parameters.
    ///
    /// # Errors
    /// A field is out of the mechanism's range; the mechanism has no finite elements.
    pub fn read(record: &mut Record, reduced: &Reduced, mechanism: &Mechanism) -> Result<Self, ModelError> {
        let fem = Arc::new(finite_elements(reduced, mechanism)?);
        let mut saved = Self {
            state: fem.blank(),
            fem,
            fem_step: fem_step(mechanism),
            applied: vec![0.0; reduced.components().sized],
            reference: 0.0,
            slack: vec![0.0; reduced.loading().stops.len()],
            rigid: SavedState::read(record, reduced)?,
            steps: 0,
        };
        saved.own(record)?;
        Ok(saved)
    }

    /// All fields, written.
    ///
    /// # Errors
    /// The count of steps is near overflow.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.rigid.record(record)?;
        self.own(record)
    }

    /// The fields besides `rigid`, written or read.
    fn own(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.state.record(record)?;
        record.length("sizes", self.applied.len())?;
        record.all_finite("size", &mut self.applied)?;
        record.finite("energy", &mut self.reference)?;
        record.length("stops", self.slack.len())?;
        let allowed = |slack: f64| slack >= 0.0 && slack.is_finite();
        for slack in &mut self.slack {
            record.number("slack of a stop", slack, allowed, "a finite number >= 0")?;
        }
        record.count("steps", &mut self.steps)
    }
}
