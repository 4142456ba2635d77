//! Where on the curve a drive has a prescribed position, and what of a prescribed motion a state keeps.
//!
//! In: a position of the drive, a sigma near it, the ends of the travel. Out: the sigma at which the drive has this
//! position, on the way without a dead point, or why there is none. It must not know forces or time.
use crate::codec::record::{Damaged, Record};
use crate::mechanism::dynamics::prescribed::Given;
use crate::mechanism::motion::contact::{Ends, outward};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::power_ahead::PowerAhead;
use crate::mechanism::motion::travel::AT_STOP;
use crate::mechanism::reduced::Reduced;

/// A drive is at a dead point where S_sigma is below this part of S_sigma_sigma times the scale of sigma.
const DEAD: f64 = 1e-6;
/// Part of the distance to the next dead point, as far as slope and curvature tell it, that one step of Newton's method
/// may go.
const CAUTION: f64 = 0.5;
/// Most steps of Newton's method from one position to the next.
const MOST: usize = 10_000;
/// Rounding of a position, relative to 1 and the position.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A prescribed motion, as far as it decides how a run goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrescribedState {
    /// Whether the last step was under a prescribed motion.
    pub is_active: bool,
    /// Whether the host states the time, as in model exchange.
    pub has_host_time: bool,
    /// Time since it is prescribed.
    pub time: Elapsed,
    /// Position of the drive where it was first prescribed [m or rad].
    pub origin: f64,
    /// The motion by inputs for which the state is placed.
    pub given: Given,
    /// The power over a time that begins with a step and goes on beyond it, while loads and motion do not change.
    pub ahead: Option<PowerAhead>,
}

impl PrescribedState {
    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.flag("motion prescribed", &mut self.is_active)?;
        record.flag("time in the simulation tool", &mut self.has_host_time)?;
        self.time.record(record)?;
        record.finite("start of the prescribed motion", &mut self.origin)?;
        record.all_finite("prescribed motion", &mut self.given)?;
        record.option("predicted power", &mut self.ahead, PowerAhead::blank, |record, power| power.record(record))
    }
}

/// Why the drive cannot have a position. Each with the sigma there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Missed {
    /// The drive turns back before.
    DeadPoint(f64),
    /// The drive has one position, whatever the mechanism does.
    Idle(f64),
    /// The travel ends before, on this side.
    End(usize),
    /// The curve ends before, or its functions are not smooth there.
    Curve(f64),
    /// The position is too far off.
    Far,
}

/// Position of a drive along the curve.
#[derive(Clone, Copy)]
pub struct Track<'a> {
    pub whole: &'a Reduced,
    /// Load of the drive.
    pub load: usize,
    /// Whole revolutions before sigma = 0.
    pub revolutions: f64,
    pub ends: &'a Ends<'a>,
    /// Panel in which the search for that of a sigma starts.
    pub panel: usize,
}

impl Track<'_> {
    /// Displacement S of the drive at a sigma, also beyond a revolution of a closed curve, with its two derivatives.
    ///
    /// # Errors
    /// [`Missed::Curve`].
    pub fn displacement(&self, sigma: f64) -> Result<[f64; 3], Missed> {
        let (within, more) = self.whole.unwound(sigma);
        let failed = Missed::Curve(sigma);
        let stretch = self.whole.reach(within).map_err(|_| failed)?;
        let (table, position) = stretch.displacement_near(self.load, within, self.panel).map_err(|_| failed)?;
        let [s, slope, curvature] = [0, 1, 2].map(|order| table.value(position, order));
        let revolutions = self.revolutions + more;
        let grown = if revolutions == 0.0 { 0.0 } else { revolutions * self.whole.load_growth(self.load) };
        Ok([s + grown, slope, curvature])
    }

    /// sigma at which the drive has this position, nearest to `from`, with the displacement's two derivatives there.
    ///
    /// # Errors
    /// [`Missed`].
    pub fn locate(&self, from: f64, position: f64) -> Result<(f64, [f64; 2]), Missed> {
        let scale = self.whole.scale();
        let (low, high) = (self.ends.limits[0], self.ends.limits[1]);
        let mut sigma = from.clamp(low, high);
        if self.whole.loading().loads[self.load].is_idle() {
            return Err(Missed::Idle(sigma));
        }
        let mut last = f64::INFINITY;
        for _ in 0..MOST {
            let [s, slope, curvature] = self.displacement(sigma)?;
            if slope.abs() <= DEAD * curvature.abs() * scale || !slope.is_normal() {
                return Err(Missed::DeadPoint(sigma));
            }
            let miss = position - s;
            let size = 1.0 + s.abs();
            let step = miss / slope;
            // Rounding of S or of sigma ends the search, where it no longer gets nearer.
            let is_rounding = miss.abs() <= ROUNDING * size || step.abs() <= ROUNDING * (scale + sigma.abs());
            let stays = miss.abs() >= last && miss.abs() <= 1e3 * ROUNDING * size;
            if is_rounding || stays {
                return Ok((self.at_end(sigma, (s, slope)), [slope, curvature]));
            }
            let most = if curvature == 0.0 { f64::INFINITY } else { CAUTION * (slope / curvature).abs() };
            let next = (sigma + step.clamp(-most, most)).clamp(low, high);
            let side = usize::from(step > 0.0);
            if next == sigma && self.ends.limits[side] == sigma {
                if miss.abs() <= AT_STOP * size {
                    return Ok((sigma, [slope, curvature]));
                }
                return Err(Missed::End(side));
            }
            (sigma, last) = (next, miss.abs());
        }
        Err(Missed::Far)
    }

    /// sigma at which the drive has this position, with S_sigma there, if one evaluation of S shows it to rounding:
    /// about `way` from a sigma, with no dead point between as far as slope and curvature tell, and within the travel.
    #[inline]
    pub fn continued(&self, from: f64, way: f64, position: f64) -> Option<(f64, f64)> {
        let [s, slope, curvature] = self.displacement(from + way).ok()?;
        let (step, size) = ((position - s) / slope, 1.0 + s.abs());
        let sigma = from + way + step;
        let margin = AT_STOP * size / slope.abs();
        let is_exact = (0.5 * curvature * step * step).abs() <= ROUNDING * size;
        let is_clear = (way.abs() + step.abs()) * curvature.abs() <= CAUTION * slope.abs();
        let is_within = self.ends.limits[0] + margin < sigma && sigma + margin < self.ends.limits[1];
        (is_exact && is_clear && is_within).then_some((sigma, slope + curvature * step))
    }

    /// sigma, at the end of the travel if it is there within rounding.
    fn at_end(&self, sigma: f64, (s, slope): (f64, f64)) -> f64 {
        let close = AT_STOP * (1.0 + s.abs()) / slope.abs();
        let limits = self.ends.limits;
        let near = (0..2).find(|&side| (limits[side] - sigma) * outward(side) <= close);
        near.map_or(sigma, |side| limits[side])
    }
}
