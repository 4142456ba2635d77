//! Steps, derivatives and states against those of FMI 2.0, and rejected calls.
use crate::Fmu;
use crate::fmi2::Gear;
use linkage_fmu::fmi2::types::Status as Status2;
use linkage_fmu::fmi3::types::Status;
use linkage_fmu::fmi3::*;
use std::ptr::null_mut;

#[test]
fn a_retraction_has_the_bits_of_fmi_2() {
    let names = ["crank.angle", "joint2.force", "energy.drift"];
    let (gear, other) = (Fmu::stepping(), Gear::new());
    assert_eq!((other.set_up(Some(1e-9), 0.0, None), other.initialize()), (Status2::Ok, Status2::Ok));
    for n in 0..130 {
        let (point, h) = (f64::from(n) * 1e-3, 1e-3);
        let force = 30_000.0 + f64::from(n / 7);
        assert_eq!((other.set("actuator.force", force), gear.set("actuator.force", force)), (Status2::Ok, Status::Ok));
        assert_eq!(other.step(point, h), Status2::Ok);
        gear.whole_step(point, h);
        let values = names.map(|name| other.get(name).unwrap());
        assert_eq!(gear.get(names).map(f64::to_bits), values.map(f64::to_bits));
        assert_eq!(gear.get([names[0], "time", "actuator.force"]), [values[0], point + h, force]);
    }
    assert_eq!(gear.terminate(), Status::Ok);
}

/// y' J x by adjoint and by directional derivatives.
#[test]
fn adjoint_and_directional_derivatives_agree() {
    let gear = Fmu::stepping();
    let unknowns = gear.vrs(["crank.acceleration", "joint1.force", "actuator.static_load"]);
    let knowns = gear.vrs(["actuator.force", "load_factor"]);
    let (left, right) = ([0.3, -2.0, 1.7], [5.0, -0.7]);
    gear.whole_step(0.0, 0.03);
    let (mut along, mut back, mut of_one) = ([0.0; 3], [0.0; 2], [0.0; 3]);
    assert_eq!(gear.derivative(false, &unknowns, &knowns, &right, &mut along), Status::Ok);
    assert_eq!(gear.derivative(true, &unknowns, &knowns, &left, &mut back), Status::Ok);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (one, other) = (dot(&left, &along), dot(&back, &right));
    assert!(one != 0.0 && (one - other).abs() < 1e-12 * one.abs(), "{one} {other}");
    // FMI 2.0 gives the same bits.
    let same = Gear::new();
    assert_eq!((same.set_up(Some(1e-9), 0.0, None), same.initialize()), (Status2::Ok, Status2::Ok));
    assert_eq!(same.step(0.0, 0.03), Status2::Ok);
    for (known, seed) in knowns.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
        let mut alone = [0.0; 3];
        assert_eq!(same.derivatives(&unknowns, *known, &mut alone), Status2::Ok);
        assert_eq!(gear.derivative(false, &unknowns, &knowns, &seed, &mut of_one), Status::Ok);
        assert_eq!(alone.map(f64::to_bits), of_one.map(f64::to_bits));
    }
}

#[test]
fn a_state_continues_bit_identically() {
    let names = ["crank.angle", "crank.speed", "time"];
    let gear = Fmu::stepping();
    gear.whole_step(0.0, 0.01);
    let mut state = gear.save();
    let mut copy = gear.deserialize(&gear.serialize(&state).unwrap()).unwrap();
    gear.whole_step(0.01, 0.02);
    let there = gear.get(names);
    for state in [&state, &copy] {
        assert_eq!(gear.restore(state), Status::Ok);
        gear.whole_step(0.01, 0.02);
        assert_eq!(gear.get(names).map(f64::to_bits), there.map(f64::to_bits));
    }
    assert_eq!((gear.free(&mut state), gear.free(&mut copy)), (Status::Ok, Status::Ok));
    assert!(state.pointer().is_null() && copy.pointer().is_null());
}

#[test]
fn wrong_calls_are_rejected_and_change_nothing() {
    let gear = Fmu::stepping();
    let [angle, force, time] = gear.vrs(["crank.angle", "actuator.force", "time"]);
    let before = gear.read(&[angle, time]);
    let mut one = [0.0];
    assert_eq!(gear.reals(&[angle, force], &mut one), Status::Error);
    assert_eq!(gear.reals(&[time + 1000], &mut one), Status::Error);
    for (reference, value) in [(angle, 0.0), (time, 0.0), (force, f64::NAN)] {
        assert_eq!(gear.set_reals(&[reference], &[value]), Status::Error);
    }
    assert_eq!((gear.enter_event_mode(), gear.enter(None, 0.0, None)), (Status::Error, Status::Error));
    let (status, stepped) = gear.step(0.5, 1e-3);
    assert_eq!((status, stepped.last), (Status::Error, 0.0));
    let c = gear.instance();
    // SAFETY: the instance is valid, all arrays that are not NULL have the lengths that are passed.
    unsafe {
        assert_eq!(fmi3GetFloat64(c, std::ptr::null(), 1, one.as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetInt32(c, &force, 1, [0].as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetInt32(c, std::ptr::null(), 0, null_mut(), 0), Status::Ok);
        assert_eq!(fmi3GetClock(c, &force, 1, [0].as_mut_ptr()), Status::Error);
        assert_eq!(fmi3GetNumberOfContinuousStates(c, &mut 0), Status::Error);
        assert_eq!(fmi3DoStep(c, 0.0, 1e-3, 1, null_mut(), null_mut(), null_mut(), null_mut()), Status::Error);
        assert_eq!(fmi3GetVersion().cast::<u8>().read(), b'3');
        assert_eq!(fmi3Terminate(null_mut()), Status::Error);
        fmi3FreeInstance(null_mut());
    }
    assert_eq!(gear.read(&[angle, time]), before);
}
