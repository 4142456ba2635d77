//! Random scenes compared with an independent integration: a block on a slope, a slider-crank, a four-bar linkage, with
//! friction, bumpers and several stops on a side, a lock, a drive with losses.
//!
//! A scene is integrated twice, the second time from a start displaced by the tolerance; the distance of the two
//! results is the effect of an error of that size. Where the engine's error is more than 10 times this distance, states
//! during the motion are displaced too. The allowed error of the engine is 100 times the tolerance or the largest of
//! these distances. A scene ends where the distance exceeds 1e-3, as it has no significance from there on.
mod machine;
mod newton;
mod oracle;

use super::probe::Probe;
use crate::kinds::jet::Jet;
use crate::kinds::sketch::Coordinate;
use linkage_fmu::mechanism::ModelError;
use linkage_fmu::simulation::{Simulation, SimulationError};
use machine::Machine;
use oracle::{Held, Oracle};

/// Largest allowed ratio of an error to the tolerance or to the effect of an error of that size.
const MOST: f64 = 100.0;
/// Distance of the two integrations above which a scene has no significance.
const LOST: f64 = 1e-3;
/// Error of the reference integration itself.
const OWN: f64 = 3e-10;
/// Ratio of the error to the effect of a displaced start above which states during the motion are displaced too.
const SUSPECT: f64 = 10.0;
/// Number of parts of a phase at whose beginnings states are displaced.
const PARTS: usize = 4;

/// A part of a phase, and the reference integration at its beginning.
struct Part<'a> {
    from: Oracle<'a>,
    /// The lock engaged at its beginning; None if the lock does not change then.
    lock: Option<Option<usize>>,
    load: f64,
    span: f64,
}

/// Distance of two integrations at one time: of the coordinate, and of its speed relative to the largest speed.
fn between(one: &Oracle<'_>, other: &Oracle<'_>) -> f64 {
    let ([y, v], [z, w]) = (one.coordinate(), other.coordinate());
    (y - z).abs().max((v - w).abs() / one.fastest.max(0.1))
}

/// Largest distance from the end of the last part if the state is displaced by the tolerance at the beginning of one of
/// the parts.
fn largest_effect(parts: &[Part<'_>], end: &Oracle<'_>, tolerance: f64) -> f64 {
    let mut farthest = 0.0_f64;
    for (k, part) in parts.iter().enumerate() {
        let Some(mut moved) = part.from.perturbed(tolerance) else { continue };
        let advanced = parts[k..].iter().all(|part| {
            if let Some(lock) = part.lock {
                moved.engage(lock);
            }
            moved.advance(part.load, part.span)
        });
        if advanced {
            farthest = farthest.max(between(end, &moved));
        }
    }
    farthest
}

/// The case of this part: one scene.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let machine = Machine::random(&mut random);
    let sketch = &machine.sketch;
    let places = (sketch.places)(Jet::default()).unwrap_or_default();
    let text = sketch.definition_with(&places, sketch.start[1]);
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
    let tolerance = sketch.tolerance;
    let oracles = [(1e-3, 1e-12), (1.7e-3, 3e-12)].map(|(most, error)| Oracle::new(sketch, most, error));
    let [Some(mut one), Some(other)] = oracles else {
        probe.count("scenes refused");
        return Ok(());
    };
    let Some(mut other) = other.perturbed(tolerance) else { return Ok(()) };
    let mut parts = Vec::new();
    let [position, speed, input] = &machine.names();
    let (mut engaged, mut met, mut judged) = (false, 0, 0);
    for phase in 0..1 + random.below(5) {
        let load = if random.chance(0.2) { 0.0 } else { machine.load * random.within(-1.0, 1.0) };
        let (span, steps) = (random.decades(0.02, 0.4), 1 + random.below(10));
        engaged ^= random.chance(0.4);
        let lock = sketch.lock.filter(|_| engaged);
        let set = |e: SimulationError| format!("an input is refused: {e}");
        run.set(input, load).map_err(set)?;
        if sketch.lock.is_some() {
            run.set("latch.engage", engaged).map_err(set)?;
        }
        if probe.verbose {
            println!("phase {phase}: load {load}, lock {engaged}, {span} s in {steps} steps");
        }
        other.engage(lock);
        let mut ok = other.advance(load, span);
        for k in 0..PARTS {
            let (lock, span) = ((k == 0).then_some(lock), span / PARTS as f64);
            parts.push(Part { from: one.clone(), lock, load, span });
            if let Some(lock) = lock {
                one.engage(lock);
            }
            ok = ok && one.advance(load, span);
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
        let ([y, v], scale) = (one.coordinate(), one.fastest.max(0.1));
        let mut doubt = between(&one, &other);
        if doubt.is_nan() || doubt >= LOST || one.held.is_some() != other.held.is_some() {
            probe.count("scenes that ended as an error grows too much");
            break;
        }
        let mut get = |name: &str| run.get(name).map_err(|e| format!("{name}: {e}"));
        let [x, u] = [get(position)?, get(speed)?];
        let off = (x - y).abs().max((u - v).abs() / scale);
        let over = |doubt: f64| off / (tolerance.max(doubt) + OWN);
        if over(doubt) > SUSPECT {
            doubt = doubt.max(largest_effect(&parts, &one, tolerance));
        }
        let ratio = over(doubt);
        if probe.verbose {
            println!(
                "  {x} {u}, expected {y} {v}: {off:.1e}, moved state {doubt:.1e}, ratio {ratio:.2}, {:?}",
                one.held
            );
        }
        probe.ratio(ratio, "error over tolerance");
        if ratio.is_nan() || ratio > MOST {
            return Err(format!("phase {phase}: {x} {u}, expected {y} {v}: {ratio:.3e} times what it may be"));
        }
        probe.count("phases judged");
        judged += 1;
        for k in 0..sketch.stops.len() {
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
        probe.count(match (sketch.coordinate, sketch.slides.len()) {
            (Coordinate::Position(_), _) => "blocks judged",
            (_, 0) => "four-bar linkages judged",
            _ => "slider-cranks judged",
        });
        if met.count_ones() > 1 {
            probe.count("scenes with several stops reached");
        }
    }
    Ok(())
}

/// Check the error of a step: one that a scene may cause is counted, any other is a fault.
fn ended(probe: &mut Probe, error: &SimulationError, integrated: bool) -> Result<(), String> {
    match error {
        SimulationError::Model(ModelError::Interrupted { .. }) => probe.count("scenes that met solver.max_steps"),
        SimulationError::Model(ModelError::Locked { .. }) if !integrated => probe.count("scenes that friction locks"),
        other => return Err(format!("a step is refused: {other}")),
    }
    Ok(())
}
