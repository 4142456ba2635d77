//! A saved state: what it holds besides the model's snapshot, and its serialised form. Safe code.
//!
//! In: an instance, or bytes. Out: bytes, or a state that can be restored. The serialised form, little-endian throughout:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `linkFMUs` |
//! | 4 | version of the form, 3 |
//! | 8 | number of bytes, all of them |
//! | 8 | hash of the GUID: the interface |
//! | 8 | hash of what of mechanism.json is neither parameter nor input nor text |
//! | 1, 1 | phase, whether the experiment was set up |
//! | 1 or 9 | whether the experiment has a tolerance, the tolerance |
//! | 17 or 25 | start time, time, whether there is a stop time, stop time |
//! | n | the model: parameters, inputs, the state of motion with the memory of its integration |
//! | 4 | CRC-32 of all before |

use super::clock::Clock;
use super::phase::Phase;
use super::refusal::Refusal;
use crate::codec::checksum::crc32;
use crate::codec::record::{Damaged, Record};
use crate::mechanism::{Model, Snapshot};

const MAGIC: [u8; 8] = *b"linkFMUs";
const VERSION: u32 = 4;
/// Bytes of magic, version, length and the two hashes.
const HEADER: usize = 36;
/// Bytes of the check sum.
const CHECK: usize = 4;

/// Everything that decides what an instance does from here on.
#[derive(Clone, Debug)]
pub struct Saved {
    pub phase: Phase,
    pub set_up: bool,
    pub tolerance: Option<f64>,
    pub clock: Clock,
    pub model: Snapshot,
}

impl Saved {
    /// Serialised, for a mechanism of this identity.
    ///
    /// # Errors
    /// A count of work done is near overflow.
    pub fn to_bytes(&self, identity: [u64; 2]) -> Result<Vec<u8>, Refusal> {
        let mut bytes = Vec::new();
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&[0; 8]);
        identity.iter().for_each(|hash| bytes.extend_from_slice(&hash.to_le_bytes()));
        bytes.extend_from_slice(&[self.phase as u8, u8::from(self.set_up)]);
        let mut record = Record::Write(&mut bytes);
        record_tolerance(&mut self.tolerance.clone(), &mut record).map_err(damaged)?;
        self.clock.clone().record(&mut record).map_err(damaged)?;
        self.model.write(&mut bytes)?;
        let length = (bytes.len() + CHECK) as u64;
        bytes[12..20].copy_from_slice(&length.to_le_bytes());
        let check = crc32(&bytes);
        bytes.extend_from_slice(&check.to_le_bytes());
        Ok(bytes)
    }

    /// The state that these bytes tell, for an instance with this model.
    ///
    /// # Errors
    /// Another form or version, bytes that are missing, too many or changed, another mechanism, a value that cannot be.
    pub fn from_bytes(bytes: &[u8], model: &Model) -> Result<Self, Refusal> {
        let refuse = |what: String| Err(Refusal::error(what));
        if bytes.get(..8) != Some(&MAGIC) {
            return refuse(
                "the bytes are no state of this kind of FMU; pass what fmi2SerializeFMUstate gave".to_owned(),
            );
        }
        let number = |range: std::ops::Range<usize>| {
            let field = bytes.get(range).unwrap_or_default();
            field.iter().rev().fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte))
        };
        if bytes.len() < HEADER + CHECK {
            return refuse(format!("the state is cut off: {} bytes are not even its header", bytes.len()));
        }
        let version = number(8..12);
        if version != u64::from(VERSION) {
            return refuse(format!("the state has the version {version}; this library reads version {VERSION}"));
        }
        let length = number(12..20);
        if length != bytes.len() as u64 {
            let what = if length > bytes.len() as u64 { "cut off" } else { "too long" };
            return refuse(format!("the state is {what}: it has {length} bytes, and {} were passed", bytes.len()));
        }
        let (all, check) = bytes.split_at(bytes.len() - CHECK);
        if check != crc32(all).to_le_bytes() {
            return refuse("the state is damaged: its check sum is wrong".to_owned());
        }
        let identity = [number(20..28), number(28..36)];
        if identity[0] != model.identity()[0] {
            return refuse("the state was saved by another FMU: its GUID is not that of this one".to_owned());
        }
        if identity[1] != model.identity()[1] {
            let what =
                "the state was saved with another mechanism.json, that differs in more than parameters and inputs";
            return refuse(what.to_owned());
        }
        let mut record = Record::Read(&all[HEADER..]);
        let (mut phase, mut set_up, mut tolerance, mut clock) = (0, false, None, Clock::default());
        record.choice("phase", &mut phase, 256).map_err(damaged)?;
        let Some(phase) = Phase::of_bit(phase) else { return refuse(format!("phase = {phase}: there is none such")) };
        record.flag("set up", &mut set_up).map_err(damaged)?;
        record_tolerance(&mut tolerance, &mut record).map_err(damaged)?;
        clock.record(&mut record).map_err(damaged)?;
        let Record::Read(rest) = record else {
            return refuse("a state that is read became one that is written".into());
        };
        let model = model.read_snapshot(rest)?;
        if !model.has_motion() && !matches!(phase, Phase::Instantiated | Phase::Initialization) {
            return refuse(format!("phase = '{}', but the state is not initialised", phase.name()));
        }
        Ok(Saved { phase, set_up, tolerance, clock, model })
    }
}

fn record_tolerance(tolerance: &mut Option<f64>, record: &mut Record) -> Result<(), Damaged> {
    record.option("tolerance", tolerance, || 0.0, |record, tolerance| record.positive("tolerance", tolerance))
}

fn damaged(damaged: Damaged) -> Refusal {
    Refusal::error(format!("the state is damaged: {damaged}"))
}
