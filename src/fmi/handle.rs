//! Pointers to instances, and calls of functions on them. No panic reaches the C caller.
//!
//! In: the host's pointer and the work to do on the instance. Out: a verdict. The logger gets the reason of a refusal.
//! Must not know: the called function, except for its name and legal phases.
#![allow(unsafe_code)]

use super::instance::Instance;
use super::logger::Logger;
use super::phase::{Function, Phase};
use super::refusal::{Refusal, Verdict};
use super::resources::Loaded;
use super::usage::Usage;
use super::version::Version;
use std::any::Any;
use std::cell::UnsafeCell;
use std::ffi::{CStr, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

/// First word of an instance between calls. A pointer to other memory is recognised by a different word. During a call,
/// all bits of the word are inverted, so that the logger cannot call a function of this instance.
const IDLE: u64 = u64::from_be_bytes(*b"linkage\0");
/// First word of an instance during a callback to the host within a step. The host can read values, but cannot free the
/// instance.
const CALLING: u64 = IDLE.rotate_left(8);
/// First word of an instance that was freed.
const FREED: u64 = 0;

/// Memory behind the host's pointer.
struct Handle {
    word: AtomicU64,
    instance: UnsafeCell<Instance>,
}

impl Handle {
    /// Inverts all bits of the word: at the start and at the end of a call.
    #[inline]
    fn invert(&self) {
        self.word.store(!self.word.load(Ordering::Relaxed), Ordering::Relaxed);
    }
}

/// Creates an instance from the result of `load`. Returns NULL, with a message, if that fails. `function` is the name
/// of the exported function, `version` its version of FMI, `name` the name of the instance, `usage` the features that
/// the host uses.
pub fn instantiate(
    version: Version,
    function: &str,
    name: &CStr,
    logger: Logger,
    usage: Usage,
    load: impl FnOnce() -> Result<Loaded, Refusal>,
) -> *mut c_void {
    let load = || match name.is_empty() {
        true => Err(Refusal::error("instanceName is NULL or empty; pass a name")),
        false => load(),
    };
    let refusal = match catch_unwind(AssertUnwindSafe(load)) {
        Ok(Ok(Loaded { component, remark })) => {
            remark.iter().for_each(|remark| logger.remark(remark));
            component.warnings().iter().for_each(|warning| logger.remark(&warning.to_string()));
            component.remarks().iter().for_each(|remark| logger.remark(remark));
            let instance = UnsafeCell::new(Instance::new(version, logger, component, usage));
            return Box::into_raw(Box::new(Handle { word: AtomicU64::new(IDLE), instance })).cast();
        }
        Ok(Err(refusal)) => refusal,
        Err(payload) => fault(&*payload),
    };
    // A panic in the report is ignored; NULL is returned all the same.
    let _ = catch_unwind(AssertUnwindSafe(|| report(&logger, function, &refusal)));
    std::ptr::null_mut()
}

/// Does `work` on the instance if the function is legal in its phase. After a panic, the verdict of this call and of
/// every later call is `Fatal`.
///
/// # Safety
/// `pointer` is NULL or comes from [`instantiate`] and was not freed. No other thread uses the instance during the call
/// (FMI 2.0.5, 2.1.5).
#[inline]
pub unsafe fn call(
    pointer: *mut c_void,
    function: &Function,
    work: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> Verdict {
    // SAFETY: guaranteed by the caller.
    let Some(handle) = (unsafe { handle(pointer) }) else { return Verdict::Error };
    // A load and a store are enough: the standard forbids the race that an atomic exchange would resolve.
    let word = handle.word.load(Ordering::Relaxed);
    if word != IDLE && word != CALLING {
        return Verdict::Error;
    }
    handle.invert();
    // SAFETY: the word was neither inverted nor FREED, so no other call on this thread uses the instance. The caller
    // guarantees that no other thread uses it.
    let verdict = guarded(unsafe { &mut *handle.instance.get() }, function, work);
    handle.invert();
    verdict
}

/// [`call`] for functions that hosts call rarely. The work is not inlined.
///
/// # Safety
/// As for [`call`].
#[inline(never)]
pub unsafe fn call_seldom(
    pointer: *mut c_void,
    function: &Function,
    work: &mut dyn FnMut(&mut Instance) -> Result<(), Refusal>,
) -> Verdict {
    // SAFETY: guaranteed by the caller.
    unsafe { call(pointer, function, work) }
}

/// Calls the host back between two calls of one step, so that the host can read the instance.
///
/// # Safety
/// As for [`call`]. No call uses the instance.
pub unsafe fn call_back<T>(pointer: *mut c_void, callback: impl FnOnce() -> T) -> T {
    // SAFETY: guaranteed by the caller.
    let handle = unsafe { handle(pointer) };
    let set = |word| handle.inspect(|handle| handle.word.store(word, Ordering::Relaxed));
    set(CALLING);
    let answer = callback();
    set(IDLE);
    answer
}

/// Frees an instance. NULL, and an instance that is in a call or a callback, are left unchanged.
///
/// # Safety
/// As for [`call`]. The pointer is not used again (FMI 2.0.5, 2.1.5).
pub unsafe fn free(pointer: *mut c_void) {
    // SAFETY: guaranteed by the caller.
    let Some(handle) = (unsafe { handle(pointer) }) else { return };
    if handle.word.load(Ordering::Relaxed) != IDLE {
        return;
    }
    handle.word.store(FREED, Ordering::Relaxed);
    // SAFETY: `instantiate` boxed the handle, and only this line unboxes it.
    let handle = unsafe { Box::from_raw(pointer.cast::<Handle>()) };
    // A panic in a destructor cannot be reported.
    let _ = catch_unwind(AssertUnwindSafe(move || drop(handle)));
}

/// # Safety
/// As for [`call`].
unsafe fn handle<'a>(pointer: *mut c_void) -> Option<&'a Handle> {
    let handle = pointer.cast::<Handle>();
    if !handle.is_aligned() {
        return None;
    }
    // SAFETY: the pointer is aligned and not NULL. The caller guarantees the rest.
    unsafe { handle.as_ref() }
}

/// Does the work and reports a refusal. Catches panics of both.
#[inline]
fn guarded(
    instance: &mut Instance,
    function: &Function,
    work: impl FnOnce(&mut Instance) -> Result<(), Refusal>,
) -> Verdict {
    let answered = catch_unwind(AssertUnwindSafe(|| {
        if !function.is_legal_in(instance.phase) {
            return refuse_phase(instance, function);
        }
        match work(instance) {
            Ok(()) => Verdict::Ok,
            Err(refusal) => report(&instance.logger, function.name, &refusal),
        }
    }));
    answered.unwrap_or_else(|payload| end_by_panic(instance, function, payload))
}

#[cold]
fn refuse_phase(instance: &Instance, function: &Function) -> Verdict {
    let message = match instance.phase {
        Phase::Fatal => {
            "an internal fault ended the instance; now only the instance and the saved states of the instance can be \
             freed"
                .to_owned()
        }
        Phase::Interrupted => format!(
            "this call is not allowed after a step that reached solver.max_steps, at t = {} s; restore an earlier \
             state, or reset and use shorter communication steps or a larger solver.max_steps; allowed in: {}",
            instance.clock.time,
            function.legal_phases()
        ),
        phase => {
            format!("this call is not allowed in the phase '{}'; allowed in: {}", phase.name(), function.legal_phases())
        }
    };
    let verdict = if instance.phase == Phase::Fatal { Verdict::Fatal } else { Verdict::Error };
    report(&instance.logger, function.name, &Refusal { verdict, message })
}

#[cold]
fn report(logger: &Logger, function: &str, refusal: &Refusal) -> Verdict {
    logger.log(refusal.verdict, &format!("{function}: {}", refusal.message));
    refusal.verdict
}

/// Handles a panic: the instance becomes fatal, and the panic is reported. A panic during the report is ignored.
#[cold]
fn end_by_panic(instance: &mut Instance, function: &Function, payload: Box<dyn Any + Send>) -> Verdict {
    instance.phase = Phase::Fatal;
    let _ = catch_unwind(AssertUnwindSafe(move || report(&instance.logger, function.name, &fault(&*payload))));
    Verdict::Fatal
}

/// The refusal for a panic.
fn fault(payload: &(dyn Any + Send)) -> Refusal {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let message = format!("internal fault in the FMU, please report: {}", text.unwrap_or("no message"));
    Refusal { verdict: Verdict::Fatal, message }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::Component;
    use crate::fmi::phase::{ALIVE, STEP};
    use crate::mechanism::GEAR;
    use crate::variables::Kind;

    const VERSION: Version = Version::of_scalars(Kind::word);
    const READ: Function = Function::new("read", ALIVE);
    const ADVANCE: Function = Function::new("advance", STEP);

    fn gear() -> *mut c_void {
        let load = || Ok(Component::from_definition("mechanism.json", GEAR)?.into());
        instantiate(VERSION, "instantiate", c"gear", Logger::new(None, false), Usage::default(), load)
    }

    #[test]
    fn a_panic_is_fatal_and_stays_so() {
        let c = gear();
        // SAFETY: the pointer is valid until `free`.
        unsafe {
            assert_eq!(call(c, &READ, |_| panic!("on purpose")), Verdict::Fatal);
            assert_eq!(call(c, &READ, |_| Ok(())), Verdict::Fatal);
            free(c);
        }
    }

    #[test]
    fn a_panic_in_instantiate_gives_null() {
        assert!(
            instantiate(VERSION, "instantiate", c"gear", Logger::new(None, false), Usage::default(), || panic!(
                "on purpose"
            ))
            .is_null()
        );
    }

    #[test]
    fn a_call_within_a_call_is_rejected() {
        let c = gear();
        // SAFETY: the pointer is valid until the last `free`.
        unsafe {
            let verdict = call(c, &READ, |_| {
                assert_eq!(call(c, &READ, |_| Ok(())), Verdict::Error);
                free(c);
                Ok(())
            });
            assert_eq!(verdict, Verdict::Ok);
            assert_eq!(call(c, &READ, |_| Ok(())), Verdict::Ok);
            free(c);
        }
    }

    #[test]
    fn a_pointer_to_other_memory_is_rejected() {
        let mut foreign = [1_u64; 8];
        let c = foreign.as_mut_ptr().cast::<c_void>();
        // SAFETY: the pointers point to a word that is not an instance's, and to no aligned word.
        unsafe {
            assert_eq!(call(c, &READ, |_| Ok(())), Verdict::Error);
            assert_eq!(call(c.wrapping_byte_add(1), &READ, |_| Ok(())), Verdict::Error);
            free(c);
        }
    }

    #[test]
    fn after_a_failed_step_values_can_be_read_and_the_instance_reset() {
        let c = gear();
        // SAFETY: the pointer is valid until `free`.
        unsafe {
            let fail = |instance: &mut Instance| {
                instance.phase = Phase::Failed;
                Ok(())
            };
            assert_eq!(call(c, &READ, fail), Verdict::Ok);
            assert_eq!(call(c, &ADVANCE, |_| Ok(())), Verdict::Error);
            assert_eq!(call(c, &READ, |_| Ok(())), Verdict::Ok);
            let reset = |instance: &mut Instance| {
                instance.reset();
                Ok(())
            };
            assert_eq!(call(c, &READ, reset), Verdict::Ok);
            assert_eq!(call(c, &ADVANCE, |_| Ok(())), Verdict::Error);
            free(c);
        }
    }
}
