//! An instance of either version of FMI, with the calls common to both. Statuses are numbers, the same in both.
use linkage_fmu::fmi2::host::{Description, Host as Host2, Log, State};
use linkage_fmu::fmi2::types::{Status, ValueReference};
use linkage_fmu::fmi3::host::{Host as Host3, Stepped};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

pub const OK: i32 = Status::Ok as i32;
pub const WARNING: i32 = Status::Warning as i32;
pub const DISCARD: i32 = Status::Discard as i32;
pub const ERROR: i32 = Status::Error as i32;

/// An instance.
pub enum Host {
    Two(Host2),
    Three(Host3),
}

/// Calls common to both versions, with the same name and arguments.
macro_rules! both {
    ($($name:ident($($argument:ident: $type:ty),*)),* $(,)?) => {$(
        #[inline]
        pub fn $name(&self $(, $argument: $type)*) -> i32 {
            match self {
                Self::Two(host) => host.$name($($argument),*) as i32,
                Self::Three(host) => host.$name($($argument),*) as i32,
            }
        }
    )*};
}

/// Calls that return more than a status.
macro_rules! both_answer {
    ($($name:ident),*) => {$(
        pub fn $name(&self) -> (i32, bool) {
            match self {
                Self::Two(host) => { let (status, answer) = host.$name(); (status as i32, answer) }
                Self::Three(host) => { let (status, answer) = host.$name(); (status as i32, answer) }
            }
        }
    )*};
}

impl Host {
    both! {
        exit(),
        terminate(),
        reset(),
        enter_event_mode(),
        enter_continuous_time_mode(),
        set_time(time: f64),
        set_states(states: &[f64]),
        states(values: &mut [f64]),
        rates(values: &mut [f64]),
        indicators(values: &mut [f64]),
        nominals(values: &mut [f64]),
        reals(references: &[ValueReference], values: &mut [f64]),
        set_reals(references: &[ValueReference], values: &[f64]),
        save_into(state: &mut State),
        restore(state: &State),
        free(state: &mut State),
    }
    both_answer!(update_discrete_states, complete_step);

    pub fn log(&self) -> &Log {
        match self {
            Self::Two(host) => &host.log,
            Self::Three(host) => &host.log,
        }
    }

    /// Enter initialization mode; for FMI 2.0 after the call that sets up the experiment.
    pub fn enter(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> i32 {
        match self {
            Self::Two(host) => host.enter() as i32,
            Self::Three(host) => host.enter(tolerance, start, stop) as i32,
        }
    }

    /// A step with the outputs of fmi3DoStep; in FMI 2.0 a step is always whole.
    #[inline]
    pub fn step(&self, point: f64, h: f64) -> (i32, Stepped) {
        match self {
            Self::Two(host) => (host.step(point, h) as i32, Stepped { last: point + h, ..Stepped::default() }),
            Self::Three(host) => {
                let (status, stepped) = host.step(point, h);
                (status as i32, stepped)
            }
        }
    }

    /// Serialise and deserialise a state: the first status that is not OK.
    pub fn renew(&self, state: &mut State) -> i32 {
        match self {
            Self::Two(host) => {
                let bytes = match host.serialize(state) {
                    Ok(bytes) => bytes,
                    Err(refused) => return refused as i32,
                };
                host.free(state);
                let new = host.deserialize(&bytes);
                new.map_or_else(
                    |refused| refused as i32,
                    |new| {
                        *state = new;
                        OK
                    },
                )
            }
            Self::Three(host) => host.renew(state) as i32,
        }
    }
}

/// A model of `modelDescription/`, with its description.
pub struct Model {
    pub description: Arc<Description>,
    /// Number of its vector variables.
    pub vectors: usize,
}

/// A model by the name of its folder.
pub fn model(name: &'static str) -> Result<&'static Model, String> {
    static ALL: Mutex<BTreeMap<&str, &'static Model>> = Mutex::new(BTreeMap::new());
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.get(name) {
        return Ok(known);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription").join(name);
    let description = Description::read(&folder)?;
    let vectors = description.vectors().len();
    let model: &'static Model = Box::leak(Box::new(Model { description, vectors }));
    all.insert(name, model);
    Ok(model)
}
