//! The energy balance under a prescribed motion: the power that leaves the mechanism, by inverse dynamics.
//!
//! In: a step, a time of it. Out: the power over this time, with an estimate of the error of its integral. It must not
//! know what is done with the energy.
use super::refusals::{Cause, Trouble};
use super::{Place, Step};
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Change;
use crate::mechanism::dynamics::inverse::{Demand, toward, with_efficiency};
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::motion::power_ahead::PowerAhead;
use crate::numerics::kronrod::{NODES, means, relative_error};

/// Part of the work of the drive's force over the size of the mechanism's motion: what is exchanged in a part of a step
/// is judged in relation to no less, as the rounding of position and speed is not smooth.
const LEAST_WORK: f64 = 1e-6;

/// The energy balance of a step under a prescribed motion.
pub(super) struct Balance<'a, 's> {
    pub(super) step: &'a Step<'a>,
    pub(super) sizes: &'a [f64],
    pub(super) airspeed: f64,
    pub(super) air: bool,
    pub(super) revolutions: f64,
    pub(super) scratch: &'s mut Scratch,
    /// Excess of the sizes of the loads over those at the beginning of the step, then as many zeros.
    pub(super) rates: &'s mut Vec<f64>,
    pub(super) touching: BumperSet,
    /// Largest generalised force of the drive in the step.
    pub(super) largest: f64,
}

/// The power over a time.
pub(super) struct Found {
    pub(super) power: PowerAhead,
    /// Relative error of the energy, as estimated.
    pub(super) error: f64,
    /// sigma at the last node that is not beyond the end of the step.
    pub(super) near: f64,
}

impl Balance<'_, '_> {
    /// The drive is the only load that changes, unless others have input derivatives.
    pub(super) fn begin(&mut self) {
        self.scratch.panel_force.invalidate();
        self.rates.fill(0.0);
        self.rates[self.step.drive.load] = 1.0;
    }

    /// The power from a time t to another one [s], in a step of `h` [s] with this sigma at t.
    pub(super) fn power(&mut self, [t, to]: [f64; 2], h: f64, sigma: f64) -> Result<Found, Trouble> {
        self.begin();
        let time = |u: f64| t + u * (to - t);
        let (mut last, mut near) = (sigma, sigma);
        let mut places = [Place::default(); NODES.len()];
        for (place, u) in places.iter_mut().zip(NODES) {
            *place = self.step.place(time(u), last)?;
            last = place.y[0];
            if time(u) <= h {
                near = last;
            }
        }
        let mut values = [0.0; NODES.len()];
        for ((value, place), u) in values.iter_mut().zip(&places).zip(NODES) {
            *value = self.lost(time(u), place)?;
        }
        let speed = places[NODES.len() - 1].y[1];
        let energy = (0.5 * speed * speed).max(LEAST_WORK * self.largest * self.step.track.whole.scale());
        let error = relative_error(means(&values), energy / (to - t));
        let is_at_rest = places.iter().all(|place| place.y[1] == 0.0);
        Ok(Found { power: PowerAhead::new(&values, to - t, is_at_rest), error, near })
    }

    /// The equation of motion at a sigma and the time t [s], with a size of the drive's force.
    fn equation(&mut self, sigma: f64, t: f64, force: f64) -> EquationOfMotion<'_> {
        let Self { step, sizes, airspeed, air, revolutions, .. } = *self;
        let (whole, inputs, load) = (step.track.whole, step.inputs, step.drive.load);
        let loads = whole.loading().inputs.len();
        let mut time = force;
        // While the drive alone changes, the loads are the same from one evaluation to the next.
        let (mut version, mut air_excess) = (u64::MAX, 0.0);
        if let Some(change) = inputs.change(whole) {
            let excess = |[first, second]: [f64; 2]| t * (first + 0.5 * t * second);
            for (rate, (&first, &second)) in self.rates.iter_mut().zip(change.first.iter().zip(change.second)) {
                *rate = excess([first, second]);
            }
            (self.rates[load], time, air_excess) = (force, 1.0, excess(change.airspeed));
            version = 0;
        }
        let (within, _) = whole.unwound(sigma);
        let (reduced, state_loads) = whole.with_state_loads(within, air);
        let (first, second) = self.rates.split_at(loads);
        let change = Some(Change { first, second, airspeed: [air_excess, 0.0] });
        let applied = AppliedLoads { version, sizes, airspeed, revolutions, change };
        let mut equation = EquationOfMotion::new(whole, (reduced, state_loads), applied, self.scratch);
        (equation.time, equation.mode.touching) = (time, self.touching);
        equation
    }

    /// The bumpers that push.
    pub(super) fn touch(&mut self, [sigma, sigma_dot]: [f64; 2]) {
        let count = self.step.track.ends.bumpers();
        if count == 0 || self.step.track.whole.linkage().is_massless {
            return;
        }
        let mut equation = self.equation(sigma, 0.0, 0.0);
        self.touching = BumperSet::of(count, |bumper| {
            let (beyond, push) = equation.bumper_push(bumper, sigma, sigma_dot);
            beyond > 0.0 && push > 0.0
        });
    }

    /// Power that leaves the mechanism at a time t [s] of the step, less that of the drive [W].
    fn lost(&mut self, t: f64, place: &Place) -> Result<f64, Trouble> {
        let [sigma, sigma_dot, acceleration] = place.y;
        if sigma_dot == 0.0 || self.step.track.whole.linkage().is_massless {
            return Ok(0.0);
        }
        self.touch([sigma, sigma_dot]);
        let (step, slope) = (self.step, place.slope);
        let direction = toward(sigma_dot, acceleration);
        let demand = Demand { drive: (step.drive.load, slope), acceleration, direction, breakaway: None };
        let force = self.equation(sigma, t, 0.0).required(sigma, sigma_dot, &demand);
        let locked = Trouble { time: t, cause: Cause::Locked(sigma) };
        let generalised = force.map_err(|_| locked)?;
        self.largest = self.largest.max(generalised.abs());
        let force = generalised / slope;
        let efficiency = step.track.whole.loading().drives[step.drive.load].efficiency;
        let force = with_efficiency(efficiency, force * sigma_dot * slope, force);
        let mut equation = self.equation(sigma, t, force);
        equation.clear_regimes();
        equation.mode.direction = direction;
        let lost = equation.effect(sigma, sigma_dot).map(|evaluation| evaluation.lost);
        match lost {
            Ok(lost) if lost.is_finite() => Ok(lost),
            Ok(_) => Err(Trouble { time: t, cause: Cause::Power }),
            Err(_) => Err(locked),
        }
    }
}
