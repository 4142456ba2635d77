//! Saved states (FMI 2.0.5, 2.1.8). The contract of the pointers is that of the
//! module `fmi2`; besides, a state is used by one thread at a time while it is written or freed.

use super::types::{Byte, Component, FmuState, Status};
use super::{call, phase};
use crate::fmi::array::{input, output};
use crate::fmi::state_handle as state_of;

/// Save everything that decides how the instance goes on. A state that `*state` already leads to is overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: `state` leads to a pointer, which is NULL or leads to a state (2.1.8).
    unsafe { call(c, &phase::GET_FMU_STATE, |i| state_of::save(i, state)) }
}

/// Go on from a saved state, in the phase in which it was saved.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: Component, state: FmuState) -> Status {
    // SAFETY: `state` is NULL or leads to a state (2.1.8).
    unsafe { call(c, &phase::SET_FMU_STATE, |i| state_of::restore(i, state)) }
}

/// End of a state; `*state` becomes NULL. Does nothing for NULL and for a pointer to NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: `state` is NULL or leads to a pointer, and that is NULL or leads to a state (2.1.8).
    unsafe { call(c, &phase::FREE_FMU_STATE, |i| state_of::free(i, state)) }
}

/// Number of bytes that [`fmi2SerializeFMUstate`] writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status {
    // SAFETY: `state` is NULL or leads to a state, `size` leads to memory for a number (2.1.8).
    unsafe {
        call(c, &phase::SERIALIZED_FMU_STATE_SIZE, |i| {
            let bytes = state_of::serialize(i, state)?;
            output("size", size, 1)?[0].write(bytes.len());
            Ok(())
        })
    }
}

/// Write the state as bytes that any process can read, on any machine. `size` is that of
/// [`fmi2SerializedFMUstateSize`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status {
    // SAFETY: `state` is NULL or leads to a state, `bytes` leads to memory for `size` bytes (2.1.8).
    unsafe { call(c, &phase::SERIALIZE_FMU_STATE, |i| state_of::serialize_to(i, state, bytes.cast(), size)) }
}

/// New state from bytes of [`fmi2SerializeFMUstate`], in this process or another. The previous value of `*state` is not
/// read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Component,
    bytes: *const Byte,
    size: usize,
    state: *mut FmuState,
) -> Status {
    // SAFETY: `bytes` has `size` bytes, `state` leads to memory for a pointer (2.1.8).
    unsafe {
        call(c, &phase::DE_SERIALIZE_FMU_STATE, |i| {
            state_of::deserialize(i, input("serializedState", bytes.cast::<u8>(), size)?, state)
        })
    }
}
