//! Not a solver but a lower limit: the time to an angle as an integral, from the energy alone.
//!
//! From rest and without friction 1/2 I(theta) omega^2 is the work W done since the start, and t = integral of d(theta)
//! / omega. With theta = theta(s), even in s, the integrand is smooth and even at the start of the motion; so half the
//! nodes of Gauss's rule over [-S, S] give the integral over [0, S]. This solves a simpler problem: the time at which
//! an angle is reached, not the angle at a time. It applies to motions without friction, drag and switches.
use crate::four_bar::{self, FourBar, OMEGA, SPAN, START, THETA2};
use crate::measure::{Point, fastest};
use std::convert::Infallible;
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

/// The substitution theta(s).
#[derive(Clone, Copy)]
enum Substitution {
    /// theta = theta(0) - s^2: smooth at the start.
    Start,
    /// theta = middle + half cos s between the start and the toggle, where I is infinite: smooth at both.
    StartAndToggle { middle: f64, half: f64 },
}

impl Substitution {
    /// Value of s at the angle `theta`.
    fn end(self, theta: f64) -> f64 {
        match self {
            Self::Start => (START[0] - theta).sqrt(),
            Self::StartAndToggle { middle, half } => ((theta - middle) / half).acos(),
        }
    }

    /// The angle and the magnitude of its derivative with respect to s.
    #[inline(always)]
    fn at(self, s: f64) -> (f64, f64) {
        match self {
            Self::Start => (START[0] - s * s, 2.0 * s),
            Self::StartAndToggle { middle, half } => {
                let (sin, cos) = s.sin_cos();
                (middle + half * cos, half * sin)
            }
        }
    }
}

/// Positive nodes of Gauss's rule with 2 n nodes on [-1, 1], and their weights: zeros of Legendre's polynomial by
/// Newton's method.
fn gauss(n: u32) -> Vec<(f64, f64)> {
    let order = f64::from(2 * n);
    (0..n)
        .map(|i| {
            let mut x = (PI * (f64::from(i) + 0.75) / (order + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..10 {
                let (mut p, mut before) = (x, 1.0);
                for k in 2..=2 * n {
                    let k = f64::from(k);
                    (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
                }
                slope = order * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Time at which the crank reaches the angle `theta` [s].
fn time(gear: &FourBar, rule: &[(f64, f64)], substitution: Substitution, theta: f64) -> f64 {
    let (end, work) = (substitution.end(theta), gear.work_and_inertia(START[0]).0);
    let sum = |sum: f64, &(x, weight): &(f64, f64)| {
        let (theta, slope) = substitution.at(end * x);
        let (done, inertia) = gear.work_and_inertia(theta);
        sum + weight * slope * (0.5 * inertia / (done - work)).sqrt()
    };
    end * rule.iter().fold(0.0, sum)
}

/// Both curves: evaluations, including that at the start, against the error of the time converted to an angle.
pub fn points() -> Vec<Point> {
    let toggle = four_bar::toggle();
    let (middle, half) = (0.5 * (START[0] + toggle), 0.5 * (START[0] - toggle));
    let methods = [
        ("singularity of the start removed", Substitution::Start),
        ("those of the start and the toggle removed", Substitution::StartAndToggle { middle, half }),
    ];
    let mut points = Vec::new();
    for (method, substitution) in methods {
        for nodes in 1..=60 {
            let began = Instant::now();
            let gear = FourBar::new();
            let rule = gauss(nodes);
            let set_up = began.elapsed().as_secs_f64();
            let run = || Ok::<_, Infallible>(time(black_box(&gear), black_box(&rule), substitution, black_box(THETA2)));
            let Ok((time, run)) = fastest(run);
            points.push(Point {
                scene: "S1 limit",
                tool: "energy quadrature",
                method: method.into(),
                setting: format!("{nodes} nodes"),
                error: ((time - SPAN) * OMEGA).abs(),
                run,
                set_up,
                evaluations: usize::try_from(nodes + 1).ok(),
            });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_even_polynomials_up_to_its_degree() {
        for n in 1..=20 {
            let moment = |power: i32| gauss(n).iter().map(|&(x, weight)| weight * x.powi(power)).sum::<f64>();
            for power in (0..4 * n as i32).step_by(2) {
                let exact = 1.0 / f64::from(power + 1);
                assert!((moment(power) - exact).abs() < 1e-14, "{n} nodes, power {power}: {}", moment(power));
            }
            let beyond = 4 * n as i32;
            let error = (moment(beyond) - 1.0 / f64::from(beyond + 1)).abs();
            assert!(n > 10 || error > 1e-13, "{n} nodes, power {beyond}: {error}");
        }
    }

    #[test]
    fn the_time_to_the_angle_of_the_reference_is_its_time() {
        let gear = FourBar::new();
        let time = time(&gear, &gauss(60), Substitution::Start, THETA2);
        assert!((time - SPAN).abs() < 1e-13, "{time}");
    }
}
