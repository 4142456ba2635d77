//! The host's arrays and strings as slices.
//!
//! In: raw pointers with a length. Out: slices, or a refusal that names the argument. An empty array may be NULL. Must
//! not know: what the elements mean.
#![allow(unsafe_code)]

use super::refusal::Refusal;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;

/// Array that the host passes in.
///
/// # Errors
/// The pointer is NULL or misaligned although `count > 0`, or the array is larger than memory.
///
/// # Safety
/// A valid `pointer` points to `count` elements that nothing writes during the call (FMI 2.0.5, 2.1.7).
#[inline]
pub unsafe fn input<'a, T>(name: &str, pointer: *const T, count: usize) -> Result<&'a [T], Refusal> {
    if !is_valid(pointer, count) {
        return if count == 0 { Ok(&[]) } else { Err(refuse(name, count, pointer.addr(), align_of::<T>())) };
    }
    // SAFETY: `is_valid` tests null, alignment and size. The caller guarantees the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Array that the host passes to be filled. The memory may be uninitialised.
///
/// # Errors
/// The pointer is NULL or misaligned although `count > 0`, or the array is larger than memory.
///
/// # Safety
/// A valid `pointer` points to memory for `count` elements that nothing else uses during the call (FMI 2.0.5, 2.1.7).
#[inline]
pub unsafe fn output<'a, T>(name: &str, pointer: *mut T, count: usize) -> Result<&'a mut [MaybeUninit<T>], Refusal> {
    if !is_valid(pointer, count) {
        return if count == 0 { Ok(&mut []) } else { Err(refuse(name, count, pointer.addr(), align_of::<T>())) };
    }
    // SAFETY: `is_valid` tests null, alignment and size. The caller guarantees the rest.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), count) })
}

/// Numbers that are 0 in the memory of an array that the host passes to be filled.
#[inline]
pub fn zeroed(numbers: &mut [MaybeUninit<f64>]) -> &mut [f64] {
    numbers.fill(MaybeUninit::new(0.0));
    // SAFETY: all are initialised.
    unsafe { &mut *(std::ptr::from_mut(numbers) as *mut [f64]) }
}

/// String that the host passes in. `None` if the pointer is NULL.
///
/// # Safety
/// A pointer that is not NULL points to zero-terminated text that is valid during `'a` (FMI 2.0.5, 2.1.4).
pub unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    // SAFETY: guaranteed by the caller.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// Whether there can be an array of `count` elements at the pointer: not NULL, aligned, not larger than memory.
#[inline]
fn is_valid<T>(pointer: *const T, count: usize) -> bool {
    !pointer.is_null() && pointer.is_aligned() && count <= isize::MAX as usize / size_of::<T>()
}

#[cold]
fn refuse(name: &str, count: usize, address: usize, alignment: usize) -> Refusal {
    Refusal::error(if address == 0 {
        format!("the array '{name}' is NULL; pass an array of {count} elements")
    } else if !address.is_multiple_of(alignment) {
        format!("the array '{name}' is not aligned to {alignment} bytes")
    } else {
        format!("the array '{name}' of {count} elements is larger than memory")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ptr::{null, null_mut};

    #[test]
    fn an_empty_array_may_be_null() {
        // SAFETY: the arrays have no elements.
        unsafe {
            assert_eq!(input::<f64>("value", null(), 0), Ok(&[][..]));
            assert!(output::<f64>("value", null_mut(), 0).unwrap().is_empty());
            assert_eq!(text(null()), None);
        }
    }

    #[test]
    fn invalid_arrays_are_rejected() {
        let values = [0.0; 2];
        let misaligned = values.as_ptr().cast::<u8>().wrapping_add(1).cast::<f64>();
        // SAFETY: each pointer is rejected before it is read.
        unsafe {
            for refused in
                [input("x", null::<f64>(), 1), input("x", misaligned, 1), input("x", values.as_ptr(), 1 << 61)]
            {
                assert!(refused.unwrap_err().message.contains("'x'"));
            }
        }
    }
}
