//! The piston at the rigid ends of its cylinder, with a mass that a host moves under the mean force.
use super::*;

/// Least and largest length of the actuator.
const LENGTHS: [f64; 2] = [0.412, 0.742];
const MASS: f64 = 700.0;
const LOAD: f64 = 1500.0;

/// A mass on an actuator.
struct Host {
    actuator: Model,
    length: f64,
    speed: f64,
}

impl Host {
    /// At rest near the end on this side, with the valve open towards it.
    fn near(side: usize, restitution: f64) -> Self {
        let mut actuator = model(ACTUATOR);
        let (length, command) = (LENGTHS[side] + [0.004, -0.004][side], [-0.7, 0.7][side]);
        for (name, value) in [
            ("solver.tolerance", 1e-12),
            ("cushion_a.length", 0.0),
            ("cushion_b.length", 0.0),
            ("cylinder.restitution", restitution),
            ("actuator.length", length),
            ("valve.command", command),
            ("actuator.reduced_mass", MASS),
            ("actuator.holding_force", LOAD),
        ] {
            set(&mut actuator, name, value);
        }
        actuator.initialize().unwrap();
        Self { actuator, length, speed: 0.0 }
    }

    fn tell(&mut self, h: f64) {
        set(&mut self.actuator, "actuator.length", self.length);
        set(&mut self.actuator, "actuator.speed", self.speed);
        set(&mut self.actuator, "preview.horizon", h);
    }

    /// A step under the mean force. Returns this force.
    fn step(&mut self, h: f64) -> f64 {
        self.tell(h);
        let force = get(&mut self.actuator, "preview.force_mean");
        let acceleration = (force - LOAD) / MASS;
        self.length += h * (self.speed + 0.5 * h * acceleration);
        self.speed += h * acceleration;
        self.actuator.step(h).unwrap();
        force
    }

    fn run(&mut self, steps: usize, h: f64) {
        (0..steps).for_each(|_| {
            self.step(h);
        });
    }
}

#[test]
fn a_load_at_rest_on_an_end_is_exact_at_any_step() {
    for (side, h) in [0, 1].into_iter().flat_map(|side| [1e-4, 1e-3, 7e-3, 5e-2].map(|h| (side, h))) {
        let mut host = Host::near(side, 0.0);
        host.run((1.0 / h) as usize, h);
        let force = host.step(h);
        assert!((force / LOAD - 1.0).abs() < 1e-9, "{side} {h}: {force} N");
        assert!((host.length - LENGTHS[side]).abs() < 1e-15 * LENGTHS[side] + 1e-16, "{side} {h}: {} m", host.length);
        host.tell(h);
        let [oil, end] = ["actuator.force", "cylinder.end_force"].map(|name| get(&mut host.actuator, name));
        assert!(end * [1.0, -1.0][side] > 1e4 && (oil + end - LOAD).abs() < 1e-9, "{side} {h}: {oil} N, {end} N");
        assert_eq!(host.actuator.take_warning(), None);
    }
}

/// Whatever the steps, the mass stays within what a mean force leaves, and comes to rest.
#[test]
fn steps_may_change_at_an_end() {
    let mut host = Host::near(1, 0.0);
    for k in 0..600 {
        host.step([1e-4, 2e-2, 3e-4, 5e-3][k % 4]);
        assert!(host.length < LENGTHS[1] + 1e-3, "{k}: {}", host.length);
    }
    assert!((host.length - LENGTHS[1]).abs() < 1e-14 && host.speed.abs() < 1e-14, "{} {}", host.length, host.speed);
}

/// The piston leaves the end at the instant at which the oil no longer presses it on, at any step.
#[test]
fn an_end_is_left_when_the_oil_draws_the_piston_off() {
    let way = |h: f64| {
        let mut host = Host::near(1, 0.0);
        host.run((0.5 / h).round() as usize, h);
        set(&mut host.actuator, "valve.command", -0.7);
        host.run((0.2 / h).round() as usize, h);
        LENGTHS[1] - host.length
    };
    let [fine, coarse, long] = [1e-4, 1e-3, 1e-2].map(way);
    println!("{fine} m, {:.1e} m, {:.1e} m", coarse - fine, long - fine);
    assert!(fine > 5e-3 && (coarse - fine).abs() < 1e-5 && (long - fine).abs() < 1e-3, "{fine} {coarse} {long}");
}

/// With a restitution of 0.5 the mass rebounds with half of its speed.
#[test]
fn an_impact_returns_the_speed_times_the_restitution() {
    let h = 1e-5;
    let mut host = Host::near(1, 0.5);
    let mut before = 0.0;
    for _ in 0..20_000 {
        host.step(h);
        if host.speed < 0.0 && before > 0.02 {
            break;
        }
        before = host.speed;
    }
    // The oil accelerates the mass within the step.
    assert!(before > 0.02 && (host.speed / before + 0.5).abs() < 0.02, "{before} {}", host.speed);
    host.run(100_000, h);
    assert!((host.length - LENGTHS[1]).abs() < 1e-12 && host.speed.abs() < 1e-9, "{} {}", host.length, host.speed);
}

#[test]
fn derivatives_at_an_end_are_those_of_differences() {
    let h = 2e-3;
    let mut host = Host::near(1, 0.0);
    host.run(500, h);
    host.tell(h);
    let mut actuator = host.actuator;
    let outputs = ["cylinder.end_force", "preview.force_mean", "preview.force", "preview.force_rate", "preview.length"]
        .map(|name| reference(&actuator, name));
    for (input, e) in [
        ("actuator.length", 1e-10),
        ("actuator.speed", 1e-8),
        ("actuator.reduced_mass", 1.0),
        ("actuator.holding_force", 10.0),
        ("actuator.holding_force_derivative", 10.0),
        ("preview.horizon", 1e-4),
    ] {
        let input = reference(&actuator, input);
        let mut exact = [f64::NAN; 5];
        actuator.directional_derivative(&outputs, &[input], &[1.0], &mut |i, value| exact[i] = value).unwrap();
        let value = actuator.real(input).unwrap();
        let mut at = |by: f64| {
            actuator.set_real(input, value + by).unwrap();
            let all = outputs.map(|output| actuator.real(output).unwrap());
            actuator.set_real(input, value).unwrap();
            all
        };
        let (low, high) = (at(-e), at(e));
        for k in 0..outputs.len() {
            let difference = (high[k] - low[k]) / (2.0 * e);
            let size = [1e4, 1e4, 1e4, 1e4 / h, 1.0][k];
            let rounding = 1e-5 * difference.abs() + 1e-11 * size / e;
            assert!((exact[k] - difference).abs() <= rounding, "{input} {k}: {} is not {difference}", exact[k]);
        }
    }
}

/// Before, at and after an impact, and at rest, a state that is written and read goes on as the one written.
#[test]
fn a_saved_state_at_an_end_goes_on_identically() {
    let h = 5e-3;
    let mut host = Host::near(1, 0.3);
    for k in 0..120 {
        let mut bytes = Vec::new();
        host.actuator.snapshot().write(&mut bytes).unwrap();
        let mut other = Host { actuator: model(ACTUATOR), ..host };
        let snapshot = other.actuator.read_snapshot(&bytes).unwrap();
        other.actuator.restore(&snapshot).unwrap();
        let (own, restored) = (host.step(h), other.step(h));
        assert_eq!(own.to_bits(), restored.to_bits(), "{k}");
    }
    assert_eq!(host.length, LENGTHS[1]);
}

/// Without the mass of what it moves the actuator cannot stop it.
#[test]
fn without_a_mass_a_motion_beyond_an_end_is_refused() {
    let mut host = Host::near(1, 0.0);
    host.tell(1e-3);
    set(&mut host.actuator, "actuator.length", 0.7425);
    host.actuator.step(1e-3).unwrap();
    set(&mut host.actuator, "actuator.reduced_mass", 0.0);
    set(&mut host.actuator, "actuator.length", 0.7425);
    let error = host.actuator.step(1e-3).unwrap_err().to_string();
    assert!(["0.7425 m", "0.742 m", "actuator.reduced_mass"].iter().all(|text| error.contains(text)), "{error}");
}
