//! Static friction: closed forms of stick-slip and of Coulomb's oscillator, exact rest, located breakaway.
use crate::support::definition::{self, G, With, friction, weight};
use crate::support::numeric::simpson;
use crate::support::{GEAR, Run, assert_says, refusal};
use linkage_fmu::mechanism::{Pauses, Reached};
use serde_json::{Value, json};
use std::f64::consts::PI;

const MASS: f64 = 2.0;
const MU_S: f64 = 0.3;
const MU_D: f64 = 0.2;
pub const STIFFNESS: f64 = 50.0;

/// A block on a slide at this angle, with a spring to the origin and a force along x.
pub fn block(slope: f64, stiffness: f64) -> Value {
    definition::block(MASS).with(json!({
        "joints": { "slide": { "axis_angle": slope } }, "gravity": weight(), "friction": sticks([MU_S, MU_D], [0.0; 2]),
        "springs": { "spring": { "joint": "slide", "stiffness": stiffness, "free_length": 0 } },
        "forces": { "pull": { "at": "block.origin" } }, "solver": { "tolerance": 1e-12 },
    }))
}

fn sticks(coefficients: [f64; 2], speeds: [f64; 2]) -> Value {
    friction(coefficients, speeds).with(json!({ "law": "stick" }))
}

/// Texts of the occurrences in the last steps.
fn messages(run: &mut Run) -> Vec<String> {
    run.take_occurrences(0.0).into_iter().map(|line| line.text).collect()
}

/// A block of mass m pulled by a spring k whose end moves at the speed V. It sticks until the spring force is the
/// static friction F_s. It slips for phi / omega, with phi = 2 pi - 2 atan((F_s - F_d) omega / (k V)), over V phi /
/// omega + 2 (F_s - F_d) / k. Then it sticks for 2 (F_s - F_d) / (k V).
struct StickSlip {
    speed: f64,
    omega: f64,
    rest: f64,
    drop: f64,
}

impl StickSlip {
    fn new(speed: f64) -> Self {
        let normal = MASS * G;
        let (rest, drop) = (MU_S * normal / STIFFNESS, (MU_S - MU_D) * normal / STIFFNESS);
        Self { speed, omega: (STIFFNESS / MASS).sqrt(), rest, drop }
    }

    fn slip_time(&self) -> f64 {
        (2.0 * PI - 2.0 * (self.drop * self.omega / self.speed).atan()) / self.omega
    }

    fn stick_time(&self) -> f64 {
        2.0 * self.drop / self.speed
    }

    fn stroke(&self) -> f64 {
        self.speed * self.slip_time() + 2.0 * self.drop
    }

    /// Position, speed and whether the block sticks, at a time.
    fn at(&self, t: f64) -> (f64, f64, bool) {
        let first = self.rest / self.speed;
        let period = self.slip_time() + self.stick_time();
        let cycles = ((t - first) / period).floor().max(0.0);
        let since = t - first - cycles * period;
        let x = cycles * self.stroke();
        if since < 0.0 {
            return (x, 0.0, true);
        }
        if since > self.slip_time() {
            return (x + self.stroke(), 0.0, true);
        }
        let (sin, cos) = (self.omega * since).sin_cos();
        let swing = self.drop - self.drop * cos - self.speed / self.omega * sin;
        let rate = self.drop * self.omega * sin - self.speed * cos;
        (x + self.speed * since + swing, self.speed + rate, false)
    }
}

/// Stick-slip over many cycles in steps of any size agrees with the closed form. The block breaks away and sticks once
/// per cycle.
#[test]
fn stick_slip_follows_its_closed_form() {
    for (speed, steps) in [(0.1, 2000), (0.1, 77), (0.1, 20), (0.5, 400), (0.02, 100)] {
        let exact = StickSlip::new(speed);
        let span = 10.0 * (exact.slip_time() + exact.stick_time()) + 0.4;
        let mut run = Run::new(block(0.0, STIFFNESS)).started();
        run.listen(true, false);
        let h = span / f64::from(steps);
        let mut events = Vec::new();
        let mut worst: f64 = 0.0;
        for k in 0..steps {
            run.set("pull.force_x", STIFFNESS * speed * f64::from(k) * h);
            run.set_derivative("pull.force_x", 1, STIFFNESS * speed);
            run.step(h);
            events.extend(messages(&mut run));
            run.set("pull.force_x", STIFFNESS * speed * f64::from(k + 1) * h);
            let (x, v, sticks) = exact.at(f64::from(k + 1) * h);
            worst = worst.max((run.get("slide.position") - x).abs()).max((run.get("slide.speed") - v).abs());
            if sticks {
                assert_eq!(run.get("slide.speed"), 0.0);
                assert!(run.is("friction.sticking"));
                assert_eq!(run.get("slide.acceleration"), 0.0);
                let spring = STIFFNESS * (speed * f64::from(k + 1) * h - x);
                assert!((run.get("slide.friction_force") + spring).abs() < 1e-8);
            } else {
                assert!(!run.is("friction.sticking"));
            }
        }
        assert!(worst < 1e-9, "{worst} at {speed} m/s in {steps} steps");
        let count = |word: &str| events.iter().filter(|line| line.contains(word)).count();
        let cycles = ((span - exact.rest / speed) / (exact.slip_time() + exact.stick_time())).floor() as usize;
        let ends = usize::from(exact.at(span).2);
        assert_eq!((count("breaks away"), count("holds")), (cycles + 1, cycles + ends), "{events:?}");
        let drift = run.get("energy.drift");
        assert!(drift.abs() < 1e-9, "{drift}");
    }
}

/// Coulomb's oscillator: each half swing lasts pi / omega, and the amplitude decreases by 2 F_d / k. The block stops
/// where the spring force is below the static friction, and then stays exactly at rest.
#[test]
fn an_oscillator_comes_to_rest() {
    let normal = MASS * G;
    let (x0, loss) = (1.0, 2.0 * MU_D * normal / STIFFNESS);
    let half = PI / (STIFFNESS / MASS).sqrt();
    let held = MU_S * normal / STIFFNESS;
    let mut swings = 0;
    while x0 - f64::from(swings) * loss > held {
        swings += 1;
    }
    let amplitude = |n: i32| (x0 - f64::from(n) * loss) * if n % 2 == 0 { 1.0 } else { -1.0 };
    for steps in [1, 10, 1000] {
        let mut definition = block(0.0, STIFFNESS);
        definition["start"]["position"] = json!(x0);
        let mut run = Run::new(&definition).started();
        for n in 1..swings {
            run.steps(steps, half);
            let x = run.get("slide.position");
            assert!((x - amplitude(n)).abs() < 1e-9, "{x} after {n} swings");
        }
        run.steps(steps, 1.5 * half);
        let x = run.get("slide.position");
        assert!((x - amplitude(swings)).abs() < 1e-9 && run.is("friction.sticking"), "{x}");
        assert!(run.get("energy.drift").abs() < 1e-9);
        run.step(1e6);
        assert_eq!((run.get("slide.position").to_bits(), run.get("slide.speed").to_bits()), (x.to_bits(), 0));
    }
}

/// On a slope that static friction can hold, the block stays exactly at rest for 1e6 s without any integration step.
/// Its friction and its normal force balance its weight. On a steeper slope it slides with Coulomb friction.
#[test]
fn a_block_on_a_slope_does_not_creep() {
    let slope = f64::atan(0.29);
    let mut run = Run::new(block(slope, 0.0)).started();
    let place = run.get("slide.position");
    run.step(1.0);
    run.steps(1000, 1e6);
    assert_eq!((run.get("slide.position").to_bits(), run.get("slide.speed").to_bits()), (place.to_bits(), 0));
    assert_eq!(run.statistics().accepted, 0);
    let (along, across) = (MASS * G * slope.sin(), MASS * G * slope.cos());
    assert!((run.get("slide.friction_force") - along).abs() < 1e-12 * along);
    assert!((run.get("slide.force") - across).abs() < 1e-12 * across);
    assert!(run.is("friction.sticking") && run.get("energy.drift") == 0.0);
    let slope = f64::atan(0.31);
    let mut run = Run::new(block(slope, 0.0)).started();
    run.step(2.0);
    let way = -0.5 * (G * slope.sin() - MU_D * G * slope.cos()) * 4.0;
    assert!((run.get("slide.position") - way).abs() < 1e-11 && !run.is("friction.sticking"));
}

/// The gear sticks between its two breakaway forces. Under a rising drive force it breaks away at one of them, for any
/// step size. While it sticks, the friction in the joints is within its static limits, and the reactions balance the
/// loads.
#[test]
fn the_gear_sticks_between_its_breakaway_forces() {
    let text = GEAR.replace("\"enabled\": false, \"static", "\"enabled\": true, \"law\": \"stick\", \"static");
    let mut start = Run::new(&text).with(&[("crank.start_angle", 0.3)]);
    start.set("airspeed", 0.0);
    let mut at_rest = start.clone();
    let [forward, backward] =
        ["breakaway_force_forward", "breakaway_force_backward"].map(|name| at_rest.get(&format!("actuator.{name}")));
    assert!(backward < forward);
    for (force, sticks) in [
        (forward - 1e-6, true),
        (forward + 1e-6, false),
        (backward + 1e-6, true),
        (backward - 1e-6, false),
        (0.5 * (forward + backward), true),
    ] {
        let mut gear = start.clone().with(&[("actuator.force", force)]).started();
        assert_eq!(gear.is("friction.sticking"), sticks, "{force}");
        let angle = gear.get("crank.angle");
        gear.step(10.0_f64.powi(if sticks { 6 } else { -3 }));
        assert_eq!(gear.get("crank.angle") == angle, sticks, "{force}");
        if sticks {
            for joint in 1..=4 {
                let radius = if joint == 1 { 0.0175 } else { 0.015 };
                let limit = 0.19 * radius * gear.get(&format!("joint{joint}.force"));
                let torque = gear.get(&format!("joint{joint}.friction_torque"));
                assert!(torque.abs() <= limit * (1.0 + 1e-12), "joint{joint}: {torque}, at most {limit}");
            }
        }
    }
    // A force that rises from the middle of the range reaches the forward breakaway force after 1 s.
    let (middle, rate) = (0.5 * (forward + backward), 0.5 * (forward - backward));
    for steps in [1, 3, 100] {
        for (late, sticks) in [(-1e-9, true), (1e-7, false)] {
            let mut gear = start.clone().with(&[("actuator.force", middle)]).started();
            gear.follow("actuator.force", [middle, rate, 0.0], (steps, 1.0 + late), |_, _| {});
            assert_eq!(gear.get("crank.speed") == 0.0, sticks, "{steps} steps, {late}");
        }
    }
}

/// Stribeck curve: between V_S and V_d the coefficient falls from mu_S to mu_d. The work of friction agrees with it.
#[test]
fn friction_falls_along_its_stribeck_curve() {
    let mut definition = block(0.0, 0.0);
    definition["friction"]["kinetic_speed"] = json!(1.0);
    definition["start"]["speed"] = json!(0.5);
    let mut run = Run::new(&definition).started();
    // In the middle of the cubic transition the coefficient has its mean value.
    let friction = run.get("slide.friction_force");
    assert!((friction + 0.5 * (MU_S + MU_D) * MASS * G).abs() < 1e-12, "{friction}");
    run.step(1.0);
    assert_eq!(run.get("slide.speed"), 0.0);
    assert!(run.get("energy.drift").abs() < 1e-11);
    // x = the integral of v / (mu(v) g) from 0 to 0.5 m/s.
    let mu = |v: f64| MU_S + (MU_D - MU_S) * v * v * (3.0 - 2.0 * v);
    run.near("slide.position", simpson(|v| v / (mu(v) * G), 0.0, 0.5, 2000), 1e-11);
}

/// A block bounces on a stop with friction, sticks at the stop while pressed, and breaks away above static friction.
#[test]
fn a_stop_and_friction_hold_together() {
    let mut definition = block(0.0, 0.0);
    definition["stops"] = json!({ "end": { "joint": "slide", "limit": "upper", "position": 0.5, "restitution": 0.5 } });
    definition["start"]["speed"] = json!(2.0);
    let mut run = Run::new(&definition).started();
    run.step(10.0);
    // At the stop v^2 = 4 - 2 mu g 0.5. After the impact a quarter of v^2 gives the distance v^2 / (2 mu g).
    let back = 0.25 * (4.0 - 2.0 * MU_D * G * 0.5) / (2.0 * MU_D * G);
    let x = run.get("slide.position");
    assert!((x - (0.5 - back)).abs() < 1e-10 && run.is("friction.sticking"), "{x}");
    assert!(run.get("energy.drift").abs() < 1e-10);
    let mut definition = definition.clone();
    definition["start"] = json!({ "joint": "slide", "position": 0.5, "speed": 0 });
    let mut run = Run::new(&definition).started();
    let held = MU_S * MASS * G;
    for (force, sticks, stays) in
        [(2.0 * held, false, true), (0.5 * held, true, true), (-0.99 * held, true, true), (-1.01 * held, false, false)]
    {
        run.set("pull.force_x", force);
        assert_eq!(run.is("friction.sticking"), sticks, "{force}");
        run.step(1.0);
        assert_eq!(run.get("slide.position") == 0.5, stays, "{force}");
    }
}

/// A block is pushed along a rail while its weight reverses twice: the normal force passes 0, and the block slips,
/// sticks and slips again in one step. At rest a limit on the step from the last slip no longer applies.
#[test]
fn a_block_whose_weight_turns_sticks_and_slips_in_one_step() {
    let position = |tolerance: f64| {
        let mut definition = block(0.0, 0.0);
        definition["friction"] = sticks([0.2, 0.1], [1e-3, 0.1]);
        definition["solver"] = json!({ "tolerance": tolerance });
        let mut run = Run::new(&definition);
        run.set_all(&[("load_factor", -3.0), ("pull.force_x", 3.0)]);
        run.initialize();
        for factor in [-3.0, 3.0] {
            run.set("load_factor", factor);
            run.set_derivative("load_factor", 1, -2.0 * factor);
            run.step(1.0);
        }
        run.get("slide.position")
    };
    let exact = position(1e-10);
    for tolerance in [0.1, 1e-2, 1e-3, 1e-4, 1e-6] {
        let error = position(tolerance) - exact;
        assert!(error.abs() <= 10.0 * tolerance, "at {tolerance}: {error} m from {exact} m");
    }
}

/// A static coefficient below the kinetic coefficient is rejected if the friction law sticks.
#[test]
fn static_below_kinetic_friction_is_rejected() {
    let mut definition = block(0.0, 0.0);
    definition["friction"]["static_coefficient"] = json!(0.1);
    assert_says(refusal(definition), &["friction.static_coefficient", "0.1", "0.2", "stick"]);
}

/// A host with event mode gets an event at each change between sticking and slipping, at the instant of the change.
#[test]
fn steps_pause_where_the_block_sticks_and_breaks_away() {
    let (speed, span) = (0.1, 6.0);
    let exact = StickSlip::new(speed);
    let mut run = Run::new(block(0.0, STIFFNESS)).started();
    let (mut t, mut changes) = (0.0, Vec::new());
    while t < span {
        run.set("pull.force_x", STIFFNESS * speed * t);
        run.set_derivative("pull.force_x", 1, STIFFNESS * speed);
        let h = span - t;
        let reached = run.step_to_pause(None, h, Pauses { at_events: true, at_steps: false }).unwrap();
        t = if reached == Reached::End { span } else { t + reached.time(h) };
        if matches!(reached, Reached::Event(_)) {
            run.handle_event(None).unwrap();
            changes.push((t, run.is("friction.sticking")));
            assert_eq!(run.get("slide.speed"), 0.0);
        }
    }
    let (first, period) = (exact.rest / speed, exact.slip_time() + exact.stick_time());
    let expected =
        (0..).map(|k| first + period * f64::from(k)).flat_map(|t| [(t, false), (t + exact.slip_time(), true)]);
    let expected: Vec<(f64, bool)> = expected.take_while(|(t, _)| *t < span).collect();
    assert_eq!(changes.len(), expected.len(), "{changes:?}");
    for ((t, sticks), (exact, expected)) in changes.into_iter().zip(expected) {
        assert!((t - exact).abs() < 1e-10, "{t}, not {exact}");
        // At breakaway the loads are at the end of the range of static friction, inside or outside by rounding.
        assert!(sticks || !expected);
    }
}
