//! The interface of a system to the integration, and the error of an integration.
/// A first-order system with the error weights of its components. f must be smooth: a step must end at each kink of f.
pub trait System<const N: usize> {
    /// Whether df/dy can have eigenvalues far in the left half-plane. Only then does the integration check for
    /// stiffness and use the Jacobian.
    const CAN_BE_STIFF: bool = false;

    /// Whether y = (q, q') with q'' = f(t, q), so that the force does not depend on the speed.
    const SECOND_ORDER: bool = false;

    /// Number of leading components on which f depends. The other components are integrals. Stages leave them at their
    /// values at the start of a step, and [`Self::scale`] should give them no weight in the error.
    const LEADING: usize = N;

    /// Number of leading components on which f depends, if only the present system determines it: at most
    /// [`Self::LEADING`]. This is the number of unknowns in the linear systems of implicit steps.
    #[inline]
    fn leading_components(&self) -> usize {
        Self::LEADING
    }

    /// f(t, y). The time t [s] is measured from the start of the span.
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N];

    /// f(t, y), of which only the leading components are used.
    #[inline]
    fn leading(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.derivative(t, y)
    }

    /// q'' of a second-order system, at the position q of y plus `displacement`.
    #[inline]
    fn acceleration(&mut self, t: f64, y: &[f64; N], displacement: f64) -> f64 {
        let mut at = *y;
        at[0] += displacement;
        self.derivative(t, &at)[1]
    }

    /// Scale > 0 of each component, to which the relative tolerance applies. `f` is f(t, y).
    fn scale(&mut self, y: &[f64; N], f: &[f64; N]) -> [f64; N];

    /// Whether a step may end at y. A step to a state where f is not defined was too long, regardless of its error
    /// estimate.
    #[inline]
    fn admits(&mut self, _y: &[f64; N]) -> bool {
        true
    }

    /// df/dy: row i is the gradient of f_i. The default uses one-sided differences. A system that can be stiff should
    /// return exact derivatives, with which Newton's method converges faster.
    fn jacobian(&mut self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        differences(self, t, y, 0..N)
    }
}

/// df/dy along some components by one-sided differences; 0 along the others.
pub fn differences<S: System<N> + ?Sized, const N: usize>(
    system: &mut S,
    t: f64,
    y: &[f64; N],
    components: impl Iterator<Item = usize>,
) -> [[f64; N]; N] {
    let f = system.derivative(t, y);
    let scale = system.scale(y, &f);
    let mut rows = [[0.0; N]; N];
    for j in components {
        let mut shifted = *y;
        shifted[j] += f64::EPSILON.sqrt() * y[j].abs().max(scale[j]);
        let width = shifted[j] - y[j];
        let g = system.derivative(t, &shifted);
        for (row, (g, f)) in rows.iter_mut().zip(g.iter().zip(&f)) {
            row[j] = (g - f) / width;
        }
    }
    rows
}

/// Reason why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationError {
    /// No step above the rounding error of time meets the tolerance.
    StepTooSmall {
        /// Time since the start of the span [s].
        t: f64,
        /// The step size that was still too large [s].
        step: f64,
    },
}
