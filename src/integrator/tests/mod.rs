//! Systems that the tests integrate.
use super::methods::radau::{Newton, Radau};
use super::pair::{Pair, Start};
use super::step::Stages;
use super::{Statistics, Step, System};

mod choice;
mod dop853;
mod dopri5;
mod radau_iia;
mod retake;
mod rk4;
mod rkn86;
mod root;
mod stiffness;

/// y'' = -y as (y, y').
pub struct Oscillator;
impl System<2> for Oscillator {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0]]
    }
    fn scale(&mut self, _y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, 1.0]
    }
}

/// y' = t^degree.
pub struct Power(pub i32);
impl System<1> for Power {
    fn derivative(&mut self, t: f64, _y: &[f64; 1]) -> [f64; 1] {
        [t.powi(self.0)]
    }
    fn scale(&mut self, _y: &[f64; 1], _f: &[f64; 1]) -> [f64; 1] {
        [1.0]
    }
    fn jacobian(&mut self, _t: f64, _y: &[f64; 1]) -> [[f64; 1]; 1] {
        [[0.0]]
    }
}

/// One step of Radau of size h, without error control.
pub fn implicitly<S: System<N>, const N: usize>(system: &mut S, t: f64, y: &[f64; N], h: f64) -> Step<N> {
    let (start, jacobian) = (start(system, t, y), system.jacobian(t, y));
    let newton = Newton { jacobian: &jacobian, scale: &[1.0; N], tolerance: 1e-14, before: None };
    let outcome = Radau::attempt(system, &start, &newton, h, &mut Statistics::default()).unwrap().0;
    Step::new(&start, h, false, outcome)
}

/// One step of an explicit pair of size h, without error control.
pub fn explicitly<P: Pair<N> + Into<Stages<N>>, S: System<N>, const N: usize>(
    system: &mut S,
    t: f64,
    y: &[f64; N],
    h: f64,
) -> Step<N> {
    let start = start(system, t, y);
    Step::new(&start, h, false, P::attempt(system, &start, h))
}

/// A start whose sums have lost nothing.
fn start<S: System<N>, const N: usize>(system: &mut S, t: f64, y: &[f64; N]) -> Start<N> {
    Start { t, y: *y, first: system.derivative(t, y), carry: [0.0; N] }
}

/// A system without its Jacobian.
pub struct WithoutJacobian<S>(pub S);
impl<S: System<N>, const N: usize> System<N> for WithoutJacobian<S> {
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.0.derivative(t, y)
    }
    fn scale(&mut self, y: &[f64; N], f: &[f64; N]) -> [f64; N] {
        self.0.scale(y, f)
    }
}
