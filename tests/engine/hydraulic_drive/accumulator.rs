//! An accumulator with a pump as the supply of a mechanism's circuit, against closed forms.
use super::*;

const AMBIENT: f64 = 101_325.0;
const EXPONENT: f64 = 1.4;

/// Volume of the gas [m3] at this gauge pressure: V_0 (p_pre/p_abs)^(1/n).
fn gas(volume: f64, precharge: f64, pressure: f64) -> f64 {
    volume * ((precharge + AMBIENT) / (pressure + AMBIENT)).powf(1.0 / EXPONENT)
}

/// The retraction with an accumulator as the supply, charged to 20 MPa.
fn from_accumulator(tolerance: f64, pump: f64) -> Run {
    let mut gear = retraction(tolerance);
    gear.set_all(&[("accumulator.volume", 2e-3), ("pump.max_flow", pump), ("supply.pressure", 20e6)]);
    gear.started()
}

/// A pump with constant flow charges the accumulator while the valve is closed. The gas volume decreases by the pumped
/// volume: p_abs = p_pre (V_0/V_gas)^n.
#[test]
fn an_accumulator_is_filled_as_its_gas_is_compressed() {
    for h in [1e-3, 0.05] {
        let mut gear = retraction(1e-12);
        let pump = [("pump.max_flow", 2e-4), ("pump.full_pressure", 50e6), ("pump.max_pressure", 60e6)];
        // The flow of this valve is almost 0.
        let valve =
            [("valve.rated_flow", 1e-19), ("accumulator.volume", 1e-3), ("accumulator.precharge_pressure", 8e6)];
        gear = gear.with(&pump).with(&valve).started();
        // Before the first step the input `supply.pressure` is the start pressure.
        gear.set("supply.pressure", 12e6);
        assert_eq!(gear.get("accumulator.pressure"), 12e6);
        let before = gas(1e-3, 8e6, 12e6);
        for step in 1..=(1.0 / h) as u32 {
            gear.step(h);
            let left = before - 2e-4 * f64::from(step) * h;
            let expected = (8e6 + AMBIENT) * (1e-3 / left).powf(EXPONENT) - AMBIENT;
            let found = gear.get("accumulator.pressure");
            assert!((found / expected - 1.0).abs() < 1e-9, "{step}: {found} is not {expected}");
        }
    }
}

/// Without the pump, the supplied energy is the work of the gas, int p_S dV.
#[test]
fn the_gas_does_the_work_of_the_oil_supplied() {
    let mut gear = from_accumulator(1e-12, 0.0);
    gear.steps(40, 4.0);
    let end = gear.get("accumulator.pressure");
    let (v, w) = (gas(2e-3, 10e6, 20e6), gas(2e-3, 10e6, end));
    let constant = (20e6 + AMBIENT) * v.powf(EXPONENT);
    let work = constant * (v.powf(1.0 - EXPONENT) - w.powf(1.0 - EXPONENT)) / (EXPONENT - 1.0) - AMBIENT * (w - v);
    let supplied = gear.get("energy.supplied");
    assert!(end < 15e6 && (supplied / work - 1.0).abs() < 1e-10, "{end}: {supplied} {work}");
    balances(&mut gear, 1e-10);
}

/// The pump flow has kinks at two pressures, which occur during and after the retraction. Integration steps end at the
/// kinks, so short and long communication steps agree.
#[test]
fn kinks_of_the_pump_end_steps() {
    let run = |h: f64, tolerance: f64| {
        let mut gear = from_accumulator(tolerance, 1e-4);
        gear.set_all(&[("pump.full_pressure", 19.9e6), ("pump.max_pressure", 20.01e6)]);
        let mut gear = gear.started();
        let mut pressures = Vec::new();
        for _ in 0..(8.0 / h).round() as u32 {
            gear.step(h);
            pressures.push(gear.get("accumulator.pressure"));
        }
        let least = pressures.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least < 19.9e6 && gear.get("accumulator.pressure") > 19.9e6, "{least}");
        (gear.get("accumulator.pressure"), gear.get("crank.angle"), gear.get("energy.supplied"))
    };
    let (pressure, angle, energy) = run(0.01, 1e-13);
    for (h, tolerance, digits) in [(1e-3, 1e-9, 1e-8), (0.5, 1e-9, 1e-8), (2.0, 1e-11, 1e-10)] {
        let other = run(h, tolerance);
        for (value, expected) in [(other.0, pressure), (other.1, angle), (other.2, energy)] {
            assert!((value / expected - 1.0).abs() < digits, "{h} s: {value} is not {expected}");
        }
    }
}
