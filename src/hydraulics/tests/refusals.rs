//! Warnings, refusals, bounds of the work, parameters far from the usual.
use super::*;

/// The line of the warnings of one step after these values are set.
fn warning(values: &[(&str, f64)], mode: &str, h: f64) -> Option<String> {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
    actuator.initialize().unwrap();
    actuator.step(h).unwrap();
    actuator.take_warning();
    values.iter().for_each(|(name, value)| set(&mut actuator, name, *value));
    let before = actuator.snapshot();
    actuator.step(h).unwrap();
    let warning = actuator.take_warning();
    let mut bytes = Vec::new();
    before.write(&mut bytes).unwrap();
    for state in [&before, &actuator.read_snapshot(&bytes).unwrap()] {
        actuator.restore(state).unwrap();
        actuator.step(h).unwrap();
        assert_eq!(actuator.take_warning(), warning, "the same step gives the same answer");
    }
    actuator.step(h).unwrap();
    assert_eq!(actuator.take_warning(), None, "a warning comes once");
    warning
}

#[test]
fn what_a_host_should_know_is_told_once() {
    assert_eq!(warning(&[("valve.command", 1.0)], "follow", 1e-3), None);
    let clipped = warning(&[("valve.command", 1.2)], "follow", 1e-3).unwrap();
    assert!(clipped.contains("valve.command") && clipped.contains("1.2"), "{clipped}");
    let drift = warning(&[("actuator.length", 0.6)], "follow", 1e-3).unwrap();
    assert!(drift.contains("actuator.length = 0.6 m") && drift.contains("0.577 m"), "{drift}");
    let horizon = warning(&[("actuator.reduced_mass", 700.0), ("preview.horizon", 2e-3)], "preview", 1e-3).unwrap();
    assert!(horizon.contains("preview.horizon is 0.002 s"), "{horizon}");
    // The difference of two times is the step but for rounding.
    let rounded = [("actuator.reduced_mass", 700.0), ("preview.horizon", 1e-3)];
    assert_eq!(warning(&rounded, "preview", 2.001 - 2.0), None);
    let unstable = warning(&[("actuator.reduced_mass", 700.0), ("preview.horizon", 5e-3)], "follow", 5e-3).unwrap();
    assert!(unstable.contains("coupling.stable_step"), "{unstable}");
    let toggle = [("actuator.reduced_mass", 1e6), ("actuator.reduced_mass_derivative", 1e9), ("actuator.speed", 1.0)];
    let toggle = warning(&toggle, "preview", 1e-3).unwrap();
    assert!(toggle.contains("dead centre"), "{toggle}");
}

#[test]
fn what_cannot_be_is_refused_by_name_and_changes_nothing() {
    let mut actuator = model(ACTUATOR);
    assert!(actuator.step(1e-3).unwrap_err().to_string().contains("initialise"));
    set(&mut actuator, "actuator.length", 0.75);
    let error = actuator.initialize().unwrap_err().to_string();
    assert!(error.contains("0.75") && error.contains("0.412 m") && error.contains("0.742 m"), "{error}");
    set(&mut actuator, "actuator.length", 0.741);
    actuator.initialize().unwrap();
    set(&mut actuator, "actuator.speed", 1.0);
    let error = actuator.step(0.1).unwrap_err();
    assert!(!error.ends_step() && error.to_string().contains("0.841"), "{error}");
    assert_eq!(get(&mut actuator, "actuator.length"), 0.741);
    for (name, value, text) in [
        ("valve.command", f64::NAN, "valve.command = NaN"),
        ("supply.pressure", -2e5, "101325 Pa"),
        ("actuator.reduced_mass", -1.0, ">= 0"),
        ("preview.horizon", -1e-3, ">= 0"),
        ("chamber_a.dead_volume", 0.0, "> 0"),
        ("actuator.force", 1.0, "output"),
    ] {
        let error = actuator.set_real(reference(&actuator, name), value).unwrap_err().to_string();
        assert!(error.contains(text) && error.contains(name), "{error}");
    }
    set(&mut actuator, "cylinder.rod", 0.1);
    let error = actuator.initialize().unwrap_err().to_string();
    assert!(error.contains("cylinder.rod = 0.1") && error.contains("cylinder.bore = 0.045"), "{error}");
    assert!(actuator.step(-1.0).is_err() && actuator.step(f64::NAN).is_err());
}

/// The culprit is named: a speed that passes the end of the stroke within a step and comes back, a pump without a band,
/// sizes that no circuit has, an element that no mechanism has.
#[test]
fn the_culprit_is_named_with_the_remedy() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    set(&mut actuator, "chamber_b.dead_volume", 1e-9);
    set(&mut actuator, "actuator.length", 0.74);
    actuator.initialize().unwrap();
    // 0.74 + 0.2 t - 2 t^2 is 0.745 at 50 ms, and 0.74 again at 100 ms.
    set(&mut actuator, "actuator.speed", 0.2);
    rate(&mut actuator, "actuator.speed", 1, -4.0);
    let error = actuator.step(0.1).unwrap_err();
    let text = error.to_string();
    assert!(!error.ends_step(), "{text}");
    for piece in ["actuator.speed = 0.2 m/s", "0.745 m", "0.742 m", "cylinder.stroke"] {
        assert!(text.contains(piece), "{piece}: {text}");
    }
    for name in ["supply.pressure", "tank.pressure"] {
        let error = actuator.set_real(reference(&actuator, name), 1e300).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("1e12 Pa"), "{error}");
    }
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "accumulator.volume", 1e-3);
    set(&mut actuator, "pump.max_pressure", 20e6 + 1e-3);
    let error = actuator.initialize().unwrap_err().to_string();
    assert!(error.contains("pump.max_pressure") && error.contains("pump.full_pressure = 20000000 Pa"), "{error}");
    for (mass, load) in [(1e-300, 1.0), (700.0, 1e300), (1e-300, 1e300)] {
        for mode in ["preview", "follow"] {
            let mut actuator = model(ACTUATOR);
            actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
            actuator.initialize().unwrap();
            set(&mut actuator, "actuator.reduced_mass", mass);
            set(&mut actuator, "actuator.holding_force", load);
            assert!(get(&mut actuator, "preview.force").is_finite());
            let said = match actuator.step(1e-3) {
                Err(error) => error.to_string(),
                Ok(()) => actuator.take_warning().unwrap(),
            };
            assert!(said.contains("actuator.reduced_mass = ") && said.contains("actuator.holding_force = "), "{said}");
        }
    }
}

/// The narrowest band of a pump that is taken costs no more than some hundred steps.
#[test]
fn a_narrow_band_of_the_pump_is_integrated() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    for (name, value) in [("accumulator.volume", 2e-4), ("supply.pressure", 19e6), ("pump.max_pressure", 20e6 + 250.0)]
    {
        set(&mut actuator, name, value);
    }
    actuator.initialize().unwrap();
    (0..200).for_each(|_| actuator.step(1e-2).unwrap());
    let (work, held) = (actuator.statistics(), get(&mut actuator, "accumulator.pressure"));
    assert!((20e6..20e6 + 250.0).contains(&held), "{held}");
    assert!(work.accepted + work.rejected < 2000, "{work:?}");
}

#[test]
fn oil_without_air_that_cavitates_is_named() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    set(&mut actuator, "fluid.air_fraction", 0.0);
    set(&mut actuator, "anticavitation.conductance", 0.0);
    actuator.initialize().unwrap();
    set(&mut actuator, "actuator.speed", 0.5);
    let before = get(&mut actuator, "chamber_a.pressure");
    let error = actuator.step(0.1).unwrap_err();
    assert!(error.ends_step());
    let error = error.to_string();
    assert!(error.contains("absolute pressure of chamber_a") && error.contains("fluid.air_fraction"), "{error}");
    assert_eq!(get(&mut actuator, "chamber_a.pressure"), before);
}

#[test]
fn the_work_of_a_step_is_bounded() {
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "solver.max_steps", 3.0);
    set(&mut actuator, "actuator.length", 0.55);
    actuator.initialize().unwrap();
    set(&mut actuator, "valve.command", 1.0);
    let error = actuator.step(1.0).unwrap_err();
    let HydraulicsError::Interrupted { time, why } = error else { panic!("{error}") };
    assert!(time > 0.0 && time < 1.0 && why.contains("solver.max_steps = 3"), "{why}");
    assert!(get(&mut actuator, "valve.position") > 0.0);
    actuator.step(1e-3).unwrap();
}

/// Parameters far from the usual: each run ends, with finite values or an error that names its reason.
#[test]
fn extreme_parameters_end_in_values_or_named_errors() {
    let list = model(ACTUATOR).variables().list().to_vec();
    let parameters = list.iter().filter(|v| v.causality == foundation::variables::Causality::Parameter);
    let real = parameters.filter_map(|v| match v.start {
        Some(foundation::variables::Value::Real(start)) if !v.name.starts_with("solver.") => {
            Some((v.name.clone(), start))
        }
        _ => None,
    });
    let (mut good, mut refused) = (0, 0);
    for (name, start) in real {
        for factor in [1e-3, 0.1, 10.0, 1e3] {
            for mode in ["follow", "preview"] {
                let mut actuator = model(ACTUATOR);
                actuator.set_text(reference(&actuator, "coupling.mode"), mode).unwrap();
                if actuator.set_real(reference(&actuator, &name), start * factor).is_err() {
                    continue;
                }
                if mode == "preview" {
                    set(&mut actuator, "actuator.reduced_mass", 700.0);
                }
                let began = std::time::Instant::now();
                if let Err(error) = actuator.initialize() {
                    assert!(error.to_string().contains(" = "), "{error}");
                    refused += 1;
                    continue;
                }
                for step in 0..100 {
                    set(&mut actuator, "valve.command", if step % 40 < 20 { 1.0 } else { -1.0 });
                    set(&mut actuator, "actuator.length", 0.577);
                    set(&mut actuator, "actuator.speed", 0.0);
                    if let Err(error) = actuator.step(1e-3) {
                        assert!(error.to_string().contains("solver."), "{name} x {factor}: {error}");
                        refused += 1;
                        break;
                    }
                    for output in ["actuator.force", "chamber_a.pressure", "energy.balance", "preview.force"] {
                        assert!(get(&mut actuator, output).is_finite(), "{name} x {factor}: {output}");
                    }
                    good += 1;
                }
                let took = began.elapsed().as_secs_f64();
                if took > 0.05 {
                    println!("{name} x {factor} {mode}: {took} s, {:?}", actuator.statistics());
                }
            }
        }
    }
    println!("{good} steps, {refused} refusals");
    assert!(good > 30_000 && refused < 40, "{good} {refused}");
}
