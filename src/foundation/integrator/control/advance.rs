//! Steps of an integration with the chosen method, and shorter steps from the same start.
use super::memory::{Begin, Integrator};
use super::sizes::starting_step;
use crate::integrator::methods::{dop853::Dop853, dopri5::Dopri5, rk4::Rk4, rkn86::Rkn86};
use crate::integrator::pair::{Pair, Start};
use crate::integrator::step::{FOREIGN, Stages, Step};
use crate::integrator::{Dense, IntegrationError, Method, System};

impl<const N: usize> Integrator<N> {
    /// Advances `y` by exactly `span` > 0 [s].
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`]. `y` and the memory are then those of the last accepted step.
    pub fn advance<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &mut [f64; N],
        span: f64,
        tolerance: f64,
    ) -> Result<(), IntegrationError> {
        self.advance_from(system, &mut 0.0, y, span, tolerance, u64::MAX).map(|_| ())
    }

    /// [`Self::advance`] from the time `t` [s] within the span, until [`Self::attempts`] reaches `most`. Returns
    /// whether the end of the span is reached. Otherwise (t, y) is the end of the last accepted step.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_from<S: System<N>>(
        &mut self,
        system: &mut S,
        t: &mut f64,
        y: &mut [f64; N],
        span: f64,
        tolerance: f64,
        most: u64,
    ) -> Result<bool, IntegrationError> {
        while *t < span {
            if self.attempts() >= most {
                return Ok(false);
            }
            let step = self.step(system, *t, y, span, tolerance)?;
            *y = step.end;
            *t += step.h;
            if step.reached {
                break;
            }
        }
        Ok(true)
    }

    /// One accepted step from (t, y) towards `end`. The last step ends exactly at `end`.
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`].
    #[inline(never)]
    pub fn step<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let begin = self.begin(system, t, y, end, tolerance)?;
        loop {
            match self.choose::<S>(begin.rest, begin.wish) {
                Method::Rk4 => {
                    let outcome = Rk4::attempt(system, &begin.start, begin.rest);
                    if self.is_good(system, &begin, &outcome, tolerance) {
                        return Ok(self.accept(&begin, begin.rest, outcome));
                    }
                }
                Method::Dopri5 => {
                    let outcome = Dopri5::attempt(system, &begin.start, begin.rest);
                    if self.is_good(system, &begin, &outcome, tolerance) {
                        return Ok(self.accept(&begin, begin.rest, outcome));
                    }
                }
                Method::Dop853 => return self.explicit_step::<Dop853<N>, S>(system, &begin, end, tolerance),
                Method::Rkn86 => return self.explicit_step::<Rkn86, S>(system, &begin, end, tolerance),
                Method::Radau => return self.implicit_step(system, &begin, end, tolerance),
            }
        }
    }

    /// [`Self::step`] of order 8, whose interpolant is within the tolerance. For a step that may extend beyond the end
    /// of a span.
    ///
    /// # Errors
    /// As [`Self::step`].
    #[inline(never)]
    pub fn step_beyond<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let begin = self.begin(system, t, y, end, tolerance)?;
        if S::SECOND_ORDER {
            self.explicit_step::<Rkn86, S>(system, &begin, end, tolerance)
        } else {
            self.explicit_step::<Dop853<N>, S>(system, &begin, end, tolerance)
        }
    }

    /// f(t, y) at the present point, which the next step uses.
    #[inline(always)]
    pub fn rates<S: System<N>>(&mut self, system: &mut S, t: f64, y: &[f64; N]) -> [f64; N] {
        if let Some(f) = self.derivative {
            return f;
        }
        self.statistics.evaluations += 1;
        let f = system.derivative(t, y);
        // Without a solution, the next step is to find the reason.
        self.derivative = Some(f).filter(|f| f.iter().all(|f| f.is_finite()));
        f
    }

    /// Data for the first attempt at a step from (t, y).
    #[inline(always)]
    fn begin<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        end: f64,
        tolerance: f64,
    ) -> Result<Begin<N>, IntegrationError> {
        let first = self.rates(system, t, y);
        let scale = system.scale(y, &first);
        let mut begin = Begin { start: Start { t, y: *y, first, carry: self.carry }, rest: end - t, scale, wish: 0.0 };
        begin.wish = match self.proposal {
            Some(h) => h,
            None => starting_step(system, &begin, tolerance, &mut self.statistics)?,
        };
        Ok(begin)
    }

    /// Repeats `step`, which must be the last step, with exactly the size h [s], 0 < h <= step.h, by its method and
    /// without error control. The integration continues from the new end, directly or after [`Self::refresh`] or
    /// [`Self::restart`].
    pub fn retake<S: System<N>>(&mut self, system: &mut S, step: &Step<N>, h: f64) -> Step<N> {
        match &step.stages {
            Stages::Rk4(_) => self.repeat::<Rk4<N>, S>(system, step, h),
            Stages::Dopri5(_) if !S::SECOND_ORDER => self.repeat::<Dopri5<N>, S>(system, step, h),
            Stages::Dop853(_) if !S::SECOND_ORDER => self.repeat::<Dop853<N>, S>(system, step, h),
            Stages::Rkn86(_) if N == 2 => self.repeat::<Rkn86, S>(system, step, h),
            Stages::Radau(stages) if !S::SECOND_ORDER => {
                let (start, whole) = (step.begin(), stages.collocation(step.h, [&step.start, &step.end]));
                let outcome = stages.shorten(system, &start, &whole, h, &mut self.statistics);
                self.before = Some(outcome.stages.collocation(h, [&start.y, &outcome.end]));
                self.arrive(&outcome);
                Step::new(&start, h, false, outcome)
            }
            _ => unreachable!("{FOREIGN}"),
        }
    }

    /// [`Self::retake`] by an explicit pair.
    fn repeat<P: Pair<N> + Into<Stages<N>>, S: System<N>>(
        &mut self,
        system: &mut S,
        step: &Step<N>,
        h: f64,
    ) -> Step<N> {
        self.statistics.evaluations += P::EVALUATIONS;
        let start = step.begin();
        let outcome = P::attempt(system, &start, h);
        self.arrive(&outcome);
        Step::new(&start, h, false, outcome)
    }

    /// Returns to the start of the last step, which was too long for its interpolant. The next step has the size h [s].
    /// If stiffness is the reason, the next step is a Radau step.
    pub fn take_back<S: System<N>>(&mut self, system: &mut S, step: &Step<N>, h: f64) {
        self.refresh();
        (self.derivative, self.carry, self.before) = (Some(step.first()), step.carry, None);
        if let (true, Stages::Dop853(stages)) = (S::CAN_BE_STIFF, &step.stages) {
            let scale = system.scale(&step.start, &step.first());
            self.stiffness.too_coarse(h, stages.stiffness::<S>(step.h, [&step.start, &step.end], &scale));
        }
    }

    /// [`Step::dense`], with its evaluations counted.
    pub fn dense<S: System<N>>(&mut self, system: &mut S, step: &Step<N>) -> Dense<N> {
        self.statistics.evaluations += step.dense_evaluations();
        step.dense(system)
    }
}
