//! Saved states (FMI 2.0.5, 2.1.8). The contract of the pointers is that of the
//! module `fmi2`; besides, a state is used by one thread at a time while it is written or freed.
//!
//! A state belongs to no instance: each of the same mechanism takes it, and it outlives the one that was saved. What is no
//! state, a state of another mechanism and most that were freed are refused by what stands at the head of a state. What
//! cannot be told: memory that was given back to the system, or that holds another state by now.

use super::array::{input, output};
use super::guard::call;
use super::instance::Instance;
use super::phase;
use super::refusal::Refusal;
use super::saved::Saved;
use super::types::{Byte, Component, FmuState, Status};
use std::sync::atomic::{AtomicU64, Ordering};

/// First word of a state.
const ALIVE: u64 = u64::from_be_bytes(*b"linkstat");
/// First word of a state that was freed.
const FREED: u64 = 0;

/// What an FMU state points to.
struct Kept {
    word: AtomicU64,
    /// The mechanism that it is a state of.
    identity: [u64; 2],
    saved: Saved,
}

/// A new state for the host to keep.
fn keep(saved: Saved, identity: [u64; 2]) -> FmuState {
    Box::into_raw(Box::new(Kept { word: AtomicU64::new(ALIVE), identity, saved })).cast()
}

/// The state behind a pointer, for an instance of this mechanism.
///
/// # Errors
/// NULL, no state, one that was freed, or one of another mechanism.
///
/// # Safety
/// `state` is NULL or leads to readable memory of a state's size; if that is a state, nobody else uses it during `'a`
/// (FMI 2.0.5, 2.1.8).
#[inline(always)]
unsafe fn kept<'a>(state: FmuState, instance: &Instance) -> Result<&'a mut Kept, Refusal> {
    let kept = state.cast::<Kept>();
    if kept.is_null() {
        return Err(Refusal::error("the state is NULL; pass one of fmi2GetFMUstate or fmi2DeSerializeFMUstate"));
    }
    let foreign = "the pointer leads to no state of this FMU, or to one that was freed";
    if !kept.is_aligned() {
        return Err(Refusal::error(foreign));
    }
    // SAFETY: not NULL and aligned is checked; the caller promises that the memory can be read. The word is read apart, as
    // the rest of what is no state need not be valid.
    if unsafe { (*kept).word.load(Ordering::Relaxed) } != ALIVE {
        return Err(Refusal::error(foreign));
    }
    // SAFETY: only `keep` writes this word, in front of a whole state; the caller promises that nobody else uses it.
    let kept = unsafe { &mut *kept };
    if kept.identity != instance.identity() {
        return Err(Refusal::error("the state was saved by another FMU, or with another mechanism.json"));
    }
    Ok(kept)
}

/// The pointer to a state that the host has room for.
///
/// # Errors
/// NULL or misaligned.
///
/// # Safety
/// A valid `state` leads to a pointer that nobody else uses during `'a` (FMI 2.0.5, 2.1.8).
#[inline(always)]
unsafe fn place<'a>(state: *mut FmuState) -> Result<&'a mut FmuState, Refusal> {
    // SAFETY: the caller's promise.
    let room = unsafe { output("FMUstate", state, 1) }?;
    // SAFETY: the host has written the pointer, as it is the standard's "in and out" (2.1.8).
    Ok(unsafe { room[0].assume_init_mut() })
}

/// Save everything that decides what the instance does from here on. A state that `*state` already leads to is written over.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: `state` is room for a pointer, which is NULL or leads to a state (2.1.8).
    unsafe {
        call(c, &phase::GET_FMU_STATE, |i| {
            let state = place(state)?;
            if state.is_null() {
                *state = keep(i.save(), i.identity());
            } else {
                i.save_into(&mut kept(*state, i)?.saved);
            }
            Ok(())
        })
    }
}

/// Go on from a saved state, in the phase that it was saved in.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: Component, state: FmuState) -> Status {
    // SAFETY: `state` is NULL or leads to a state (2.1.8).
    unsafe { call(c, &phase::SET_FMU_STATE, |i| i.restore(&kept(state, i)?.saved)) }
}

/// End of a state; `*state` becomes NULL. Does nothing for NULL and for a pointer to NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: `state` is NULL or leads to a pointer, and that is NULL or leads to a state (2.1.8).
    unsafe {
        call(c, &phase::FREE_FMU_STATE, |i| {
            if state.is_null() {
                return Ok(());
            }
            let state = place(state)?;
            if !state.is_null() {
                kept(*state, i)?.word.store(FREED, Ordering::Relaxed);
                drop(Box::from_raw(state.cast::<Kept>()));
                *state = std::ptr::null_mut();
            }
            Ok(())
        })
    }
}

/// Number of bytes that [`fmi2SerializeFMUstate`] writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status {
    // SAFETY: `state` is NULL or leads to a state, `size` is room for a number (2.1.8).
    unsafe {
        call(c, &phase::SERIALIZED_FMU_STATE_SIZE, |i| {
            let kept = kept(state, i)?;
            output("size", size, 1)?[0].write(kept.saved.to_bytes(kept.identity)?.len());
            Ok(())
        })
    }
}

/// Write the state as bytes that any process can read, on any machine. `size` is what [`fmi2SerializedFMUstateSize`] told.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status {
    // SAFETY: `state` is NULL or leads to a state, `bytes` is room for `size` bytes (2.1.8).
    unsafe {
        call(c, &phase::SERIALIZE_FMU_STATE, |i| {
            let kept = kept(state, i)?;
            let serialized = kept.saved.to_bytes(kept.identity)?;
            if size != serialized.len() {
                let needed = serialized.len();
                return Err(Refusal::error(format!(
                    "size is {size}; the state has {needed} bytes, pass room for these"
                )));
            }
            for (room, byte) in output("serializedState", bytes.cast::<u8>(), size)?.iter_mut().zip(serialized) {
                room.write(byte);
            }
            Ok(())
        })
    }
}

/// New state from bytes that [`fmi2SerializeFMUstate`] wrote, in this process or another. What `*state` was is not read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Component,
    bytes: *const Byte,
    size: usize,
    state: *mut FmuState,
) -> Status {
    // SAFETY: `bytes` has `size` bytes, `state` is room for a pointer (2.1.8).
    unsafe {
        call(c, &phase::DE_SERIALIZE_FMU_STATE, |i| {
            let room = output("FMUstate", state, 1)?;
            let saved = i.deserialize(input("serializedState", bytes.cast::<u8>(), size)?)?;
            room[0].write(keep(saved, i.identity()));
            Ok(())
        })
    }
}
