//! Systems for the tests of the integration.
use super::methods::radau::{Newton, Radau};
use super::pair::{Pair, Start};
use super::step::Stages;
use super::{Integrator, Statistics, Step, System};

mod choice;
mod dop853;
mod kept;
mod orders;
mod radau_iia;
mod retake;
mod rkn86;
mod root;
mod short;

/// A function f(t, y) as a system whose components have the scale 1.
impl<F: FnMut(f64, &[f64; N]) -> [f64; N], const N: usize> System<N> for F {
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self(t, y)
    }
    fn scale(&mut self, _y: &[f64; N], _f: &[f64; N]) -> [f64; N] {
        [1.0; N]
    }
}

/// Such a system of second order.
pub struct SecondOrder<F>(pub F);
impl<F: FnMut(f64, &[f64; N]) -> [f64; N], const N: usize> System<N> for SecondOrder<F> {
    const SECOND_ORDER: bool = true;
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.0(t, y)
    }
    fn scale(&mut self, _y: &[f64; N], _f: &[f64; N]) -> [f64; N] {
        [1.0; N]
    }
}

/// Such a system that can be stiff, with its Jacobian.
pub struct Stiff<F, J>(pub F, pub J);
impl<F, J, const N: usize> System<N> for Stiff<F, J>
where
    F: FnMut(f64, &[f64; N]) -> [f64; N],
    J: FnMut(f64, &[f64; N]) -> [[f64; N]; N],
{
    const CAN_BE_STIFF: bool = true;
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.0(t, y)
    }
    fn scale(&mut self, _y: &[f64; N], _f: &[f64; N]) -> [f64; N] {
        [1.0; N]
    }
    fn jacobian(&mut self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        self.1(t, y)
    }
}

/// y'' = -y as (y, y').
pub fn oscillator(_t: f64, y: &[f64; 2]) -> [f64; 2] {
    [y[1], -y[0]]
}

/// Distance from the exact solution (cos t, -sin t).
pub fn miss(y: &[f64; 2], t: f64) -> f64 {
    (y[0] - t.cos()).hypot(y[1] + t.sin())
}

/// y'' = -sin y as (y, y').
pub fn pendulum(_t: f64, y: &[f64; 2]) -> [f64; 2] {
    [y[1], -y[0].sin()]
}

/// y'' = -sin y - y'/10 as (y, y').
pub fn damped(_t: f64, y: &[f64; 2]) -> [f64; 2] {
    [y[1], -y[0].sin() - 0.1 * y[1]]
}

/// y' = t^degree.
pub fn power(degree: i32) -> impl Fn(f64, &[f64; 1]) -> [f64; 1] {
    move |t, _| [t.powi(degree)]
}

/// The end of a number of spans h from (1, 0).
pub fn run(system: &mut impl System<2>, h: f64, spans: u32, tolerance: f64) -> ([f64; 2], Integrator<2>) {
    let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
    for _ in 0..spans {
        integrator.advance(system, &mut y, h, tolerance).unwrap();
    }
    (y, integrator)
}

/// One Radau step of size h without error control.
pub fn implicitly<S: System<N>, const N: usize>(system: &mut S, t: f64, y: &[f64; N], h: f64) -> Step<N> {
    let (start, jacobian) = (start(system, t, y), system.jacobian(t, y));
    let newton = Newton { scale: &[1.0; N], tolerance: 1e-14, before: None };
    let mut kept = super::kept::Kept::default();
    kept.take(&jacobian, system.leading_components(), 0.0);
    let outcome = Radau::attempt(system, &start, (&newton, &mut kept), h, &mut Statistics::default()).unwrap().0;
    Step::new(&start, h, false, outcome)
}

/// One step of an explicit pair of size h without error control.
pub fn explicitly<P: Pair<N> + Into<Stages<N>>, S: System<N>, const N: usize>(
    system: &mut S,
    t: f64,
    y: &[f64; N],
    h: f64,
) -> Step<N> {
    let start = start(system, t, y);
    Step::new(&start, h, false, P::attempt(system, &start, h))
}

/// A start without compensation.
fn start<S: System<N>, const N: usize>(system: &mut S, t: f64, y: &[f64; N]) -> Start<N> {
    Start { t, y: *y, first: system.derivative(t, y), carry: [0.0; N] }
}
