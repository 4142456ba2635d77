//! Memory of an integration between steps.
use super::stiffness::Stiffness;
use crate::codec::record::{Damaged, Record};
use crate::integrator::kept::Kept;
use crate::integrator::methods::radau::Collocation;
use crate::integrator::pair::{Outcome, Pair, Path, Start};
use crate::integrator::step::{Stages, Step};
use crate::integrator::{Method, Statistics, System};

/// Number of methods that are tried over a whole span: the first ones of [`Method`].
const WHOLE_SPAN: usize = 2;
/// Factor by which a step of a more expensive method lengthens the spans up to which a cheaper method is tried again.
const TRY_AGAIN: f64 = 1.01;

/// Data for the first attempt at a step.
pub struct Begin<const N: usize> {
    pub start: Start<N>,
    /// Time to the end of the span [s].
    pub rest: f64,
    /// Scales of the components.
    pub scale: [f64; N],
    /// Step size proposed by the error control [s].
    pub wish: f64,
}

/// Memory of the integration between spans: proposed step size, last derivative, compensation of the sums, and the
/// history for the choice of the method.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrator<const N: usize> {
    /// Next step size proposed by the error control [s]. None before the first step.
    pub(super) proposal: Option<f64>,
    /// Derivative at the present point, while it is valid.
    pub(super) derivative: Option<[f64; N]>,
    /// Rounding error of the last sums, component by component (compensation).
    pub(super) carry: [f64; N],
    pub(super) stiffness: Stiffness,
    /// Span [s] up to which one step of RK4, and one of DOPRI5, is expected to meet its share of the tolerance.
    pub(super) longest_span: [f64; WHOLE_SPAN],
    /// Size [s] of the last step, and the factor by which it could have been larger. None if the factor is unknown, for
    /// example after a Radau step.
    pub(super) last: Option<(f64, f64)>,
    /// The last step, if it was a Radau step.
    pub(super) before: Option<Collocation<N>>,
    /// Jacobian that implicit steps share. If None, each implicit step computes a new Jacobian.
    pub(super) kept: Option<Box<Kept<N>>>,
    pub(super) method: Method,
    pub(super) statistics: Statistics,
}

impl<const N: usize> Default for Integrator<N> {
    fn default() -> Self {
        Self {
            proposal: None,
            derivative: None,
            carry: [0.0; N],
            stiffness: Stiffness::default(),
            longest_span: [f64::INFINITY; WHOLE_SPAN],
            last: None,
            before: None,
            kept: None,
            method: Method::default(),
            statistics: Statistics::default(),
        }
    }
}

impl<const N: usize> Integrator<N> {
    /// An integrator whose implicit steps share a Jacobian.
    pub fn keeping() -> Self {
        Self { kept: Some(Box::default()), ..Self::default() }
    }

    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Steps accepted and rejected so far.
    #[inline]
    pub fn tried(&self) -> [u64; 2] {
        [self.statistics.accepted, self.statistics.rejected]
    }

    /// Steps tried so far, whether accepted or rejected.
    #[inline]
    pub fn attempts(&self) -> u64 {
        self.statistics.accepted + self.statistics.rejected
    }

    /// Counts evaluations of a search within a step.
    pub fn count_evaluations(&mut self, evaluations: u64) {
        self.statistics.evaluations += evaluations;
    }

    /// Adds the work of another integration.
    pub fn count(&mut self, other: &Self) {
        self.statistics.add(&other.statistics);
    }

    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A field that was read has a value that no integration can produce.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.option("proposed step", &mut self.proposal, || 0.0, |record, h| record.positive("proposed step", h))?;
        let blank = || [0.0; N];
        // In a self-locking state, the derivative has no finite value. It is evaluated again after reading.
        let mut derivative = self.derivative.filter(|f| f.iter().all(|f| f.is_finite()));
        record.option("derivative", &mut derivative, blank, |record, f| record.all_finite("derivative", f))?;
        if record.reads() {
            self.derivative = derivative;
        }
        record.all_finite("compensation", &mut self.carry)?;
        self.stiffness.record(record)?;
        for span in &mut self.longest_span {
            record.number("longest span of one step", span, |h| h > 0.0, "a number > 0")?;
        }
        record.option(
            "last explicit step",
            &mut self.last,
            || (0.0, 0.0),
            |record, (h, error)| {
                record.positive("size of the last step", h)?;
                record.positive("error of the last step", error)
            },
        )?;
        record.option("last implicit step", &mut self.before, Collocation::blank, |record, before| {
            before.record(record)
        })?;
        if let Some(kept) = &mut self.kept {
            kept.record(record)?;
        }
        self.method.record(record)?;
        self.statistics.record(record)
    }

    /// Copies `other` without allocation. The stages of an implicit step and its Jacobian, which are larger than all
    /// other fields, are copied only if they exist.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        let Self { proposal, derivative, carry, stiffness, longest_span, last, before, kept, method, statistics } =
            self;
        (*proposal, *derivative, *carry, *stiffness) = (other.proposal, other.derivative, other.carry, other.stiffness);
        (*longest_span, *last, *method, *statistics) = (other.longest_span, other.last, other.method, other.statistics);
        if before.is_some() || other.before.is_some() {
            *before = other.before;
        }
        match (kept, &other.kept) {
            (Some(own), Some(other)) => own.copy_from(other),
            (own, other) => own.clone_from(other),
        }
    }

    /// The method of the last step.
    pub fn method(&self) -> Method {
        self.method
    }

    /// After a change of the right-hand side (new inputs): discards the last derivative and keeps the step size.
    pub fn refresh(&mut self) {
        self.derivative = None;
        self.last = None;
    }

    /// [`Self::refresh`], with the known rates at the present point.
    pub fn begin_with(&mut self, rates: [f64; N]) {
        self.refresh();
        self.derivative = Some(rates);
    }

    /// Continues from a state on the interpolant of the last step.
    pub fn branch_off(&mut self) {
        self.refresh();
        self.carry = [0.0; N];
    }

    /// After a jump of the state or the right-hand side: discards everything except the statistics.
    pub fn restart(&mut self) {
        let mut kept = self.kept.take();
        kept.iter_mut().for_each(|kept| kept.is_useful = false);
        *self = Self { statistics: self.statistics, method: self.method, kept, ..Self::default() };
    }

    /// Discards everything, including the statistics, as before the first step.
    pub fn begin_anew(&mut self) {
        (self.statistics, self.method) = Default::default();
        self.restart();
    }

    /// The memory for a system with another number of components. Step sizes and statistics are kept.
    pub fn with_components<const M: usize>(&self) -> Integrator<M> {
        Integrator {
            proposal: self.proposal,
            longest_span: self.longest_span,
            method: self.method,
            statistics: self.statistics,
            ..Integrator::default()
        }
    }

    /// Continues from the end of a step.
    #[inline]
    pub(super) fn arrive<P>(&mut self, outcome: &Outcome<P, N>) {
        (self.derivative, self.carry) = (outcome.last, outcome.carry);
    }

    /// Continues from the end of an accepted step.
    #[inline]
    pub(super) fn accept<P: Path<N> + Into<Stages<N>>>(
        &mut self,
        begin: &Begin<N>,
        h: f64,
        outcome: Outcome<P, N>,
    ) -> Step<N> {
        self.arrive(&outcome);
        self.method = P::METHOD;
        self.statistics.accept(P::METHOD);
        Step::new(&begin.start, h, h == begin.rest, outcome)
    }

    /// After an accepted explicit step: the next step does not follow a Radau step, and cheaper methods are tried again
    /// sooner.
    #[inline]
    pub(super) fn after_explicit<P: Pair<N>, S: System<N>>(&mut self) {
        if S::CAN_BE_STIFF {
            self.before = None;
            self.kept.iter_mut().for_each(|kept| kept.is_useful = false);
        }
        for span in self.longest_span.iter_mut().take(P::METHOD as usize) {
            *span *= TRY_AGAIN;
        }
    }
}
