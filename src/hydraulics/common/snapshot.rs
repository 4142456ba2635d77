//! Snapshots of a hydraulic model: its complete state.
//!
//! In: a model. Out: a copy of its state, which shares the parameters; a model restored from a snapshot, which
//! continues with identical results; the record of a snapshot. It must not know FMI.
use super::{HostInputs, Kind, Model, Parameters, Quantity};
use crate::error::HydraulicsError;
use foundation::codec::checksum::fnv1a;
use foundation::codec::record::{Damaged, Record};
use foundation::codec::writer::Writer;
use foundation::numerics::bits::same_bits;
use std::sync::Arc;

/// All values that decide how a model continues.
#[derive(Clone, Debug)]
pub struct Snapshot<K: Kind> {
    parameters: Arc<Parameters<K>>,
    inputs: K::Inputs,
    state: Option<K::State>,
    /// What was warned of: the same step gives the same answer again.
    warnings: K::Warnings,
}

impl<K: Kind> Snapshot<K> {
    /// Whether the model was initialised.
    pub fn has_motion(&self) -> bool {
        self.state.is_some()
    }

    /// Append all fields to these bytes.
    ///
    /// # Errors
    /// As [`Self::write_to`].
    pub fn write(&self, out: &mut Vec<u8>) -> Result<(), HydraulicsError> {
        Writer::append_to(out, |writer| self.write_to(writer))
    }

    /// Write all fields.
    ///
    /// # Errors
    /// A count of work done is near overflow.
    pub fn write_to(&self, out: &mut Writer) -> Result<(), HydraulicsError> {
        let Self { parameters, mut inputs, mut state, mut warnings } = self.clone();
        let record = &mut Record::Write(out);
        record.small("version", &mut { K::VERSION })?;
        // Their ranges are checked by the reader.
        record.numbers("parameters", &mut parameters.values.clone())?;
        record.choice("coupling.mode", &mut (K::mode(&parameters.definition) as u8), K::MODES.len())?;
        inputs.record(record)?;
        record.flag("in motion", &mut state.is_some())?;
        state.iter_mut().try_for_each(|state| K::record_state(&parameters.laws, state, record))?;
        Ok(K::record_warnings(&mut warnings, record)?)
    }
}

impl<K: Kind> Model<K> {
    /// Hashes of the interface and of the kind of model: equal for all models between which snapshots can be exchanged.
    pub fn identity(&self) -> [u64; 2] {
        [fnv1a(self.original.variables.guid().as_bytes()), fnv1a(K::NAME.as_bytes())]
    }

    /// Snapshot of the present state.
    pub fn snapshot(&self) -> Snapshot<K> {
        let Self { parameters, inputs, state, warnings, .. } = self;
        let (inputs, state) = (inputs.clone(), state.clone());
        Snapshot { parameters: Arc::clone(parameters), inputs, state, warnings: *warnings }
    }

    /// [`Self::snapshot`] into an existing snapshot, without allocation if both are in motion.
    #[inline]
    pub fn snapshot_into(&self, snapshot: &mut Snapshot<K>) {
        share(&mut snapshot.parameters, &self.parameters);
        snapshot.inputs.copy_from(&self.inputs);
        copy::<K>(&mut snapshot.state, self.state.as_ref());
        snapshot.warnings = self.warnings;
    }

    /// Return to a snapshot of this model, taken of this or of another instance; without allocation if both are in
    /// motion.
    ///
    /// # Errors
    /// None.
    #[inline]
    pub fn restore(&mut self, snapshot: &Snapshot<K>) -> Result<(), HydraulicsError> {
        share(&mut self.parameters, &snapshot.parameters);
        self.inputs.copy_from(&snapshot.inputs);
        copy::<K>(&mut self.state, snapshot.state.as_ref());
        self.warnings = snapshot.warnings;
        K::clear(&mut self.cache);
        Ok(())
    }

    /// Read a snapshot that [`Snapshot::write`] has written, in this or in another process. The model is unchanged.
    ///
    /// # Errors
    /// The bytes are no snapshot, or a value is out of range.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot<K>, HydraulicsError> {
        let record = &mut Record::Read(bytes);
        let (mut version, mut mode, mut moves) = (0, 0, false);
        record.small("version", &mut version)?;
        if version != K::VERSION {
            let own = K::VERSION;
            return Err(Damaged(format!("format version {version}, but this model reads version {own}")).into());
        }
        let mut parameters = Parameters::clone(&self.parameters);
        record.numbers("parameters", &mut parameters.values)?;
        record.choice("coupling.mode", &mut mode, K::MODES.len())?;
        K::set_mode(&mut parameters.definition, usize::from(mode));
        for (index, value) in parameters.values.iter().enumerate() {
            let (range, _) = self.original.ranges[index];
            if !range.contains(*value) {
                let name = self.parameter_name(index);
                return Err(HydraulicsError::Value { name, value: *value, allowed: range.text() });
            }
        }
        parameters.update();
        let (mut inputs, mut warnings) = (self.inputs.clone(), self.warnings);
        inputs.record(record)?;
        // Inputs that change within a step may be out of their ranges where `solver.max_steps` has ended it.
        let horizon = inputs.values()[K::horizon(&parameters.laws)];
        if horizon < 0.0 {
            return Err(Damaged(format!("preview.horizon = {horizon} s: must be at least 0")).into());
        }
        record.flag("in motion", &mut moves)?;
        if moves {
            K::check(&parameters.definition)?;
        }
        let mut state = moves.then(|| K::start(&parameters, &inputs));
        state.iter_mut().try_for_each(|state| K::record_state(&parameters.laws, state, record))?;
        K::record_warnings(&mut warnings, record)?;
        let known = [&self.parameters, &self.original.parameters].into_iter().find(|known| {
            let is_same_mode = K::mode(&known.definition) == K::mode(&parameters.definition);
            same_bits(&known.values, &parameters.values) && is_same_mode
        });
        let parameters = known.map_or_else(|| Arc::new(parameters.clone()), Arc::clone);
        match record {
            Record::Read([]) => Ok(Snapshot { parameters, inputs, state, warnings }),
            _ => Err(Damaged("the saved data is longer than the state of this model".to_owned()).into()),
        }
    }

    fn parameter_name(&self, index: usize) -> String {
        self.original.variables.name_of(Quantity::Parameter(index)).to_owned()
    }
}

/// Make one the other; without touching the reference counts if both are the same already.
fn share<T>(one: &mut Arc<T>, other: &Arc<T>) {
    if !Arc::ptr_eq(one, other) {
        one.clone_from(other);
    }
}

/// Make one the other, without allocation if both are there.
fn copy<K: Kind>(one: &mut Option<K::State>, other: Option<&K::State>) {
    match (one, other) {
        (Some(own), Some(other)) => K::copy_state(own, other),
        (own, other) => *own = other.cloned(),
    }
}
