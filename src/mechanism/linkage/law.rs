//! Laws u2 = F(u1) of couplings.
//!
//! In: u1. Out: F with two derivatives. It must not know bodies.
use crate::numerics::alternating::alternating_periodic;
use crate::numerics::periodic::Periodic;
use crate::numerics::twofold::Twofold;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Law u2 = F(u1) of a coupling.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// F = ratio u1 + phase.
    Constant {
        /// Ratio u2_dot / u1_dot [1, or m/rad].
        ratio: f64,
        /// u2 at u1 = 0 [rad, or m].
        phase: f64,
    },
    /// Two equal elliptic gears of the eccentricity e with n lobes. With theta = u1 + vertex, which is 0 where the
    /// first wheel touches the second with the vertex nearest to its centre,
    ///
    /// ```text
    /// tan(n (phase - F) / 2) = (1 - e) / (1 + e) tan(n theta / 2)
    /// F = phase - theta + (2 / n) atan(e sin(n theta) / (1 + e cos(n theta)))
    /// ```
    ///
    /// The second form holds over any number of revolutions.
    Elliptic {
        /// Eccentricity e of the pitch curves [1], >= 0 and < 1.
        eccentricity: f64,
        /// Number n of lobes [1]: 1 for ellipses about a focus.
        lobes: f64,
        /// theta at u1 = 0 [rad].
        vertex: f64,
        /// u2 at theta = 0 [rad].
        phase: f64,
    },
    /// F = phase + sign lift(u1 - start): the follower of a cam.
    Lift {
        /// The lift [rad, or m], of the period 2 pi.
        lift: Arc<Periodic>,
        /// u1 at which the lift begins [rad].
        start: f64,
        /// Sign of a lift in u2.
        sign: f64,
        /// u2 at lift 0 [rad, or m].
        phase: f64,
    },
}

impl Law {
    /// F, F' and F'' at u1.
    pub fn at(&self, u: f64) -> [f64; 3] {
        match *self {
            Self::Constant { ratio, phase } => [ratio * u + phase, ratio, 0.0],
            Self::Elliptic { eccentricity: e, lobes, vertex, phase } => {
                let theta = u + vertex;
                let (sin, cos) = (lobes * theta).sin_cos();
                let part = 1.0 + e * (e + 2.0 * cos);
                let slope = (e * e - 1.0) / part;
                let value = phase - theta + (2.0 / lobes) * (e * sin).atan2(1.0 + e * cos);
                [value, slope, 2.0 * e * lobes * sin * slope / part]
            }
            Self::Lift { ref lift, start, sign, phase } => {
                let [value, slope, curvature] = lift.at(u - start);
                [phase + sign * value, sign * slope, sign * curvature]
            }
        }
    }

    /// F at a u1 of twice the precision: with twice the precision for a constant ratio, else with the rounding of F.
    pub(super) fn precise(&self, u: Twofold) -> Twofold {
        match *self {
            Self::Constant { ratio, phase } => Twofold::from(ratio) * u + Twofold::from(phase),
            _ => {
                let [value, slope, _] = self.at(u.rounded());
                Twofold::from(value) + Twofold::from(slope) * (u - Twofold::from(u.rounded()))
            }
        }
    }

    /// The same law with a value added to u2.
    pub(super) fn add_phase(&mut self, change: f64) {
        match self {
            Self::Constant { phase, .. } | Self::Elliptic { phase, .. } | Self::Lift { phase, .. } => *phase += change,
        }
    }

    /// Whether F is not analytic somewhere.
    pub fn has_knots(&self) -> bool {
        matches!(self, Self::Lift { .. })
    }

    /// A continuous function of u1 that changes its sign where F is not analytic, and only there.
    pub fn alternating(&self, u: f64) -> f64 {
        match self {
            Self::Lift { lift, start, .. } => alternating_periodic(lift.knots(), u - start, TAU),
            _ => 1.0,
        }
    }

    /// Distance from u1 to the next place beyond `close` at which F is not analytic, in the direction of growing u1 or
    /// against it; infinite if F is analytic everywhere.
    pub fn next_knot(&self, u: f64, ascending: bool, close: f64) -> f64 {
        match self {
            Self::Lift { lift, start, .. } => lift.next_knot(u - start, ascending, close),
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elliptic_gears_hold_their_closed_form_over_many_turns() {
        let h = 1e-4;
        for (e, lobes) in [(0.0, 1.0), (0.4, 1.0), (0.85, 1.0), (0.3, 2.0), (0.2, 3.0)] {
            let law = Law::Elliptic { eccentricity: e, lobes, vertex: 0.3, phase: 0.7 };
            for k in -400..400 {
                let u = 0.11 * f64::from(k);
                let [value, slope, curvature] = law.at(u);
                let half = [0.5 * lobes * (u + 0.3), 0.5 * lobes * (0.7 - value)];
                // tan a = k tan b without a pole.
                let ratio = (1.0 - e) / (1.0 + e);
                let gap = half[1].sin() * half[0].cos() - ratio * half[0].sin() * half[1].cos();
                assert!(gap.abs() < 1e-14 * half[0].abs().max(1.0), "{e} {u}: {gap}");
                assert!((value - law.at(u + TAU)[0] - TAU).abs() < 1e-13 * u.abs().max(10.0));
                let [before, after] = [-h, h].map(|h| law.at(u + h));
                // Third derivatives are at most some (1 + e)^2 / (1 - e)^4.
                let tolerance = 10.0 * h * h / (1.0 - e).powi(5);
                assert!(((after[0] - before[0]) / (2.0 * h) - slope).abs() < tolerance, "{e} {lobes} {u}");
                assert!(((after[1] - before[1]) / (2.0 * h) - curvature).abs() < 10.0 * tolerance, "{e} {lobes} {u}");
            }
        }
    }
}
