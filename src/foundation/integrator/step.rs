//! One accepted step of any method.
use super::methods::{dop853::Dop853, dopri5::Dopri5, radau::Radau, rk4::Rk4, rkn86::Rkn86};
use super::pair::{Outcome, Path, Start};
use super::{Dense, Method, System};

/// One accepted step from t to t + h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<const N: usize> {
    /// Start of the step since the start of the span [s].
    pub t: f64,
    /// Step size [s].
    pub h: f64,
    /// Whether the step ends at the end of the span.
    pub reached: bool,
    /// State at the start.
    pub start: [f64; N],
    /// State at the end.
    pub end: [f64; N],
    /// Sum of the rounding errors of the sums up to the start (compensation).
    pub(super) carry: [f64; N],
    pub(super) stages: Stages<N>,
}

/// Stages of a step, for the interpolant and for a shorter step from the same start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stages<const N: usize> {
    Rk4(Rk4<N>),
    Dopri5(Dopri5<N>),
    Dop853(Dop853<N>),
    Rkn86(Rkn86),
    Radau(Radau<N>),
}

/// The same expression for the stages of any method.
macro_rules! on_stages {
    ($step:expr, $stages:ident => $result:expr) => {
        match &$step.stages {
            Stages::Rk4($stages) => $result,
            Stages::Dopri5($stages) => $result,
            Stages::Dop853($stages) => $result,
            Stages::Rkn86($stages) => $result,
            Stages::Radau($stages) => $result,
        }
    };
}

/// Message for stages of a method that a system does not use. The code of such a method is not compiled for the system.
pub(super) const FOREIGN: &str = "internal fault: this system has no step of this integration method";

macro_rules! into_stages {
    ($($method:ident: $stages:ty),*) => {
        $(impl<const N: usize> From<$stages> for Stages<N> {
            #[inline]
            fn from(stages: $stages) -> Self {
                Self::$method(stages)
            }
        })*
    };
}
into_stages!(Rk4: Rk4<N>, Dopri5: Dopri5<N>, Dop853: Dop853<N>, Rkn86: Rkn86, Radau: Radau<N>);

impl<const N: usize> Step<N> {
    /// The step of size h from `start`. `reached`: whether the step ends at the end of the span.
    #[inline]
    pub(super) fn new<P: Into<Stages<N>>>(start: &Start<N>, h: f64, reached: bool, outcome: Outcome<P, N>) -> Self {
        let &Start { t, y, carry, .. } = start;
        Self { t, h, reached, start: y, end: outcome.end, carry, stages: outcome.stages.into() }
    }

    /// The start of the step.
    pub(super) fn begin(&self) -> Start<N> {
        Start { t: self.t, y: self.start, first: self.first(), carry: self.carry }
    }

    /// Method that made the step.
    pub fn method(&self) -> Method {
        on_stages!(self, stages => Path::<N>::method(stages))
    }

    /// Rates at the start.
    #[inline]
    pub fn first(&self) -> [f64; N] {
        on_stages!(self, stages => stages.first(&self.start))
    }

    /// Rates at the start and at the end of an explicit step of a first-order system.
    #[inline]
    pub fn rates(&self) -> Option<[&[f64; N]; 2]> {
        on_stages!(self, stages => stages.rates())
    }

    /// Largest distance of component n, within the step, from the range between its values at start and end. This is an
    /// estimate with a margin, because the rates are known only at the stages. Infinite if unknown, where the
    /// interpolant needs no evaluation.
    #[inline]
    pub fn bulge(&self, n: usize) -> f64 {
        on_stages!(self, stages => stages.bulge(n, self.h, [&self.start, &self.end]))
    }

    /// Number of evaluations of [`Self::dense`].
    pub fn dense_evaluations(&self) -> u64 {
        on_stages!(self, stages => Path::<N>::dense_evaluations(stages))
    }

    /// Whether the error of the interpolant is within the tolerance of the step, as for DOP853, RKN8(6) and DOPRI5.
    pub fn interpolates(&self) -> bool {
        on_stages!(self, stages => Path::<N>::interpolates(stages))
    }

    /// Interpolant over this step. Order 7 with three evaluations after DOP853, and with four after RKN8(6). Order 4
    /// after DOPRI5. Order 3 after RK4 (Hermite's cubic) and after Radau (the collocation polynomial).
    pub fn dense<S: System<N>>(&self, system: &mut S) -> Dense<N> {
        let (t, h, ends) = (self.t, self.h, [&self.start, &self.end]);
        match &self.stages {
            Stages::Rk4(stages) => stages.dense(system, t, h, ends),
            Stages::Dopri5(stages) if !S::SECOND_ORDER => stages.dense(system, t, h, ends),
            Stages::Dop853(stages) if !S::SECOND_ORDER => stages.dense(system, t, h, ends),
            Stages::Rkn86(stages) if N == 2 => stages.dense(system, t, h, ends),
            Stages::Radau(stages) if !S::SECOND_ORDER => stages.dense(system, t, h, ends),
            _ => unreachable!("{FOREIGN}"),
        }
    }
}
