//! Adaptive explicit Runge-Kutta pair of order 8 with an interpolant of order 7 (DOP853).
//!
//! In: a first-order system y' = f(t, y), a start, a span, a tolerance. Out: y at the exact end of the span; for each
//! step, on request, the interpolant. It must not know what y means.
//! Source: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4 (step-size control), II.5, II.6 (dense output).
mod dense;
mod tableau;

pub use dense::Dense;
use tableau::{A, C, E3, E5, EXTENDED, STAGES};

/// A first-order system with the error weights of its components.
pub trait System<const N: usize> {
    /// f(t, y); t is counted from the start of the span [s].
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N];

    /// Size of each component, to which the relative tolerance applies; positive. `f` is f(t, y).
    fn scale(&self, y: &[f64; N], f: &[f64; N]) -> [f64; N];
}

/// Why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationError {
    /// No step above the round-off of time meets the tolerance.
    StepTooSmall {
        /// Time since the start of the span [s].
        t: f64,
        /// The step size that was still too large [s].
        step: f64,
    },
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Right-hand-side evaluations.
    pub evaluations: u64,
    /// Accepted steps.
    pub accepted: u64,
    /// Rejected steps.
    pub rejected: u64,
}

/// Limits of the step-size control as in DOP853; its safety factor is 0.9, at which the retraction at tolerance 1e-12 takes
/// a quarter more evaluations, in rejected steps.
const SAFETY: f64 = 0.8;
const SHRINK_MOST: f64 = 1.0 / 3.0;
const GROW_MOST: f64 = 6.0;
/// A step below this part of the span cannot be told from round-off in time.
const SMALLEST: f64 = 1e-14;

/// Memory of the integration between spans: proposed step size, last derivative, compensation of the sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator<const N: usize> {
    /// Step size that the error control proposes next [s]; none before the first step.
    proposal: Option<f64>,
    /// Derivative at the present point, while it is valid.
    derivative: Option<[f64; N]>,
    /// What the last sums lost to rounding, component by component.
    carry: [f64; N],
    statistics: Statistics,
}

/// One accepted step from t to t + h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<const N: usize> {
    /// Start of the step since the start of the span [s].
    pub t: f64,
    /// Step size [s].
    pub h: f64,
    /// Whether it ends at the end of the span.
    pub reached: bool,
    /// State at the start.
    pub start: [f64; N],
    /// State at the end.
    pub end: [f64; N],
    /// Derivatives of the 12 stages, then the one at the end.
    pub(self) stages: [[f64; N]; STAGES + 1],
}

impl<const N: usize> Default for Integrator<N> {
    fn default() -> Self {
        Self { proposal: None, derivative: None, carry: [0.0; N], statistics: Statistics::default() }
    }
}

impl<const N: usize> Integrator<N> {
    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The right-hand side has changed (new inputs): forget the last derivative, keep the step size.
    pub fn refresh(&mut self) {
        self.derivative = None;
    }

    /// The state or the right-hand side has jumped: forget everything but the statistics.
    pub fn restart(&mut self) {
        *self = Self { statistics: self.statistics, ..Self::default() };
    }

    /// Advance `y` by exactly `span` > 0 [s].
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`]; `y` and the memory are then those of the last accepted step.
    pub fn advance<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &mut [f64; N],
        span: f64,
        tolerance: f64,
    ) -> Result<(), IntegrationError> {
        let mut t = 0.0;
        while t < span {
            let step = self.step(system, t, y, span, tolerance)?;
            *y = step.end;
            t += step.h;
            if step.reached {
                break;
            }
        }
        Ok(())
    }

    /// One accepted step from (t, y) towards `end`, not past it; the step that reaches it ends there exactly.
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`].
    pub fn step<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let first = match self.derivative {
            Some(f) => f,
            None => self.evaluate(system, t, y),
        };
        let rest = end - t;
        let scale = system.scale(y, &first);
        let mut wish = match self.proposal {
            Some(h) => h,
            None => self.starting_step(system, t, y, &first, &scale, rest, tolerance),
        };
        let mut grow_most = GROW_MOST;
        loop {
            // Fit the rest of the span: one step if it nearly reaches, two equal ones rather than a long and a tiny one.
            let h = if wish * 1.01 >= rest {
                rest
            } else if wish * 2.0 > rest {
                0.5 * rest
            } else {
                wish
            };
            let (mut step, carry) = self.attempt(system, t, y, &first, h);
            let error = step.error(&scale, tolerance);
            if error <= 1.0 {
                let grow = (SAFETY * error.powf(-0.125)).clamp(SHRINK_MOST, grow_most);
                let next = h * grow;
                // A step cut short by the end of the span says little about the size that is possible.
                self.proposal = Some(if h < wish { next.max(wish) } else { next });
                self.derivative = Some(step.stages[STAGES]);
                self.carry = carry;
                step.reached = h == rest;
                self.statistics.accepted += 1;
                return Ok(step);
            }
            self.statistics.rejected += 1;
            grow_most = 1.0;
            let shrink = if error.is_finite() { (SAFETY * error.powf(-0.125)).max(SHRINK_MOST) } else { 0.1 };
            wish = h * shrink;
            if wish < SMALLEST * end.abs() {
                return Err(IntegrationError::StepTooSmall { t, step: wish });
            }
        }
    }

    fn evaluate<S: System<N>>(&mut self, system: &mut S, t: f64, y: &[f64; N]) -> [f64; N] {
        self.statistics.evaluations += 1;
        system.derivative(t, y)
    }

    /// First step size: Hairer, Norsett, Wanner, II.4, with the error of an explicit Euler step as the guide.
    #[allow(clippy::too_many_arguments)]
    fn starting_step<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        first: &[f64; N],
        scale: &[f64; N],
        rest: f64,
        tolerance: f64,
    ) -> f64 {
        let size = |v: &[f64; N]| (0..N).map(|i| (v[i] / scale[i]).powi(2)).sum::<f64>().sqrt();
        let slope = size(first);
        let h0 = if slope > 0.0 { (0.01 / slope).min(rest) } else { rest };
        let ahead = std::array::from_fn(|i| y[i] + h0 * first[i]);
        let second = self.evaluate(system, t + h0, &ahead);
        let bend = size(&std::array::from_fn(|i| second[i] - first[i])) / h0;
        let largest = slope.max(bend);
        let h1 = if largest > 0.0 { (tolerance / largest).powf(0.125).min(rest) } else { rest };
        h1.min(100.0 * h0)
    }

    /// The step of size h, with the new compensation of the sums.
    fn attempt<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        first: &[f64; N],
        h: f64,
    ) -> (Step<N>, [f64; N]) {
        let mut k = [[0.0; N]; STAGES + 1];
        k[0] = *first;
        macro_rules! stage {
            ($i:literal; $($j:literal)*) => {{
                let at = std::array::from_fn(|n| y[n] + h * (0.0 $(+ A[$i][$j] * k[$j][n])*));
                k[$i] = system.derivative(t + C[$i] * h, &at);
            }};
        }
        stage!(1; 0);
        stage!(2; 0 1);
        stage!(3; 0 2);
        stage!(4; 0 2 3);
        stage!(5; 0 3 4);
        stage!(6; 0 3 4 5);
        stage!(7; 0 3 4 5 6);
        stage!(8; 0 3 4 5 6 7);
        stage!(9; 0 3 4 5 6 7 8);
        stage!(10; 0 3 4 5 6 7 8 9);
        stage!(11; 0 3 4 5 6 7 8 9 10);
        let (mut end, mut carry) = ([0.0; N], [0.0; N]);
        for n in 0..N {
            let mut sum = A[12][0] * k[0][n];
            for (j, stage) in k.iter().enumerate().take(STAGES).skip(5) {
                sum += A[12][j] * stage[n];
            }
            let delta = h * sum + self.carry[n];
            end[n] = y[n] + delta;
            // Knuth's two-sum: the exact rounding error of the line above.
            let back = end[n] - y[n];
            carry[n] = (y[n] - (end[n] - back)) + (delta - back);
        }
        k[STAGES] = system.derivative(t + h, &end);
        self.statistics.evaluations += STAGES as u64;
        (Step { t, h, reached: false, start: *y, end, stages: k }, carry)
    }
}

impl<const N: usize> Step<N> {
    /// How far component n can have come from its start within the step: the step size times the largest rate in a stage.
    pub fn excursion(&self, n: usize) -> f64 {
        self.stages.iter().fold(0.0, |most: f64, f| most.max(f[n].abs())) * self.h.abs()
    }

    /// Error estimate over the tolerance: below 1 the step is good. II.10, eq. (10.17).
    fn error(&self, scale: &[f64; N], tolerance: f64) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for n in 0..N {
            let (mut e5, mut e3) = (0.0, 0.0);
            for (j, stage) in self.stages.iter().enumerate().take(STAGES) {
                e5 += E5[j] * stage[n];
                e3 += E3[j] * stage[n];
            }
            let weight = 1.0 / (tolerance * scale[n]);
            fifth += (e5 * weight).powi(2);
            third += (e3 * weight).powi(2);
        }
        let both = fifth + 0.01 * third;
        if both == 0.0 { 0.0 } else { self.h * fifth / (both * N as f64).sqrt() }
    }

    /// Interpolant of order 7 over this step; costs three evaluations.
    pub fn dense<S: System<N>>(&self, system: &mut S) -> Dense<N> {
        let mut k = [[0.0; N]; EXTENDED];
        k[..=STAGES].copy_from_slice(&self.stages);
        for i in STAGES + 1..EXTENDED {
            let at = std::array::from_fn(|n| {
                self.start[n] + self.h * k[..i].iter().zip(&A[i]).map(|(stage, a)| a * stage[n]).sum::<f64>()
            });
            k[i] = system.derivative(self.t + C[i] * self.h, &at);
        }
        Dense::new(self.h, self.start, self.end, &k)
    }
}

#[cfg(test)]
mod tests;
