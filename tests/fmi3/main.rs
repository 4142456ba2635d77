//! Tests through the C interface of FMI 3.0.2, partly against the same calls of FMI 2.0.
#![allow(unsafe_code, clippy::unwrap_used)]

#[allow(dead_code)]
#[path = "../support/definition.rs"]
mod definition;
mod events;
mod exchange;
#[path = "../fmi2/host.rs"]
mod fmi2;
mod messages;
mod prescribed;
mod step;
mod updates;
mod vectors;

use fmi2::Folder;
use linkage_fmu::fmi2::host::{Description, State};
use linkage_fmu::fmi3::host::{Host, Wishes};
use linkage_fmu::fmi3::types::{Status, ValueReference};
use std::ops::Deref;
use std::sync::Arc;

/// Time [s] at which the retraction of PHYSICS.md reaches the up stop, and the speed of the crank there [rad/s].
const RETRACTED: (f64, f64) = (0.132_059_852_744_259_7, -30.257_773_253_560_312);

/// An instance with the names of its variables.
struct Fmu {
    host: Host,
    description: Arc<Description>,
}

impl Deref for Fmu {
    type Target = Host;

    fn deref(&self) -> &Host {
        &self.host
    }
}

impl Fmu {
    /// An instance of the landing gear for co-simulation.
    fn gear(wishes: Wishes) -> Self {
        let description = Arc::clone(fmi2::description());
        Self { host: Host::new(&description, wishes).unwrap(), description }
    }

    /// An instance of a definition for co-simulation.
    fn of(definition: &str, wishes: Wishes) -> Self {
        let folder = Folder::new("stepped");
        let description = folder.described(definition);
        Self { host: Host::new(&description, wishes).unwrap(), description }
    }

    /// An instance of the landing gear in step mode, without event mode.
    fn stepping() -> Self {
        let gear = Self::gear(Wishes::default());
        gear.initialize(1e-9);
        gear
    }

    /// An instance of a definition for model exchange.
    fn exchanging(definition: &str) -> Self {
        let folder = Folder::new("exchanged");
        let description = folder.described(definition);
        Self { host: Host::exchange(&description, false).unwrap(), description }
    }

    fn initialize(&self, tolerance: f64) {
        assert_eq!((self.enter(Some(tolerance), 0.0, None), self.exit()), (Status::Ok, Status::Ok));
    }

    /// Value reference of a variable. The reference of the time is the number of scalars, and the vectors follow.
    fn vr(&self, name: &str) -> ValueReference {
        let list = self.description.interface().list();
        let scalars = list.iter().map(|v| v.name.clone()).chain(["time".to_owned()]);
        let mut all = scalars.chain(self.description.vectors().into_iter().map(|vector| vector.name));
        all.position(|other| other == name).unwrap() as ValueReference
    }

    fn vrs<const N: usize>(&self, names: [&str; N]) -> [ValueReference; N] {
        names.map(|name| self.vr(name))
    }

    fn read<const N: usize>(&self, references: &[ValueReference; N]) -> [f64; N] {
        let mut values = [f64::NAN; N];
        assert_eq!(self.reals(references, &mut values), Status::Ok);
        values
    }

    fn get<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        self.read(&self.vrs(names))
    }

    fn set(&self, name: &str, value: f64) -> Status {
        self.set_reals(&[self.vr(name)], &[value])
    }

    fn save(&self) -> State {
        let mut state = State::NONE;
        assert_eq!(self.save_into(&mut state), Status::Ok);
        state
    }

    /// A step that reaches its end.
    fn whole_step(&self, point: f64, h: f64) {
        let (status, stepped) = self.step(point, h);
        assert_eq!((status, stepped.event, stepped.terminate, stepped.early), (Status::Ok, false, false, false));
        assert_eq!(stepped.last, point + h);
    }
}
