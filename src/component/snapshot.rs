//! The complete state of a component: saved and restored.
//!
//! In: a component. Out: its snapshot, the bytes of a snapshot and back. Must not know: the contents of a snapshot.
use super::{Component, Refused};
use crate::hydraulics::any::AnySnapshot;
use crate::mechanism;

/// All data that determine how the simulation of a component continues.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// [`Component::identity`] of the component.
    identity: [u64; 2],
    of: Kind,
}

#[expect(clippy::large_enum_variant, reason = "the calls of a mechanism pay for no indirection")]
#[derive(Clone, Debug)]
enum Kind {
    Mechanism(mechanism::Snapshot),
    Hydraulic(Box<dyn AnySnapshot>),
}

#[cold]
fn of_another() -> Refused {
    Refused(
        "the saved state belongs to another model; restore a state of a model with the same definition, in which only \
         values of parameters and inputs may differ"
            .to_owned(),
    )
}

impl Component {
    /// Saves all data that determine how the simulation of the component continues.
    pub fn snapshot(&self) -> Snapshot {
        let of = match self {
            Self::Mechanism(model) => Kind::Mechanism(model.snapshot()),
            Self::Hydraulic(model) => Kind::Hydraulic(model.snapshot()),
        };
        Snapshot { identity: self.identity(), of }
    }

    /// [`Self::snapshot`] into an existing snapshot, without allocation if the snapshot has this identity, and both are
    /// in motion with the same integration method.
    #[inline]
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        match (self, &mut snapshot.of) {
            _ if snapshot.identity != self.identity() => *snapshot = self.snapshot(),
            (Self::Mechanism(model), Kind::Mechanism(snapshot)) => model.snapshot_into(snapshot),
            (Self::Hydraulic(model), Kind::Hydraulic(snapshot)) => model.snapshot_into(snapshot),
            _ => *snapshot = self.snapshot(),
        }
    }

    /// Restores a snapshot of a component with this identity.
    ///
    /// # Errors
    /// The snapshot has another identity, or the state cannot be restored. Nothing has changed.
    #[inline]
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Refused> {
        if snapshot.identity != self.identity() {
            return Err(of_another());
        }
        let is_own = match (self, &snapshot.of) {
            (Self::Mechanism(model), Kind::Mechanism(snapshot)) => model.restore(snapshot).map(|()| true)?,
            (Self::Hydraulic(model), Kind::Hydraulic(snapshot)) => model.restore(snapshot.as_ref())?,
            _ => false,
        };
        if is_own { Ok(()) } else { Err(of_another()) }
    }

    /// Reads a snapshot that [`Snapshot::write`] has written for this identity. The component is unchanged.
    ///
    /// # Errors
    /// The bytes are not a snapshot, or a value is out of range.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot, Refused> {
        let of = match self {
            Self::Mechanism(model) => Kind::Mechanism(model.read_snapshot(bytes)?),
            Self::Hydraulic(model) => Kind::Hydraulic(model.read_snapshot(bytes)?),
        };
        Ok(Snapshot { identity: self.identity(), of })
    }
}

impl Snapshot {
    /// [`Component::identity`] of the components that can restore the snapshot.
    pub fn identity(&self) -> [u64; 2] {
        self.identity
    }

    /// Whether the component was initialised.
    pub fn is_initialized(&self) -> bool {
        match &self.of {
            Kind::Mechanism(snapshot) => snapshot.has_motion(),
            Kind::Hydraulic(snapshot) => snapshot.has_motion(),
        }
    }

    /// Writes all fields, which do not change.
    ///
    /// # Errors
    /// A work counter is near overflow.
    pub fn write(&mut self, out: &mut Vec<u8>) -> Result<(), Refused> {
        match &mut self.of {
            Kind::Mechanism(snapshot) => Ok(snapshot.write(out)?),
            Kind::Hydraulic(snapshot) => Ok(snapshot.write(out)?),
        }
    }
}
