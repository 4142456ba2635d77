//! The crate `differential-equations` on the hand-written equation of motion.
use crate::four_bar::{FourBar, SPAN, START};
use crate::measure::{Point, error, fastest};
use differential_equations::prelude::{ControlFlag, ExplicitRungeKutta, IVP, Interpolation, ODE, Solout, Solution};
use std::time::Instant;

const TOOL: &str = "differential-equations";
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

/// Run one method over the sweep of tolerances.
macro_rules! sweep {
    ($points:ident, $($method:ident),*) => {$(
        for half in 4..=28 {
            for ratio in [1.0, 1e-2] {
                let rtol = 10f64.powf(-f64::from(half) / 2.0);
                let began = Instant::now();
                let gear = FourBar::new();
                let set_up = began.elapsed().as_secs_f64();
                let run = fastest(|| {
                    let mut y = START;
                    let method = ExplicitRungeKutta::$method().rtol(rtol).atol(ratio * rtol).max_steps(1_000_000);
                    IVP::ode(&gear, 0.0, SPAN, START)
                        .method(method)
                        .solout(Last(&mut y))
                        .solve()
                        .map(|solution| (y[0], solution.evals.function))
                });
                let method = stringify!($method);
                let setting = format!("rtol {rtol:.1e} atol {:.1e}", ratio * rtol);
                match run {
                    Ok(((theta2, evaluations), run)) => $points.push(Point {
                        scene: "S1",
                        tool: TOOL,
                        method: method.into(),
                        setting,
                        error: error(theta2),
                        run,
                        set_up,
                        evaluations: Some(evaluations),
                    }),
                    Err(reason) => println!("{TOOL} {method} {setting}: {reason:?}"),
                }
            }
        }
    )*};
}

/// All curves.
pub fn points() -> Vec<Point> {
    let mut points = Vec::new();
    sweep!(points, dopri5, dop853, rkv766e, rkv877e, rkv988e);
    points
}
