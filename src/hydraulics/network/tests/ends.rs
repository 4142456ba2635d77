//! Pistons at the rigid ends of their cylinders, with a mass that a host moves by the force of the cylinder.
use super::{ACTUATOR, Host};

/// Least and largest length of the cylinder.
const LENGTHS: [f64; 2] = [0.412, 0.742];
const MASS: f64 = 700.0;
const LOAD: f64 = 1500.0;
const FORCES: [&str; 2] = ["ram.preview.force", "ram.preview.force_rate"];

/// A mass on a cylinder.
struct Mass {
    host: Host,
    motion: [f64; 2],
    /// Whether the host applies a linear force; else the mean force.
    is_linear: bool,
}

impl Mass {
    /// At rest near the end on this side, with the valve open towards it.
    fn near(side: usize, restitution: f64, is_linear: bool) -> Self {
        let text = ACTUATOR
            .replace("\"follow\"", "\"preview\"")
            .replace("\"length\": 0.5, \"speed\": 0.1,", &format!("\"restitution\": {restitution},"))
            .replace("\"cushion_flow\": 1.2e-5", "\"cushion_flow\": 0");
        let mut host = Host::of(&text);
        let length = LENGTHS[side] + [0.004, -0.004][side];
        for (name, value) in [
            ("solver.tolerance", 1e-12),
            ("ram.length", length),
            ("valve.command", [-0.7, 0.7][side]),
            ("ram.reduced_mass", MASS),
            ("ram.holding_force", LOAD),
        ] {
            host.set(name, value);
        }
        host.0.initialize().unwrap();
        Self { host, motion: [length, 0.0], is_linear }
    }

    fn announce(&mut self, h: f64) {
        let [length, speed] = self.motion;
        for (name, to) in [("ram.length", length), ("ram.speed", speed), ("preview.horizon", h)] {
            self.host.set(name, to);
        }
    }

    /// A step under the force of the cylinder. Returns the force at its beginning.
    fn step(&mut self, h: f64) -> f64 {
        self.announce(h);
        let [force, rate] = match self.is_linear {
            true => FORCES.map(|name| self.host.get(name)),
            false => [self.host.get("ram.preview.force_mean"), 0.0],
        };
        let [length, speed] = self.motion;
        let acceleration = (force - LOAD) / MASS;
        let jerk = rate / MASS;
        self.motion = [
            length + h * (speed + h * (acceleration / 2.0 + h * jerk / 6.0)),
            speed + h * (acceleration + h * jerk / 2.0),
        ];
        self.host.0.step(h).unwrap();
        force
    }

    fn run(&mut self, span: f64, h: f64) {
        (0..(span / h).round() as usize).for_each(|_| {
            self.step(h);
        });
    }
}

/// The acceleration at the end of the preview is the slope of the speed over the horizon.
#[test]
fn the_acceleration_of_the_preview_is_the_slope_of_its_speed() {
    let mut mass = Mass::near(0, 0.0, false);
    mass.run(0.02, 1e-4);
    for horizon in [1e-4, 1e-3, 4e-3] {
        let mut at = |output: &str, h: f64| {
            mass.announce(h);
            mass.host.get(&format!("ram.preview.{output}"))
        };
        let step = 1e-3 * horizon;
        let slope = (at("speed", horizon + step) - at("speed", horizon - step)) / (2.0 * step);
        let acceleration = at("acceleration", horizon);
        assert!(slope.abs() > 0.1, "{slope} m/s2");
        assert!((acceleration / slope - 1.0).abs() < 1e-4, "{horizon} s: {acceleration} instead of {slope} m/s2");
    }
}

/// The force on an end is the load, whatever the step, and the oil balance is kept.
#[test]
fn a_load_at_rest_on_an_end_is_exact_at_any_step() {
    for (side, is_linear) in [(0, false), (1, false), (0, true), (1, true)] {
        for h in [1e-4, 1e-3, 7e-3, 5e-2] {
            let mut mass = Mass::near(side, 0.0, is_linear);
            mass.run(1.0, h);
            let (force, [length, speed]) = (mass.step(h), mass.motion);
            assert!((force / LOAD - 1.0).abs() < 1e-9, "{side} {h}: {force} N");
            assert!(
                (length - LENGTHS[side]).abs() < 1e-14 && speed.abs() < 1e-13,
                "{side} {h}: {length} m, {speed} m/s"
            );
            assert!(mass.host.get("volume.balance").abs() < 1e-15, "{side} {h}: {}", mass.host.get("volume.balance"));
            assert_eq!(mass.host.0.take_warning(), None);
        }
    }
}

/// Whatever the steps, the mass stays within what a mean force leaves, and comes to rest.
#[test]
fn steps_may_change_at_an_end() {
    let mut mass = Mass::near(1, 0.0, false);
    for k in 0..600 {
        mass.step([1e-4, 2e-2, 3e-4, 5e-3][k % 4]);
        assert!(mass.motion[0] < LENGTHS[1] + 1e-3, "{k}: {:?}", mass.motion);
    }
    assert!((mass.motion[0] - LENGTHS[1]).abs() < 1e-14 && mass.motion[1].abs() < 1e-14, "{:?}", mass.motion);
}

/// The piston leaves the end with the step that follows the release.
#[test]
fn an_end_is_left_when_the_oil_draws_the_piston_off() {
    let way = |h: f64| {
        let mut mass = Mass::near(1, 0.0, true);
        mass.run(0.5, h);
        mass.host.set("valve.command", -0.7);
        mass.run(0.2, h);
        LENGTHS[1] - mass.motion[0]
    };
    let [fine, coarse, long] = [1e-4, 1e-3, 1e-2].map(way);
    println!("{fine} m, {:.1e} m, {:.1e} m", coarse - fine, long - fine);
    assert!(
        fine > 5e-3 && (coarse - fine).abs() < 0.1 * 1e-3 && (long - fine).abs() < 0.1 * 1e-2,
        "{fine} {coarse} {long}"
    );
}

/// With a restitution of 0.5 the mass rebounds with half of its speed, and comes to rest in the end.
#[test]
fn an_impact_returns_the_speed_times_the_restitution() {
    let h = 1e-5;
    let mut mass = Mass::near(1, 0.5, true);
    let mut before = 0.0;
    for _ in 0..20_000 {
        mass.step(h);
        if mass.motion[1] < 0.0 && before > 0.02 {
            break;
        }
        before = mass.motion[1];
    }
    // The oil accelerates the mass within the step.
    assert!(before > 0.02 && (mass.motion[1] / before + 0.5).abs() < 0.02, "{before} {}", mass.motion[1]);
    mass.run(1.0, h);
    assert!((mass.motion[0] - LENGTHS[1]).abs() < 1e-12 && mass.motion[1].abs() < 1e-9, "{:?}", mass.motion);
}

#[test]
fn derivatives_at_an_end_are_those_of_differences() {
    let h = 2e-3;
    let mut mass = Mass::near(1, 0.0, false);
    mass.run(1.0, h);
    mass.announce(h);
    let mut host = mass.host;
    let outputs = ["ram.preview.force_mean", "ram.preview.force", "ram.preview.force_rate", "ram.preview.length"]
        .map(|name| host.reference(name));
    for (input, e) in [
        ("ram.length", 1e-10),
        ("ram.speed", 1e-8),
        ("ram.reduced_mass", 1.0),
        ("ram.holding_force", 10.0),
        ("ram.holding_force_derivative", 10.0),
        ("preview.horizon", 1e-4),
    ] {
        let input = host.reference(input);
        let mut exact = [f64::NAN; 4];
        host.0.directional_derivative(&outputs, &[input], &[1.0], &mut |i, value| exact[i] = value).unwrap();
        let value = host.0.real(input).unwrap();
        let mut at = |by: f64| {
            host.0.set_real(input, value + by).unwrap();
            let all = outputs.map(|output| host.0.real(output).unwrap());
            host.0.set_real(input, value).unwrap();
            all
        };
        let (low, high) = (at(-e), at(e));
        for k in 0..outputs.len() {
            let difference = (high[k] - low[k]) / (2.0 * e);
            let size = [1e4, 1e4, 1e4 / h, 1.0][k];
            let rounding = 1e-5 * difference.abs() + 1e-11 * size / e;
            assert!((exact[k] - difference).abs() <= rounding, "{input} {k}: {} is not {difference}", exact[k]);
        }
    }
}

/// Before, at and after an impact, and at rest, a state that is written and read continues as the one written.
#[test]
fn a_saved_state_at_an_end_continues_identically() {
    let h = 5e-3;
    let mut mass = Mass::near(1, 0.3, true);
    for k in 0..120 {
        let mut bytes = Vec::new();
        mass.host.0.snapshot().write(&mut bytes).unwrap();
        let mut other = Mass { motion: mass.motion, ..Mass::near(1, 0.3, true) };
        let snapshot = other.host.0.read_snapshot(&bytes).unwrap();
        other.host.0.restore(&snapshot).unwrap();
        let (own, restored) = (mass.step(h), other.step(h));
        assert_eq!(own.to_bits(), restored.to_bits(), "{k}");
    }
    assert!((mass.motion[0] - LENGTHS[1]).abs() < 1e-12, "{:?}", mass.motion);
}

/// Without the mass of what it moves the cylinder cannot stop it.
#[test]
fn without_a_mass_a_motion_beyond_an_end_is_rejected() {
    let mut mass = Mass::near(1, 0.0, true);
    mass.announce(1e-3);
    mass.host.set("ram.length", 0.7425);
    mass.host.0.step(1e-3).unwrap();
    mass.host.set("ram.reduced_mass", 0.0);
    mass.host.set("ram.length", 0.7425);
    let error = mass.host.0.step(1e-3).unwrap_err().to_string();
    assert!(["ram.length", "0.7425", "0.742"].iter().all(|text| error.contains(text)), "{error}");
}
