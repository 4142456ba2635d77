//! The host on an FMU that this project did not make: an oil spring with a leak, exported by another tool.
//!
//! In: the FMU, with `speed`, `force`, `stiffness` and `leak_time`. Out: how far a run with it is from one with the
//! same law in closed form.
use super::models::{Integrated, Mass, OilSpring};
use super::pair::{Actuator, Element, Pair, Preview, Refused};
use super::schemes;
use super::unpacked::Fmu;
use linkage_fmu::fmi2::importer::Instance;
use linkage_fmu::fmi2::types::ValueReference;
use std::sync::Arc;

const MASS: f64 = 700.0;
const SPRING: OilSpring = OilSpring { stiffness: 1.5e6, leak_time: 0.03 };
/// Force at the start, the FMU's own [N].
const START: f64 = 1000.0;
const STEP: f64 = 5e-4;
const STEPS: u32 = 400;
/// Largest difference of the force relative to the start [1]: rounding of either side over the run.
const ALLOWED: f64 = 1e-10;

/// An actuator that knows a held speed and its force only.
#[derive(Debug)]
struct Spring {
    instance: Instance,
    speed: ValueReference,
    force: ValueReference,
}

fn lacking<T>(what: &str) -> Result<T, Refused> {
    Err(format!("the FMU has no {what}"))
}

impl Actuator for Spring {
    fn set_motion(&mut self, _length: f64, [speed, ..]: [f64; 5]) -> Result<(), Refused> {
        self.instance.set_reals(&[self.speed], &[speed])
    }

    fn force(&mut self) -> Result<f64, Refused> {
        Ok(self.instance.reals(&[self.force])?[0])
    }

    fn force_rate(&mut self, _acceleration: f64) -> Result<f64, Refused> {
        lacking("output derivatives")
    }

    fn compliance(&mut self) -> Result<[f64; 2], Refused> {
        lacking("stiffness as an output")
    }

    fn preview(&mut self, _element: Element, _h: f64, _keeps: bool) -> Result<Preview, Refused> {
        lacking("preview")
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.instance.step(t, h)
    }

    fn save(&mut self) -> Result<(), Refused> {
        lacking("saved states")
    }

    fn restore(&mut self) -> Result<(), Refused> {
        lacking("saved states")
    }

    fn work(&mut self) -> Result<f64, Refused> {
        lacking("energy")
    }
}

/// Forces at the communication points of a mass on this spring, by Jacobi coupling with held inputs.
fn forces(spring: &mut dyn Actuator) -> Result<Vec<f64>, Refused> {
    let mut mass = Mass::new(MASS, 0.0, [0.5, 0.0]);
    let mut scheme = schemes::by_name("Jacobi 0").ok_or("no Jacobi coupling")?;
    let mut pair = Pair::new(&mut mass, spring);
    let mut forces = Vec::new();
    for k in 0..STEPS {
        scheme.step(&mut pair, STEP * f64::from(k), STEP)?;
        forces.push(pair.actuator.force()?);
    }
    Ok(forces)
}

/// Couple the FMU with a mass, and compare; the sentence of the result.
///
/// # Errors
/// The FMU refuses a call, or the forces differ.
pub fn compare(fmu: &Arc<Fmu>) -> Result<String, String> {
    let instance = fmu.instantiate("spring")?;
    let [speed, force, stiffness, leak_time] = fmu.find_all(["speed", "force", "stiffness", "leak_time"])?;
    instance.set_up(0.0, None)?;
    instance.set_reals(&[stiffness, leak_time], &[SPRING.stiffness, SPRING.leak_time])?;
    instance.initialize()?;
    let seen = forces(&mut Spring { instance, speed, force })?;
    let exact = forces(&mut Integrated::new(SPRING, [START, 0.0, 0.0, 0.0]))?;
    let worst = seen.iter().zip(&exact).map(|(a, b)| (a - b).abs() / START).fold(0.0, f64::max);
    let last = seen.last().copied().unwrap_or_default();
    if worst.is_nan() || worst > ALLOWED {
        return Err(format!("the force differs by {worst:e} of that at the start; {ALLOWED:e} is allowed"));
    }
    Ok(format!("{STEPS} steps, force at the end {last:.6} N, largest difference from the closed form {worst:.1e}"))
}
