//! A saved state of an instance, and its serialised form.
//!
//! In: an instance, or bytes. Out: bytes, or a state that can be restored. Must not know: what a component saves. The
//! serialised form, little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `linkFMUs` |
//! | 4 | version of the form: [`VERSION`] |
//! | 8 | number of all bytes |
//! | 8 | hash of the GUID |
//! | 8 | hash of the definition without parameter values, inputs and texts |
//! | 1, 1, 1 | phase, whether an event is to be handled, whether the experiment was set up |
//! | 1 or 9 | whether the experiment has a tolerance, the tolerance |
//! | 17 or 25 | start time, time, whether there is a stop time, stop time |
//! | n | the component: parameters, inputs, the state with the memory of its integrator |
//! | 8 | XXH64 of all bytes before |

use super::clock::Clock;
use super::phase::Phase;
use super::refusal::Refusal;
use crate::codec::checksum::xxh64;
use crate::codec::record::{Damaged, Record};
use crate::codec::writer::Writer;
use crate::component::{Component, Snapshot};

const MAGIC: [u8; 8] = *b"linkFMUs";
/// Version of the form. It changes with every change of the bytes or of the hashed data.
const VERSION: u32 = 16;
/// Bytes of magic, version, length and the two hashes.
const HEADER: usize = 36;
/// Bytes of the check sum.
const CHECK: usize = 8;

/// All data that determine how the simulation of an instance continues.
#[derive(Clone, Debug)]
pub struct Saved {
    pub phase: Phase,
    pub awaits_event: bool,
    pub set_up: bool,
    pub tolerance: Option<f64>,
    pub clock: Clock,
    pub component: Snapshot,
}

impl Saved {
    /// Writes the serialised form for a component of this identity into the memory of `bytes`.
    ///
    /// # Errors
    /// A work counter is near overflow.
    pub fn serialise(&mut self, identity: [u64; 2], bytes: Vec<u8>) -> Result<Vec<u8>, Refusal> {
        let mut writer = Writer::new(bytes);
        writer.put(MAGIC);
        writer.put(VERSION.to_le_bytes());
        writer.put([0; 8]);
        identity.iter().for_each(|hash| writer.put(hash.to_le_bytes()));
        writer.put([self.phase.place(), u8::from(self.awaits_event), u8::from(self.set_up)]);
        let mut record = Record::Write(&mut writer);
        record_tolerance(&mut self.tolerance, &mut record).map_err(damaged)?;
        self.clock.record(&mut record).map_err(damaged)?;
        self.component.write_to(&mut writer)?;
        let length = (writer.written() + CHECK) as u64;
        let mut bytes = writer.finish();
        bytes[12..20].copy_from_slice(&length.to_le_bytes());
        let check = xxh64(&bytes);
        bytes.extend_from_slice(&check.to_le_bytes());
        Ok(bytes)
    }

    /// Reads a serialised state for an instance with this component.
    ///
    /// # Errors
    /// Another form or version, missing, additional or changed bytes, another identity, a value out of range.
    pub fn from_bytes(bytes: &[u8], component: &Component) -> Result<Self, Refusal> {
        let refuse = |what: String| Err(Refusal::error(what));
        if bytes.get(..8) != Some(&MAGIC) {
            return refuse(
                "the bytes are not a serialized state of this type of FMU; pass the bytes of a serialized state"
                    .to_owned(),
            );
        }
        let number = |range: std::ops::Range<usize>| {
            let field = bytes.get(range).unwrap_or_default();
            field.iter().rev().fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte))
        };
        if bytes.len() < HEADER + CHECK {
            return refuse(format!(
                "the serialized state is incomplete: only {} bytes were passed, fewer than the header of a state \
                 has; pass all bytes of the state",
                bytes.len()
            ));
        }
        let version = number(8..12);
        if version != u64::from(VERSION) {
            return refuse(format!(
                "the serialized state has format version {version}, but this library reads version {VERSION}; \
                 serialize the state again with this library"
            ));
        }
        let length = number(12..20);
        if length != bytes.len() as u64 {
            let what = if length > bytes.len() as u64 { "incomplete" } else { "too long" };
            return refuse(format!(
                "the serialized state is {what}: the header of the state states {length} bytes, but {} bytes were \
                 passed; pass exactly the bytes of the state",
                bytes.len()
            ));
        }
        let (all, check) = bytes.split_at(bytes.len() - CHECK);
        if check != xxh64(all).to_le_bytes() {
            return refuse(
                "the serialized state is damaged: the check sum is wrong; serialize the state again".to_owned(),
            );
        }
        let ([guid, structure], own) = ([number(20..28), number(28..36)], component.identity());
        if guid != own[0] {
            return refuse(
                "the state was saved by another FMU, which has another GUID; pass a state that this FMU \
                saved"
                    .to_owned(),
            );
        }
        if structure != own[1] {
            let file = component.definition_file();
            return refuse(format!(
                "the state was saved with a different {file}; between the two files, only values of parameters and \
                 inputs may differ"
            ));
        }
        let mut record = Record::Read(&all[HEADER..]);
        let (mut phase, mut awaits_event, mut set_up) = (0, false, false);
        let (mut tolerance, mut clock) = (None, Clock::default());
        record.choice("phase", &mut phase, 256).map_err(damaged)?;
        let Some(phase) = Phase::at(phase) else {
            return refuse(format!(
                "the serialized state is damaged: the bytes contain the number {phase} for the status of the FMU \
                 instance, but no status that can be saved has this number"
            ));
        };
        record.flag("mark of an unhandled event", &mut awaits_event).map_err(damaged)?;
        record.flag("set up", &mut set_up).map_err(damaged)?;
        record_tolerance(&mut tolerance, &mut record).map_err(damaged)?;
        clock.record(&mut record).map_err(damaged)?;
        let Record::Read(rest) = record else {
            return refuse("internal fault: the serialized state was not read to its end".into());
        };
        let component = component.read_snapshot(rest)?;
        if !component.is_initialized() && !matches!(phase, Phase::Instantiated | Phase::Initialization) {
            return refuse(format!(
                "the serialized state is damaged: the status of the saved FMU instance is '{}', but the saved model \
                 is not initialised",
                phase.name()
            ));
        }
        Ok(Saved { phase, awaits_event, set_up, tolerance, clock, component })
    }
}

fn record_tolerance(tolerance: &mut Option<f64>, record: &mut Record) -> Result<(), Damaged> {
    record.option("tolerance", tolerance, || 0.0, |record, tolerance| record.positive("tolerance", tolerance))
}

fn damaged(damaged: Damaged) -> Refusal {
    Refusal::error(format!("the serialized state is damaged: {}", damaged.0))
}
