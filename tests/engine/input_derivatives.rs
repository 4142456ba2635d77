//! Inputs that change within a step: order, exactness, energy, and what is let go in between.

use linkage_fmu::mechanism::Model;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

const FORCE: &str = "\"force\": 30000";

struct Gear(Model);

impl Gear {
    /// Flags are set to true; the word "lossy" gives the drive an efficiency.
    fn new(values: &[(&str, f64)], flags: &[&str]) -> Self {
        let lossy = flags.contains(&"lossy");
        let flags = flags.iter().filter(|flag| **flag != "lossy");
        let json = if lossy { GEAR.replace(FORCE, &format!("{FORCE}, \"efficiency\": 0.6")) } else { GEAR.into() };
        let mut gear = Gear(Model::from_json(&json).unwrap());
        for (name, value) in values {
            gear.set(name, *value);
        }
        for name in flags {
            let reference = gear.0.variables().find(name).unwrap();
            gear.0.set_boolean(reference, true).unwrap();
        }
        gear.0.initialize().unwrap();
        gear
    }

    fn set(&mut self, name: &str, value: f64) {
        let reference = self.0.variables().find(name).unwrap();
        self.0.set_real(reference, value).unwrap();
    }

    fn change(&mut self, name: &str, order: i32, value: f64) {
        let reference = self.0.variables().find(name).unwrap();
        self.0.set_input_derivative(reference, order, value).unwrap();
    }

    fn get(&mut self, name: &str) -> f64 {
        let reference = self.0.variables().find(name).unwrap();
        self.0.real(reference).unwrap()
    }

    fn state(&mut self) -> [f64; 2] {
        [self.get("crank.angle"), self.get("crank.speed")]
    }
}

/// Tight enough that the error of the integration does not show beside that of the inputs.
const TIGHT: (&str, f64) = ("solver.tolerance", 1e-13);
const SPAN: f64 = 0.08;

/// Run with F = 30 kN + 10 kN sin(300 t), told with so many derivatives at each of the communication points.
fn sampled(steps: usize, derivatives: i32, flags: &[&str]) -> Gear {
    let (amplitude, omega) = (1e4, 300.0);
    let mut gear = Gear::new(&[TIGHT], flags);
    let h = SPAN / steps as f64;
    for n in 0..steps {
        let (sine, cosine) = (omega * n as f64 * h).sin_cos();
        gear.set("actuator.force", 3e4 + amplitude * sine);
        if derivatives > 0 {
            gear.change("actuator.force", 1, amplitude * omega * cosine);
        }
        if derivatives > 1 {
            gear.change("actuator.force", 2, -amplitude * omega * omega * sine);
        }
        gear.0.step(h).unwrap();
    }
    gear
}

#[test]
fn each_derivative_raises_the_order_by_one() {
    for flags in [&[][..], &["friction.enabled"]] {
        let exact = sampled(8000, 2, flags).state();
        for derivatives in 0..=2 {
            let error = |steps| {
                let mut gear = sampled(steps, derivatives, flags);
                assert!(gear.get("energy.drift").abs() < 1e-7, "{}", gear.get("energy.drift"));
                (gear.state()[0] - exact[0]).abs()
            };
            let errors = [40, 80, 160].map(error);
            let order = (errors[1] / errors[2]).log2();
            println!("{flags:?} derivatives to order {derivatives}: errors {errors:?}, order {order:.2}");
            // The leading terms of the orders 1 and 3 happen to be small here, so that the next ones show.
            let above = order - f64::from(derivatives + 1);
            assert!(-0.25 < above && above < 0.8, "{derivatives} {errors:?}");
        }
    }
}

#[test]
fn one_step_under_a_parabola_is_as_good_as_many() {
    // All inputs that act change; so do the wind and gravity.
    let course = [
        ("actuator.force", [3e4, -4e4, 3e6]),
        ("load_factor", [3.0, -20.0, 100.0]),
        ("wheel.force_x", [0.0, 5e3, 0.0]),
    ];
    let wind = ("airspeed", [0.0, 400.0, 1e3]);
    for (flags, winds) in [
        (&[][..], false),
        (&["friction.enabled"][..], false),
        (&[][..], true),
        (&["friction.enabled", "air.relative_wind"][..], true),
        (&["lossy"][..], false),
        (&["lossy", "friction.enabled"][..], true),
    ] {
        let course: Vec<_> = course.into_iter().chain(winds.then_some(wind)).collect();
        let run = |steps: usize| {
            let mut gear = Gear::new(&[TIGHT], flags);
            let h = SPAN / steps as f64;
            for n in 0..steps {
                let t = n as f64 * h;
                for (name, [zeroth, first, second]) in &course {
                    gear.set(name, zeroth + first * t + 0.5 * second * t * t);
                    gear.change(name, 1, first + second * t);
                    gear.change(name, 2, *second);
                }
                gear.0.step(h).unwrap();
            }
            for (name, [zeroth, first, second]) in &course {
                let end = zeroth + first * SPAN + 0.5 * second * SPAN * SPAN;
                assert!((gear.get(name) - end).abs() <= 1e-12 * end.abs(), "{name}");
            }
            let drift = gear.get("energy.drift");
            assert!(drift.abs() < 2e-8, "{flags:?} {winds} {steps}: {drift}");
            gear.state()
        };
        let (one, many) = (run(1), run(97));
        for i in 0..2 {
            assert!((one[i] - many[i]).abs() < 1e-10 * many[1].abs(), "{flags:?} {winds}: {one:?} {many:?}");
        }
    }
}

#[test]
fn derivatives_hold_for_one_step_and_the_input_stays_where_it_came_to() {
    let mut gear = Gear::new(&[], &[]);
    gear.change("actuator.force", 1, 1e6);
    gear.0.step(1e-3).unwrap();
    assert_eq!(gear.get("actuator.force"), 31_000.0);
    gear.0.step(1e-3).unwrap();
    assert_eq!(gear.get("actuator.force"), 31_000.0);
    let mut other = Gear::new(&[], &[]);
    // The order of value and derivative does not matter.
    other.change("actuator.force", 1, 1e6);
    other.set("actuator.force", 30_000.0);
    other.0.step(1e-3).unwrap();
    other.0.step(1e-3).unwrap();
    assert_eq!(gear.state(), other.state());
}

#[test]
fn a_ramp_lets_go_of_the_down_stop_in_time() {
    for flags in [&[][..], &["friction.enabled"]] {
        let mut gear = Gear::new(&[("actuator.force", 0.0), TIGHT], flags);
        let holding = gear.get("actuator.holding_force");
        let release = 0.0312;
        let start = holding - 5_000.0;
        let rate = 5_000.0 / release;
        gear.set("actuator.force", start);
        assert!(gear.get("downstop.torque") < 0.0);
        gear.change("actuator.force", 1, rate);
        gear.0.step(0.999 * release).unwrap();
        assert!((gear.state()[0] - 0.8).abs() < 1e-14 && gear.state()[1] == 0.0);
        // One long step over the release, against a start from it.
        let rest = 0.01;
        let mut long = Gear::new(&[("actuator.force", start), TIGHT], flags);
        long.change("actuator.force", 1, rate);
        long.0.step(release + rest).unwrap();
        let mut short = Gear::new(&[("actuator.force", holding), TIGHT], flags);
        short.change("actuator.force", 1, rate);
        short.0.step(rest).unwrap();
        let (long, short) = (long.state(), short.state());
        assert!(short[1] < -1e-3);
        for i in 0..2 {
            assert!((long[i] - short[i]).abs() < 1e-9 * short[1].abs(), "{flags:?}: {long:?} {short:?}");
        }
    }
}

#[test]
fn a_ramp_overcomes_the_drive_that_holds_the_gear_at_rest() {
    let at = [("crank.start_angle", 0.5), TIGHT];
    let mut gear = Gear::new(&at, &["lossy"]);
    let holding = gear.get("actuator.holding_force");
    // Forward it takes the holding force over the efficiency, backward times it; between the two the drive holds.
    let [first, last] = if holding < 0.0 { [holding, 0.2 * holding] } else { [holding, 3.0 * holding] };
    let limit = if holding < 0.0 { 0.6 * holding } else { holding / 0.6 };
    let release = 0.0312;
    let rate = (limit - first) / release;
    let rest = (last - limit).abs().min(500.0) / rate.abs();
    let mut long = Gear::new(&at, &["lossy"]);
    long.set("actuator.force", first);
    long.change("actuator.force", 1, rate);
    long.0.step(release + rest).unwrap();
    let mut short = Gear::new(&at, &["lossy"]);
    short.set("actuator.force", limit);
    short.change("actuator.force", 1, rate);
    short.0.step(rest).unwrap();
    let (long, short) = (long.state(), short.state());
    assert!(short[1].abs() > 1e-6, "{short:?}");
    for i in 0..2 {
        assert!((long[i] - short[i]).abs() < 1e-8 * short[1].abs(), "{long:?} {short:?}");
    }
}

#[test]
fn a_ramp_that_turns_brings_the_gear_back_to_its_stop() {
    let mut gear = Gear::new(&[("actuator.force", 3e4)], &[]);
    gear.change("actuator.force", 1, -2e6);
    gear.0.step(0.1).unwrap();
    let [angle, speed] = gear.state();
    assert!((angle - 0.8).abs() < 1e-14 && speed == 0.0, "{angle} {speed}");
    let drift = gear.get("energy.drift");
    assert!(drift.abs() < 1e-4, "{drift}");
}

#[test]
fn a_derivative_out_of_range_is_refused() {
    let mut gear = Gear::new(&[], &[]);
    let (force, angle) = (0, gear.0.variables().find("crank.angle").unwrap());
    for (reference, order, value) in
        [(force, 0, 1.0), (force, 3, 1.0), (force, 1, f64::NAN), (angle, 1, 1.0), (9999, 1, 1.0)]
    {
        assert!(gear.0.set_input_derivative(reference, order, value).is_err());
    }
    gear.change("actuator.force", 2, f64::MAX);
    let before = gear.state();
    let error = gear.0.step(10.0).unwrap_err().to_string();
    assert!(error.contains("actuator.force"), "{error}");
    assert_eq!(gear.state(), before);
    let method = gear.0.variables().find("solver.method").unwrap();
    gear.0.set_text(method, "rigid_fem").unwrap();
    assert!(gear.0.set_input_derivative(force, 1, 1.0).unwrap_err().to_string().contains("rigid_fem"));
}

/// Bare cost; run with --release -- --ignored --nocapture.
#[test]
#[ignore = "a timing"]
fn a_constant_input_costs_nothing_more() {
    for changing in [false, true] {
        let mut gear = Gear::new(&[], &[]);
        let clock = std::time::Instant::now();
        let mut steps = 0;
        while gear.get("crank.angle") > -1.2 {
            for _ in 0..100 {
                if changing {
                    gear.change("actuator.force", 1, 1.0);
                }
                gear.0.step(1e-5).unwrap();
                steps += 1;
            }
        }
        println!("changing {changing}: {:?} for each of {steps} steps of 10 us", clock.elapsed() / steps);
    }
}
