//! The way from a pointer of the host's to an instance and back to a status, with nothing unwinding across C.
//!
//! In: a component and what to do with it. Out: a status; the reason of a refusal goes to the logger. This is the only
//! place that knows how an instance lives behind its pointer.

use super::array;
use super::instance::Instance;
use super::logger::Logger;
use super::phase::{Function, Phase};
use super::refusal::Refusal;
use super::types::{CallbackFunctions, Component, Status, Text};
use crate::mechanism::Model;
use std::any::Any;
use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

/// First word of an instance between calls: a pointer that leads elsewhere is told apart by it.
const IDLE: u64 = u64::from_be_bytes(*b"linkage\0");
/// First word of an instance while a function works on it: its logger must not call back into it.
const BUSY: u64 = !IDLE;
/// First word of an instance that was freed.
const FREED: u64 = 0;

/// What a component points to.
struct Handle {
    word: AtomicU64,
    instance: UnsafeCell<Instance>,
}

/// Build an instance; NULL, with a message, if that fails.
///
/// # Safety
/// The pointers are those of `fmi2Instantiate` (FMI 2.0.5, 2.1.5).
pub unsafe fn instantiate(
    functions: *const CallbackFunctions,
    name: Text,
    logging_on: bool,
    load: impl FnOnce() -> Result<Model, Refusal>,
) -> Component {
    if functions.is_null() || !functions.is_aligned() {
        return std::ptr::null_mut();
    }
    // SAFETY: the host passes the callbacks and a name (FMI 2.0.5, 2.1.5); both are copied.
    let (functions, name) = unsafe { (functions.read(), array::text(name).unwrap_or_default()) };
    let logger = Logger::new(&functions, name, logging_on);
    let load = || match name.is_empty() {
        true => Err(Refusal::error("instanceName is NULL or empty; pass a name")),
        false => load(),
    };
    match catch_unwind(AssertUnwindSafe(load)) {
        Ok(Ok(model)) => {
            let instance = UnsafeCell::new(Instance::new(logger, model));
            Box::into_raw(Box::new(Handle { word: AtomicU64::new(IDLE), instance })).cast()
        }
        Ok(Err(refusal)) => {
            logger.log(refusal.status, &format!("fmi2Instantiate: {}", refusal.message));
            std::ptr::null_mut()
        }
        Err(payload) => {
            logger.log(Status::Fatal, &format!("fmi2Instantiate: {}", fault(&*payload)));
            std::ptr::null_mut()
        }
    }
}

/// Call `work` on the instance if the function is legal in its phase. A panic is answered with `Fatal`, and so is every
/// later call.
///
/// # Safety
/// `component` is NULL or comes from `fmi2Instantiate`, was not freed, and no other thread uses it during the call
/// (FMI 2.0.5, 2.1.5).
#[inline]
pub unsafe fn call(
    component: Component,
    function: &Function,
    work: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> Status {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle(component) }) else { return Status::Error };
    // A load and a store, as the standard forbids the race that an exchange would decide.
    if handle.word.load(Ordering::Relaxed) != IDLE {
        return Status::Error;
    }
    handle.word.store(BUSY, Ordering::Relaxed);
    // SAFETY: the word was IDLE, so that no call is at work on the instance further up this stack; the caller promises
    // that none is on another thread.
    let status = guarded(unsafe { &mut *handle.instance.get() }, function, work);
    handle.word.store(IDLE, Ordering::Relaxed);
    status
}

/// End of an instance. NULL, and an instance whose logger is being called right now, are left alone.
///
/// # Safety
/// As for [`call`]; the component is not used again (FMI 2.0.5, 2.1.5).
pub unsafe fn free(component: Component) {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle(component) }) else { return };
    if handle.word.load(Ordering::Relaxed) != IDLE {
        return;
    }
    handle.word.store(FREED, Ordering::Relaxed);
    // SAFETY: the handle was boxed by `instantiate`, and this is its only way out.
    let handle = unsafe { Box::from_raw(component.cast::<Handle>()) };
    // There is nobody left to hear of a panic in a destructor.
    let _ = catch_unwind(AssertUnwindSafe(move || drop(handle)));
}

/// # Safety
/// As for [`call`].
unsafe fn handle<'a>(component: Component) -> Option<&'a Handle> {
    let handle = component.cast::<Handle>();
    if !handle.is_aligned() {
        return None;
    }
    // SAFETY: aligned and not NULL is checked, the rest is the caller's promise.
    unsafe { handle.as_ref() }
}

#[inline]
fn guarded(
    instance: &mut Instance,
    function: &Function,
    work: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> Status {
    if !function.is_legal_in(instance.phase) {
        return refuse_phase(instance, function);
    }
    match catch_unwind(AssertUnwindSafe(|| work(instance))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(refusal)) => {
            instance.logger.log(refusal.status, &format!("{}: {}", function.name, refusal.message));
            refusal.status
        }
        Err(payload) => {
            instance.phase = Phase::Fatal;
            instance.logger.log(Status::Fatal, &format!("{}: {}", function.name, fault(&*payload)));
            Status::Fatal
        }
    }
}

#[cold]
fn refuse_phase(instance: &Instance, function: &Function) -> Status {
    let status = if instance.phase == Phase::Fatal { Status::Fatal } else { Status::Error };
    let message = match status {
        Status::Fatal => format!("{}: the instance is lost; only fmi2FreeInstance is left", function.name),
        _ => format!(
            "{}: not allowed in the phase '{}'; allowed in: {}",
            function.name,
            instance.phase.name(),
            function.legal_phases()
        ),
    };
    instance.logger.log(status, &message);
    status
}

fn fault(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    format!("fault in the FMU, please report: {}", text.unwrap_or("no message"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi2::phase::{DO_STEP, GET_REAL, RESET};
    use crate::mechanism::GEAR;
    use std::ffi::c_void;
    use std::ptr::{null, null_mut};

    fn gear() -> Component {
        let functions = CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        // SAFETY: callbacks and name live during the call.
        unsafe { instantiate(&functions, c"gear".as_ptr(), false, || Ok(Model::from_json(GEAR)?)) }
    }

    #[test]
    fn a_panic_is_fatal_and_stays_so() {
        let c = gear();
        // SAFETY: the component is valid until `free`.
        unsafe {
            assert_eq!(call(c, &RESET, |_| panic!("on purpose")), Status::Fatal);
            assert_eq!(call(c, &RESET, |_| Ok(())), Status::Fatal);
            free(c);
        }
    }

    #[test]
    fn a_panic_in_instantiate_gives_null() {
        let functions = CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        // SAFETY: callbacks and name live during the call.
        let c = unsafe { instantiate(&functions, c"gear".as_ptr(), false, || panic!("on purpose")) };
        assert!(c.is_null());
        // SAFETY: NULL callbacks are what is tested.
        assert!(unsafe { instantiate(null(), c"gear".as_ptr(), false, || panic!("not reached")) }.is_null());
    }

    #[test]
    fn a_call_from_within_a_call_is_refused() {
        let c = gear();
        // SAFETY: the component is valid until the last `free`.
        unsafe {
            let status = call(c, &RESET, |_| {
                assert_eq!(call(c, &RESET, |_| Ok(())), Status::Error);
                free(c);
                Ok(())
            });
            assert_eq!(status, Status::Ok);
            assert_eq!(call(c, &RESET, |_| Ok(())), Status::Ok);
            free(c);
        }
    }

    #[test]
    fn a_pointer_to_something_else_is_refused() {
        let mut foreign = [1_u64; 8];
        let c: Component = foreign.as_mut_ptr().cast::<c_void>();
        // SAFETY: the pointers lead to a word that is none of an instance's, and nowhere.
        unsafe {
            assert_eq!(call(c, &RESET, |_| Ok(())), Status::Error);
            assert_eq!(call(c.wrapping_byte_add(1), &RESET, |_| Ok(())), Status::Error);
            free(c);
        }
    }

    #[test]
    fn after_a_failed_step_values_can_be_read_and_the_instance_reset() {
        let c = gear();
        // SAFETY: the component is valid until `free`.
        unsafe {
            let fail = |instance: &mut Instance| {
                instance.phase = Phase::Failed;
                Ok(())
            };
            assert_eq!(call(c, &RESET, fail), Status::Ok);
            assert_eq!(call(c, &DO_STEP, |_| Ok(())), Status::Error);
            assert_eq!(call(c, &GET_REAL, |_| Ok(())), Status::Ok);
            assert_eq!(call(c, &RESET, Instance::reset), Status::Ok);
            free(c);
        }
    }
}
