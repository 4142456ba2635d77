//! Smooth functions in place of kinks: a rounded maximum and a rounded step.
//!
//! In: an argument and the width of the rounding. Out: the value with its derivative. It must not know what they stand
//! for.
use foundation::numerics::dual::Number;

/// max(0, x), rounded over the width w: (x + sqrt(x^2 + w^2)) / 2.
#[inline]
pub fn soft<T: Number>(x: T, w: f64) -> T {
    let root = (x.value() * x.value() + w * w).sqrt();
    // Where x < 0 the sum cancels; its product with the difference is w^2.
    let value = if x.value() > 0.0 { 0.5 * (x.value() + root) } else { 0.5 * w * w / (root - x.value()) };
    x.chain(value, value / root)
}

/// Step from 0 to 1, rounded over the width w: (1 + x / sqrt(x^2 + w^2)) / 2.
pub fn gate<T: Number>(x: T, w: f64) -> T {
    let square = x.value() * x.value() + w * w;
    let root = square.sqrt();
    x.chain(0.5 + 0.5 * x.value() / root, 0.5 * w * w / (square * root))
}

/// Pressure [Pa] whose square root divides a pressure drop d in the law of an orifice: sqrt(d^2 + d_t^2), or, where the
/// flow switches from laminar to turbulent, the larger one of |d| and d_t.
#[inline]
pub fn head<T: Number>(d: T, transition: f64, switches: bool) -> T {
    if !switches {
        return (d * d + T::constant(transition * transition)).sqrt();
    }
    if d.value().abs() < transition { T::constant(transition) } else { d * d.value().signum() }
}
