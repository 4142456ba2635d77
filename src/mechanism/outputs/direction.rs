//! The direction in which state and inputs change, for derivatives along it.
use crate::mechanism::dynamics::input_polynomial::Change;
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::dual::Number;

/// A direction: state and inputs as functions of one parameter s, at s = 0.
#[derive(Clone, Debug)]
pub struct Direction<N> {
    /// s itself, with the derivative 1 if N carries derivatives.
    pub s: N,
    /// d sigma / d s and d sigma_dot / d s.
    pub along: [f64; 2],
    /// du / d s of the Real inputs; none where nothing changes.
    pub rates: Vec<f64>,
    /// As many zeros: the second derivatives of the inputs along s.
    zeros: Vec<f64>,
}

impl<N: Number> Direction<N> {
    /// A direction along s in which nothing changes yet.
    pub fn new(s: N, inputs: usize) -> Self {
        Self { s, along: [0.0; 2], rates: vec![0.0; inputs], zeros: vec![0.0; inputs] }
    }

    /// A Real input, from its value.
    #[inline]
    pub fn input(&self, input: usize, value: f64) -> N {
        self.s.chain(value, self.rates.get(input).copied().unwrap_or(0.0))
    }

    /// Change of the inputs that size loads and of the airspeed; the airspeed is the last input.
    pub fn change(&self, loading: &Loading) -> Option<Change<'_>> {
        let loads = loading.inputs.len();
        let air = self.rates.last().filter(|_| loading.air.is_some()).copied().unwrap_or(0.0);
        N::CARRIES.then(|| Change { first: &self.rates[..loads], second: &self.zeros[..loads], airspeed: [air, 0.0] })
    }
}
