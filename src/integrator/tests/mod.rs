//! Systems that the tests integrate.
use super::radau::{self, Start};
use super::{Statistics, Step, System};

mod choice;
mod dop853;
mod dopri5;
mod linear;
mod radau_iia;
mod retake;
mod rk4;
mod rkn86;
mod root;

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
    let (first, jacobian) = (system.derivative(t, y), system.jacobian(t, y));
    let (carry, scale) = ([0.0; N], [1.0; N]);
    let start = Start {
        t,
        y,
        first: &first,
        jacobian: &jacobian,
        carry: &carry,
        before: None,
        scale: &scale,
        tolerance: 1e-14,
    };
    radau::attempt(system, &start, h, &mut Statistics::default()).unwrap().0.step
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
