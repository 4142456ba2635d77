//! The reference motion of a scene, and the effect of an error during the motion on its end.
//!
//! The integration keeps each step's error, relative to (L, V), below the tolerance in the root mean square of the two
//! components: the error of sigma below sqrt(2) tol L, that of sigma_dot below sqrt(2) tol V. L is the length of sigma
//! that corresponds to a radian, V^2 the largest reference energy, 2 T + abs(force) L. kappa is the change at the end
//! per unit of an error relative to (L, V) made at any time of the motion; it is determined by restarts there with an
//! error. The error at the end is therefore at most sqrt(2) N tol kappa for N steps. N is that of one doStep over the
//! span: short steps share the tolerance, as the engine guarantees.
use super::case::{Case, get, set};
use super::motion::{Run, run, scale, step};
use super::plan::{Force, Plan};
use linkage_fmu::mechanism::Model;

/// Errors relative to L and V with which kappa is determined: small against the motion, large against rounding.
const ERROR: f64 = 1e-6;
/// Accuracy of the tables, relative to a component's largest value; ARCHITECTURE.md, invariant 5.
pub const TABLE: f64 = 1e-13;

/// The reference motion.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The angle at the end [rad].
    pub value: f64,
    /// Its uncertainty [rad].
    pub within: f64,
    /// Change at the end per unit of an error relative to (L, V) [rad].
    pub kappa: f64,
    /// V^2 [J].
    pub energy: f64,
    /// Distance that the motion can cover in the span, in lengths L.
    pub lengths: f64,
    /// Steps of the integration at the scene's tolerance in one doStep; None if the input changes.
    pub steps: Option<u64>,
}

impl Reference {
    /// For an unscaled case. The value at the end is the reference value, if there is one, otherwise the engine's at a
    /// thousandth of the tolerance.
    pub fn of(case: &Case, plan: &Plan, tolerance: f64) -> Result<Self, String> {
        let tight = (1e-3 * tolerance).max(1e-14);
        let start = case.model(tight)?;
        // With a constant input few steps are sufficient; kappa is then determined by long steps.
        let course = if plan.force == Force::Stated { Plan::steady(plan.span, 64) } else { plan.clone() };
        let reading = case.own("angle");
        let found = run(case, &mut start.clone(), &course, &reading)?;
        let mut whole = case.model(tolerance)?;
        let length = scale(&mut whole)?;
        let steps = if plan.force == Force::Stated {
            whole.step(plan.span).map_err(|e| e.to_string())?;
            Some(whole.statistics().accepted)
        } else {
            None
        };
        let kappa = sensitivity(case, &start, &course, &found, length)?;
        let lengths = plan.span * found.energy.sqrt() / length;
        let mut reference = Self { value: found.value, within: 0.0, kappa, energy: found.energy, lengths, steps };
        let unchanged = case.set.is_empty() && case.flags.is_empty() && case.text.is_none();
        let at_end = case.mechanism.known.iter().find(|k| (k.time - plan.span).abs() < 1e-12);
        match at_end.filter(|_| unchanged && plan.force == Force::Stated) {
            Some(known) => (reference.value, reference.within) = (known.value, known.within),
            None => reference.within = reference.bound(tight, found.work.accepted, found.work.accepted),
        }
        Ok(reference)
    }

    /// Bound of the error at the end (see the head of this file); `steps` of the integration count, `made` is the
    /// number of rounded sums.
    pub fn bound(&self, tolerance: f64, steps: u64, made: u64) -> f64 {
        let rounding = made as f64 * f64::EPSILON + TABLE * (1.0 + self.lengths);
        self.within
            + self.kappa * (2f64.sqrt() * tolerance * steps as f64 + rounding)
            + TABLE * self.value.abs().max(1.0)
    }

    /// Bound of the energy's error: an error (sqrt(2) tol L, sqrt(2) tol V) changes the energy by sqrt(2) tol (force L
    /// + V sigma_dot), at most 2 sqrt(2) tol V^2.
    pub fn energy_bound(&self, tolerance: f64, steps: u64, made: u64) -> f64 {
        energy_bound(self.energy, self.lengths, tolerance, steps, made)
    }
}

/// See [`Reference::energy_bound`].
pub fn energy_bound(energy: f64, lengths: f64, tolerance: f64, steps: u64, made: u64) -> f64 {
    let rounding = made as f64 * f64::EPSILON + TABLE * (1.0 + lengths);
    energy * (8f64.sqrt() * tolerance * steps as f64 + rounding)
}

/// Sensitivity of the end of a case's motion to its start: change of the angle at the end per radian of the start angle
/// of `body`, and per V / L of its start speed.
pub fn amplification(case: &Case, body: &str, plan: &Plan, tolerance: f64, energy: f64) -> Result<f64, String> {
    let mut start = case.model(tolerance)?;
    let rate = energy.sqrt() / scale(&mut start)?;
    let (angle, speed) = (format!("{body}.start_angle"), format!("{body}.start_speed"));
    let (at, with) = (get(&mut start, &angle)?, get(&mut start, &speed)?);
    let end = |x: f64, v: f64| -> Result<f64, String> {
        let mut model = start.clone();
        set(&mut model, &angle, x)?;
        set(&mut model, &speed, v)?;
        model.initialize().map_err(|e| e.to_string())?;
        Ok(run(case, &mut model, plan, &case.own("angle"))?.value)
    };
    let straight = end(at, with)?;
    // Away from a position where the body reverses.
    let aside = end(at + ERROR, with).or_else(|_| end(at - ERROR, with))?;
    Ok(((aside - straight).abs() + (end(at, with + ERROR * rate)? - straight).abs()) / ERROR)
}

/// kappa: the largest change at the end over restarts at several positions of the motion.
fn sensitivity(case: &Case, start: &Model, plan: &Plan, found: &Run, length: f64) -> Result<f64, String> {
    const PLACES: usize = 12;
    let speed = found.energy.sqrt();
    let mut again = start.clone();
    let stated = get(&mut again, case.mechanism.input)?;
    let mut largest: f64 = 0.0;
    let last = found.looks.len() - 1;
    for place in 0..PLACES {
        let (k, angle, rate) = found.looks[place * last / PLACES];
        // A start is rejected where a bumper is compressed: errors made there are covered by positions nearby.
        if place_at(case, &mut again, angle, rate).is_err_and(|message| message.contains("beyond this stop")) {
            continue;
        }
        // In the direction of motion, or inwards, so that no stop prevents it.
        let goes = if rate == 0.0 { found.looks[1].1 - angle } else { rate };
        let ahead = if goes == 0.0 { -angle.signum() } else { goes.signum() };
        let slope = slope_at(case, &mut again, angle)?;
        let sigma_dot = rate / slope;
        let perturbed = angle + ahead * ERROR * length * slope;
        let slope_there = slope_at(case, &mut again, perturbed)?;
        let mut end = |angle: f64, rate: f64| -> Result<f64, String> {
            place_at(case, &mut again, angle, rate)?;
            if plan.force == Force::Stated {
                let left = plan.span * (1.0 - k as f64 / plan.steps() as f64);
                again.step(left).map_err(|e| e.to_string())?;
            } else {
                for k in k..plan.steps() {
                    step(case, &mut again, plan, k, stated)?;
                }
                set(&mut again, case.mechanism.input, stated)?;
            }
            get(&mut again, &case.own("angle"))
        };
        let straight = end(angle, rate)?;
        let by_place = (end(perturbed, sigma_dot * slope_there)? - straight).abs();
        let by_speed = (end(angle, (sigma_dot + ahead * ERROR * speed) * slope)? - straight).abs();
        largest = largest.max((by_place + by_speed) / ERROR);
    }
    Ok(largest)
}

/// d(angle)/d(sigma) > 0 [rad/(sqrt(kg) m)]: with T = sigma_dot^2 / 2 at 1 rad/s.
fn slope_at(case: &Case, model: &mut Model, angle: f64) -> Result<f64, String> {
    place_at(case, model, angle, 1.0)?;
    Ok(1.0 / (2.0 * get(model, "energy.kinetic")?).sqrt())
}

fn place_at(case: &Case, model: &mut Model, angle: f64, rate: f64) -> Result<(), String> {
    set(model, &case.own("start_angle"), angle)?;
    set(model, &case.own("start_speed"), rate)?;
    model.initialize().map_err(|e| e.to_string())
}
