//! Random scenes against an independent integration: a block on a slope, a slider-crank, a four-bar linkage, with
//! friction, bumpers and several stops on a side, a lock, a drive with losses.
//!
//! A scene is integrated twice, the second time with its start moved by the tolerance: how far the two are apart is what
//! the scene makes of an error of that size. The engine may be off by 100 times the tolerance or that distance, whichever
//! is larger. From where the distance is above 1e-3 a scene says nothing, and ends.
mod machine;
mod newton;
mod oracle;

use super::probe::Probe;
use linkage_fmu::mechanism::ModelError;
use linkage_fmu::simulation::{Simulation, SimulationError};
use machine::{Machine, Quantity};
use oracle::{Held, Oracle};

/// Largest ratio of an error to the tolerance or to what the scene makes of it.
const MOST: f64 = 100.0;
/// Distance of the two integrations from which on nothing can be said.
const LOST: f64 = 1e-3;
/// Error of the integration itself.
const OWN: f64 = 3e-10;

/// A part's case: one scene.
///
/// # Errors
/// The engine is too far off, or refuses a step.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let machine = Machine::random(&mut random);
    let text = machine.definition();
    if probe.verbose {
        println!("{text}");
    }
    let opened = probe.timed("instantiation", || {
        let mut run = Simulation::open(&text)?;
        run.initialize().map(|()| run)
    });
    let mut run = match opened {
        Ok(run) => run,
        Err(error) => {
            if probe.verbose {
                println!("{error}");
            }
            probe.count("scenes refused");
            return Ok(());
        }
    };
    let tolerance = machine.tolerance;
    let oracles = [(1e-3, 1e-12, 0.0), (1.7e-3, 3e-12, tolerance)];
    let [Some(mut one), Some(mut other)] =
        oracles.map(|(most, error, nudge)| Oracle::new(&machine, most, error, nudge))
    else {
        probe.count("scenes refused");
        return Ok(());
    };
    let [position, speed, input] = machine.names;
    let (mut engaged, mut met, mut judged) = (false, 0, 0);
    for phase in 0..1 + random.below(5) {
        let load = if random.chance(0.2) { 0.0 } else { machine.load * random.within(-1.0, 1.0) };
        let (span, steps) = (random.decades(0.02, 0.4), 1 + random.below(10));
        engaged ^= random.chance(0.4);
        let lock = machine.lock.filter(|_| engaged);
        let set = |e: SimulationError| format!("an input is refused: {e}");
        run.set(input, load).map_err(set)?;
        if machine.lock.is_some() {
            run.set("latch.engage", engaged).map_err(set)?;
        }
        if probe.verbose {
            println!("phase {phase}: load {load}, lock {engaged}, {span} s in {steps} steps");
        }
        let mut ok = true;
        for oracle in [&mut one, &mut other] {
            oracle.engage(lock);
            ok &= oracle.advance(load, span);
        }
        for _ in 0..steps {
            let stepped = probe.timed("step", || run.step(span / steps as f64));
            probe.count("steps");
            if let Err(error) = stepped {
                return ended(probe, &error, ok);
            }
        }
        if !ok {
            probe.count("scenes that the integration gave up");
            return Ok(());
        }
        let ([y, v], [z, w]) = (one.coordinate(), other.coordinate());
        let scale = one.fastest.max(0.1);
        let doubt = (y - z).abs().max((v - w).abs() / scale);
        if doubt.is_nan() || doubt >= LOST || one.held.is_some() != other.held.is_some() {
            probe.count("scenes that ended as an error grows too much");
            break;
        }
        let mut get = |name: &str| run.get(name).map_err(|e| format!("{name}: {e}"));
        let [x, u] = [get(position)?, get(speed)?];
        let off = (x - y).abs().max((u - v).abs() / scale);
        let ratio = off / (tolerance.max(doubt) + OWN);
        if probe.verbose {
            println!(
                "  {x} {u}, expected {y} {v}: {off:.1e}, moved start {doubt:.1e}, ratio {ratio:.2}, {:?}",
                one.held
            );
        }
        probe.ratio(ratio, "error over tolerance");
        if ratio.is_nan() || ratio > MOST {
            return Err(format!("phase {phase}: {x} {u}, expected {y} {v}: {ratio:.3e} times what it may be"));
        }
        probe.count("phases judged");
        judged += 1;
        for k in 0..machine.stops.len() {
            let beyond = one.beyond(k, &one.state)[0];
            let clear = beyond.abs() > 1e-9 + 2.0 * MOST * (tolerance + doubt) || one.held == Some(Held::Stop(k));
            let flag = run.boolean(&format!("s{k}.reached")).map_err(|e| e.to_string())?;
            met |= if flag { 1_u64 << k } else { 0 };
            if clear && flag != (beyond > -1e-6) {
                return Err(format!("phase {phase}: s{k}.reached is {flag}, {beyond:e} beyond it"));
            }
        }
    }
    if judged > 0 {
        probe.count(match machine.coordinate {
            Quantity::Slide(_) => "blocks judged",
            _ if machine.bodies[2].length > 0.0 => "four-bar linkages judged",
            _ => "slider-cranks judged",
        });
        if met.count_ones() > 1 {
            probe.count("scenes with several stops reached");
        }
    }
    Ok(())
}

/// A step that ended with an error: one that a scene may meet, or a fault.
fn ended(probe: &mut Probe, error: &SimulationError, integrated: bool) -> Result<(), String> {
    match error {
        SimulationError::Model(ModelError::Interrupted { .. }) => probe.count("scenes that met solver.max_steps"),
        SimulationError::Model(ModelError::Locked { .. }) if !integrated => probe.count("scenes that friction locks"),
        other => return Err(format!("a step is refused: {other}")),
    }
    Ok(())
}
