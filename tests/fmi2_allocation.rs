//! The success path of a communication step allocates nothing.
#![allow(unsafe_code)]

mod fmi2_host;

use fmi2_host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::{
    fmi2DoStep, fmi2FreeFMUstate, fmi2GetDirectionalDerivative, fmi2GetFMUstate, fmi2GetReal,
    fmi2GetRealOutputDerivatives, fmi2SetBoolean, fmi2SetFMUstate, fmi2SetReal, fmi2SetRealInputDerivatives,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn set_step_get_allocates_nothing() {
    exchange_allocates_nothing("reduced");
}

#[test]
fn nor_do_the_finite_elements() {
    exchange_allocates_nothing("rigid_fem");
}

#[test]
fn nor_do_derivatives() {
    let h = 1e-4;
    let gear = Gear::new();
    assert_eq!(gear.initialize(), Status::Ok);
    let inputs = [gear.vr("actuator.force"), gear.vr("load_factor")];
    let outputs =
        ["crank.angle", "crank.acceleration", "actuator.static_load", "joint2.force"].map(|name| gear.vr(name));
    let mut values = [0.0; 4];
    let mut exchange = |n: i32| {
        let (ones, rates) = ([1; 4], [2e5, 10.0]);
        // SAFETY: every array has the length that is passed.
        unsafe {
            assert_eq!(fmi2SetReal(gear.c, inputs.as_ptr(), 2, [3e4, 3.0].as_ptr()), Status::Ok);
            let status = fmi2SetRealInputDerivatives(gear.c, inputs.as_ptr(), 2, ones.as_ptr(), rates.as_ptr());
            assert_eq!(status, Status::Ok);
            assert_eq!(fmi2DoStep(gear.c, f64::from(n) * h, h, 1), Status::Ok);
            let (known, unknown) = (inputs.as_ptr(), outputs.as_ptr());
            let status =
                fmi2GetDirectionalDerivative(gear.c, unknown, 4, known, 2, rates.as_ptr(), values.as_mut_ptr());
            assert_eq!(status, Status::Ok);
            let status = fmi2GetRealOutputDerivatives(gear.c, unknown, 4, ones.as_ptr(), values.as_mut_ptr());
            assert_eq!(status, Status::Ok);
        }
    };
    (0..10).for_each(&mut exchange);
    let before = COUNT.get();
    (10..200).for_each(&mut exchange);
    assert_eq!(COUNT.get(), before);
}

#[test]
fn nor_do_saving_and_restoring_in_a_state_that_is_used_again() {
    for (method, friction) in [("reduced", 0), ("reduced", 1), ("rigid_fem", 0)] {
        let h = 1e-4;
        let gear = Gear::new();
        assert_eq!(gear.set_text("solver.method", method), Status::Ok);
        // SAFETY: one reference, one value.
        assert_eq!(unsafe { fmi2SetBoolean(gear.c, &gear.vr("friction.enabled"), 1, &friction) }, Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        let (input, output) = (gear.vr("actuator.force"), gear.vr("joint2.force"));
        let mut state = std::ptr::null_mut();
        let mut step_twice = |n: i32| {
            let mut values = [0.0; 2];
            // SAFETY: every array has the length that is passed.
            unsafe {
                assert_eq!(fmi2GetFMUstate(gear.c, &mut state), Status::Ok);
                for value in &mut values {
                    assert_eq!(fmi2SetReal(gear.c, &input, 1, &f64::from(n)), Status::Ok);
                    assert_eq!(fmi2DoStep(gear.c, f64::from(n) * h, h, 0), Status::Ok);
                    assert_eq!(fmi2GetReal(gear.c, &output, 1, value), Status::Ok);
                    assert_eq!(fmi2SetFMUstate(gear.c, state), Status::Ok);
                }
                assert_eq!(values[0].to_bits(), values[1].to_bits());
                assert_eq!(fmi2DoStep(gear.c, f64::from(n) * h, h, 1), Status::Ok);
            }
        };
        (0..10).for_each(&mut step_twice);
        let before = COUNT.get();
        (10..200).for_each(&mut step_twice);
        assert_eq!(COUNT.get(), before, "{method}, friction {friction}");
        // SAFETY: component and state are valid.
        assert_eq!(unsafe { fmi2FreeFMUstate(gear.c, &mut state) }, Status::Ok);
    }
}

fn exchange_allocates_nothing(method: &str) {
    let h = 1e-4;
    let gear = Gear::new();
    assert_eq!(gear.set_text("solver.method", method), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    let inputs = [gear.vr("actuator.force"), gear.vr("load_factor")];
    let outputs = [
        "crank.angle",
        "crank.speed",
        "crank.acceleration",
        "actuator.acceleration",
        "actuator.reduced_mass",
        "wheel.acceleration_x",
        "joint2.force",
        "energy.drift",
    ];
    let outputs = outputs.map(|name| gear.vr(name));
    let mut values = [0.0; 8];
    let mut exchange = |n: i32| {
        // SAFETY: every array has the length that is passed.
        unsafe {
            let force = [30_000.0 + f64::from(n), 3.0];
            assert_eq!(fmi2SetReal(gear.c, inputs.as_ptr(), 2, force.as_ptr()), Status::Ok);
            assert_eq!(fmi2DoStep(gear.c, f64::from(n) * h, h, 1), Status::Ok);
            assert_eq!(fmi2GetReal(gear.c, outputs.as_ptr(), 8, values.as_mut_ptr()), Status::Ok);
        }
    };
    // Tables are built when an output first asks for them.
    (0..10).for_each(&mut exchange);
    let before = COUNT.get();
    (10..200).for_each(&mut exchange);
    assert_eq!(COUNT.get(), before);
}
