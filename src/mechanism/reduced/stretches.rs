//! Stretches of the reduced model: where the curve is open, it and its tables go on as far as the motion goes.
//!
//! In: the reduced model on the stretch of the curve with the guess, a sigma. Out: the reduced model on the stretch
//! that holds this sigma, made at its first use and shared from then on. Stretches depend on the definition and on
//! nothing else, in whatever order they are made. It must not know states or inputs.
use super::Reduced;
use super::error::ReductionError;
use super::resolved::trace_stretch;
use super::snap::not_smooth;
use super::state_loads::StateLoads;
use crate::mechanism::curve::{Curve, STRETCHES};
use std::sync::OnceLock;

/// A stretch, once it has been needed.
type Slot = OnceLock<Result<Box<Reduced>, ReductionError>>;

/// Stretches beyond the low and the high end of the one with the guess, going out from it.
#[derive(Debug)]
pub(super) struct Beyond([[Slot; STRETCHES]; 2]);

impl Beyond {
    /// None yet, for a curve with an open end.
    pub(super) fn of(curve: &Curve) -> Option<Box<Self>> {
        [0, 1].into_iter().any(|side| curve.is_open(side)).then(|| Box::new(Self(Default::default())))
    }
}

/// Why the motion cannot go on beyond a sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End<'a> {
    /// The travel ends there.
    OfTravel,
    /// Positions so far from the guess cannot be told apart.
    OfNumbers,
    /// The curve cannot be followed, or a function that the motion needs is not smooth.
    Failed(&'a ReductionError),
}

impl Reduced {
    /// Whether the curve is open at an end.
    #[inline(always)]
    pub fn is_open(&self) -> bool {
        self.beyond.is_some()
    }

    /// Whether this is one of several stretches of an open curve, or may become one.
    #[inline(always)]
    pub fn is_stretch(&self) -> bool {
        self.beyond.is_some() || self.stretch != 0
    }

    /// Whether this stretch holds sigma.
    #[inline(always)]
    pub fn holds(&self, sigma: f64) -> bool {
        let (first, last) = self.curve().range;
        first <= sigma && sigma < last
    }

    /// The reduced model on the stretch that holds sigma; where there is none, on the last one towards it.
    #[inline(always)]
    pub fn at(&self, sigma: f64) -> &Self {
        if self.beyond.is_none() || self.holds(sigma) { self } else { self.outside(sigma).0 }
    }

    /// Whether sigma is on the curve, with [`Self::at`] to be asked; it is not beyond the end of an open curve.
    ///
    /// # Errors
    /// The last stretch towards sigma, and its [`End`].
    pub fn reach(&self, sigma: f64) -> Result<&Self, (&Self, End<'_>)> {
        if self.holds(sigma) || self.period().is_some() {
            return Ok(self);
        }
        match self.outside(sigma) {
            (stretch, None) => Ok(stretch),
            (stretch, Some(end)) => Err((stretch, end)),
        }
    }

    /// The stretch that holds a sigma beyond this one, or the last towards it with its end.
    #[cold]
    fn outside(&self, sigma: f64) -> (&Self, Option<End<'_>>) {
        if sigma.is_nan() {
            return (self, Some(End::OfTravel));
        }
        let side = usize::from(sigma >= self.curve().range.0);
        let mut stretch = self;
        loop {
            match self.next(stretch, side) {
                // A limited travel includes its last position.
                Err(_) if side == 1 && sigma == stretch.curve().range.1 => return (stretch, None),
                Err(end) => return (stretch, Some(end)),
                Ok(next) => stretch = next,
            }
            if stretch.holds(sigma) {
                return (stretch, None);
            }
        }
    }

    /// The stretch beyond the low end (side 0) or the high end (side 1) of a stretch of this reduced model.
    ///
    /// # Errors
    /// There is none.
    pub fn next<'a>(&'a self, stretch: &'a Self, side: usize) -> Result<&'a Self, End<'a>> {
        if let Some(reason) = &stretch.ends_meet[side] {
            return Err(End::Failed(reason));
        }
        let Some(Beyond(slots)) = self.beyond.as_deref() else { return Err(End::OfTravel) };
        let outward = if side == 0 { -1 } else { 1 };
        let number = stretch.stretch + outward;
        if number == 0 {
            return Ok(self);
        }
        let slots = &slots[usize::from(number > 0)];
        let index = number.unsigned_abs() as usize - 1;
        let is_inward = number * outward < 0;
        if is_inward {
            let known = slots[index].get().and_then(|slot| slot.as_deref().ok());
            return known.ok_or(End::OfTravel);
        }
        if !stretch.curve().is_open(side) {
            return Err(End::OfTravel);
        }
        let slot = slots.get(index).ok_or(End::OfNumbers)?;
        let made = slot.get_or_init(|| self.make(stretch, side, number).map(Box::new));
        made.as_deref().map_err(End::Failed)
    }

    fn make(&self, stretch: &Self, side: usize, number: i32) -> Result<Self, ReductionError> {
        let curve = trace_stretch(stretch.curve(), side, self.loading()).map_err(ReductionError::Curve)?;
        let made = self.on_stretch(curve, number)?;
        // A stop that could not be found would be passed.
        for stop in self.loading().stops.iter().filter(|stop| stop.enabled) {
            let name = || format!("{}.{}", stop.name, stop.quantity);
            made.displacement(stop.load).map_err(|at| not_smooth(made.curve(), name(), at))?;
        }
        Ok(made)
    }

    /// [`Self::at`], with its loads that the state decides; the next stretch inward if these are not smooth.
    pub fn with_state_loads(&self, sigma: f64, air: bool) -> (&Self, Option<&StateLoads>) {
        let mut stretch = self.at(sigma);
        loop {
            match stretch.state_loads(air) {
                Ok(state_loads) => return (stretch, state_loads),
                Err(_) if stretch.stretch == 0 => return (stretch, None),
                Err(_) => stretch = self.next(stretch, usize::from(stretch.stretch < 0)).unwrap_or(self),
            }
        }
    }

    /// Stretches made so far.
    pub fn stretches(&self) -> impl Iterator<Item = &Self> {
        let slots = self.beyond.iter().flat_map(|beyond| beyond.0.as_flattened());
        slots.filter_map(|slot| slot.get()?.as_deref().ok())
    }

    /// Whether the start decides which part of the curve this is: the curve ends where two ends of a load coincide, or
    /// the guess is beyond a stop.
    pub fn is_part(&self) -> bool {
        self.curve().by_start || self.ends_meet.iter().any(Option::is_some)
    }

    /// sigma at the low and at the high end of the stretch with the guess, where two ends of a load coincide there.
    pub fn ends_meet(&self) -> [Option<f64>; 2] {
        let (first, last) = self.curve().range;
        let at = |side: usize, sigma: f64| self.ends_meet[side].as_ref().map(|_| sigma);
        [at(0, first), at(1, last)]
    }

    /// The coordinates at sigma after a number of revolutions of a closed curve, by name and in words.
    pub fn describe(&self, sigma: f64, revolutions: f64) -> String {
        self.at(sigma).curve().describe(sigma, revolutions)
    }
}
