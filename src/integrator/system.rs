//! What is integrated, and why an integration stops.
/// A first-order system with the error weights of its components. f must be smooth: who has kinks ends a step at each.
pub trait System<const N: usize> {
    /// Whether df/dy can have eigenvalues far in the left half-plane. Only then does the integration look for stiffness
    /// and ask for the Jacobian.
    const CAN_BE_STIFF: bool = false;

    /// Whether y = (q, q') with q'' = f(t, q): the force does not depend on the speed.
    const SECOND_ORDER: bool = false;

    /// Number of leading components on which f depends. The components after these are integrals beside the motion:
    /// stages leave them as they are at the start of a step, and the scale is to give them no weight in its error.
    const LEADING: usize = N;

    /// Number of leading components on which f depends where only the system at hand knows it: at most
    /// [`Self::LEADING`]. Linear systems of implicit steps have so many unknowns.
    #[inline]
    fn leading_components(&self) -> usize {
        Self::LEADING
    }

    /// f(t, y); t is counted from the start of the span [s].
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N];

    /// f(t, y), of which only the leading components are read.
    #[inline]
    fn leading(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.derivative(t, y)
    }

    /// q'' where q is `way` on from that of y, of a system of second order.
    #[inline]
    fn acceleration(&mut self, t: f64, y: &[f64; N], way: f64) -> f64 {
        let mut at = *y;
        at[0] += way;
        self.derivative(t, &at)[1]
    }

    /// Size of each component, to which the relative tolerance applies; positive. `f` is f(t, y).
    fn scale(&mut self, y: &[f64; N], f: &[f64; N]) -> [f64; N];

    /// Whether a step may end at y: a step to a state where f has no meaning was too long, whatever its error estimate.
    #[inline]
    fn admits(&mut self, _y: &[f64; N]) -> bool {
        true
    }

    /// df/dy: row i is the gradient of f_i. By default from one-sided differences; a system that can be stiff should
    /// know better, as Newton's method converges the faster the more exact this is.
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
        let mut beside = *y;
        beside[j] += f64::EPSILON.sqrt() * y[j].abs().max(scale[j]);
        let width = beside[j] - y[j];
        let g = system.derivative(t, &beside);
        for (row, (g, f)) in rows.iter_mut().zip(g.iter().zip(&f)) {
            row[j] = (g - f) / width;
        }
    }
    rows
}

/// Why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationError {
    /// No step above the round-off of time meets the tolerance.
    StepTooSmall {
        /// Time since the start of the span [s].
        t: f64,
        /// The step size that was still too large [s].
        step: f64,
    },
}
