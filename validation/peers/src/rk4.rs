//! The classical Runge-Kutta method, written by hand for this equation of motion: equal steps, no error estimate, no
//! allocation. This is what an engineer would write after deriving the equation.
use crate::four_bar::{FourBar, SPAN, START};
use crate::measure::{Point, point};
use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

/// Numbers of steps, each about a quarter more than the one before.
const STEPS: [u32; 10] = [10, 13, 16, 20, 25, 32, 40, 50, 63, 80];
/// Powers of ten by which they are multiplied.
const DECADES: [u32; 3] = [1, 10, 100];
/// Smaller numbers of steps, used first.
const FEW: [u32; 4] = [4, 5, 6, 8];

/// theta2 at the end of the span.
fn march(gear: &FourBar, steps: u32) -> f64 {
    let h = SPAN / f64::from(steps);
    let half = 0.5 * h;
    let [mut theta, mut omega] = START;
    for _ in 0..steps {
        let a1 = gear.acceleration(theta, omega).0;
        let w2 = omega + half * a1;
        let a2 = gear.acceleration(theta + half * omega, w2).0;
        let w3 = omega + half * a2;
        let a3 = gear.acceleration(theta + half * w2, w3).0;
        let w4 = omega + h * a3;
        let a4 = gear.acceleration(theta + h * w3, w4).0;
        theta += h / 6.0 * (omega + 2.0 * (w2 + w3) + w4);
        omega += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
    }
    theta
}

/// The curve.
pub fn points() -> Vec<Point> {
    let numbers = FEW.into_iter().chain(DECADES.iter().flat_map(|decade| STEPS.map(|steps| steps * decade)));
    let own = numbers.filter_map(|steps| {
        let began = Instant::now();
        let gear = FourBar::new();
        let set_up = began.elapsed().as_secs_f64();
        let run = || Ok::<_, Infallible>((march(black_box(&gear), black_box(steps)), 4 * steps as usize));
        point("by hand", "RK4", format!("{steps} steps"), set_up, run)
    });
    own.collect()
}
