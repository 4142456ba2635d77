//! FMU files as the sides of a coupling, through the functions of FMI 2.0 alone: unpacked, with the description parsed
//! and the library loaded.
//!
//! In: a `.fmu` file and a folder, values by name. Out: the gear, its hydraulic actuator, an oil spring of another
//! tool. Variables are accessed by name.
use super::models::{Integrated, Mass, OilSpring};
use super::pair::{Actuator, Element, Mechanism, Motion, Pair, Preview, Refused};
use super::schemes;
use crate::measure::timed;
use linkage_fmu::fmi2::host::logger;
use linkage_fmu::fmi2::importer::{Instance, Library, State};
use linkage_fmu::fmi2::types::ValueReference;
use linkage_fmu::hydraulics::definition::Mode;
use quick_xml::events::Event;
use quick_xml::{Reader, XmlVersion};
use std::collections::HashMap;
use std::env::consts::{DLL_EXTENSION, OS};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A loaded FMU.
#[derive(Debug)]
pub struct Fmu {
    library: Arc<Library>,
    references: HashMap<String, ValueReference>,
}

/// An unpacked FMU that is not loaded.
struct Unpacked {
    library: PathBuf,
    guid: String,
    resources: String,
    references: HashMap<String, ValueReference>,
}

impl Unpacked {
    fn of(file: &Path, folder: &Path) -> Result<Self, String> {
        let refused = |reason: String| format!("{}: {reason}", file.display());
        let archive = File::open(file).map_err(|e| refused(e.to_string()))?;
        let mut archive = zip::ZipArchive::new(archive).map_err(|e| refused(e.to_string()))?;
        archive.extract(folder).map_err(|e| refused(e.to_string()))?;
        let text = std::fs::read_to_string(folder.join("modelDescription.xml")).map_err(|e| refused(e.to_string()))?;
        let (guid, identifier, references) = described(&text).map_err(refused)?;
        let platform = match OS {
            "linux" => "linux64",
            "windows" => "win64",
            _ => "darwin64",
        };
        let library = folder.join("binaries").join(platform).join(format!("{identifier}.{DLL_EXTENSION}"));
        let library = library.canonicalize().map_err(|e| refused(format!("{}: {e}", library.display())))?;
        let resources = folder.canonicalize().map_err(|e| refused(e.to_string()))?.join("resources");
        Ok(Self { library, guid, resources: format!("file://{}", resources.display()), references })
    }

    fn load(self) -> Result<Arc<Fmu>, String> {
        let library = Library::open(self.library.as_os_str(), &self.guid, &self.resources)?;
        Ok(Arc::new(Fmu { library, references: self.references }))
    }
}

/// Times [s] of the first calls in this process, for an instance with default values: loading of the library,
/// instantiation, initialisation, a step of 1 ms, reading of four Reals.
///
/// # Errors
/// As [`Fmu::open`], or a call that returns an error.
pub fn first_calls(file: &Path, folder: &Path, outputs: [&str; 4]) -> Result<[f64; 5], String> {
    let unpacked = Unpacked::of(file, folder)?;
    let mut times = [f64::INFINITY; 5];
    let [load, instantiate, initialize, step, read] = &mut times;
    let fmu = timed(load, || unpacked.load())?;
    let instance = timed(instantiate, || fmu.library.instantiate("first", Some(logger())))?;
    timed(initialize, || instance.set_up(0.0, None).and_then(|()| instance.initialize()))?;
    timed(step, || instance.step(0.0, 1e-3))?;
    let mut references = [0; 4];
    for (reference, name) in references.iter_mut().zip(outputs) {
        *reference = fmu.find(name)?;
    }
    timed(read, || instance.reals(&references))?;
    Ok(times)
}

impl Fmu {
    /// Unpack an FMU into a folder and load it.
    ///
    /// # Errors
    /// The file is no FMU for co-simulation on this platform, or cannot be unpacked.
    pub fn open(file: &Path, folder: &Path) -> Result<Arc<Self>, String> {
        Unpacked::of(file, folder)?.load()
    }

    fn find(&self, name: &str) -> Result<ValueReference, String> {
        self.references.get(name).copied().ok_or_else(|| format!("the FMU has no variable {name}"))
    }
}

/// Contents of `modelDescription.xml`: GUID, name of the library, value references.
fn described(text: &str) -> Result<(String, String, HashMap<String, ValueReference>), String> {
    let mut reader = Reader::from_str(text);
    let (mut guid, mut identifier, mut references) = (None, None, HashMap::new());
    loop {
        let element = match reader.read_event().map_err(|e| e.to_string())? {
            Event::Eof => break,
            Event::Start(element) | Event::Empty(element) => element,
            _ => continue,
        };
        let attribute = |name: &str| -> Result<Option<String>, String> {
            let found = element.try_get_attribute(name).map_err(|e| e.to_string())?;
            let value = found.map(|a| a.normalized_value(XmlVersion::Explicit1_0).map(|v| v.into_owned()));
            value.transpose().map_err(|e| e.to_string())
        };
        match element.name().as_ref() {
            "fmiModelDescription" => guid = attribute("guid")?,
            "CoSimulation" => identifier = attribute("modelIdentifier")?,
            "ScalarVariable" => {
                let name = attribute("name")?.ok_or("a ScalarVariable has no name")?;
                let reference = attribute("valueReference")?.and_then(|text| text.parse().ok());
                references.insert(name, reference.ok_or("a ScalarVariable has no valueReference")?);
            }
            _ => {}
        }
    }
    let (guid, identifier) = (guid.ok_or("no guid")?, identifier.ok_or("the FMU is not for co-simulation")?);
    Ok((guid, identifier, references))
}

/// An instance in step mode, with a saved state.
#[derive(Debug)]
struct Side {
    fmu: Arc<Fmu>,
    instance: Instance,
    state: State,
}

impl Side {
    /// An instance at its start, with values of Reals, Booleans and Enumerations by name.
    fn start(fmu: &Arc<Fmu>, reals: &[(String, f64)], flags: &[(String, bool)], mode: &str) -> Result<Self, String> {
        let instance = fmu.library.instantiate("side", Some(logger()))?;
        instance.set_up(0.0, None)?;
        for (name, value) in reals {
            instance.set_reals(&[fmu.find(name)?], &[*value])?;
        }
        for (name, value) in flags {
            instance.set_boolean(fmu.find(name)?, *value)?;
        }
        if let Some(number) = Mode::WORDS.iter().position(|word| *word == mode) {
            instance.set_integer(fmu.find("coupling.mode")?, number as i32 + 1)?;
        }
        instance.initialize()?;
        Ok(Self { fmu: Arc::clone(fmu), instance, state: State::NONE })
    }

    fn references<const N: usize>(&self, names: [&str; N]) -> Result<[ValueReference; N], Refused> {
        let mut all = [0; N];
        for (reference, name) in all.iter_mut().zip(names) {
            *reference = self.fmu.find(name)?;
        }
        Ok(all)
    }

    fn get<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], Refused> {
        self.instance.reals(&self.references(names)?)
    }

    fn set<const N: usize>(&self, names: [&str; N], values: [f64; N]) -> Result<(), Refused> {
        self.instance.set_reals(&self.references(names)?, &values)
    }

    fn set_rates<const N: usize>(&self, name: &str, rates: [f64; N]) -> Result<(), Refused> {
        self.instance.set_derivatives(self.fmu.find(name)?, &rates)
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.instance.save(&mut self.state)
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.instance.restore(&self.state)
    }
}

impl Drop for Side {
    fn drop(&mut self) {
        // The result of termination does not affect the measurement.
        let _ = self.instance.free(&mut self.state);
    }
}

const FORCE: &str = "actuator.force";
const SPEED: &str = "actuator.speed";
const ACCELERATION: &str = "actuator.acceleration";
/// Outputs of the element.
const ELEMENT: [&str; 6] = [
    "actuator.reduced_mass",
    "actuator.reduced_mass_derivative",
    "actuator.holding_force",
    "actuator.holding_force_derivative",
    "actuator.lower_limit",
    "actuator.upper_limit",
];

/// The FMU `LandingGearRetraction`.
#[derive(Debug)]
pub struct Gear(Side);

impl Gear {
    /// An instance at its start.
    pub fn start(fmu: &Arc<Fmu>, reals: &[(String, f64)], flags: &[(String, bool)]) -> Result<Self, String> {
        Side::start(fmu, reals, flags, "").map(Self)
    }
}

impl Mechanism for Gear {
    fn motion(&mut self) -> Result<Motion, Refused> {
        let [length, speed, acceleration] = self.0.get(["actuator.length", SPEED, ACCELERATION])?;
        Ok(Motion { length, speed, acceleration })
    }

    fn jerk(&mut self) -> Result<[f64; 2], Refused> {
        let [acceleration, force] = self.0.references([ACCELERATION, FORCE])?;
        Ok([self.0.instance.rate(acceleration)?, self.0.instance.derivative(acceleration, force)?])
    }

    fn element(&mut self) -> Result<Element, Refused> {
        let [mass, mass_derivative, holding, holding_derivative, lower, upper] = self.0.get(ELEMENT)?;
        Ok(Element { mass, mass_derivative, holding, holding_derivative, limits: [lower, upper] })
    }

    fn set_force(&mut self, [force, first, second]: [f64; 3]) -> Result<(), Refused> {
        self.0.set([FORCE], [force])?;
        self.0.set_rates(FORCE, [first, second])
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.0.instance.step(t, h)
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.0.save()
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.0.restore()
    }

    fn energy(&mut self) -> Result<f64, Refused> {
        Ok(self.0.get(["energy.kinetic", "energy.potential"])?.iter().sum())
    }

    fn position(&mut self) -> Result<f64, Refused> {
        Ok(self.0.get(["crank.angle"])?[0])
    }
}

/// The FMU `HydraulicActuator`, and whether a step keeps the predicted motion (one pass).
#[derive(Debug)]
pub struct Hydraulic(Side, bool);

impl Hydraulic {
    /// An instance at its start, with a value of `coupling.mode`.
    pub fn start(fmu: &Arc<Fmu>, reals: &[(String, f64)], mode: &str) -> Result<Self, String> {
        Ok(Self(Side::start(fmu, reals, &[], mode)?, mode != "follow"))
    }
}

impl Actuator for Hydraulic {
    fn set_motion(&mut self, length: f64, [speed, first, second, third, fourth]: [f64; 5]) -> Result<(), Refused> {
        self.0.set(["actuator.length", SPEED], [length, speed])?;
        self.0.set_rates(SPEED, [first, second, third, fourth])
    }

    fn force(&mut self) -> Result<f64, Refused> {
        Ok(self.0.get([FORCE])?[0])
    }

    fn force_rate(&mut self, acceleration: f64) -> Result<f64, Refused> {
        self.0.set([ACCELERATION], [acceleration])?;
        self.0.set_rates(SPEED, [acceleration])?;
        self.0.instance.rate(self.0.fmu.find(FORCE)?)
    }

    fn compliance(&mut self) -> Result<[f64; 2], Refused> {
        self.0.get(["actuator.stiffness", "actuator.damping"])
    }

    fn preview(&mut self, element: Element, h: f64, keeps: bool) -> Result<Preview, Refused> {
        if keeps != self.1 {
            return Err("coupling.mode is not that of the scheme".into());
        }
        let Element { mass, mass_derivative, holding, holding_derivative, limits: [lower, upper] } = element;
        self.0.set(ELEMENT, [mass, mass_derivative, holding, holding_derivative, lower, upper])?;
        self.0.set(["preview.horizon"], [h])?;
        let line = self.0.get(["preview.force", "preview.force_rate"])?;
        let [mean, from, to] =
            self.0.get(["preview.force_mean", "preview.start_acceleration", "preview.acceleration"])?;
        Ok(Preview { line, mean, accelerations: [from, to] })
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.0.instance.step(t, h)
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.0.save()
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.0.restore()
    }

    fn work(&mut self) -> Result<f64, Refused> {
        Ok(self.0.get(["energy.piston"])?[0])
    }
}

/// An oil spring with leakage, exported by another tool: its input is a held speed, its output the force.
#[derive(Debug)]
struct Spring(Side);

impl Actuator for Spring {
    fn set_motion(&mut self, _length: f64, [speed, ..]: [f64; 5]) -> Result<(), Refused> {
        self.0.set(["speed"], [speed])
    }

    fn force(&mut self) -> Result<f64, Refused> {
        Ok(self.0.get(["force"])?[0])
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.0.instance.step(t, h)
    }
}

/// Couple an FMU of another tool, with `speed`, `force`, `stiffness` and `leak_time`, with a mass by Jacobi coupling
/// with held inputs, and compare it with the same law in closed form. Returns the sentence with the result.
///
/// # Errors
/// The FMU returns an error, or the forces differ.
pub fn foreign(fmu: &Arc<Fmu>) -> Result<String, String> {
    const SPRING: OilSpring = OilSpring { stiffness: 1.5e6, leak_time: 0.03 };
    /// Force at the start, as in the FMU [N].
    const START: f64 = 1000.0;
    const STEP: f64 = 5e-4;
    const STEPS: u32 = 400;
    /// Allowed difference of the force relative to the start [1]: rounding of both sides over the run.
    const ALLOWED: f64 = 1e-10;
    let forces = |spring: &mut dyn Actuator| -> Result<Vec<f64>, Refused> {
        let mut mass = Mass::new(700.0, 0.0, [0.5, 0.0]);
        let mut scheme = schemes::by_name("Jacobi 0").ok_or("no Jacobi coupling")?;
        let mut pair = Pair::new(&mut mass, spring);
        let mut step = |k: u32| {
            scheme.step(&mut pair, STEP * f64::from(k), STEP)?;
            pair.actuator.force()
        };
        (0..STEPS).map(&mut step).collect()
    };
    let reals = [("stiffness".into(), SPRING.stiffness), ("leak_time".into(), SPRING.leak_time)];
    let seen = forces(&mut Spring(Side::start(fmu, &reals, &[], "")?))?;
    let exact = forces(&mut Integrated::new(SPRING, [START, 0.0, 0.0, 0.0]))?;
    let worst = seen.iter().zip(&exact).map(|(a, b)| (a - b).abs() / START).fold(0.0, f64::max);
    let last = seen.last().copied().unwrap_or_default();
    if worst.is_nan() || worst > ALLOWED {
        return Err(format!("the force differs by {worst:e} of that at the start; {ALLOWED:e} is allowed"));
    }
    Ok(format!("{STEPS} steps, force at the end {last:.6} N, largest difference from the closed form {worst:.1e}"))
}
