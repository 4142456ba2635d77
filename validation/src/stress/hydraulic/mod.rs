//! Hydraulics in the stress suite: the actuator with a given motion and with an element whose motion it predicts, and
//! the landing gear with a circuit, compared with the same circuit in plain numbers.
//!
//! In: cases. Out: rows of the suite. Must not use `energy.balance`, which is 0 to rounding at every time.
mod case;
mod gear;
mod implicit;
mod table;

pub use table::all;

use super::{Outcome, Row, Verdict};
use case::{Case, Drive, End};

/// Relative errors with which the sensitivity to errors during the run is determined.
const ERROR: f64 = 1e-5;
/// Number of points of a run at which the sensitivity is determined.
const PLACES: usize = 8;
/// Tolerances of the second integration and of a third one, for the error of the second.
const TIGHT: [f64; 2] = [1e-11, 1e-9];
/// The root mean square of the errors of one step in at most 15 components is kept below the tolerance.
const EACH: f64 = 3.88;
/// Bound of the relative error above which the end is not predictable.
const PREDICTABLE: f64 = 1.0;

/// One row: a case, its tolerance, and the parts of the expected error message, if one is expected.
#[derive(Clone, Debug)]
struct Scene {
    group: &'static str,
    what: String,
    case: Case,
    tolerance: f64,
    refusal: Option<Vec<&'static str>>,
}

impl From<Scene> for Row {
    fn from(scene: Scene) -> Self {
        let (what, steps) = (scene.what.clone(), scene.case.steps as u64);
        let Scene { group, tolerance, .. } = scene;
        let model = match scene.case.drive {
            Drive::Motion(_) => "HydraulicActuator, follow",
            Drive::Element(..) => "HydraulicActuator, preview",
        };
        let refusal = scene.refusal.as_ref().map(|words| words.iter().map(|&word| word.into()).collect());
        Self { group, model, what, tolerance, steps, refusal, run: Box::new(move || scene.judged()) }
    }
}

impl Scene {
    fn judged(&self) -> Result<Outcome, String> {
        let case = &self.case;
        let found = case.run(self.tolerance)?;
        let circuit = case.circuit();
        let mut places = Vec::new();
        let start = case.at_start();
        let exact = case.exact(start, 0, TIGHT[0], |k, y| places.push((k, *y)))?;
        let again = case.exact(start, 0, TIGHT[1], |_, _| {})?;
        let weights = case.weights(&circuit, &exact);
        let moves = matches!(case.drive, Drive::Element(..));
        let count = if moves { 6 } else { 4 };
        let apart = |a: &End, b: &End| {
            (0..count).map(|i| ((a[i] - b[i]) / weights[i]).abs()).fold(0.0, |worst: f64, e| worst.max(e))
        };
        // Errors at several points, for each component separately.
        let mut kappa: f64 = 1.0;
        for (k, y) in places.iter().step_by(places.len().div_ceil(PLACES)) {
            let own = case.weights(&circuit, y);
            let straight = case.exact(*y, *k, TIGHT[1], |_, _| {})?;
            let mut sum = 0.0;
            for i in 0..count {
                let mut aside = *y;
                aside[i] += ERROR * own[i];
                sum += apart(&case.exact(aside, *k, TIGHT[1], |_, _| {})?, &straight) / ERROR;
            }
            kappa = kappa.max(sum);
        }
        let steps = (found.work.accepted + case.steps as u64) as f64;
        let within = apart(&exact, &again);
        let bound = within + kappa * steps * (EACH * self.tolerance + f64::EPSILON) + 1e-12;
        let error = apart(&found.end, &exact);
        // The work of the piston: errors of the pressures and of the speed accumulate along the motion.
        let [area_a, area_b] = circuit.areas();
        let mut largest = [0.0_f64; 3];
        for (_, y) in places.iter().chain([&(0, exact)]) {
            let own = case.weights(&circuit, y);
            let [friction, slope] = circuit.friction(y[5]);
            let force = (area_a * y[0] - area_b * y[1]).abs() + friction.abs();
            let by_speed = if moves { force + y[5].abs() * slope } else { 0.0 };
            let now = [y[5].abs(), area_a * own[0] + area_b * own[1], by_speed * own[5]];
            (0..3).for_each(|i| largest[i] = largest[i].max(now[i]));
        }
        let power = largest[0] * largest[1] + largest[2];
        let drift = (found.end[6] - exact[6]).abs();
        let drift_bound = case.span * power * bound + (exact[6] - again[6]).abs();
        let mut why = format!("N = {}, of these {} by Radau, kappa = {kappa:.1e}", found.work.accepted, found.implicit);
        let predictable = bound <= PREDICTABLE;
        if !predictable {
            why += "; beyond foretelling";
        }
        let holds = !predictable || (error <= bound && drift <= drift_bound);
        let finite = found.end.iter().all(|value| value.is_finite());
        let verdict = if holds && finite { Verdict::Holds } else { Verdict::Fails };
        let (error, drift) = (Some((error, bound)), Some((drift, drift_bound)));
        Ok(Outcome { error, drift, work: found.work, cpu: found.cpu, why, verdict })
    }
}
