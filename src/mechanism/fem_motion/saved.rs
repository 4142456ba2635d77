//! The saved state of a motion by rigid finite elements.
//!
//! In: a motion, or a record. Out: the fields that decide its next steps, and the motion again. It must not know
//! outputs.
use super::{Kept, RigidFemMotion, fem_step, finite_elements};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::reduced::Reduced;
use crate::mechanism::{motion::SavedState, outputs::ReducedMotion};
use std::sync::Arc;

/// A [`RigidFemMotion`] without what is derived from it.
#[derive(Clone, Debug)]
pub struct SavedRigidFem {
    kept: Kept,
    rigid: SavedState,
}

impl RigidFemMotion {
    /// The fields that decide the next steps.
    pub fn saved(&self) -> SavedRigidFem {
        SavedRigidFem { kept: self.kept.clone(), rigid: SavedState::clone(&self.rigid.state) }
    }

    /// [`Self::saved`] in the place of another one, without allocation.
    pub fn save(&self, saved: &mut SavedRigidFem) {
        saved.kept.copy_from(&self.kept);
        saved.rigid.copy_from(&self.rigid.state);
    }

    /// A motion that continues as the saved one did, under these inputs.
    ///
    /// # Errors
    /// As [`ReducedMotion::from_saved`].
    pub fn from_saved(saved: &SavedRigidFem, reduced: &Reduced, inputs: &Inputs) -> Result<Self, ModelError> {
        let rigid = ReducedMotion::from_saved(&saved.rigid, reduced, inputs)?;
        Ok(Self::new(saved.kept.clone(), rigid, reduced, inputs))
    }

    /// [`Self::from_saved`] in place, with the same reduced model; without allocation if the finite elements are the
    /// same.
    ///
    /// # Errors
    /// As [`Self::from_saved`]; nothing has changed.
    pub fn restore(&mut self, saved: &SavedRigidFem, reduced: &Reduced) -> Result<(), ModelError> {
        self.rigid.restore(&saved.rigid, reduced)?;
        self.kept.copy_from(&saved.kept);
        Ok(())
    }
}

impl Kept {
    /// Copy the fields of another motion of this mechanism, without allocation.
    fn copy_from(&mut self, other: &Self) {
        self.fem.clone_from(&other.fem);
        self.state.copy_from(&other.state);
        self.applied.clone_from(&other.applied);
        self.slack.clone_from(&other.slack);
        (self.fem_step, self.reference, self.steps) = (other.fem_step, other.reference, other.steps);
    }

    /// All fields that do not follow from the parameters, written or read.
    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
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

impl SavedRigidFem {
    /// Read a saved state for these parameters.
    ///
    /// # Errors
    /// A field is out of the mechanism's range; the mechanism has no finite elements.
    pub fn read(record: &mut Record, reduced: &Reduced, mechanism: &Mechanism) -> Result<Self, ModelError> {
        let fem = Arc::new(finite_elements(reduced, mechanism)?);
        let rigid = SavedState::read(record, reduced)?;
        let mut kept = Kept {
            state: fem.blank(),
            fem,
            fem_step: fem_step(mechanism),
            applied: vec![0.0; reduced.components().sized],
            reference: 0.0,
            slack: vec![0.0; reduced.loading().stops.len()],
            steps: 0,
        };
        kept.record(record)?;
        Ok(Self { kept, rigid })
    }

    /// All fields, written.
    ///
    /// # Errors
    /// The count of steps is near overflow.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.rigid.record(record)?;
        self.kept.record(record)
    }
}
