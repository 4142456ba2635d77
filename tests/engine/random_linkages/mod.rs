//! Random linkages against the Newton-Euler equations in absolute coordinates, solved without any code of the engine.
//!
//! 100 linkages per property. `LINKAGE_FMU_CASES=600 cargo test --test engine random_linkages` tests 600.
pub mod generate;
mod run;

use crate::support::oracle::linkage::{self, Coordinate, Linkage};
use crate::support::{Vec2, cases, oracle, read_all};
use generate::{CHAINS, Discard, build, grashof, linkages, numbers};
use linkage_fmu::mechanism::ModelError;
use linkage_fmu::mechanism::curve::CurveError;
use linkage_fmu::mechanism::reduced::ReductionError;
use linkage_fmu::simulation::SimulationError;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use run::{Run, State};
use std::collections::BTreeMap;

/// Number of linkages per property, unless the environment variable sets another number.
const CASES: u32 = 100;
/// Accuracy of the engine's tables, relative to the largest value along the motion.
const TABLE: f64 = 1e-13;
/// Rounding of sums of some tens of terms, each with the rounding of a table of angles.
const ROUNDING: f64 = 1e-13;

/// Tolerance of the integration in the definitions.
const TOLERANCE: f64 = 1e-12;
/// In about one of a thousand motions the estimate of a step's error is too small, by less than this factor.
const MISJUDGED: f64 = 100.0;
/// Of a hundred cases the engine may reject this many for its documented limits.
const REFUSED: u32 = 3;

fn config() -> ProptestConfig {
    let cases = cases().unwrap_or(CASES);
    ProptestConfig {
        cases,
        max_global_rejects: cases * REFUSED / 100,
        failure_persistence: None,
        max_shrink_iters: 100,
        ..ProptestConfig::default()
    }
}

/// The result of the engine. A case beyond a documented limit is discarded: coinciding ends of an actuator, branches
/// that almost cross (measured by `singular`), or an unlimited slide that leaves the traced stretch.
fn given<T>(linkage: &Linkage, result: Result<T, SimulationError>) -> Result<T, TestCaseError> {
    let model_error = |error| match error {
        ModelError::Reduction(ReductionError::EndsMeet { .. }) => TestCaseError::reject("ends meet"),
        ModelError::Travel { reason, .. } if reason.contains("both ends are at the same place") => {
            TestCaseError::reject("comes to where ends meet")
        }
        ModelError::Table { .. } | ModelError::Reduction(ReductionError::Table { .. }) => {
            TestCaseError::reject("ends almost meet, or not smooth far out")
        }
        ModelError::Reduction(ReductionError::Curve(CurveError::NearCrossing { .. })) => {
            TestCaseError::reject("branches almost cross")
        }
        ModelError::Reduction(ReductionError::Curve(CurveError::Stuck { .. })) if linkage.kind == "double slider" => {
            TestCaseError::reject("lost far out")
        }
        error => TestCaseError::fail(error.to_string()),
    };
    result.map_err(|error| match error {
        SimulationError::Model(error) => model_error(error),
        error => TestCaseError::fail(error.to_string()),
    })
}

fn within(what: &str, error: f64, bound: f64) -> Result<(), TestCaseError> {
    prop_assert!(error <= bound, "{what}: off by {error:e}, allowed {bound:e}");
    Ok(())
}

/// The error is within the bound at the tolerance. If a step was misjudged, the error must be within the bound at a
/// tenth of the tolerance. A fault of the tables or of the laws of motion would remain with other steps.
fn within_steps(
    what: &str,
    bound: f64,
    error: impl Fn(f64) -> Result<f64, TestCaseError>,
) -> Result<(), TestCaseError> {
    let first = error(1.0)?;
    within(what, first, MISJUDGED * bound)?;
    if first > bound { within(what, error(0.1)?, bound) } else { Ok(()) }
}

/// Positions, speeds, accelerations and reactions of the present state agree with those of the oracle.
fn agrees(run: &mut Run, linkage: &Linkage) -> Result<(), TestCaseError> {
    let state = given(linkage, run.state())?;
    let motion = run.motion(&state);
    let fastest = state.iter().fold(1.0, |a: f64, s| a.max(s[1].abs()));
    let farthest = motion.poses.iter().fold(2.0, |a: f64, p| a.max(p.0.norm()));
    let winding = state.iter().fold(1.0, |a: f64, s| a.max(s[0].abs()));
    let rounding = ROUNDING * winding.max(farthest);
    let [gap, drift] = motion.gap();
    within("closure", gap, rounding)?;
    within("closure of speeds", drift, rounding * fastest * farthest)?;
    let mark = motion.point(linkage.loads.forces[0].0);
    let [x, y] = ["mark.x", "mark.y"].map(|name| given(linkage, run.simulation.get(name)));
    within("marker", (mark - Vec2::new(x?, y?)).norm(), rounding)?;
    let solution = motion.solve();
    let bound = TABLE * solution.sensitivity;
    for (coordinate, [_, _, acceleration]) in linkage.coordinates().into_iter().zip(&state) {
        let expected = motion.acceleration(&solution, coordinate);
        within("acceleration", (acceleration - expected).abs(), bound)?;
    }
    for ((force, moment), (f, m)) in given(linkage, run.reactions())?.into_iter().zip(&solution.reactions) {
        within("reaction", (force - f).norm().max((moment - m).abs()), bound)?;
    }
    let undefined = read_all(run.simulation.model_mut());
    // A drive whose length is constant except for rounding has no inverse dynamics.
    let stands_still = !undefined.is_empty() && run.simulation.get("push.reduced_mass").is_ok_and(|mass| mass > 1e20);
    prop_assert!(undefined.iter().all(|name| stands_still && name.starts_with("push.")), "{undefined:?}");
    Ok(())
}

/// Largest difference of two states, in values and speeds. The speeds of the second state are multiplied by `sign`.
fn apart(a: &State, b: &State, sign: f64) -> f64 {
    a.iter().zip(b).fold(0.0, |w, (a, b)| w.max((a[0] - b[0]).abs()).max((a[1] - sign * b[1]).abs()))
}

/// Factor by which a small error at the start grows until the end, for values and speeds, by finite differences; at
/// least 1.
fn growth(linkage: &Linkage, run: &Run, steps: &[f64]) -> Result<f64, TestCaseError> {
    const OFF: f64 = 1e-7;
    let (end, _) = given(linkage, run.end([0.0, 0.0], steps))?;
    let mut sum = 1.0;
    for off in [[OFF, 0.0], [0.0, OFF]] {
        sum += apart(&given(linkage, run.end(off, steps))?.0, &end, 1.0) / OFF;
    }
    Ok(sum)
}

/// The linkage in this state: the guess is the state, the fastest coordinate states the start, and the speed is
/// reversed.
fn turned_back(linkage: &Linkage, run: &Run, state: &State) -> Linkage {
    let mut back = linkage.clone();
    for (body, pose) in back.bodies.iter_mut().zip(run.motion(state).poses) {
        (body.position, body.angle) = pose;
    }
    let coordinates = linkage.coordinates();
    for (coordinate, [value, ..]) in coordinates.iter().zip(state) {
        if let Coordinate::Position(j) = coordinate
            && let linkage::Freedom::Prismatic { position, .. } = &mut back.joints[*j].freedom
        {
            *position = *value;
        }
    }
    let fastest = (0..state.len()).fold(0, |a, i| if state[i][1].abs() > state[a][1].abs() { i } else { a });
    back.astray.fill(0.0);
    back.start = (coordinates[fastest], state[fastest][0], -state[fastest][1]);
    back
}

#[test]
fn few_are_discarded_and_every_type_occurs() {
    const TRIED: usize = 1000;
    let mut runner = TestRunner::deterministic();
    for chain in CHAINS {
        let (mut short, mut crossing, mut types) = (0, 0, BTreeMap::new());
        for _ in 0..TRIED {
            let drawn = numbers().new_tree(&mut runner).unwrap().current();
            match build(chain, &drawn) {
                Err(Discard::Short) => short += 1,
                Err(Discard::Crossing) => crossing += 1,
                Ok(l) if chain == CHAINS[0] => *types.entry(grashof(&l)).or_insert(0) += 1,
                Ok(_) => {}
            }
        }
        assert!(short < TRIED / 4 && crossing < TRIED / 50, "{}", chain.name);
        assert!(chain != CHAINS[0] || types.len() == 4 && types.values().all(|n| *n > TRIED / 50), "{types:?}");
    }
}

proptest! {
    #![proptest_config(config())]

    /// The guess is slightly wrong. The start is the built position with the stated speed.
    #[test]
    fn the_start_is_as_built(linkage in linkages()) {
        let mut run = given(&linkage, Run::new(&linkage))?;
        let state = given(&linkage, run.state())?;
        let coordinates = linkage.coordinates();
        let (stated, value, speed) = linkage.start;
        let (rates, least) = oracle::free_motion(&linkage);
        let own = coordinates.iter().position(|c| *c == stated).unwrap_or(0);
        let largest = rates.iter().fold(0.0, |a: f64, r| a.max(r.abs()));
        for (i, [q, v, _]) in state.iter().enumerate() {
            within("built position", (q - linkage.value(coordinates[i])).abs(),
                ROUNDING * largest / rates[own].abs() / least)?;
            let expected = speed * rates[i] / rates[own];
            within("built speed", (v - expected).abs(), ROUNDING * speed.abs() * largest / rates[own].abs() / least)?;
        }
        prop_assert!((state[own][0] - value).abs() < ROUNDING);
    }

    /// At the start and after each of a few steps: closed loops, Newton-Euler equations, energy.
    #[test]
    fn motion_obeys_newton_and_euler(linkage in linkages(), steps in prop::collection::vec(0.01..0.5f64, 6)) {
        let mut run = given(&linkage, Run::new(&linkage))?;
        agrees(&mut run, &linkage)?;
        let mut largest = 0.0;
        for h in &steps {
            given(&linkage, run.simulation.step(*h))?;
            agrees(&mut run, &linkage)?;
            let state = given(&linkage, run.state())?;
            let motion = run.motion(&state);
            largest = f64::max(largest, motion.kinetic() + motion.potentials().iter().map(|p| p.abs()).sum::<f64>());
            let kinetic = given(&linkage, run.simulation.get("energy.kinetic"))?;
            within("energy.kinetic", (kinetic - motion.kinetic()).abs(), TABLE * largest)?;
        }
        // The error per step is the tolerance in speed and position, and twice the tolerance in energy.
        let count = run.simulation.model().statistics().accepted as f64;
        within_steps("energy", (4.0 * count * TOLERANCE + TABLE) * largest, |part| {
            let mut run = run.clone();
            given(&linkage, run.simulation.set("solver.tolerance", part * TOLERANCE))?;
            given(&linkage, run.simulation.initialize())?;
            let energy = |state: &State| {
                let motion = oracle::Motion::of(&linkage, state);
                motion.kinetic() + motion.potentials().iter().sum::<f64>()
            };
            let start = energy(&given(&linkage, run.state())?);
            for h in &steps {
                given(&linkage, run.simulation.step(*h))?;
            }
            let change = energy(&given(&linkage, run.state())?) - start;
            let drift = given(&linkage, run.simulation.get("energy.drift"))?;
            within("energy.drift", (drift - change).abs(), TABLE * largest)?;
            Ok(change.abs())
        })?;
    }

    /// A motion from the end state with the opposite speed, in a model built from this state, returns to the start.
    #[test]
    fn motion_reversed_returns(linkage in linkages(), time in 0.1..3.0f64) {
        let run = given(&linkage, Run::new(&linkage))?;
        let start = given(&linkage, run.clone().state())?;
        let (end, there) = given(&linkage, run.end([0.0, 0.0], &[time]))?;
        let back = turned_back(&linkage, &run, &end);
        prop_assume!(back.start.2 != 0.0);
        let back_run = given(&linkage, Run::new(&back))?;
        let (_, again) = given(&linkage, back_run.end([0.0, 0.0], &[time]))?;
        let grown = growth(&linkage, &back_run, &[time])?;
        let fastest = start.iter().chain(&end).fold(1.0, |a: f64, s| a.max(s[0].abs()).max(s[1].abs()));
        let bound = (there + again) as f64 * TOLERANCE * grown * fastest;
        within_steps("return", bound, |part| {
            let mut back_run = back_run.clone();
            given(&linkage, back_run.simulation.set("solver.tolerance", part * TOLERANCE))?;
            let (home, _) = given(&linkage, back_run.end([0.0, 0.0], &[time]))?;
            Ok(apart(&start, &home, -1.0))
        })?;
    }

    /// One step and many steps agree, at any tolerance.
    #[test]
    fn steps_may_be_split(
        linkage in linkages(),
        steps in prop::collection::vec(1e-3..0.3f64, 1..12),
        exponent in -12.0..-6.0f64,
    ) {
        let run = given(&linkage, Run::new(&linkage))?;
        let tolerance = 10f64.powf(exponent);
        let whole = [steps.iter().sum()];
        let ends = |tolerance: f64| {
            let mut run = run.clone();
            given(&linkage, run.simulation.set("solver.tolerance", tolerance))?;
            Ok::<_, TestCaseError>([given(&linkage, run.end([0.0, 0.0], &whole))?, given(&linkage, run.end([0.0, 0.0],
                &steps))?])
        };
        let [(one, few), (_, many)] = ends(tolerance)?;
        let fastest = one.iter().fold(1.0, |a: f64, s| a.max(s[1].abs()));
        let bound = (few + many) as f64 * tolerance * growth(&linkage, &run, &whole)? * fastest;
        within_steps("split", bound, |part| {
            let [(one, _), (other, _)] = ends(part * tolerance)?;
            Ok(apart(&one, &other, 1.0))
        })?;
    }
}
