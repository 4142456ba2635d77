//! Random mechanisms of the usual kinds, compared with closed forms and Lagrange's equation.
use super::probe::Probe;
use crate::kinds::{Draw, Off, Sketch, open, run, wild};
use linkage_fmu::simulation::SimulationError;

/// Allowed error of a position relative to the size [1, rad].
const POSITION: f64 = 1e-11;
/// Allowed error of rates and of the balance of the reactions, relative to the largest.
const RATES: f64 = 1e-8;
/// Allowed ratio of an error of the motion to the tolerance or to the effect of an error of that size.
const MOST: f64 = 100.0;
/// Number of draws after which a case ends without a result.
const DRAWS: u32 = 50;

/// The case of this part: one mechanism.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    for _ in 0..DRAWS {
        let (name, drawn) = wild(&mut random);
        match drawn {
            Draw::Near => probe.count("draws near a limit of the travel, drawn again"),
            Draw::Impossible(sketch, text) => return impossible(probe, &sketch, &text),
            Draw::Possible(sketch, text) => {
                let span = random.within(1.0, 12.0) / sketch.own_motion();
                let steps = 5 + random.below(60) as u32;
                return possible(probe, &sketch, &text, span, steps).map_err(|why| format!("{name}: {why}"));
            }
        }
    }
    Ok(())
}

fn possible(probe: &mut Probe, sketch: &Sketch, text: &str, span: f64, steps: u32) -> Result<(), String> {
    if probe.verbose {
        println!("{text}\n{span} s in {steps} steps");
    }
    let mut model = probe.timed("instantiation", || open(text)).map_err(|error| format!("refused: {error}"))?;
    probe.count(if sketch.stops.is_empty() { "mechanisms without stops" } else { "mechanisms with stops" });
    let off = run(sketch, &mut model, span, steps, &mut |model, h| {
        probe.count("steps");
        probe.timed("step", || model.step(h))
    })?;
    if probe.verbose {
        println!("{off:?}");
    }
    probe.ratio(off.ratio, "error over tolerance");
    let Off { position, rates, balance, motion, ratio, plain, samples, .. } = off;
    if samples == 0 {
        probe.count("mechanisms that leave the closed form at once");
    }
    if plain > MOST {
        probe.count("mechanisms beyond 100 times the tolerance that a state moved by it explains");
    }
    for (what, value, most) in [
        ("position", position, POSITION),
        ("rates", rates, RATES),
        ("balance of the reactions", balance, RATES),
        ("motion over what it may be", ratio, MOST),
    ] {
        if value.is_nan() || value > most {
            let tolerance = sketch.tolerance;
            return Err(format!(
                "{what}: {value:.3e}, at most {most:e}; motion {motion:.2e} at tolerance {tolerance:.2e}"
            ));
        }
    }
    Ok(())
}

/// Lengths that cannot be assembled at the start are rejected, or the assembly is that of another branch.
fn impossible(probe: &mut Probe, sketch: &Sketch, text: &str) -> Result<(), String> {
    if probe.verbose {
        println!("{text}\ncannot be joined at its start");
    }
    match probe.timed("instantiation", || open(text)) {
        Err(SimulationError::Model(_)) => probe.count("impossible mechanisms refused"),
        Err(error) => return Err(format!("{}: {error}", sketch.name)),
        Ok(_) => probe.count("mechanisms joined on another side"),
    }
    Ok(())
}
