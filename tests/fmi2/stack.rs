//! Stack of `fmi2Instantiate`. Hosts may call the function on threads with small stacks.
//!
//! The thread of the test runs on memory that the test has filled with a pattern. The memory that differs from the
//! pattern is the used stack. A call that needs too much stack is therefore measured and does not crash.
#![cfg(target_os = "linux")]

use crate::host::c;
use linkage_fmu::fmi2::host::{Description, Log, callbacks, logger};
use linkage_fmu::fmi2::types::Component;
use linkage_fmu::fmi2::{fmi2FreeInstance, fmi2Instantiate};
use std::alloc::{Layout, alloc, dealloc};
use std::ffi::{CString, c_void};
use std::path::Path;
use std::ptr::null_mut;

/// Stack of the measuring thread [bytes].
const STACK: usize = 1 << 20;
const PATTERN: u8 = 0xA5;
/// The largest stack that a thread with the call may use [bytes], in the profile of the tests (opt-level 2).
const MOST: usize = 64 << 10;

/// Arguments and result of a call on the thread.
struct Call {
    guid: CString,
    location: CString,
    log: Log,
    component: Component,
}

extern "C" fn instantiate(call: *mut c_void) -> *mut c_void {
    // SAFETY: the call outlives the thread, which alone uses it meanwhile.
    let call = unsafe { &mut *call.cast::<Call>() };
    let functions = callbacks(Some(logger()), &call.log);
    let (guid, location) = (call.guid.as_ptr(), call.location.as_ptr());
    // SAFETY: all pointers live during the call.
    call.component = unsafe { fmi2Instantiate(c"x".as_ptr(), 1, guid, location, &functions, 0, 0) };
    null_mut()
}

/// Bytes of stack that a thread with this function uses.
fn used(start: extern "C" fn(*mut c_void) -> *mut c_void, argument: *mut c_void) -> usize {
    let layout = Layout::from_size_align(STACK, 1 << 16).unwrap();
    // SAFETY: the memory is allocated and filled before the thread begins, and freed after it has ended.
    unsafe {
        let stack = alloc(layout);
        stack.write_bytes(PATTERN, STACK);
        let (mut attributes, mut thread) = (std::mem::zeroed(), 0);
        assert_eq!(libc::pthread_attr_init(&mut attributes), 0);
        assert_eq!(libc::pthread_attr_setstack(&mut attributes, stack.cast(), STACK), 0);
        assert_eq!(libc::pthread_create(&mut thread, &attributes, start, argument), 0);
        assert_eq!(libc::pthread_join(thread, null_mut()), 0);
        libc::pthread_attr_destroy(&mut attributes);
        let untouched = std::slice::from_raw_parts(stack, STACK).iter().take_while(|byte| **byte == PATTERN).count();
        dealloc(stack, layout);
        STACK - untouched
    }
}

/// The largest of these examples: a gear with stops and air, a curve with crossings, a jib with redundant joints.
#[test]
fn an_instance_needs_little_stack() {
    for name in ["LandingGearRetraction", "FourBarChain", "CraneJib"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription").join(name);
        let description = Description::read(&folder).unwrap();
        let (guid, location) = (c(description.interface().guid()), c(folder.join("resources").to_str().unwrap()));
        let mut call = Call { guid, location, log: Log::default(), component: null_mut() };
        let bytes = used(instantiate, (&raw mut call).cast());
        assert!(!call.component.is_null(), "{name}: {:?}", call.log.take());
        println!("{name}: {bytes} bytes of stack");
        // SAFETY: the instance is valid and not used again.
        unsafe { fmi2FreeInstance(call.component) };
        assert!(bytes <= MOST, "{name}: fmi2Instantiate uses {bytes} bytes of stack, more than {MOST}");
    }
}
