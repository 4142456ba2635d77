//! The mechanisms of the stress suite, and the changes that a scene makes.
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value};
use std::borrow::Cow;

/// A reference value from another source.
pub struct Known {
    /// Time [s].
    pub time: f64,
    /// Angle of the coordinate at that time [rad].
    pub value: f64,
    /// Its uncertainty [rad].
    pub within: f64,
}

/// One of the mechanisms in `modelDescription/`.
pub struct Mechanism {
    /// Its name.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
    /// Body whose angle determines the position through all of the motion, and is compared.
    pub body: &'static str,
    /// Span of a scene [s].
    pub span: f64,
    /// Communication steps in the span, as in its default experiment.
    pub steps: u64,
    /// Input that scenes change.
    pub input: &'static str,
    /// Prismatic joint, if it has one.
    pub slide: Option<&'static str>,
    /// Exact values, where there are any.
    pub known: &'static [Known],
}

/// Defaults of the rows of the table; those for the mechanisms with a jib under a cylinder.
const PLAIN: Mechanism = Mechanism {
    name: "",
    text: "",
    body: "crank",
    span: 1.0,
    steps: 1000,
    input: "drive.torque",
    slide: None,
    known: &[],
};
const JIB_LIKE: Mechanism = Mechanism { body: "jib", input: "cylinder.force", ..PLAIN };

/// Every mechanism; the gear's span is that of scene S1 up to its last reference value.
pub static MECHANISMS: [Mechanism; 8] = [
    Mechanism {
        name: "LandingGearRetraction",
        text: example!("LandingGearRetraction"),
        span: 0.13,
        steps: 130,
        input: "actuator.force",
        // Energy quadrature with 34 digits.
        known: &[
            Known { time: 0.02, value: 0.754_575_037_883_200_4, within: 1e-15 },
            Known { time: 0.05, value: 0.509_301_986_703_906_5, within: 1e-15 },
            Known { time: 0.10, value: -0.409_135_231_200_168_4, within: 1e-15 },
            Known { time: 0.13, value: -1.237_711_726_689_136_7, within: 1e-15 },
        ],
        ..PLAIN
    },
    Mechanism {
        name: "AndrewsSqueezer",
        text: example!("AndrewsSqueezer"),
        body: "K1",
        span: 0.03,
        steps: 300,
        known: &[Known { time: 0.03, value: 15.810_771_195_153_797, within: 4e-15 }],
        ..PLAIN
    },
    Mechanism { name: "CraneJib", text: example!("CraneJib"), span: 5.0, steps: 500, ..JIB_LIKE },
    Mechanism { name: "FourBar", text: example!("FourBar"), ..PLAIN },
    Mechanism {
        name: "FourBarChain",
        text: example!("FourBarChain"),
        body: "bar0",
        span: 10.0,
        input: "load_factor",
        // pi/2 - 2 am(t/2 | -4 k), k = 9.81 (3/2 + 2) / (1 + 2).
        known: &[Known { time: 10.0, value: -30.179_800_860_191_205, within: 1e-14 }],
        ..PLAIN
    },
    Mechanism { name: "Jib", text: example!("Jib"), span: 3.0, steps: 300, ..JIB_LIKE },
    Mechanism {
        name: "SlCrank",
        text: example!("SlCrank"),
        span: 10.0,
        input: "push.force_x",
        slide: Some("slide"),
        known: &[Known { time: 10.0, value: 1.275_675_848_650, within: 1e-12 }],
        ..PLAIN
    },
    Mechanism {
        name: "SliderCrank",
        text: example!("SliderCrank"),
        span: 0.2,
        steps: 400,
        slide: Some("cylinder"),
        ..PLAIN
    },
];

/// The landing gear.
pub static GEAR: &Mechanism = &MECHANISMS[0];
/// The chain of four-bars.
pub static CHAIN: &Mechanism = &MECHANISMS[4];
/// A single body.
pub static JIB: &Mechanism = &MECHANISMS[5];

/// Factors on the units of mass, length and time.
///
/// The equations of motion are homogeneous: with every quantity of unit kg^a m^b s^c multiplied by mass^a length^b
/// time^c the motion has the same angles at times multiplied by `time`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// On masses.
    pub mass: f64,
    /// On lengths.
    pub length: f64,
    /// On times.
    pub time: f64,
}

impl Scaling {
    /// None.
    pub const ONE: Self = Self { mass: 1.0, length: 1.0, time: 1.0 };

    fn factor(self, unit: Unit) -> f64 {
        let [kg, m, s, _] = unit.base().map(|(_, exponent)| exponent.into());
        self.mass.powi(kg) * self.length.powi(m) * self.time.powi(s)
    }

    /// On energies.
    pub fn energy(self) -> f64 {
        self.mass * (self.length / self.time).powi(2)
    }
}

/// A mechanism with the changes of a scene.
#[derive(Clone)]
pub struct Case {
    /// The mechanism.
    pub mechanism: &'static Mechanism,
    /// Its file with changes, if any.
    pub text: Option<String>,
    /// Values of parameters and inputs, before scaling.
    pub set: Vec<(String, f64)>,
    /// Values of Booleans.
    pub flags: Vec<(String, bool)>,
    /// Factors on all Reals, after that.
    pub scaling: Scaling,
}

impl Case {
    /// The mechanism without changes.
    pub fn of(mechanism: &'static Mechanism) -> Self {
        Self { mechanism, text: None, set: Vec::new(), flags: Vec::new(), scaling: Scaling::ONE }
    }

    /// With this value of a Real.
    pub fn with(mut self, name: impl Into<String>, value: f64) -> Self {
        self.set.push((name.into(), value));
        self
    }

    /// With this value of a Boolean.
    pub fn turned(mut self, name: &str, value: bool) -> Self {
        self.flags.push((name.into(), value));
        self
    }

    /// With another text.
    pub fn text(mut self, text: String) -> Self {
        self.text = Some(text);
        self
    }

    /// With other units.
    pub fn scaled(mut self, scaling: Scaling) -> Self {
        self.scaling = scaling;
        self
    }

    /// Without the gear's stops.
    pub fn free(self) -> Self {
        self.turned("upstop.enabled", false).turned("downstop.enabled", false)
    }

    /// The model at its start.
    pub fn model(&self, tolerance: f64) -> Result<Model, String> {
        let words = |e: linkage_fmu::mechanism::ModelError| e.to_string();
        let text = self.text.as_deref().unwrap_or(self.mechanism.text);
        // A guess in metres is no parameter: all lengths are then scaled in the text.
        let guessed = self.mechanism.slide.is_some() && self.scaling.length != 1.0;
        let text = if guessed { Cow::Owned(stretched(text, self.scaling.length)) } else { Cow::Borrowed(text) };
        let mut model = Model::from_json(&text).map_err(words)?;
        for (name, value) in &self.set {
            set(&mut model, name, *value)?;
        }
        for (name, value) in &self.flags {
            let reference = find(&model, name)?;
            model.set_boolean(reference, *value).map_err(words)?;
        }
        if self.scaling != Scaling::ONE {
            for (reference, factor) in self.factors(&model, guessed) {
                let value = model.real(reference).map_err(words)?;
                model.set_real(reference, value * factor).map_err(words)?;
            }
        }
        model.set_tolerance(tolerance).map_err(words)?;
        model.initialize().map_err(words)?;
        Ok(model)
    }

    /// Factor of each Real that can be set; 1 for lengths if `stretched` has scaled them.
    fn factors(&self, model: &Model, stretched: bool) -> Vec<(Reference, f64)> {
        let list = model.variables().list().iter();
        let settable = list.zip(0..).filter(|(v, _)| v.kind == Kind::Real && v.causality != Causality::Output);
        let with_unit = settable.filter_map(|(v, reference)| {
            // Settings of the solver do not belong to the mechanism and have their own ranges.
            let is_own = matches!(v.start, Some(Value::Real(_))) && !v.name.starts_with("solver.");
            is_own.then_some(())?;
            let done = stretched && matches!(v.unit, Some(Unit::Metre | Unit::KilogramSquareMetre));
            let scaling = if done { Scaling { length: 1.0, ..self.scaling } } else { self.scaling };
            v.unit.map(|unit| (reference, scaling.factor(unit)))
        });
        with_unit.collect()
    }

    /// Name of a variable of the compared body.
    pub fn own(&self, variable: &str) -> String {
        format!("{}.{variable}", self.mechanism.body)
    }
}

/// The text of a mechanism with all lengths, points and guesses in metres multiplied by `length` and moments of inertia
/// by its square, for the keys that occur in mechanisms with a prismatic joint.
fn stretched(text: &str, length: f64) -> String {
    const KEYS: [(&str, i32); 7] =
        [("length", 1), ("free_length", 1), ("middle", 1), ("far", 1), ("slide", 1), ("cylinder", 1), ("inertia", 2)];
    let mut out = text.to_owned();
    for (key, power) in KEYS {
        let factor = length.powi(power);
        let head = format!("\"{key}\": ");
        let parts: Vec<String> = out.split(&head).map(str::to_owned).collect();
        let numbers = |part: &String| {
            let end = if part.starts_with('[') { part.find(']') } else { part.find([',', ' ', '\n', '}']) };
            let (value, rest) = part.split_at(end.unwrap_or(0));
            let scaled = value.trim_start_matches('[').split(", ").map(|x| x.parse().map(|x: f64| x * factor));
            match scaled.collect::<Result<Vec<f64>, _>>() {
                Ok(scaled) if value.starts_with('[') => format!("{scaled:?}").trim_end_matches(']').to_owned() + rest,
                Ok(scaled) => format!("{:e}", scaled[0]) + rest,
                // The key of an object.
                Err(_) => part.clone(),
            }
        };
        out = parts[..1].iter().cloned().chain(parts[1..].iter().map(numbers)).collect::<Vec<_>>().join(&head);
    }
    out
}

/// Reference of a variable.
pub fn find(model: &Model, name: &str) -> Result<Reference, String> {
    model.variables().find(name).ok_or_else(|| format!("no variable {name}"))
}

/// Value of a Real.
pub fn get(model: &mut Model, name: &str) -> Result<f64, String> {
    let reference = find(model, name)?;
    let value = model.real(reference).map_err(|e| e.to_string())?;
    if value.is_nan() { Err(model.undefined(reference).unwrap_or_default()) } else { Ok(value) }
}

/// Set a Real.
pub fn set(model: &mut Model, name: &str, value: f64) -> Result<(), String> {
    let reference = find(model, name)?;
    model.set_real(reference, value).map_err(|e| e.to_string())
}
