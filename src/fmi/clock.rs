//! The time of an instance. The host's communication points are compared with it.
//!
//! In: the experiment and the steps. Out: the end of an accepted step, or a refusal. Must not know: any model.

use super::refusal::Refusal;
use crate::codec::record::{Damaged, Record};
use crate::numerics::decimal::Decimal;

/// Tolerance of a communication point, relative to the step size. A lost or repeated step has an error of a whole step.
/// A host that counts time in other units (ticks, single-precision steps) has a much smaller error than this.
const STEP_SLACK: f64 = 1e-6;

/// Rounding error of a communication point, in units of [`f64::EPSILON`] times the largest time involved. The host may
/// compute `start + n h`, a running sum, or `stop - k h`: a product and two sums with half an epsilon each. The sum of
/// the clock adds another half. Errors of a running sum do not accumulate, because the clock adopts the host's point at
/// every step.
const ROUNDING: f64 = 8.0;

/// Largest rounding error of a point computed from the stop time, relative to the step size. A host cannot compute
/// points from a stop time with a larger rounding error, such as 1e300 s for "no end".
const FORMED_FROM_STOP: f64 = 1e-2;

/// Largest part of a step by which the last step may end after the stop time. Relative to the stop time, the errors of
/// a running sum do accumulate: half an epsilon of the time per step. A larger excess is not a rounding error.
const STOP_SLACK: f64 = 0.25;

/// Time of one instance. The default is the clock of a host that sets up no experiment: start at 0, no stop time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    start: f64,
    /// Present time [s]: end of the last accepted step.
    pub time: f64,
    stop: Option<f64>,
}

impl Clock {
    /// Clock of an experiment from `start` [s], of any sign, to `stop` [s], if a stop time is defined. `stop` = `start`
    /// is allowed, for an instance that is only initialised.
    ///
    /// # Errors
    /// `start` or `stop` is not finite, or `stop` is before `start`.
    pub fn new(start: f64, stop: Option<f64>) -> Result<Self, Refusal> {
        if !start.is_finite() {
            return Err(Refusal::error(format!("startTime is {start} s, but startTime must be finite")));
        }
        match stop {
            Some(stop) if !(stop.is_finite() && stop >= start) => Err(Refusal::error(format!(
                "stopTime is {} s, but stopTime must be finite and not before startTime = {} s",
                Decimal(stop),
                Decimal(start)
            ))),
            _ => Ok(Clock { start, time: start, stop }),
        }
    }

    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A value that was read is out of range.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.finite("startTime", &mut self.start)?;
        record.finite("time", &mut self.time)?;
        let start = self.start;
        record.option(
            "stopTime",
            &mut self.stop,
            || 0.0,
            |record, stop| {
                record.number("stopTime", stop, |v| v >= start && v.is_finite(), "finite and not before startTime")
            },
        )
    }

    /// End [s] of a step of size `h` [s] from the host's communication point `point` [s].
    ///
    /// # Errors
    /// `h` is not finite and positive, `point` is not the present time, or the step ends after the stop time.
    pub fn end_of_step(&self, point: f64, h: f64) -> Result<f64, Refusal> {
        let end = point + h;
        if h <= 0.0 || h.is_nan() {
            return Err(Self::refuse_size(h));
        }
        let off = (point - self.time).abs();
        // Most points are exact. The condition is negated so that NaN is rejected.
        if !((off <= STEP_SLACK * h || off <= self.slack(h)) && end.abs() <= f64::MAX) {
            return Err(if h == f64::INFINITY { Self::refuse_size(h) } else { self.refuse_point(point, h) });
        }
        match self.stop {
            Some(stop) if end > stop && end > stop + self.stop_slack(end, h) => {
                let [point, h, end, stop] = [point, h, end, stop].map(Decimal);
                Err(Refusal::error(format!(
                    "the step from {point} s by {h} s ends at {end} s, after stopTime = {stop} s; use a shorter \
                     step or a later stopTime"
                )))
            }
            _ => Ok(end),
        }
    }

    /// The refusal of a communication point that differs from the present time.
    #[cold]
    fn refuse_point(&self, point: f64, h: f64) -> Refusal {
        Refusal::error(format!(
            "currentCommunicationPoint is {} s, but the time of the instance is {} s (tolerance {:e} s)",
            Decimal(point),
            Decimal(self.time),
            self.slack(h)
        ))
    }

    /// The refusal of a step size.
    #[cold]
    fn refuse_size(h: f64) -> Refusal {
        Refusal::error(format!(
            "communicationStepSize is {} s, but the step size must be finite and greater than 0",
            Decimal(h)
        ))
    }

    fn slack(&self, h: f64) -> f64 {
        STEP_SLACK * h + ROUNDING * f64::EPSILON * self.scale(h)
    }

    fn stop_slack(&self, end: f64, h: f64) -> f64 {
        let steps = (end - self.start) / h;
        let running_sum = 0.5 * steps * f64::EPSILON * self.scale(h);
        self.slack(h) + running_sum.min(STOP_SLACK * h)
    }

    /// Largest time involved [s]: start, end of the step, and the stop time if a host can compute points from it.
    fn scale(&self, h: f64) -> f64 {
        let formed_from = |stop: &f64| ROUNDING * f64::EPSILON * stop <= FORMED_FROM_STOP * h;
        let stop = self.stop.map_or(0.0, f64::abs);
        let stop = Some(stop).filter(formed_from).unwrap_or(0.0);
        self.start.abs().max(self.time.abs() + h).max(stop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(clock: &mut Clock, point: f64, h: f64) {
        clock.time = clock.end_of_step(point, h).unwrap();
    }

    #[test]
    fn accepts_points_formed_as_a_sum_or_as_a_product() {
        for (start, h, count) in
            [(0.0, 1e-5, 13_000), (-0.05, 1e-5, 13_000), (1e6, 1e-5, 13_000), (0.0, 1e-5, 1_000_000)]
        {
            let stop = start + f64::from(count) * h;
            let mut summed = Clock::new(start, Some(stop)).unwrap();
            let mut formed = summed;
            let mut point = start;
            for n in 0..count {
                step(&mut summed, point, h);
                step(&mut formed, start + f64::from(n) * h, h);
                point += h;
            }
            assert!(summed.end_of_step(point, h).is_err());
            assert!(formed.end_of_step(stop, h).is_err());
        }
    }

    #[test]
    fn a_lost_or_repeated_step_is_rejected_at_any_time() {
        let h = 1e-5;
        for time in [0.13, 1e4, -1e4] {
            let clock = Clock::new(time, None).unwrap();
            assert!(clock.end_of_step(time, h).is_ok());
            for point in [time + h, time - h, time + 0.01 * h, f64::NAN, f64::INFINITY] {
                assert!(clock.end_of_step(point, h).is_err(), "{point}");
            }
        }
    }

    /// Hosts pass 1e300 or the largest number for "no end".
    #[test]
    fn a_late_stop_time_does_not_hide_a_lost_or_repeated_step() {
        for stop in [1e6, 1e12, 1e18, 1e300, f64::MAX] {
            for (h, time) in [(1e-3, 0.0), (1e-3, 7.25), (1e-6, 0.5), (10.0, 1e4)] {
                let clock = Clock { time, ..Clock::new(0.0, Some(stop)).unwrap() };
                assert!(clock.end_of_step(time, h).is_ok());
                for point in [time + h, time - h, time + 0.03 * h, time - 0.03 * h, f64::NAN, 1e300] {
                    assert!(clock.end_of_step(point, h).is_err(), "{point} at {time} before {stop}");
                }
            }
        }
    }

    #[test]
    fn points_counted_back_from_the_stop_time_are_accepted() {
        for (stop, h, count) in [(1e6, 1e-5, 1000_u32), (0.13, 1e-5, 13_000), (1e4, 1e-7, 1000), (1e9, 1e-3, 1000)] {
            let formed = |left: u32| stop - f64::from(left) * h;
            let mut clock = Clock::new(formed(count), Some(stop)).unwrap();
            // The clock of an experiment that started long before.
            clock.start = 0.0;
            for left in (1..=count).rev() {
                step(&mut clock, formed(left), h);
            }
            assert!(clock.end_of_step(stop, h).is_err());
        }
        // Early in a long experiment, the rounding error is that of the stop time, not of the point.
        let (stop, h) = (1e6_f64, 1e-5_f64);
        let steps = (stop / h).floor();
        let mut clock = Clock::new(stop - steps * h, Some(stop)).unwrap();
        for k in 0..1000 {
            step(&mut clock, stop - (steps - f64::from(k)) * h, h);
        }
    }

    #[test]
    fn a_step_is_finite_and_positive() {
        let clock = Clock::default();
        for h in [0.0, -0.0, -1e-3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(clock.end_of_step(0.0, h).is_err(), "{h}");
        }
    }

    #[test]
    fn the_last_step_may_end_at_the_stop_time_but_not_past_it() {
        let mut clock = Clock::new(0.0, Some(0.3)).unwrap();
        for n in 0..3 {
            step(&mut clock, f64::from(n) * 0.1, 0.1); // 0.2 + 0.1 > 0.3 in floating point
        }
        assert!(clock.end_of_step(0.3, 0.1).is_err());
    }

    #[test]
    fn the_last_point_of_a_running_sum_may_be_after_the_stop_time() {
        let (mut clock, mut point, h) = (Clock::new(0.0, Some(100.0)).unwrap(), 0.0, 1e-4);
        for _ in 0..1_000_000 {
            step(&mut clock, point, h);
            point += h;
        }
        assert!(point > 100.0 + 1e-9, "{point}");
        assert!(clock.end_of_step(point, h).is_err());
    }

    #[test]
    fn an_experiment_is_finite_and_ends_not_before_its_start() {
        assert!(Clock::new(f64::NAN, None).is_err());
        assert!(Clock::new(f64::INFINITY, None).is_err());
        for stop in [1.0_f64.next_down(), 0.5, f64::NAN, f64::INFINITY] {
            assert!(Clock::new(1.0, Some(stop)).is_err(), "{stop}");
        }
        // An experiment that only initialises the instance.
        for time in [0.0, 1.0, -1e6] {
            let clock = Clock::new(time, Some(time)).unwrap();
            assert!(clock.end_of_step(time, 1e-9 * (1.0 + time.abs())).is_err(), "{time}");
        }
        assert!(Clock::new(-2.0, Some(-1.0)).is_ok());
    }
}
