//! Snapshots of a model, and their records.
//!
//! In: a model. Out: a copy of some hundred bytes, which shares the parameters and the reduced model; a model restored
//! from a snapshot, which continues to the bit. Caches of outputs, the panel in memory and scratch are left out. It
//! must not know FMI.
use super::designs::shares_reduced;
use super::dynamics::inputs::Inputs;
use super::error::ModelError;
use super::model::{Clipped, Exchange, Formulation, Model, Untuned, Watched};
use crate::codec::checksum::fnv1a;
use crate::codec::record::{Damaged, Record, write_numbers};
use crate::codec::writer::Writer;
use crate::mechanism::definition::{Method, Role};
use crate::mechanism::fem_motion::{RigidFemMotion, SavedRigidFem};
use crate::mechanism::motion::SavedState;
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::parameters::{ParameterValues, fingerprint};
use crate::mechanism::quantity::Quantity;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::same_bits;
use std::sync::Arc;

/// All values that decide how a model continues.
#[derive(Clone, Debug)]
pub struct Snapshot {
    parameter_values: Arc<ParameterValues>,
    inputs: Inputs,
    /// The reduced model for these parameters, if the model had built it.
    reduced: Option<Arc<Reduced>>,
    motion: Option<SavedFormulation>,
    /// What model exchange keeps.
    exchange: Option<Exchange>,
    /// What was warned of: the same step gives the same answer again.
    clipped: Clipped,
    watched: Watched,
    /// The laws of the last step, where they are others.
    untuned: Option<Untuned>,
}

#[derive(Clone, Debug)]
enum SavedFormulation {
    Reduced(SavedState),
    RigidFem(SavedRigidFem),
}

impl Snapshot {
    /// Whether the model was initialised, so that the snapshot has a state of motion.
    pub fn has_motion(&self) -> bool {
        self.motion.is_some()
    }

    /// Append all fields, which stay as they are, to these bytes.
    ///
    /// # Errors
    /// As [`Self::write_to`].
    pub fn write(&mut self, out: &mut Vec<u8>) -> Result<(), ModelError> {
        Writer::append_to(out, |writer| self.write_to(writer))
    }

    /// Write all fields, which stay as they are.
    ///
    /// # Errors
    /// The number of bookings of work is near overflow.
    pub fn write_to(&mut self, out: &mut Writer) -> Result<(), ModelError> {
        let values = &self.parameter_values;
        write_parameters(out, &values.parameters, &values.flags)?;
        let record = &mut Record::Write(out);
        record.choice("solver.method", &mut (values.method() as u8), Method::ALL.len())?;
        self.inputs.record(record)?;
        record.flag("in motion", &mut self.has_motion())?;
        match &mut self.motion {
            Some(SavedFormulation::Reduced(state)) => state.record(record)?,
            Some(SavedFormulation::RigidFem(state)) => state.record(record)?,
            None => {}
        }
        record_rest(record, &mut self.exchange, &mut self.clipped, &mut self.watched)?;
        let untuned = self.untuned.as_ref();
        let mut untuned = untuned.map(|untuned| (untuned.values.parameters.clone(), untuned.reference));
        Ok(record_untuned(record, &mut untuned, 0)?)
    }
}

/// What model exchange keeps and what was warned of, written or read.
fn record_rest(
    record: &mut Record,
    exchange: &mut Option<Exchange>,
    clipped: &mut Clipped,
    watched: &mut Watched,
) -> Result<(), Damaged> {
    record.option("model exchange", exchange, Exchange::default, |record, exchange| exchange.record(record))?;
    clipped.record(record)?;
    watched.record(record)
}

/// The parameters of the last step, where they are others, with the energy that the balance referred to, written or
/// read.
fn record_untuned(record: &mut Record, untuned: &mut Option<(Vec<f64>, f64)>, count: usize) -> Result<(), Damaged> {
    let blank = || (vec![0.0; count], 0.0);
    record.option("parameters have changed", untuned, blank, |record, (parameters, reference)| {
        record_parameters(record, parameters, &mut [])?;
        record.finite("energy before", reference)
    })
}

/// Parameters in the record. Their ranges are checked by the reader.
fn record_parameters(record: &mut Record, parameters: &mut [f64], flags: &mut [bool]) -> Result<(), Damaged> {
    record.numbers("parameters", parameters)?;
    record.length("Boolean parameters", flags.len())?;
    flags.iter_mut().try_for_each(|flag| record.flag("Boolean parameter", flag))
}

/// What [`record_parameters`] reads, of parameters that others share.
fn write_parameters(out: &mut Writer, parameters: &[f64], flags: &[bool]) -> Result<(), Damaged> {
    write_numbers(out, parameters);
    let record = &mut Record::Write(out);
    record.length("Boolean parameters", flags.len())?;
    flags.iter().try_for_each(|flag| record.flag("Boolean parameter", &mut { *flag }))
}

impl Model {
    /// Hashes of the interface and of what no parameter changes in the definition: equal for all models between which
    /// snapshots can be exchanged.
    #[inline]
    pub fn identity(&self) -> [u64; 2] {
        *self.original.identity.get_or_init(|| {
            let guid = self.original.variables.guid();
            [fnv1a(guid.as_bytes()), fingerprint(self.original.parameter_values.mechanism())]
        })
    }

    /// Snapshot of the present state.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            parameter_values: Arc::clone(&self.parameter_values),
            inputs: self.inputs.clone(),
            reduced: self.reduced.clone(),
            motion: self.kept_state().map(saved),
            exchange: self.exchange,
            clipped: self.clipped,
            watched: self.watched.clone(),
            untuned: self.untuned.clone(),
        }
    }

    /// The state, but for one that an input would still move to another start: it is sought again.
    #[inline]
    fn kept_state(&self) -> Option<&Formulation> {
        self.state.as_ref().filter(|_| self.is_placed || !self.parameter_values.starts_by_inputs())
    }

    /// [`Self::snapshot`] into an existing snapshot of this mechanism; without allocation if the existing snapshot has
    /// a state of motion in the same formulation.
    #[inline]
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        share(&mut snapshot.parameter_values, &self.parameter_values);
        snapshot.inputs.copy_from(&self.inputs);
        (snapshot.exchange, snapshot.clipped) = (self.exchange, self.clipped);
        snapshot.watched.copy_from(&self.watched);
        snapshot.untuned.clone_from(&self.untuned);
        match (&mut snapshot.reduced, &self.reduced) {
            (Some(theirs), Some(own)) => share(theirs, own),
            (theirs, own) => theirs.clone_from(own),
        }
        match (self.kept_state(), &mut snapshot.motion) {
            (Some(Formulation::Reduced(motion)), Some(SavedFormulation::Reduced(saved))) => {
                saved.copy_from(&motion.state);
            }
            (Some(Formulation::RigidFem(state)), Some(SavedFormulation::RigidFem(saved))) => state.save(saved),
            (state, motion) => *motion = state.map(saved),
        }
    }

    /// Return to a snapshot of this mechanism, taken of this or of another instance; without allocation if the
    /// parameters are the present ones and the model is initialised.
    ///
    /// # Errors
    /// Reactions that cause friction are not smooth under the snapshot's parameters. The model is unchanged.
    #[inline]
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), ModelError> {
        self.restart_told();
        let (own, theirs) = (&self.parameter_values, &snapshot.parameter_values);
        let shares = |reduced: &Arc<Reduced>| shares_reduced(own, reduced, theirs, &self.original.ranges);
        let same = self.reduced.as_ref().is_some_and(shares);
        match (&snapshot.motion, &mut self.state, &self.reduced) {
            (Some(SavedFormulation::Reduced(saved)), Some(Formulation::Reduced(state)), Some(reduced)) if same => {
                state.restore(saved, reduced)?;
            }
            _ => self.restore_otherwise(snapshot, same)?,
        }
        self.inputs.copy_from(&snapshot.inputs);
        share(&mut self.parameter_values, &snapshot.parameter_values);
        self.exchange = self.exchange.map(|_| snapshot.exchange.unwrap_or_default());
        self.is_placed = snapshot.has_motion();
        self.clipped = snapshot.clipped;
        self.watched.copy_from(&snapshot.watched);
        self.untuned.clone_from(&snapshot.untuned);
        Ok(())
    }

    /// Restore the state of motion in all cases but one: the reduced formulation under the present parameters.
    #[cold]
    fn restore_otherwise(&mut self, snapshot: &Snapshot, same: bool) -> Result<(), ModelError> {
        if let (Some(SavedFormulation::RigidFem(saved)), Some(Formulation::RigidFem(state)), Some(reduced)) =
            (&snapshot.motion, &mut self.state, &self.reduced)
            && same
        {
            return state.restore(saved, reduced);
        }
        let (values, inputs, ranges) = (&snapshot.parameter_values, &snapshot.inputs, &self.original.ranges);
        let reduced = match (&self.reduced, &snapshot.reduced) {
            (Some(own), _) if same => Some(Arc::clone(own)),
            (_, Some(theirs)) => Some(Arc::clone(self.designs.find(values, ranges).unwrap_or(theirs))),
            (_, None) if snapshot.has_motion() => Some(self.designs.reduced(values, ranges)?),
            (_, None) => None,
        };
        self.state = match (&snapshot.motion, &reduced) {
            (Some(SavedFormulation::Reduced(saved)), Some(reduced)) => {
                Some(Formulation::Reduced(Box::new(ReducedMotion::from_saved(saved, reduced, inputs)?)))
            }
            (Some(SavedFormulation::RigidFem(saved)), Some(reduced)) => {
                Some(Formulation::RigidFem(Box::new(RigidFemMotion::from_saved(saved, reduced, inputs)?)))
            }
            _ => None,
        };
        if let (Some(reduced), true) = (&reduced, values.is_settled()) {
            self.designs.keep(values, reduced);
        }
        self.reduced = reduced;
        Ok(())
    }

    /// Read a snapshot that [`Snapshot::write`] has written for this mechanism, in this or in another process. The
    /// model is unchanged.
    ///
    /// # Errors
    /// The bytes are no snapshot, a value is out of range, or the parameters give no mechanism.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot, ModelError> {
        let mut parameter_values = ParameterValues::clone(&self.parameter_values);
        let mut inputs = self.inputs.clone();
        let record = &mut Record::Read(bytes);
        record_parameters(record, &mut parameter_values.parameters, &mut parameter_values.flags)?;
        let mut method = 0;
        record.choice("solver.method", &mut method, Method::ALL.len())?;
        let method = Method::ALL[usize::from(method)];
        match parameter_values.stated_method() {
            Some(_) => parameter_values.set_method(method),
            None if method == Method::default() => {}
            None => {
                return Err(Damaged::new(format!(
                    "solver.method = \"{}\": this model does not have this method",
                    method.word()
                ))
                .into());
            }
        }
        let parameter_values = self.checked(parameter_values)?;
        inputs.record(record)?;
        let ranges = &self.original.ranges;
        let mut reduced = self.designs.find(&parameter_values, ranges).map(Arc::clone);
        let mut moves = false;
        record.flag("in motion", &mut moves)?;
        let motion = if moves {
            let reduced = match &mut reduced {
                Some(reduced) => reduced,
                none => none.insert(self.designs.reduced(&parameter_values, ranges)?),
            };
            Some(match method {
                Method::Reduced => SavedFormulation::Reduced(SavedState::read(record, reduced)?),
                Method::RigidFem => {
                    SavedFormulation::RigidFem(SavedRigidFem::read(record, reduced, parameter_values.mechanism())?)
                }
            })
        } else {
            None
        };
        let (mut exchange, mut clipped, mut watched) = (None, self.clipped, self.watched.clone());
        record_rest(record, &mut exchange, &mut clipped, &mut watched)?;
        let mut untuned = None;
        record_untuned(record, &mut untuned, parameter_values.parameters.len())?;
        let untuned = untuned.map(|(read, reference)| {
            self.before_tuning(&parameter_values, read).map(|values| Untuned { values, reference })
        });
        let untuned = untuned.transpose()?;
        match record {
            Record::Read([]) => {
                Ok(Snapshot { parameter_values, inputs, reduced, motion, exchange, clipped, watched, untuned })
            }
            _ => Err(Damaged::new("the saved data is longer than the state of this model").into()),
        }
    }

    /// Parameters that were read, settled.
    ///
    /// # Errors
    /// One is out of range, or is not what its expression gives.
    fn checked(&self, mut values: ParameterValues) -> Result<Arc<ParameterValues>, ModelError> {
        for (index, value) in values.parameters.iter().enumerate() {
            let (range, _) = self.original.ranges[index];
            if !range.contains(*value) {
                let name = self.parameter_name(index);
                return Err(ModelError::Value { name, value: *value, allowed: range.text() });
            }
        }
        let mut computed = values.parameters.clone();
        values.expressions().compute(&mut computed);
        if !same_bits(&computed, &values.parameters) {
            return Err(Damaged::new(
                "a saved calculated parameter differs from the value of the expression of this parameter",
            )
            .into());
        }
        values.changed();
        let mut values = Arc::new(values);
        let own = &self.parameter_values;
        match own.is_settled() && own.has_same_bits(&values) {
            true => values = Arc::clone(own),
            false => self.designs.settle(&mut values),
        }
        Ok(values)
    }

    /// The values that these had before they were tuned, as they were read.
    ///
    /// # Errors
    /// As [`Self::checked`], or one differs that cannot be tuned.
    fn before_tuning(&self, tuned: &ParameterValues, read: Vec<f64>) -> Result<Arc<ParameterValues>, ModelError> {
        let both = tuned.parameters.iter().zip(&read).zip(&self.original.ranges);
        let mut changed = both.filter(|((after, before), _)| after.to_bits() != before.to_bits());
        if changed.any(|(_, (_, role))| !(role.is_tunable() || *role == Role::Named)) {
            return Err(Damaged::new(
                "the saved data contains two values of a parameter that cannot change during a run",
            )
            .into());
        }
        let mut before = tuned.clone();
        before.parameters = read;
        self.checked(before)
    }

    /// Name of the parameter with this index.
    pub(super) fn parameter_name(&self, index: usize) -> String {
        self.original.variables.name_of(Quantity::Parameter(index)).to_owned()
    }
}

/// Make one the other; without touching the reference counts if both are the same already.
fn share<T>(one: &mut Arc<T>, other: &Arc<T>) {
    if !Arc::ptr_eq(one, other) {
        one.clone_from(other);
    }
}

#[cold]
fn saved(motion: &Formulation) -> SavedFormulation {
    match motion {
        Formulation::Reduced(motion) => SavedFormulation::Reduced(SavedState::clone(&motion.state)),
        Formulation::RigidFem(state) => SavedFormulation::RigidFem(state.saved()),
    }
}
