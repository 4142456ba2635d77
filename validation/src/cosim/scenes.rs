//! The scenes of the coupling from `scenes/coupling.json` with their reference values, and one run of a scheme.
//!
//! In: a scene, a scheme, a communication step. Out: errors, energy at the interface, steps. Reference values: an
//! independent Taylor-series integration of mechanism and circuit as one system.
use super::circuit::Circuit;
use super::fmus::{Fmu, Gear, Hydraulic};
use super::models::Integrated;
use super::pair::{Actuator, Mechanism, Pair};
use super::schemes;
use serde_json::Value;
use std::sync::Arc;

const FILE: &str = include_str!("../../scenes/coupling.json");
/// Tolerance of both sides, as in the reference runs.
const TOLERANCE: (&str, f64) = ("solver.tolerance", 1e-12);

/// A scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// End of the run [s].
    pub span: f64,
    /// Time [s], crank angle [rad] and force [N]; empty if the element model is not exact.
    pub reference: Vec<[f64; 3]>,
    /// Errors of the angle from an earlier measurement by scheme, at the steps of the table.
    pub earlier: Value,
    gear: Vec<(String, f64)>,
    flags: Vec<(String, bool)>,
    hydraulics: Vec<(String, f64)>,
    /// Whether the load of the circuit in plain numbers is corrected by the error of the element model.
    corrects: bool,
}

/// All scenes.
pub fn all() -> Result<Vec<Scene>, String> {
    let file: Vec<Value> = serde_json::from_str(FILE).map_err(|e| e.to_string())?;
    file.iter().map(|value| Scene::read(value).ok_or_else(|| format!("no scene: {value}"))).collect()
}

/// Names with their values.
fn pairs<T>(value: &Value, of: fn(&Value) -> Option<T>) -> Option<Vec<(String, T)>> {
    value.as_object()?.iter().map(|(name, value)| Some((name.clone(), of(value)?))).collect()
}

impl Scene {
    fn read(value: &Value) -> Option<Self> {
        let rows = value["reference"].as_array().into_iter().flatten();
        let reference = rows.map(|row| Some([row[0].as_f64()?, row[1].as_f64()?, row[2].as_f64()?]));
        let [mut gear, mut hydraulics] =
            [pairs(&value["gear"], Value::as_f64)?, pairs(&value["hydraulics"], Value::as_f64)?];
        for side in [&mut gear, &mut hydraulics] {
            side.push((TOLERANCE.0.into(), TOLERANCE.1));
        }
        Some(Self {
            name: value["name"].as_str()?.into(),
            span: value["span"].as_f64()?,
            reference: reference.collect::<Option<_>>()?,
            earlier: value["earlier"].clone(),
            gear,
            flags: pairs(&value["flags"], Value::as_bool)?,
            hydraulics,
            corrects: value["corrects"].as_bool()?,
        })
    }

    /// Whether the element model is exact, so that there are reference values.
    pub fn is_exact(&self) -> bool {
        !self.reference.is_empty()
    }

    /// The circuit in plain numbers at the start of the scene.
    fn circuit(&self) -> Integrated<Circuit> {
        let (mut laws, mut x) = (Circuit::standard(), [6e6, 11.15e6, 0.0, 0.0]);
        for (name, value) in &self.hydraulics {
            match name.as_str() {
                "chamber_a.start_pressure" => x[0] = *value,
                "chamber_b.start_pressure" => x[1] = *value,
                name => laws.parameter(name).into_iter().for_each(|own| *own = *value),
            }
        }
        let mut actuator = Integrated::new(laws, x);
        actuator.corrects = self.corrects;
        actuator
    }
}

/// The FMUs of a pair; the circuit in plain numbers replaces the FMU of the hydraulics if that is None.
#[derive(Clone, Debug)]
pub struct Fmus {
    /// `LandingGearRetraction`.
    pub gear: Arc<Fmu>,
    /// `HydraulicActuator`.
    pub hydraulic: Option<Arc<Fmu>>,
}

/// Result of one run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Crank angle [rad] and force [N] at every communication point, the start included.
    pub trace: Vec<[f64; 2]>,
    /// Largest difference between the mechanism's gain of energy and the actuator's work [J].
    pub interface: f64,
    /// Average number of steps of mechanism and actuator per communication step.
    pub steps: [f64; 2],
}

/// Run a scheme over a scene in steps of h [s].
///
/// # Errors
/// A side returns an error: the coupling was unstable.
pub fn run(fmus: &Fmus, scene: &Scene, scheme: &str, h: f64) -> Result<Run, String> {
    let mut gear = Gear::start(&fmus.gear, &scene.gear, &scene.flags)?;
    match &fmus.hydraulic {
        Some(fmu) => {
            let mut actuator = Hydraulic::start(fmu, &scene.hydraulics, schemes::mode(scheme))?;
            couple(&mut gear, &mut actuator, scene.span, scheme, h)
        }
        None => couple(&mut gear, &mut scene.circuit(), scene.span, scheme, h),
    }
}

fn couple(
    gear: &mut dyn Mechanism,
    actuator: &mut dyn Actuator,
    span: f64,
    scheme: &str,
    h: f64,
) -> Result<Run, String> {
    let mut scheme = schemes::by_name(scheme).ok_or_else(|| format!("no scheme is called {scheme}"))?;
    let start = gear.energy()? - actuator.work()?;
    let mut run = Run::default();
    let mut pair = Pair::new(gear, actuator);
    let steps = (span / h * (1.0 + 1e-12)).floor() as u64;
    for k in 0..=steps {
        if k > 0 {
            scheme.step(&mut pair, h * (k - 1) as f64, h)?;
        }
        let motion = pair.mechanism.motion()?;
        pair.actuator.set_motion(motion.length, [motion.speed, 0.0, 0.0, 0.0, 0.0])?;
        run.trace.push([pair.mechanism.position()?, pair.actuator.force()?]);
        let gained = pair.mechanism.energy()? - start - pair.actuator.work()?;
        run.interface = run.interface.max(gained.abs());
    }
    run.steps = pair.steps.map(|count| count as f64 / steps as f64);
    Ok(run)
}
