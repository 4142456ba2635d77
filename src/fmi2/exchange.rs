//! The functions of model exchange (FMI 2.0.5, 3.2): exported, as hosts look them up, and refused. The contract of the
//! pointers is that of the module `fmi2`.

use super::call;
use super::types::{Boolean, Component, EventInfo, Real, Status};
use crate::fmi::phase::{ALIVE, Function};
use crate::fmi::refusal::Refusal;

/// Exported functions that are always refused, each with the types of its arguments after the component.
macro_rules! refused {
    ($($name:ident($($argument:ty),*);)*) => {
        $(
            /// Not supported.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(c: Component $(, _: $argument)*) -> Status {
                let refusal =
                    || Refusal::error("a function of model exchange; this FMU is for co-simulation, use fmi2DoStep");
                // SAFETY: the component is valid (2.1.5).
                unsafe { call(c, &Function::new(stringify!($name), ALIVE), |_| Err(refusal())) }
            }
        )*
    };
}

refused! {
    fmi2EnterEventMode();
    fmi2NewDiscreteStates(*mut EventInfo);
    fmi2EnterContinuousTimeMode();
    fmi2CompletedIntegratorStep(Boolean, *mut Boolean, *mut Boolean);
    fmi2SetTime(Real);
    fmi2SetContinuousStates(*const Real, usize);
    fmi2GetDerivatives(*mut Real, usize);
    fmi2GetEventIndicators(*mut Real, usize);
    fmi2GetContinuousStates(*mut Real, usize);
    fmi2GetNominalsOfContinuousStates(*mut Real, usize);
}
