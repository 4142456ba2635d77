//! Pointers to saved states.
//!
//! In: an instance and pointers of the host. Out: states, or a refusal. A state belongs to no instance: every instance
//! of the same identity accepts the state, also after the saved instance was freed. The first words of a state
//! distinguish it from other memory, and mostly from a freed state. They also show another identity or another version
//! of this library. They cannot detect memory that was returned to the system, or that now holds another state.
//!
//! # Safety
//! All functions share the contract of FMI 2.0.5, 2.1.8. A state is NULL or points to readable memory of the size of a
//! state. A pointer to a state is NULL or points to a pointer. Nothing else uses either during the call.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::array::output;
use super::instance::Instance;
use super::refusal::Refusal;
use super::saved::Saved;
use crate::component::Snapshot;
use std::ffi::c_void;
use std::mem::offset_of;
use std::sync::atomic::{AtomicU64, Ordering};

/// A saved state, opaque to the host.
pub type State = *mut c_void;

/// First word of a state. It depends on the version of this library and on the layout of a state. Different libraries
/// in one process therefore reject each other's states.
const ALIVE: u64 = word(env!("CARGO_PKG_VERSION"), &LAYOUT);
/// Sizes and offsets of the layout of [`Kept`] [bytes], and the kind of build.
const LAYOUT: [usize; 8] = [
    size_of::<Kept>(),
    align_of::<Kept>(),
    offset_of!(Kept, identity),
    offset_of!(Kept, saved),
    offset_of!(Saved, clock),
    offset_of!(Saved, component),
    size_of::<Snapshot>(),
    cfg!(debug_assertions) as usize,
];
/// First word of a state that was freed.
const FREED: u64 = 0;

/// First word for a version and a layout: FNV-1a of both.
const fn word(version: &str, layout: &[usize]) -> u64 {
    const fn mixed(hash: u64, part: u64) -> u64 {
        (hash ^ part).wrapping_mul(0x0000_0100_0000_01B3)
    }
    let (mut hash, mut i, mut k) = (u64::from_be_bytes(*b"linkstat"), 0, 0);
    while i < version.len() {
        hash = mixed(hash, version.as_bytes()[i] as u64);
        i += 1;
    }
    while k < layout.len() {
        hash = mixed(hash, layout[k] as u64);
        k += 1;
    }
    hash
}

/// Memory behind the pointer to a state.
struct Kept {
    word: AtomicU64,
    /// Identity of the component that was saved.
    identity: [u64; 2],
    saved: Saved,
    /// Serialised bytes whose size the host has requested, until the host reads them or the state is overwritten.
    bytes: Option<Vec<u8>>,
}

/// A new state for the host.
fn new_state(saved: Saved, instance: &Instance) -> State {
    let kept = Kept { word: AtomicU64::new(ALIVE), identity: instance.component.identity(), saved, bytes: None };
    Box::into_raw(Box::new(kept)).cast()
}

/// The state behind a pointer, for this instance.
///
/// # Errors
/// NULL, memory without a state, a freed state, or a state of another identity.
#[inline(always)]
unsafe fn kept<'a>(state: State, instance: &Instance) -> Result<&'a mut Kept, Refusal> {
    let kept = state.cast::<Kept>();
    if kept.is_null() {
        return Err(Refusal::error("the state is NULL; pass a saved or deserialized state"));
    }
    let foreign = "the pointer is not a saved state of this FMU and this library version, or the state was freed";
    if !kept.is_aligned() {
        return Err(Refusal::error(foreign));
    }
    // SAFETY: the pointer is not NULL and aligned. The caller guarantees that the memory can be read. The word is read
    // separately, because the rest of other memory need not be valid.
    if unsafe { (*kept).word.load(Ordering::Relaxed) } != ALIVE {
        return Err(Refusal::error(foreign));
    }
    // SAFETY: only `new_state` writes this word, before a complete state. The caller guarantees that nothing else uses
    // the state.
    let kept = unsafe { &mut *kept };
    if kept.identity != instance.component.identity() {
        return Err(Refusal::error(format!(
            "the state was saved by another FMU, or with a different {}",
            instance.component.definition_file()
        )));
    }
    Ok(kept)
}

/// The host's pointer to a state.
///
/// # Errors
/// The pointer to it is NULL or misaligned.
#[inline(always)]
unsafe fn pointer<'a>(state: *mut State) -> Result<&'a mut State, Refusal> {
    // SAFETY: guaranteed by the caller.
    let pointer = unsafe { output("pointer to a state", state, 1) }?;
    // SAFETY: the host has initialised the pointer, which is "in and out" in the standard (2.1.8).
    Ok(unsafe { pointer[0].assume_init_mut() })
}

/// Saves the instance. An existing state at `*state` is overwritten.
#[inline]
pub unsafe fn save(instance: &Instance, state: *mut State) -> Result<(), Refusal> {
    // SAFETY: guaranteed by the caller.
    let state = unsafe { pointer(state) }?;
    if state.is_null() {
        *state = new_state(instance.save(), instance);
    } else {
        // SAFETY: guaranteed by the caller.
        let kept = unsafe { kept(*state, instance) }?;
        instance.save_into(&mut kept.saved);
        kept.bytes = None;
    }
    Ok(())
}

/// Restores a saved state, with the phase in which it was saved.
#[inline]
pub unsafe fn restore(instance: &mut Instance, state: State) -> Result<(), Refusal> {
    // SAFETY: guaranteed by the caller.
    let kept = unsafe { kept(state, instance) }?;
    instance.restore(&kept.saved)
}

/// Frees a state and sets `*state` to NULL. Does nothing for NULL and for a pointer to NULL.
pub unsafe fn free(instance: &Instance, state: *mut State) -> Result<(), Refusal> {
    if state.is_null() {
        return Ok(());
    }
    // SAFETY: guaranteed by the caller.
    let state = unsafe { pointer(state) }?;
    if !state.is_null() {
        // SAFETY: guaranteed by the caller; `new_state` boxed the state, and only this block unboxes it.
        unsafe {
            kept(*state, instance)?.word.store(FREED, Ordering::Relaxed);
            drop(Box::from_raw(state.cast::<Kept>()));
        }
        *state = std::ptr::null_mut();
    }
    Ok(())
}

/// The bytes of a state, which any process on any machine can read.
unsafe fn serialized<'a>(instance: &mut Instance, state: State) -> Result<&'a mut Option<Vec<u8>>, Refusal> {
    // SAFETY: guaranteed by the caller.
    let kept = unsafe { kept(state, instance) }?;
    if kept.bytes.is_none() {
        kept.bytes = Some(kept.saved.serialise(kept.identity, std::mem::take(&mut instance.spare))?);
    }
    Ok(&mut kept.bytes)
}

/// Number of bytes that [`serialize_to`] writes. The bytes are kept for the next call of [`serialize_to`].
pub unsafe fn serialized_size(instance: &mut Instance, state: State) -> Result<usize, Refusal> {
    // SAFETY: guaranteed by the caller.
    Ok(unsafe { serialized(instance, state) }?.as_ref().map_or(0, Vec::len))
}

/// Writes the bytes of a state to `size` bytes at `bytes`.
pub unsafe fn serialize_to(instance: &mut Instance, state: State, bytes: *mut u8, size: usize) -> Result<(), Refusal> {
    // SAFETY: guaranteed by the caller.
    let serialized = unsafe { serialized(instance, state) }?;
    let needed = serialized.as_ref().map_or(0, Vec::len);
    if size != needed {
        return Err(Refusal::error(format!(
            "size is {size}, but the state has {needed} bytes; pass a buffer of exactly {needed} bytes"
        )));
    }
    // SAFETY: guaranteed by the caller.
    let bytes = unsafe { output("serializedState", bytes, size) }?;
    let serialized = serialized.take().unwrap_or_default();
    // SAFETY: both have this length, and the vector does not overlap the host's memory.
    unsafe { std::ptr::copy_nonoverlapping(serialized.as_ptr(), bytes.as_mut_ptr().cast(), serialized.len()) };
    instance.spare = serialized;
    Ok(())
}

/// Creates a state from bytes that [`serialize_to`] wrote. The previous value of `*state` is not read.
pub unsafe fn deserialize(instance: &Instance, bytes: &[u8], state: *mut State) -> Result<(), Refusal> {
    // SAFETY: guaranteed by the caller.
    let state = unsafe { output("pointer to a state", state, 1) }?;
    state[0].write(new_state(Saved::from_bytes(bytes, &instance.component)?, instance));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::Component;
    use crate::fmi::logger::Logger;
    use crate::mechanism::GEAR;

    #[test]
    fn the_first_word_differs_between_versions_and_layouts() {
        assert_eq!(ALIVE, word(env!("CARGO_PKG_VERSION"), &LAYOUT));
        assert_ne!(word("1.0.0", &LAYOUT), word("1.0.1", &LAYOUT));
        for part in 0..LAYOUT.len() {
            let mut other = LAYOUT;
            other[part] ^= 1;
            assert_ne!(word("1.0.0", &LAYOUT), word("1.0.0", &other));
        }
        assert!(ALIVE != FREED && ALIVE != u64::from_be_bytes(*b"linkstat"));
    }

    /// Each function reads only the first words of a state of another version.
    #[test]
    fn a_state_of_another_version_is_rejected_by_every_function() {
        let component = Component::from_definition("mechanism.json", GEAR).unwrap();
        let usage = crate::fmi::usage::Usage::default();
        let version = crate::fmi::version::Version::of_scalars(crate::variables::Kind::word);
        let mut instance = Instance::new(version, Logger::new(None, false), component, usage);
        let mut other = [word("0.0.0-other", &LAYOUT), 1, 2, 3];
        let state: State = other.as_mut_ptr().cast();
        // SAFETY: the memory is readable and belongs to this test. The last call frees a state of `save`.
        unsafe {
            let mut pointer = state;
            let refused = [
                save(&instance, &mut pointer),
                restore(&mut instance, state),
                free(&instance, &mut pointer),
                serialized_size(&mut instance, state).map(drop),
            ];
            for refusal in refused {
                assert!(refusal.unwrap_err().message.contains("library version"));
            }
            assert_eq!((pointer, other[1..].to_vec()), (state, vec![1, 2, 3]));
            let mut own = std::ptr::null_mut();
            save(&instance, &mut own).unwrap();
            free(&instance, &mut own).unwrap();
            assert!(own.is_null());
        }
    }
}
