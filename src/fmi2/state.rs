//! Saved states (FMI 2.0.5, 2.1.8). The contract of the pointers is that of the module `fmi2`; besides, a state is used
//! by one thread at a time while it is written or freed.

use super::types::{Byte, Component, FmuState, Status};
use crate::fmi::array::{input, output};
use crate::fmi::phase::{ALIVE, Function};
use crate::fmi::{handle, state_handle};

exported! {
    /// Save everything that decides how the instance goes on. A state that `*state` already leads to is overwritten.
    // SAFETY: `state` leads to a pointer, which is NULL or leads to a state (2.1.8).
    fn fmi2GetFMUstate(state: *mut FmuState) in ALIVE => |i| state_handle::save(i, state);

    /// Go on from a saved state, in the phase in which it was saved.
    // SAFETY: `state` is NULL or leads to a state (2.1.8).
    fn fmi2SetFMUstate(state: FmuState) in ALIVE => |i| state_handle::restore(i, state);

    /// End of a state; `*state` becomes NULL. Does nothing for NULL and for a pointer to NULL.
    // SAFETY: `state` is NULL or leads to a pointer, and that is NULL or leads to a state (2.1.8).
    fn fmi2FreeFMUstate(state: *mut FmuState) in ALIVE => |i| state_handle::free(i, state);

    /// Number of bytes that [`fmi2SerializeFMUstate`] writes.
    // SAFETY: `state` is NULL or leads to a state, `size` leads to memory for a number (2.1.8).
    fn fmi2SerializedFMUstateSize(state: FmuState, size: *mut usize) in ALIVE => |i| {
        let bytes = state_handle::serialize(i, state)?;
        output("size", size, 1)?[0].write(bytes.len());
        Ok(())
    };

    /// Write the state as bytes that any process can read, on any machine. `size` is that of
    /// [`fmi2SerializedFMUstateSize`].
    // SAFETY: `state` is NULL or leads to a state, `bytes` leads to memory for `size` bytes (2.1.8).
    fn fmi2SerializeFMUstate(state: FmuState, bytes: *mut Byte, size: usize) in ALIVE => |i|
        state_handle::serialize_to(i, state, bytes.cast(), size);

    /// New state from bytes of [`fmi2SerializeFMUstate`], in this process or another. The previous value of `*state` is
    /// not read.
    // SAFETY: `bytes` has `size` bytes, `state` leads to memory for a pointer (2.1.8).
    fn fmi2DeSerializeFMUstate(bytes: *const Byte, size: usize, state: *mut FmuState) in ALIVE => |i|
        state_handle::deserialize(i, input("serializedState", bytes.cast::<u8>(), size)?, state);
}
