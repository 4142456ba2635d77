//! The explicit pairs, as the step-size control sees them.
use super::step::Stages;
use super::{Method, System, dop853, rkn86};

/// What an attempt at a step gives.
pub(super) struct Outcome<K, const N: usize> {
    /// f at the stages and at the end, as the pair keeps it.
    pub stages: K,
    pub end: [f64; N],
    /// f at the end.
    pub last: [f64; N],
    /// What the sums up to the end have lost to rounding.
    pub carry: [f64; N],
}

/// An explicit pair with an error estimate; f at the end of a step is the first stage of the next.
pub(super) trait Pair<const N: usize> {
    /// What it keeps of the stages.
    type Stages;
    const METHOD: Method;
    /// Evaluations of a step.
    const EVALUATIONS: u64;
    /// [`Self::error`] falls as this power of the step size.
    const ERROR_POWER: f64;

    /// The step of size h from (t, y), where f(t, y) = `first` and the sums so far have lost `carry`.
    fn attempt<S: System<N>>(
        system: &mut S,
        t: f64,
        y: &[f64; N],
        first: &[f64; N],
        h: f64,
        carry: &[f64; N],
    ) -> Outcome<Self::Stages, N>;

    /// A power of the error estimate over the tolerance: below 1 the step is good.
    fn error(stages: &Self::Stages, h: f64, scale: &[f64; N], tolerance: f64) -> f64;

    /// h |lambda| as the step has felt it; 0 for a pair that no stiff system is given to.
    fn stiffness(y: &[f64; N], outcome: &Outcome<Self::Stages, N>, h: f64, scale: &[f64; N]) -> f64;

    /// As a step keeps them.
    fn stages(stages: Self::Stages) -> Stages<N>;
}

/// For systems of first order.
pub(super) struct Dop853;

/// For systems of second order.
pub(super) struct Rkn86;

impl<const N: usize> Pair<N> for Dop853 {
    type Stages = dop853::Slopes<N>;
    const METHOD: Method = Method::Dop853;
    const EVALUATIONS: u64 = dop853::tableau::STAGES as u64;
    const ERROR_POWER: f64 = dop853::ERROR_POWER;

    fn attempt<S: System<N>>(
        system: &mut S,
        t: f64,
        y: &[f64; N],
        first: &[f64; N],
        h: f64,
        carry: &[f64; N],
    ) -> Outcome<Self::Stages, N> {
        dop853::attempt(system, t, y, first, h, carry)
    }

    fn error(stages: &Self::Stages, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        dop853::error(stages, h, scale, tolerance)
    }

    fn stiffness(y: &[f64; N], outcome: &Outcome<Self::Stages, N>, h: f64, scale: &[f64; N]) -> f64 {
        dop853::stiffness(y, &outcome.end, &outcome.stages, h, scale)
    }

    fn stages(stages: Self::Stages) -> Stages<N> {
        Stages::Dop853(stages)
    }
}

impl<const N: usize> Pair<N> for Rkn86 {
    type Stages = rkn86::Accelerations;
    const METHOD: Method = Method::Rkn86;
    const EVALUATIONS: u64 = rkn86::EVALUATIONS;
    const ERROR_POWER: f64 = rkn86::ERROR_POWER;

    #[inline]
    fn attempt<S: System<N>>(
        system: &mut S,
        t: f64,
        y: &[f64; N],
        first: &[f64; N],
        h: f64,
        carry: &[f64; N],
    ) -> Outcome<Self::Stages, N> {
        rkn86::attempt(system, t, y, first, h, carry)
    }

    #[inline]
    fn error(stages: &Self::Stages, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        rkn86::error(stages, h, scale, tolerance)
    }

    fn stiffness(_y: &[f64; N], _outcome: &Outcome<Self::Stages, N>, _h: f64, _scale: &[f64; N]) -> f64 {
        0.0
    }

    #[inline]
    fn stages(stages: Self::Stages) -> Stages<N> {
        Stages::Rkn86(stages)
    }
}
