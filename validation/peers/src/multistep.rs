//! The crate `diffsol` on the hand-written equation of motion.
use crate::four_bar::{FourBar, SPAN, START};
use crate::measure::{Point, point, tolerances};
use diffsol::error::DiffsolError;
use diffsol::{
    NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason, Op,
};
use std::time::Instant;

type Lu = NalgebraLU<f64>;

/// theta2 at the end of the span.
fn march<'a, E, S>(mut solver: S) -> Result<f64, DiffsolError>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    solver.set_stop_time(SPAN)?;
    while !matches!(solver.step()?, OdeSolverStopReason::TstopReached) {}
    Ok(solver.state().y[0])
}

/// Points of several methods over the sweep of tolerances, down to 10^(-last/2).
macro_rules! sweep {
    ($points:ident, $($method:ident $(<$lu:ty>)? to $last:literal),*) => {$(
        for [rtol, atol] in tolerances($last) {
            let began = Instant::now();
            let gear = FourBar::new();
            let problem = OdeBuilder::<NalgebraMat<f64>>::new()
                .rtol(rtol)
                .atol([atol])
                .h0(1e-3)
                .rhs_implicit(
                    |y: &[f64], _: &[f64], _, rate: &mut [f64]| {
                        rate[0] = y[1];
                        rate[1] = gear.acceleration(y[0], y[1]).0;
                    },
                    |y: &[f64], _: &[f64], _, v: &[f64], out: &mut [f64]| {
                        out[0] = v[1];
                        out[1] = stiffness(&gear, y) * v[0] + gear.acceleration(y[0], y[1]).1 * v[1];
                    },
                )
                .init(|_: &[f64], _, y: &mut [f64]| y.copy_from_slice(&START), 2)
                .build()?;
            let set_up = began.elapsed().as_secs_f64();
            let run = || {
                let before = problem.eqn.rhs().statistics().number_of_calls;
                let theta2 = march(problem.$method$(::<$lu>)?()?)?;
                Ok::<_, DiffsolError>((theta2, problem.eqn.rhs().statistics().number_of_calls - before))
            };
            let setting = format!("rtol {rtol:.1e} atol {atol:.1e}");
            $points.extend(point("diffsol", stringify!($method), setting, set_up, run));
        }
    )*};
}

/// Derivative of theta2'' with respect to theta2 by a central difference, accurate enough for Newton's method.
fn stiffness(gear: &FourBar, y: &[f64]) -> f64 {
    const H: f64 = 1e-6;
    (gear.acceleration(y[0] + H, y[1]).0 - gear.acceleration(y[0] - H, y[1]).0) / (2.0 * H)
}

/// All curves.
pub fn points() -> Result<Vec<Point>, DiffsolError> {
    let mut points = Vec::new();
    sweep!(points, tsit45 to 26, bdf<Lu> to 20, esdirk34<Lu> to 20);
    Ok(points)
}
