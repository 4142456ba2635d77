//! Common parts of the tests: the definitions in the repository, and a simulation whose errors end the test.
#![allow(clippy::unwrap_used)]

pub mod definition;
pub mod examples;
pub mod numeric;
pub mod oracle;

use linkage_fmu::mechanism::Model;
use linkage_fmu::simulation::{Settable, Simulation};
use linkage_fmu::variables::{Causality, Kind, Reference};
use nalgebra::Vector2;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::ops::{Deref, DerefMut};
use std::sync::Mutex;

pub type Vec2 = Vector2<f64>;

macro_rules! mechanism {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/", $name, "/resources/mechanism.json"))
    };
}

pub const ANDREWS: &str = mechanism!("AndrewsSqueezer");
pub const CHAIN: &str = mechanism!("FourBarChain");
pub const CRANE: &str = mechanism!("CraneJib");
pub const FOUR_BAR: &str = mechanism!("FourBar");
pub const GEAR: &str = mechanism!("LandingGearRetraction");
pub const HYDRAULIC_GEAR: &str = mechanism!("LandingGearRetractionHydraulic");
pub const JIB: &str = mechanism!("Jib");
pub const MAIN_GEAR: &str = mechanism!("MainGear");
pub const SL_CRANK: &str = mechanism!("SlCrank");
pub const SLIDER_CRANK: &str = mechanism!("SliderCrank");
pub const SMOOTH: &str = mechanism!("SmoothRetraction");
pub const TAILGATE: &str = mechanism!("Tailgate");

/// A slider-crank with a drive `servo` on its crank and a drive `ram` on its slider.
pub const TWO_DRIVES: &str = include_str!("../fixtures/two_drives.json");

/// A slider-crank with drives, dampers, a spring and a bumper that have curves.
pub const CURVES: &str = include_str!("../fixtures/curves.json");

/// Bucket of an excavator: a four-bar linkage with friction in its pins. Friction can lock it against its cylinder.
pub const BUCKET: &str = include_str!("../fixtures/excavator_bucket.json");

/// A definition after a change. Its keys are then in alphabetical order.
pub fn changed(definition: impl Display, change: impl FnOnce(&mut Value)) -> String {
    let mut value: Value = serde_json::from_str(&definition.to_string()).unwrap();
    change(&mut value);
    value.to_string()
}

/// A definition with pieces of its text replaced.
pub fn replaced(text: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no {from} in the definition");
        text.replace(from, to)
    })
}

/// The gear without its stops.
pub fn without_stops() -> String {
    replaced(GEAR, &[("\"flag\"", "\"enabled\": false, \"flag\"")])
}

/// A vector turned by an angle [rad].
pub fn turned(a: Vec2, angle: f64) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    Vec2::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y)
}

/// Numbers of a group in a file of reference values.
pub fn numbers<T: DeserializeOwned>(file: &str, group: &str) -> T {
    let file: Value = serde_json::from_str(file).unwrap();
    serde_json::from_value(file[group].clone()).unwrap()
}

/// The error message of reading or starting a definition.
#[track_caller]
pub fn refusal(definition: impl Display) -> String {
    let text = definition.to_string();
    let opened = Simulation::open(&text).and_then(|mut simulation| simulation.initialize());
    opened.map_or_else(|error| error.to_string(), |()| panic!("accepted: {text}"))
}

/// A definition is accepted, and each of its changes in a group of `tests/fixtures/refusals.json` is rejected in one
/// line. A row has the changed keys with their values, where null removes a key, and pieces of the message.
#[track_caller]
pub fn assert_rejected(group: &str, definition: impl Display) {
    let rows: Vec<(Map<String, Value>, Vec<String>)> = numbers(include_str!("../fixtures/refusals.json"), group);
    assert!(!rows.is_empty());
    let definition = definition.to_string();
    Run::new(&definition).initialize();
    for (changes, pieces) in rows {
        let message =
            refusal(changed(&definition, |all| changes.iter().for_each(|(path, value)| change(all, path, value))));
        assert!(!message.contains('\n'), "more than one line: {message}");
        pieces.iter().for_each(|piece| assert!(message.contains(piece), "{changes:?}: `{message}` lacks `{piece}`"));
    }
}

/// Set or remove the value at a path with dots.
fn change(mut within: &mut Value, path: &str, value: &Value) {
    let (parents, key) = path.rsplit_once('.').map_or((None, path), |(parents, key)| (Some(parents), key));
    for parent in parents.into_iter().flat_map(|parents| parents.split('.')) {
        within = match within {
            Value::Array(list) => &mut list[parent.parse::<usize>().unwrap()],
            object => &mut object[parent],
        };
    }
    match (within, value) {
        (Value::Object(object), Value::Null) => _ = object.remove(key).unwrap(),
        (Value::Array(list), value) => list[key.parse::<usize>().unwrap()] = value.clone(),
        (object, value) => object[key] = value.clone(),
    }
}

/// A value agrees with the expected value, with this absolute tolerance.
#[track_caller]
pub fn assert_near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((value - expected).abs() <= tolerance, "{what}: {value} instead of {expected}");
}

/// The message contains all of these pieces.
#[track_caller]
pub fn assert_says(message: impl ToString, pieces: &[&str]) {
    let message = message.to_string();
    pieces.iter().for_each(|piece| assert!(message.contains(piece), "`{message}` lacks `{piece}`"));
}

/// Number of random cases of each kind that the environment variable sets.
pub fn cases() -> Option<u32> {
    std::env::var("LINKAGE_FMU_CASES").ok().map(|text| text.parse().unwrap())
}

/// Random cases: `default` cases from a fixed seed, or the number of the environment variable from another seed.
pub fn runner(default: u32) -> TestRunner {
    let asked = cases();
    let config = Config { cases: asked.unwrap_or(default), failure_persistence: None, ..Config::default() };
    match asked {
        Some(_) => TestRunner::new(config),
        None => TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha)),
    }
}

/// The Reals of this causality.
pub fn reals(model: &Model, causality: Causality) -> Vec<Reference> {
    let list = model.variables().list().iter().zip(0..);
    list.filter(|(v, _)| v.causality == causality && v.kind == Kind::Real).map(|(_, reference)| reference).collect()
}

/// Values of these Reals, all of which must have one.
#[track_caller]
pub fn values(model: &mut Model, references: &[Reference]) -> Vec<f64> {
    let mut value = |reference| {
        let value = model.real(reference).unwrap();
        let reason = if value.is_finite() { None } else { model.undefined(reference) };
        assert!(value.is_finite(), "{}: {reason:?}", model.variables().list()[reference as usize].name);
        value
    };
    references.iter().map(|&reference| value(reference)).collect()
}

/// Read every output, like a host that records all of them. Each Real is finite, or is NaN with a reason. A drive has a
/// force without a value if and only if friction locks the mechanism against this drive. Returns the Reals without a
/// value.
#[track_caller]
pub fn read_all(model: &mut Model) -> Vec<String> {
    let list = model.variables().list().to_vec();
    let mut undefined = Vec::new();
    for (variable, reference) in list.iter().zip(0..).filter(|(v, _)| v.causality == Causality::Output) {
        let name = &variable.name;
        if variable.kind == Kind::Real {
            let value = model.real(reference).unwrap_or_else(|e| panic!("{name}: {e}"));
            let reason = model.undefined(reference);
            assert!(
                value.is_finite() && reason.is_none() || value.is_nan() && reason.is_some(),
                "{name} {value} {reason:?}"
            );
            undefined.extend(reason.map(|_| name.clone()));
        }
    }
    for (variable, reference) in list.iter().zip(0..).filter(|(v, _)| v.kind == Kind::Boolean) {
        let value = model.boolean(reference).unwrap_or_else(|e| panic!("{}: {e}", variable.name));
        if let Some(drive) = variable.name.strip_suffix(".self_locking") {
            let forces = |name: &&String| {
                let term = name.strip_prefix(drive).unwrap_or_default();
                term == ".required_force" || term.starts_with(".breakaway_")
            };
            let locked = undefined.iter().filter(forces).count() > 0;
            assert_eq!(value, locked, "{}: {undefined:?}", variable.name);
        }
    }
    undefined
}

/// A simulation in which every call must succeed. The calls of `.0` return their errors.
#[derive(Clone)]
pub struct Run(pub Simulation);

impl Run {
    #[track_caller]
    pub fn new(definition: impl Display) -> Self {
        Self(Simulation::open(&definition.to_string()).unwrap_or_else(|e| panic!("{e}")))
    }

    /// A definition with pieces of its text replaced.
    #[track_caller]
    pub fn replaced(definition: &str, changes: &[(&str, &str)]) -> Self {
        Self::new(replaced(definition, changes))
    }

    /// A model of a definition that is read once for all tests, so that its tables are built once.
    pub fn shared(definition: &str) -> Self {
        static RUNS: Mutex<BTreeMap<String, Run>> = Mutex::new(BTreeMap::new());
        RUNS.lock().unwrap().entry(definition.to_owned()).or_insert_with(|| Self::new(definition)).clone()
    }

    /// The landing gear, read once.
    pub fn gear() -> Self {
        Self::shared(GEAR)
    }

    #[track_caller]
    pub fn get(&mut self, name: &str) -> f64 {
        let value = self.0.get(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(value.is_finite(), "{name}: {:?}", self.0.undefined(name));
        value
    }

    /// The output has this value, with this absolute tolerance.
    #[track_caller]
    pub fn near(&mut self, name: &str, expected: f64, allowed: f64) {
        let value = self.get(name);
        let error = (value - expected).abs();
        assert!(error <= allowed, "{name} = {value:e}, not {expected:e}: error {error:.2e}, allowed {allowed:.2e}");
    }

    /// Force of a joint or a coupling on its second body.
    #[track_caller]
    pub fn force(&mut self, joint: &str) -> Vec2 {
        Vec2::new(self.get(&format!("{joint}.force_x")), self.get(&format!("{joint}.force_y")))
    }

    /// Bits of outputs.
    #[track_caller]
    pub fn bits<const N: usize>(&mut self, names: [&str; N]) -> [u64; N] {
        names.map(|name| self.get(name).to_bits())
    }

    /// The warnings of the model.
    pub fn warnings(&self) -> Vec<String> {
        self.0.model().warnings().iter().map(ToString::to_string).collect()
    }

    /// The present state in bytes.
    pub fn saved(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.snapshot().write(&mut bytes).unwrap();
        bytes
    }

    /// Restore a state from bytes.
    #[track_caller]
    pub fn take(&mut self, bytes: &[u8]) {
        let state = self.read_snapshot(bytes).unwrap_or_else(|e| panic!("{e}"));
        self.restore(&state).unwrap_or_else(|e| panic!("{e}"));
    }

    /// Save the state, advance, restore the state, advance: all values are identical both times, and in another run
    /// that reads the state. The run ends after the advance.
    #[track_caller]
    pub fn repeats(&mut self, mut advance: impl FnMut(&mut Self)) {
        let saved = self.saved();
        let mut other = self.clone();
        other.reset();
        other.initialize();
        advance(self);
        let expected = self.all();
        for run in [self, &mut other] {
            run.take(&saved);
            advance(run);
            assert_eq!(run.all(), expected);
        }
    }

    /// The bits of all Reals that are no parameters.
    pub fn all(&mut self) -> Vec<(String, u64)> {
        let list = self.variables().list().to_vec();
        let own = list.iter().zip(0..).filter(|(v, _)| v.kind == Kind::Real && v.causality != Causality::Parameter);
        own.map(|(v, reference)| (v.name.clone(), self.real(reference).unwrap().to_bits())).collect()
    }

    /// The reason why this output is NaN.
    #[track_caller]
    pub fn undefined(&mut self, name: &str) -> String {
        let value = self.0.get(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(value.is_nan(), "{name} = {value}");
        self.0.undefined(name).unwrap().unwrap_or_else(|| panic!("{name}: no reason"))
    }

    #[track_caller]
    pub fn is(&mut self, name: &str) -> bool {
        self.0.boolean(name).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    #[track_caller]
    pub fn set(&mut self, name: &str, value: impl Settable) {
        self.0.set(name, value).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    #[track_caller]
    pub fn set_all<T: Settable + Copy>(&mut self, values: &[(&str, T)]) {
        values.iter().for_each(|(name, value)| self.set(name, *value));
    }

    /// The simulation with these values.
    #[track_caller]
    pub fn with<T: Settable + Copy>(mut self, values: &[(&str, T)]) -> Self {
        self.set_all(values);
        self
    }

    #[track_caller]
    pub fn initialize(&mut self) {
        self.0.initialize().unwrap_or_else(|e| panic!("{e}"));
    }

    /// The simulation at its start.
    #[track_caller]
    pub fn started(mut self) -> Self {
        self.initialize();
        self
    }

    /// Set the start position and the start speed of a body or joint.
    #[track_caller]
    pub fn place(&mut self, position: (&str, f64), speed: (&str, f64)) {
        self.set_all(&[position, speed]);
        self.initialize();
    }

    /// Set a derivative of an input for the next step.
    #[track_caller]
    pub fn set_derivative(&mut self, name: &str, order: i32, value: f64) {
        self.0.set_derivative(name, order, value).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    /// Rate of an output.
    #[track_caller]
    pub fn derivative(&mut self, name: &str) -> f64 {
        let rate = self.0.derivative(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(rate.is_finite(), "{name}: no rate");
        rate
    }

    #[track_caller]
    pub fn step(&mut self, h: f64) {
        self.0.step(h).unwrap_or_else(|e| panic!("{e}"));
    }

    /// A time span in this number of equal steps.
    #[track_caller]
    pub fn steps(&mut self, count: u32, span: f64) {
        (0..count).for_each(|_| self.step(span / f64::from(count)));
    }

    /// Equal steps over a time span, in which an input is `value + rate t + second t^2 / 2`. `check` gets the time
    /// after each step.
    #[track_caller]
    pub fn follow(
        &mut self,
        input: &str,
        [value, rate, second]: [f64; 3],
        (count, span): (u32, f64),
        mut check: impl FnMut(&mut Self, f64),
    ) {
        let h = span / f64::from(count);
        for k in 0..count {
            let t = h * f64::from(k);
            self.set(input, value + t * (rate + 0.5 * t * second));
            self.set_derivative(input, 1, rate + t * second);
            self.set_derivative(input, 2, second);
            self.step(h);
            check(self, t + h);
        }
    }

    /// The error message of the initialisation.
    #[track_caller]
    pub fn refusal(&mut self) -> String {
        self.0.initialize().unwrap_err().to_string()
    }
}

impl Deref for Run {
    type Target = Model;

    fn deref(&self) -> &Model {
        self.0.model()
    }
}

impl DerefMut for Run {
    fn deref_mut(&mut self) -> &mut Model {
        self.0.model_mut()
    }
}
