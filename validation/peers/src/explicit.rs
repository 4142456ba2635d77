//! The crate `differential-equations` on the hand-written equation of motion.
use crate::four_bar::{FourBar, SPAN, START};
use crate::measure::{Point, point, tolerances};
use differential_equations::prelude::{ControlFlag, ExplicitRungeKutta, IVP, Interpolation, ODE, Solout, Solution};
use std::time::Instant;

type State = [f64; 2];

impl ODE<f64, State> for FourBar {
    fn diff(&self, _t: f64, y: &State, rate: &mut State) {
        *rate = [y[1], self.acceleration(y[0], y[1]).0];
    }
}

/// Keeps the last state only.
struct Last<'a>(&'a mut State);

impl Solout<f64, State> for Last<'_> {
    fn solout<I: Interpolation<f64, State> + ?Sized>(
        &mut self,
        _t: f64,
        _before: f64,
        y: &State,
        _y_before: &State,
        _interpolator: &mut I,
        _solution: &mut Solution<f64, State>,
    ) -> ControlFlag<f64, State> {
        *self.0 = *y;
        ControlFlag::Continue
    }
}

/// Points of several methods over the sweep of tolerances.
macro_rules! sweep {
    ($points:ident, $($method:ident),*) => {$(
        for [rtol, atol] in tolerances(28) {
            let began = Instant::now();
            let gear = FourBar::new();
            let set_up = began.elapsed().as_secs_f64();
            let run = || {
                let mut y = START;
                let method = ExplicitRungeKutta::$method().rtol(rtol).atol(atol).max_steps(1_000_000);
                let solved = IVP::ode(&gear, 0.0, SPAN, START).method(method).solout(Last(&mut y)).solve();
                solved.map(|solution| (y[0], solution.evals.function))
            };
            let setting = format!("rtol {rtol:.1e} atol {atol:.1e}");
            $points.extend(point("differential-equations", stringify!($method), setting, set_up, run));
        }
    )*};
}

/// All curves.
pub fn points() -> Vec<Point> {
    let mut points = Vec::new();
    sweep!(points, dopri5, dop853, rkv766e, rkv877e, rkv988e);
    points
}
