//! Snapshots of a hydraulic actuator: its complete state.
//!
//! In: a model. Out: a copy of its state, which shares the parameters; a model restored from a snapshot, which
//! continues with identical results; the record of a snapshot. It must not know FMI.
use super::definition::Mode;
use super::error::HydraulicsError;
use super::inputs::{Input, Inputs};
use super::interface::Quantity;
use super::model::{Model, Parameters, Warnings};
use super::state::State;
use crate::codec::checksum::fnv1a;
use crate::codec::record::{Damaged, Record};
use crate::numerics::bits::same_bits;
use std::sync::Arc;

/// Version of the record.
const VERSION: u32 = 6;

/// All values that decide how a model continues.
#[derive(Clone, Debug)]
pub struct Snapshot {
    parameters: Arc<Parameters>,
    inputs: Inputs,
    state: Option<State>,
    /// What was warned of: the same step gives the same answer again.
    warnings: Warnings,
}

impl Snapshot {
    /// Whether the model was initialised.
    pub fn has_motion(&self) -> bool {
        self.state.is_some()
    }

    /// Write all fields.
    ///
    /// # Errors
    /// A count of work done is near overflow.
    pub fn write(&self, out: &mut Vec<u8>) -> Result<(), HydraulicsError> {
        let mut copy = self.clone();
        let record = &mut Record::Write(out);
        record.small("version", &mut { VERSION })?;
        record_parameters(record, &mut self.parameters.values.clone())?;
        record.choice("coupling.mode", &mut (self.parameters.actuator.coupling.mode as u8), Mode::ALL.len())?;
        copy.inputs.record(record)?;
        record.flag("in motion", &mut copy.has_motion())?;
        copy.state.iter_mut().try_for_each(|state| state.record(record))?;
        Ok(copy.warnings.record(record)?)
    }
}

/// Parameters in the record. Their ranges are checked by the reader.
pub(super) fn record_parameters(record: &mut Record, parameters: &mut [f64]) -> Result<(), Damaged> {
    record.numbers("parameters", parameters)
}

impl Model {
    /// Hashes of the interface and of the kind of model: equal for all models between which snapshots can be exchanged.
    pub fn identity(&self) -> [u64; 2] {
        [fnv1a(self.original.variables.guid().as_bytes()), fnv1a(b"hydraulic actuator")]
    }

    /// Snapshot of the present state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { parameters, inputs, state, warnings, .. } = self;
        let parameters = Arc::clone(parameters);
        Snapshot { parameters, inputs: *inputs, state: state.clone(), warnings: *warnings }
    }

    /// [`Self::snapshot`] into an existing snapshot, without allocation.
    #[inline]
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        share(&mut snapshot.parameters, &self.parameters);
        (snapshot.inputs, snapshot.warnings) = (self.inputs, self.warnings);
        snapshot.state.clone_from(&self.state);
    }

    /// Return to a snapshot of this actuator, taken of this or of another instance; without allocation.
    ///
    /// # Errors
    /// None.
    #[inline]
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), HydraulicsError> {
        share(&mut self.parameters, &snapshot.parameters);
        (self.inputs, self.warnings) = (snapshot.inputs, snapshot.warnings);
        self.state.clone_from(&snapshot.state);
        self.cache.clear();
        Ok(())
    }

    /// Read a snapshot that [`Snapshot::write`] has written, in this or in another process. The model is unchanged.
    ///
    /// # Errors
    /// The bytes are no snapshot, or a value is out of range.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot, HydraulicsError> {
        let record = &mut Record::Read(bytes);
        let mut version = 0;
        record.small("version", &mut version)?;
        if version != VERSION {
            return Err(Damaged(format!("format version {version}, but this model reads version {VERSION}")).into());
        }
        let mut parameters = Parameters::clone(&self.parameters);
        record_parameters(record, &mut parameters.values)?;
        let mut mode = 0;
        record.choice("coupling.mode", &mut mode, Mode::ALL.len())?;
        parameters.actuator.coupling.mode = Mode::ALL[usize::from(mode)];
        for (index, value) in parameters.values.iter().enumerate() {
            let (range, _) = self.original.ranges[index];
            if !range.contains(*value) {
                let name = self.parameter_name(index);
                return Err(HydraulicsError::Value { name, value: *value, allowed: range.text() });
            }
        }
        parameters.update();
        let mut inputs = self.inputs;
        inputs.record(record)?;
        // Inputs that change within a step may be out of their ranges where `solver.max_steps` has ended it.
        let horizon = inputs.get(Input::Horizon);
        if horizon < 0.0 {
            return Err(Damaged(format!("preview.horizon = {horizon} s: must be at least 0")).into());
        }
        let mut moves = false;
        record.flag("in motion", &mut moves)?;
        let state = if moves {
            parameters.actuator.check()?;
            let mut state = parameters.start(&inputs);
            state.record(record)?;
            Some(state)
        } else {
            None
        };
        let mut warnings = self.warnings;
        warnings.record(record)?;
        let known = [&self.parameters, &self.original.parameters].into_iter().find(|known| {
            same_bits(&known.values, &parameters.values) && known.actuator.coupling == parameters.actuator.coupling
        });
        let parameters = known.map_or_else(|| Arc::new(parameters.clone()), Arc::clone);
        match record {
            Record::Read([]) => Ok(Snapshot { parameters, inputs, state, warnings }),
            _ => Err(Damaged("the saved data is longer than the state of this model".to_owned()).into()),
        }
    }

    fn parameter_name(&self, index: usize) -> String {
        let list = self.original.variables.list().iter().enumerate();
        let is = |i: usize| self.original.variables.quantity(i as u32) == Some(Quantity::Parameter(index));
        list.filter(|(i, _)| is(*i)).map(|(_, variable)| variable.name.clone()).collect()
    }
}

/// Make one the other; without touching the reference counts if both are the same already.
pub(super) fn share<T>(one: &mut Arc<T>, other: &Arc<T>) {
    if !Arc::ptr_eq(one, other) {
        one.clone_from(other);
    }
}
