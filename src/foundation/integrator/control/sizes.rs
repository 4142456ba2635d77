//! The first step size, and step sizes under error control.
//!
//! Source: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4 (step-size control); Hairer, Wanner, Solving ODEs II
//! (1996), IV.2 (detecting stiffness), IV.8 (Radau, step sizes).
use super::inverse_root::inverse_root;
use super::memory::{Begin, Integrator};
use super::stiffness::largest_eigenvalue;
use crate::integrator::kept::Kept;
use crate::integrator::methods::dop853::STABLE_TO;
use crate::integrator::methods::radau::{self, Newton, Radau};
use crate::integrator::pair::{Pair, Start};
use crate::integrator::step::{Stages, Step};
use crate::integrator::{IntegrationError, Statistics, System};

/// Limits of the step-size control are those of DOP853. The safety factor of DOP853 is 0.9. With 0.9, the retraction at
/// tolerance 1e-12 would need 25 % more evaluations, because more steps are rejected.
const SAFETY: f64 = 0.8;
const SHRINK_MOST: f64 = 1.0 / 3.0;
pub const GROW_MOST: f64 = 6.0;
/// Factor on the step size if the error is not finite. Also the lower limit for Radau.
pub const SHRINK_INFINITE: f64 = 0.1;
/// Factor on the step size if a step ends in a state that the system does not admit.
const SHRINK_OUTSIDE: f64 = 0.25;
/// Factor on the step size if Newton's method does not converge.
const SHRINK_UNSOLVED: f64 = 0.25;
/// Largest factor by which a step could have been larger that is used to predict the growth of the error.
const LARGEST_GROWTH: f64 = 10.0;
/// Smallest step relative to the span. A smaller step is within the rounding error of time. For a span longer than
/// [`LONG`], the limit is relative to [`LONG`], because such spans occur only at rest.
const SMALLEST: f64 = 1e-14;
const LONG: f64 = 1e3;
/// Longest proposed step [s], which is still finite after growth.
pub const LONGEST: f64 = 1e300;
/// Largest h |lambda| of a proposed step. It is within DOP853's interval of stability, which ends at 6.4. A decaying
/// component and its errors decrease to a sixteenth in each step. Without this limit, steps would leave the interval
/// until the errors that grow there reach several tolerances.
const STABLE: f64 = 5.0;
/// Order of the explicit pairs.
const ORDER: f64 = 8.0;

impl<const N: usize> Integrator<N> {
    /// One accepted step of an explicit pair.
    #[inline]
    pub(super) fn explicit_step<P: Pair<N> + Into<Stages<N>>, S: System<N>>(
        &mut self,
        system: &mut S,
        begin: &Begin<N>,
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let &Begin { ref start, rest, ref scale, mut wish } = begin;
        let mut grow_most = GROW_MOST;
        loop {
            let h = fitted(wish, rest);
            self.statistics.evaluations += P::EVALUATIONS;
            let outcome = P::attempt(system, start, h);
            let error = outcome.stages.error::<S>(h, scale, tolerance);
            let is_admitted = system.admits(&outcome.end);
            if error <= 1.0 && is_admitted {
                let mut grow = grow_most;
                self.after_explicit::<P, S>();
                // A step shortened by the end of the span is often too short to grow to the proposed size.
                if S::CAN_BE_STIFF || h >= wish || h * grow_most > wish {
                    let growth = inverse_root(error, P::ERROR_POWER);
                    let mut stable = f64::INFINITY;
                    if S::CAN_BE_STIFF {
                        let h_lambda = outcome.stages.stiffness::<S>(h, [&start.y, &outcome.end], scale);
                        stable = STABLE / h_lambda;
                        self.stiffness.explicit_step(h, h_lambda, (SAFETY * growth).min(stable));
                    }
                    let predicted = (SAFETY * self.predicted_growth(h, growth)).min(stable);
                    grow = predicted.clamp(SHRINK_MOST, grow_most);
                } else {
                    self.last = None;
                }
                self.propose(h, wish, grow);
                return Ok(self.accept(begin, h, outcome));
            }
            grow_most = 1.0;
            let shrink = shrink(error, P::ERROR_POWER, SHRINK_MOST);
            let shrink = if is_admitted { shrink } else { shrink.min(SHRINK_OUTSIDE) };
            wish = self.reject(start.t, h, shrink, end)?;
        }
    }

    /// Growth for which the next step is expected to meet the tolerance, after a step of size h that could have grown
    /// by `growth`. An increase of the error from step to step is extrapolated: Solving ODEs II (1996), IV.8, eq.
    /// (8.25).
    #[inline]
    fn predicted_growth(&mut self, h: f64, growth: f64) -> f64 {
        let growth = growth.min(LARGEST_GROWTH);
        let last = self.last.replace((h, growth));
        last.map_or(growth, |(h_before, before)| growth.min(growth * (growth * (h / (h_before * before)))))
    }

    /// One accepted step of Radau.
    #[inline(never)]
    pub(super) fn implicit_step<S: System<N>>(
        &mut self,
        system: &mut S,
        begin: &Begin<N>,
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        match self.kept.take() {
            Some(mut kept) => {
                let step = self.implicit_step_with(system, begin, (end, tolerance), &mut kept);
                self.kept = Some(kept);
                step
            }
            None => self.implicit_step_with(system, begin, (end, tolerance), &mut Kept::default()),
        }
    }

    /// [`Self::implicit_step`] with a shared Jacobian.
    fn implicit_step_with<S: System<N>>(
        &mut self,
        system: &mut S,
        begin: &Begin<N>,
        (end, tolerance): (f64, f64),
        kept: &mut Kept<N>,
    ) -> Result<Step<N>, IntegrationError> {
        let &Begin { ref start, rest, ref scale, mut wish } = begin;
        self.last = None;
        let before = self.before;
        let newton = Newton { scale, tolerance, before: before.as_ref() };
        // Not after explicit steps, a jump or a step taken back.
        let mut is_old = kept.is_useful && before.is_some();
        if !is_old {
            self.renew(system, start, kept);
        }
        let mut grow_most = GROW_MOST;
        loop {
            let h = fitted(wish, rest);
            let attempt = Radau::attempt(system, start, (&newton, &mut *kept), h, &mut self.statistics);
            let shrink = match attempt {
                Some((outcome, error)) if error <= 1.0 && system.admits(&outcome.end) => {
                    self.stiffness.implicit_step(h, kept.lambda);
                    self.before = Some(outcome.stages.collocation(h, [&start.y, &outcome.end]));
                    let grow = SAFETY * inverse_root(error, radau::ERROR_POWER);
                    self.propose(h, wish, grow.clamp(SHRINK_MOST, grow_most));
                    return Ok(self.accept(begin, h, outcome));
                }
                // A new Jacobian may be sufficient, with the same step size.
                _ if is_old => {
                    self.renew(system, start, kept);
                    is_old = false;
                    continue;
                }
                Some((_, error)) if error <= 1.0 => SHRINK_OUTSIDE,
                Some((_, error)) => shrink(error, radau::ERROR_POWER, SHRINK_INFINITE),
                None => SHRINK_UNSOLVED,
            };
            grow_most = 1.0;
            wish = self.reject(start.t, h, shrink, end)?;
        }
    }

    /// Computes a new Jacobian at the start of a step.
    fn renew<S: System<N>>(&mut self, system: &mut S, start: &Start<N>, kept: &mut Kept<N>) {
        let jacobian = system.jacobian(start.t, &start.y);
        self.statistics.jacobians += 1;
        let leading = system.leading_components();
        kept.take(&jacobian, leading, largest_eigenvalue(&jacobian, leading));
    }

    /// Sets the next proposed step size after an accepted step of size h. `wish`: the size proposed for this step.
    /// `grow`: the factor by which the step may grow.
    #[inline]
    fn propose(&mut self, h: f64, wish: f64, grow: f64) {
        // A step shortened by the end of the span does not determine the possible size.
        self.proposal = Some(if h < wish { (h * grow).max(wish) } else { h * grow }.min(LONGEST));
    }

    /// The next size to try after a rejected step.
    fn reject(&mut self, t: f64, h: f64, shrink: f64, end: f64) -> Result<f64, IntegrationError> {
        self.statistics.rejected += 1;
        let wish = h * shrink;
        let smallest = SMALLEST * end.abs().min(LONG);
        if wish < smallest { Err(IntegrationError::StepTooSmall { t, step: wish }) } else { Ok(wish) }
    }
}

/// First step size: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4, based on the error of an explicit Euler step.
/// For a system that can be stiff, DOP853 is stable with this step size.
///
/// # Errors
/// The step size is 0, because the rates are too large.
// Called rarely, therefore not inlined.
#[inline(never)]
pub fn starting_step<S: System<N>, const N: usize>(
    system: &mut S,
    begin: &Begin<N>,
    tolerance: f64,
    statistics: &mut Statistics,
) -> Result<f64, IntegrationError> {
    let &Begin { start: Start { t, ref y, ref first, .. }, ref scale, rest, .. } = begin;
    let weight = scale.map(|s| 1.0 / s);
    let square = |v: &[f64; N]| (0..N).map(|i| (v[i] * weight[i]).powi(2)).sum::<f64>();
    let slope = square(first);
    let h0 = if slope > 0.0 { (0.01 / slope.sqrt()).min(rest) } else { rest };
    let ahead = std::array::from_fn(|i| y[i] + h0 * first[i]);
    let second = system.derivative(t + h0, &ahead);
    statistics.evaluations += 1;
    let curvature = square(&std::array::from_fn(|i| second[i] - first[i])) * (1.0 / (h0 * h0));
    let largest = slope.max(curvature);
    let share = 1.0 / (0.01 * tolerance).powi(2);
    let h1 = if largest > 0.0 { inverse_root(largest * share, 2.0 * ORDER).min(rest) } else { rest };
    let mut h = h1.min(100.0 * h0);
    if S::CAN_BE_STIFF {
        statistics.jacobians += 1;
        let jacobian = system.jacobian(t, y);
        let lambda = largest_eigenvalue(&jacobian, system.leading_components());
        if h * lambda > STABLE_TO {
            h = STABLE_TO / lambda;
        }
    }
    if h > 0.0 { Ok(h) } else { Err(IntegrationError::StepTooSmall { t, step: h }) }
}

/// Factor on the size of a rejected step for the next attempt, at least `least`.
#[inline]
fn shrink(error: f64, power: f64, least: f64) -> f64 {
    if error.is_finite() { (SAFETY * inverse_root(error, power)).max(least) } else { SHRINK_INFINITE }
}

/// Step size fitted to the rest of the span: one step if it nearly reaches the end, two equal steps instead of a long
/// and a tiny one.
fn fitted(wish: f64, rest: f64) -> f64 {
    if wish * 1.01 >= rest {
        rest
    } else if wish * 2.0 > rest {
        0.5 * rest
    } else {
        wish
    }
}
