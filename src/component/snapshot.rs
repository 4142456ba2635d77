//! The complete state of a component: saved and restored.
//!
//! In: a component. Out: its snapshot, the bytes of a snapshot and back. It must not know the contents of a snapshot.
use super::{Component, Refused};
use crate::hydraulics::any::AnySnapshot;
use crate::mechanism;

/// All that decides how a component goes on.
#[expect(clippy::large_enum_variant, reason = "the calls of a mechanism pay for no indirection")]
#[derive(Clone, Debug)]
pub enum Snapshot {
    /// Of a mechanism.
    Mechanism(mechanism::Snapshot),
    /// Of a hydraulic model.
    Hydraulic(Box<dyn AnySnapshot>),
}

impl Component {
    /// All that decides how the component goes on.
    pub fn snapshot(&self) -> Snapshot {
        match self {
            Self::Mechanism(model) => Snapshot::Mechanism(model.snapshot()),
            Self::Hydraulic(model) => Snapshot::Hydraulic(model.snapshot()),
        }
    }

    /// [`Self::snapshot`] into an existing snapshot of this identity, without allocation if both are in motion by the
    /// same method.
    #[inline]
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        match (self, snapshot) {
            (Self::Mechanism(model), Snapshot::Mechanism(snapshot)) => model.snapshot_into(snapshot),
            (Self::Hydraulic(model), Snapshot::Hydraulic(snapshot)) => model.snapshot_into(snapshot),
            (component, snapshot) => *snapshot = component.snapshot(),
        }
    }

    /// Go on from a snapshot of a component of this identity.
    ///
    /// # Errors
    /// The state cannot be taken; nothing has changed.
    #[inline]
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Refused> {
        let is_own = match (self, snapshot) {
            (Self::Mechanism(model), Snapshot::Mechanism(snapshot)) => model.restore(snapshot).map(|()| true)?,
            (Self::Hydraulic(model), Snapshot::Hydraulic(snapshot)) => model.restore(snapshot.as_ref())?,
            _ => false,
        };
        match is_own {
            true => Ok(()),
            false => Err(Refused("the saved state belongs to another type of model".to_owned())),
        }
    }

    /// Read a snapshot that [`Snapshot::write`] has written for this identity. The component is unchanged.
    ///
    /// # Errors
    /// The bytes are no snapshot, or a value is out of range.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot, Refused> {
        match self {
            Self::Mechanism(model) => Ok(Snapshot::Mechanism(model.read_snapshot(bytes)?)),
            Self::Hydraulic(model) => Ok(Snapshot::Hydraulic(model.read_snapshot(bytes)?)),
        }
    }
}

impl Snapshot {
    /// Whether the component was initialised.
    pub fn is_initialized(&self) -> bool {
        match self {
            Self::Mechanism(snapshot) => snapshot.has_motion(),
            Self::Hydraulic(snapshot) => snapshot.has_motion(),
        }
    }

    /// Write all fields, which stay as they are.
    ///
    /// # Errors
    /// A count of work done is near overflow.
    pub fn write(&mut self, out: &mut Vec<u8>) -> Result<(), Refused> {
        match self {
            Self::Mechanism(snapshot) => Ok(snapshot.write(out)?),
            Self::Hydraulic(snapshot) => Ok(snapshot.write(out)?),
        }
    }
}
