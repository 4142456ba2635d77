//! Accumulator and pump, lock valve, hoses and walls, pressed seals against closed forms.
use super::*;

/// A pump of constant flow fills an accumulator behind a closed valve: the gas has V_0 (p_pre/p_abs)^(1/n) at the start
/// and loses the oil pumped, so p_abs = p_pre (V_0/V_gas)^n.
#[test]
fn an_accumulator_is_filled_as_its_gas_is_compressed() {
    for h in [1e-3_f64, 0.05] {
        let mut actuator = model(ACTUATOR);
        actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
        for (name, value) in [
            ("solver.tolerance", 1e-12),
            ("accumulator.volume", 1e-3),
            ("accumulator.precharge_pressure", 8e6),
            ("supply.pressure", 12e6),
            ("pump.max_flow", 2e-4),
            ("pump.full_pressure", 50e6),
            ("pump.max_pressure", 60e6),
            // A valve that passes next to nothing.
            ("valve.rated_flow", 1e-19),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        let (ambient, n) = (101_325.0, 1.4_f64);
        let gas = 1e-3 * ((8e6_f64 + ambient) / (12e6 + ambient)).powf(1.0 / n);
        for step in 1..=(1.0 / h).round() as u32 {
            actuator.step(h).unwrap();
            let left = gas - 2e-4 * f64::from(step) * h;
            let expected = (8e6 + ambient) * (1e-3 / left).powf(n) - ambient;
            let found = get(&mut actuator, "accumulator.pressure");
            assert!((found / expected - 1.0).abs() < 1e-9, "{step}: {found} is not {expected}");
        }
    }
}

/// The pump fills the accumulator until it gives what leaks through the valve; without the pump, the gas does the work
/// of the oil supplied.
#[test]
fn a_compensated_pump_holds_its_pressure_and_an_accumulator_is_emptied_by_the_valve() {
    let mut actuator = model(ACTUATOR);
    actuator.set_text(reference(&actuator, "coupling.mode"), "follow").unwrap();
    for (name, value) in [("accumulator.volume", 2e-4), ("supply.pressure", 18e6), ("actuator.length", 0.5)] {
        set(&mut actuator, name, value);
    }
    actuator.initialize().unwrap();
    (0..300).for_each(|_| actuator.step(1e-2).unwrap());
    let held = get(&mut actuator, "accumulator.pressure");
    // The clearance of the valve leaks; the pump gives as much, but for what the gas still takes.
    let (flow, leak) = (1.5e-4 * (20.7e6 - held) / 0.7e6, get(&mut actuator, "supply.flow"));
    let rate = actuator.output_derivative(reference(&actuator, "accumulator.pressure"), 1).unwrap();
    let gas = 2e-4 * (10_101_325.0 / (held + 101_325.0)).powf(1.0 / 1.4);
    let taken = rate * gas / (1.4 * (held + 101_325.0));
    assert!((flow / leak - 1.0).abs() < 1e-3, "{flow} {leak}");
    assert!((flow - leak - taken).abs() < 1e-9 * leak, "{flow} {leak} {taken}");
    set(&mut actuator, "pump.max_flow", 0.0);
    actuator.initialize().unwrap();
    let start = get(&mut actuator, "accumulator.pressure");
    assert_eq!(start, 18e6);
    set(&mut actuator, "valve.command", 0.5);
    let mut before = start;
    for _ in 0..20 {
        actuator.step(1e-2).unwrap();
        let now = get(&mut actuator, "accumulator.pressure");
        assert!(now < before);
        before = now;
    }
    // Supplied oil is the growth of the gas, and its energy the work of the gas: int p_S dV.
    let (ambient, n) = (101_325.0_f64, 1.4_f64);
    let gas = |p: f64| 2e-4 * ((10e6 + ambient) / (p + ambient)).powf(1.0 / n);
    let (v, w) = (gas(18e6), gas(before));
    let work = (18e6 + ambient) * v.powf(n) * (v.powf(1.0 - n) - w.powf(1.0 - n)) / (n - 1.0) - ambient * (w - v);
    let supplied = get(&mut actuator, "energy.supplied");
    assert!((supplied / work - 1.0).abs() < 1e-7, "{supplied} {work}");
    assert!(get(&mut actuator, "energy.balance").abs() < 1e-8 * supplied);
}

#[test]
fn a_lock_valve_holds_until_its_pilot_opens() {
    use super::super::circuit::{Equations, Point};
    use super::super::definition::Circuit;
    let mut circuit = Circuit::default();
    (circuit.relief.conductance, circuit.anticavitation.conductance) = (0.0, 0.0);
    let free = Equations::new(&circuit);
    circuit.lock_valve.pilot_ratio = 0.3;
    let locked = Equations::new(&circuit);
    let at = |pressures| Point {
        pressures,
        spool: -0.5,
        spool_speed: 0.0,
        length: 0.6,
        speed: 0.0,
        // Of the pressure in the chamber, so that nothing leaks into it.
        supply: 12e6,
        tank: 0.35e6,
        command: 0.0,
    };
    // Leakages do not pass the valve.
    let leaks = |p: [f64; 2]| -2e-13 * (p[0] - p[1]);
    let out = |laws: &Equations, p| laws.flows(&at(p)).chambers[0] - leaks(p);
    let (closed, open) = ([12e6, 0.0], [12e6, 9e6]);
    assert!(out(&free, closed) < -1e-5);
    assert!(out(&locked, closed).abs() < 1e-7 * out(&free, closed).abs(), "{}", out(&locked, closed));
    assert!((out(&locked, open) / out(&free, open) - 1.0).abs() < 1e-3);
    // Inflow passes whatever the pilot says, but for the tail of the gate, (w/2d)^2 at the pressure drop d.
    let inflow = |laws: &Equations| laws.flows(&Point { spool: 0.5, ..at([5e6, 0.0]) }).chambers[0];
    assert!((inflow(&locked) / inflow(&free) - 1.0).abs() < 1e-4);
    let powers = locked.powers(&at(closed), &locked.flows(&at(closed)));
    let out = powers.returned + powers.piston + powers.seal_friction + powers.compression + powers.throttling;
    assert!((powers.supply - out).abs() < 1e-12 * powers.throttling.abs().max(1.0));
}

#[test]
fn hoses_and_walls_soften_the_oil_as_springs_in_series() {
    use super::super::circuit::Equations;
    use super::super::definition::Circuit;
    let mut circuit = Circuit::default();
    circuit.hose.volume_a = 4e-5;
    circuit.hose.modulus = 3e8;
    circuit.cylinder.wall_modulus = 2e10;
    let laws = Equations::new(&circuit);
    let (p, v) = (5e6, 3e-4);
    let oil = laws.bulk_modulus(p);
    let expected = 1.0 / (1.0 / oil + (4e-5 / v) / 3e8 + ((v - 4e-5) / v) / 2e10);
    assert!((laws.chamber_modulus(0, p, v) / expected - 1.0).abs() < 1e-14);
    // A hose holds its part whatever the stroke: growth of each volume under a pressure adds up.
    let growth = v / laws.chamber_modulus(0, p, v);
    assert!((growth - (v / oil + 4e-5 / 3e8 + (v - 4e-5) / 2e10)).abs() < 1e-14 * growth);
    circuit.hose.volume_a = 7e-5;
    let error = circuit.check().unwrap_err().to_string();
    assert!(error.contains("hose.volume_a = 0.00007") && error.contains("chamber_a.dead_volume"), "{error}");
    let stiff = Equations::new(&Circuit::default());
    assert_eq!(stiff.chamber_modulus(0, p, v), stiff.bulk_modulus(p));
}

#[test]
fn pressed_seals_rub_by_the_sum_of_the_pressures() {
    use super::super::circuit::Equations;
    use super::super::definition::Circuit;
    let mut circuit = Circuit::default();
    circuit.seal.pressure_area = 2e-5;
    let (dry, pressed) = (Equations::new(&Circuit::default()), Equations::new(&circuit));
    let (pressures, v) = ([10e6, 6e6], 0.05);
    let more = pressed.seal_friction(pressures, v) - dry.seal_friction(pressures, v);
    // 2e-5 m2 x 16 MPa, tanh(10) and the rounding of the pressures at 0 apart: w^2/(4 p) each.
    let expected = 2e-5 * (16e6 + 0.25e10 / 10e6 + 0.25e10 / 6e6) * 10.0_f64.tanh();
    assert!((more / expected - 1.0).abs() < 1e-8, "{more} {expected}");
    for v in [-0.01, 0.0, 0.004] {
        let h = 1e-7;
        let slope = (pressed.seal_friction(pressures, v + h) - pressed.seal_friction(pressures, v - h)) / (2.0 * h);
        assert!((pressed.damping(pressures, v) / slope - 1.0).abs() < 1e-6);
    }
    assert!((pressed.force(pressures, v) - dry.force(pressures, v) + more).abs() < 1e-9);
}
