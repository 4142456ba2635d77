//! Derivatives of outputs and inputs (FMI 2.0.5, 2.1.9, 4.2.1). The contract of the pointers is that of the module
//! `fmi2`.

use super::types::{Component, Integer, Real, Status, ValueReference};
use crate::fmi::array::{input, output};
use crate::fmi::handle;
use crate::fmi::phase::{Function, INITIALIZATION, SETTABLE, STEPPED};

exported! {
    /// For each unknown the sum over the knowns of the partial derivative times `known_rates`, at the present state,
    /// exact.
    ///
    /// An unknown is a continuous output, a known is a continuous input. Refused with `solver.method` = "rigid_fem". On
    /// an error the array may be filled in part.
    // SAFETY: two arrays have `unknown_count` elements, two have `known_count` (2.1.9).
    fn fmi2GetDirectionalDerivative(
        unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize,
        known_rates: *const Real, unknown_rates: *mut Real
    ) in INITIALIZATION | STEPPED => |i| {
        let unknowns = input("vUnknown_ref", unknowns, unknown_count)?;
        let knowns = input("vKnown_ref", knowns, known_count)?;
        let seeds = input("dvKnown", known_rates, known_count)?;
        i.directional_derivative(unknowns, knowns, seeds, output("dvUnknown", unknown_rates, unknown_count)?)
    };

    /// Set derivatives of order 1 and 2 of continuous inputs, all or none: u(t) = u_0 + u_1 t + u_2 t^2 / 2 from the
    /// present communication point on.
    ///
    /// The derivatives are 0 until set. They refer to the beginning of a step (4.2.1) and hold for one step. At its end
    /// the inputs are u(h), which `fmi2GetReal` then reads, and stay constant. `fmi2SetReal` sets u_0, before or after
    /// this function. Refused with `solver.method` = "rigid_fem".
    // SAFETY: all arrays have `count` elements (4.2.1).
    fn fmi2SetRealInputDerivatives(
        vr: *const ValueReference, count: usize, order: *const Integer, value: *const Real
    ) in SETTABLE => |i| {
        let (vr, order) = (input("vr", vr, count)?, input("order", order, count)?);
        i.set_input_derivatives(vr, order, input("value", value, count)?)
    };

    /// First time derivatives of continuous outputs at the present communication point, exact, under inputs that change
    /// with the derivatives set for the next step. After a step and before an input is set: with the derivatives at the
    /// step's end.
    ///
    /// Refused with `solver.method` = "rigid_fem". On an error the array may be filled in part.
    // SAFETY: all arrays have `count` elements (4.2.1).
    fn fmi2GetRealOutputDerivatives(
        vr: *const ValueReference, count: usize, order: *const Integer, value: *mut Real
    ) in INITIALIZATION | STEPPED => |i| {
        let (vr, order) = (input("vr", vr, count)?, input("order", order, count)?);
        i.output_derivatives(vr, order, output("value", value, count)?)
    };
}
