//! Changes of sign of switching quantities within a step: normal forces, transmitted forces, forces of drives.
//!
//! In: the values that the evaluations of a step have seen, the interpolant. Out: whether a quantity may pass 0, and
//! where. It must not know which law follows.
use super::REGIME_TOLERANCE;
use crate::integrator::{Dense, Integrator, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::loads::friction_loop::Locked;
use crate::numerics::passage::first_rise_of_quartic;

/// Part of the range of a switching quantity within a step by which a parabola through three samples may be wrong.
const PARABOLA: f64 = 0.02;
/// Part of the tolerance of a speed that the wrong law of a switch may cost in a step, where no change is looked for:
/// so rounding about 0 is none.
const NEGLIGIBLE: f64 = 1e-2;

impl EquationOfMotion<'_> {
    /// Value of a switching quantity at the time t of the span [s], positive with the held sign.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub(super) fn switch_value<const N: usize>(&mut self, switch: usize, t: f64, z: &[f64; N]) -> Result<f64, Locked>
    where
        Self: System<N>,
    {
        let is_locked = self.derivative(t, z)[1].is_nan();
        if is_locked { Err(Locked) } else { Ok(self.scratch.evaluator.switches.value(switch)) }
    }

    /// Change of sigma_ddot that the other law makes for each unit of a switching quantity.
    fn switch_effect(&self, switch: usize) -> f64 {
        let of = |state_loads| self.scratch.evaluator.switch_effect((self.reduced, state_loads), switch);
        self.state_loads.map_or(0.0, of)
    }
}

/// Whether a switching quantity may pass 0 within a step: it does in one of the evaluations of the step, or the
/// parabola through three of them in a row, the middle one the least, does so within a margin.
pub(super) fn may_switch<'e, const N: usize>(
    dynamics: &mut EquationOfMotion<'e>,
    switch: usize,
    step: &Step<N>,
    tolerance: f64,
) -> bool
where
    EquationOfMotion<'e>: System<N>,
{
    /// More than any method takes in one step.
    const MOST: usize = 24;
    let (mut samples, mut count) = ([[0.0; 2]; MOST], 0);
    let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for sample in (0..MOST).map_while(|index| dynamics.scratch.evaluator.switches.sample(index, switch)) {
        // Rejected attempts may have been longer.
        if sample[0] <= step.t + step.h {
            (least, largest) = (least.min(sample[1]), largest.max(sample[1]));
            let at = samples[..count].partition_point(|before| before[0] < sample[0]);
            samples.copy_within(at..count, at + 1);
            samples[at] = sample;
            count += 1;
        }
    }
    for triple in samples[..count].windows(3) {
        let [[a, f_a], [b, f_b], [c, f_c]] = [triple[0], triple[1], triple[2]];
        if f_b <= f_a && f_b <= f_c && a < b && b < c {
            // f_b less the square of the slope at b over twice the second derivative.
            let (left, right) = ((f_b - f_a) / (b - a), (f_c - f_b) / (c - b));
            let bend = (right - left) / (c - a);
            let slope = left + bend * (b - a);
            let margin = PARABOLA * (largest - least);
            least = least.min(f_b - if bend > 0.0 { 0.25 * slope * slope / bend } else { 0.0 } - margin);
        }
    }
    if least >= 0.0 || count == 0 {
        return false;
    }
    let mean: [f64; N] = std::array::from_fn(|n| (step.end[n] - step.start[n]) / step.h);
    let speed = dynamics.scale(&step.start, &mean)[1];
    -least * dynamics.switch_effect(switch) * step.h > NEGLIGIBLE * tolerance * speed
}

/// Part of a step after which a switching quantity passes 0, by the polynomials of degree 4 through five values in
/// either half of the step; located on the quantity itself.
pub(super) fn passage_of_switch<'e, const N: usize>(
    dynamics: &mut EquationOfMotion<'e>,
    switch: usize,
    integrator: &mut Integrator<N>,
    step: &Step<N>,
    dense: &Dense<N>,
) -> Option<f64>
where
    EquationOfMotion<'e>: System<N>,
{
    let mut evaluations = 0;
    let mut excess = |s: f64| {
        evaluations += 1;
        dynamics.switch_value(switch, step.t + s * step.h, &dense.at(s)).map(|value| -value)
    };
    let mut first = None;
    for half in [[0.0, 0.5], [0.5, 1.0]] {
        if first.is_none() {
            // Where friction has no solution, the step is as it is.
            first = first_rise_of_quartic(&mut excess, half, REGIME_TOLERANCE).unwrap_or(None);
        }
    }
    integrator.count_evaluations(evaluations);
    first
}
