//! Saved states (FMI 2.0.5, 2.1.8): not supported, and the XML says so. The
//! contract of the pointers is that of the module `fmi2`.

use super::guard::call;
use super::phase::{self, Function};
use super::refusal::Refusal;
use super::types::{Byte, Component, FmuState, Status};

/// # Safety
/// As for `guard::call`.
unsafe fn unsupported(c: Component, function: &Function, capability: &str) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(c, function, |_| Err(Refusal::error(format!("not supported: {capability} is false")))) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, _state: *mut FmuState) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { unsupported(c, &phase::GET_FMU_STATE, "canGetAndSetFMUstate") }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: Component, _state: FmuState) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { unsupported(c, &phase::SET_FMU_STATE, "canGetAndSetFMUstate") }
}

/// Does nothing for NULL and for a pointer to NULL; there is no other state that could be freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: `state` is NULL or leads to a state (2.1.8).
    unsafe {
        call(c, &phase::FREE_FMU_STATE, |_| match state.as_ref() {
            Some(state) if !state.is_null() => Err(Refusal::error("not a state of this FMU, which saves none")),
            _ => Ok(()),
        })
    }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Component, _state: FmuState, _size: *mut usize) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { unsupported(c, &phase::SERIALIZED_FMU_STATE_SIZE, "canSerializeFMUstate") }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: Component,
    _state: FmuState,
    _bytes: *mut Byte,
    _size: usize,
) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { unsupported(c, &phase::SERIALIZE_FMU_STATE, "canSerializeFMUstate") }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Component,
    _bytes: *const Byte,
    _size: usize,
    _state: *mut FmuState,
) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { unsupported(c, &phase::DE_SERIALIZE_FMU_STATE, "canSerializeFMUstate") }
}
