//! Stick-slip on a driven surface: the closed form, events, saved states.
use super::sticking_surfaces::{MASS, MU_D, MU_S, STIFFNESS, machine, parcel, sprung};
use crate::support::definition::{G, With};
use crate::support::{Run, assert_near, runner};
use linkage_fmu::mechanism::{Pauses, Reached};
use proptest::collection::vec;
use serde_json::json;
use std::f64::consts::PI;

/// Stick-slip of a parcel on a spring k, on a belt of the speed V: it sticks up to the displacement mu_S N / k, swings
/// with the frequency omega about mu_d N / k, and sticks again where it has the speed of the belt.
struct StickSlip {
    belt: f64,
    omega: f64,
    middle: f64,
    drop: f64,
}

impl StickSlip {
    fn new(belt: f64) -> Self {
        let per_stiffness = MASS * G / STIFFNESS;
        let (middle, drop) = (MU_D * per_stiffness, (MU_S - MU_D) * per_stiffness);
        Self { belt, omega: (STIFFNESS / MASS).sqrt(), middle, drop }
    }

    fn slip_time(&self) -> f64 {
        2.0 * (PI - (self.drop * self.omega / self.belt).atan()) / self.omega
    }

    fn period(&self) -> f64 {
        self.slip_time() + 2.0 * self.drop / self.belt
    }

    /// Time of the first slip of a parcel that starts at 0 with the speed of the belt.
    fn first(&self) -> f64 {
        (self.middle + self.drop) / self.belt
    }

    /// Largest displacement.
    fn largest(&self) -> f64 {
        self.middle + self.drop.hypot(self.belt / self.omega)
    }

    /// Position, speed and whether the parcel sticks, at a time.
    fn at(&self, t: f64) -> (f64, f64, bool) {
        let since = t - self.first();
        if since < 0.0 {
            return (self.belt * t, self.belt, true);
        }
        let since = since % self.period();
        if since > self.slip_time() {
            return (self.middle - self.drop + self.belt * (since - self.slip_time()), self.belt, true);
        }
        let ((sin, cos), per) = ((self.omega * since).sin_cos(), self.belt / self.omega);
        let x = self.middle + self.drop * cos + per * sin;
        (x, self.omega * (per * cos - self.drop * sin), false)
    }
}

/// Period, amplitude and every state of stick-slip are those of the closed form, in steps of any size. Each cycle has
/// two events.
#[test]
fn stick_slip_on_a_belt_follows_its_closed_form() {
    for (belt, steps) in [(0.1, 2000), (0.1, 77), (0.1, 20), (0.5, 400), (0.02, 100)] {
        let exact = StickSlip::new(belt);
        let mut run = Run::new(sprung(belt).with(json!({ "start": { "speed": belt } }))).started();
        run.listen(true, false);
        let span = exact.first() + 6.0 * exact.period() + 0.3 * exact.slip_time();
        let h = span / f64::from(steps);
        let (mut worst, mut most, mut events): (f64, f64, Vec<String>) = (0.0, 0.0, Vec::new());
        for k in 1..=steps {
            run.step(h);
            events.extend(run.take_occurrences(0.0).into_iter().map(|line| line.text));
            let (x, v, sticks) = exact.at(f64::from(k) * h);
            worst = worst.max((run.get("slide.position") - x).abs()).max((run.get("slide.speed") - v).abs());
            most = most.max(run.get("slide.position"));
            assert_eq!(run.is("friction.sticking"), sticks);
            if sticks {
                run.near("slide.friction_force", STIFFNESS * x, 1e-8);
                assert_near(run.derivative("slide.friction_force"), STIFFNESS * belt, 1e-8, "rate of the friction");
                run.near("slide.surface_power", STIFFNESS * x * belt, 1e-8);
                run.near("slide.slip_speed", 0.0, 1e-15);
            }
        }
        assert!(worst < 1e-9, "{worst} at {belt} m/s in {steps} steps");
        assert!(most <= exact.largest() + 1e-9 && (steps < 2000 || most > exact.largest() - 1e-4));
        let count = |word: &str| events.iter().filter(|line| line.contains(word)).count();
        assert_eq!((count("starts to slip"), count("carries")), (7, 6), "{events:?}");
        run.near("energy.drift", 0.0, 1e-9);
    }
}

/// A host with event mode gets an event at each change between sticking and slipping, at the instant of the change.
#[test]
fn steps_pause_where_a_parcel_sticks_and_slips() {
    let exact = StickSlip::new(0.1);
    let mut run = Run::new(sprung(0.1).with(json!({ "start": { "speed": 0.1 } }))).started();
    let (mut t, span, mut changes) = (0.0, exact.first() + 2.5 * exact.period(), Vec::new());
    while t < span {
        let h = span - t;
        let reached = run.step_to_pause(None, h, Pauses { at_events: true, at_steps: false }).unwrap();
        t = if reached == Reached::End { span } else { t + reached.time(h) };
        if matches!(reached, Reached::Event(_)) {
            run.handle_event(None).unwrap();
            changes.push(t);
        }
    }
    let [first, slip, period] = [exact.first(), exact.slip_time(), exact.period()];
    let expected: Vec<f64> = (0..3).flat_map(|k| [0.0, slip].map(|own| first + f64::from(k) * period + own)).collect();
    assert_eq!(changes.len(), expected.len(), "{changes:?}");
    changes.into_iter().zip(expected).for_each(|(t, exact)| assert_near(t, exact, 1e-10, "time of an event"));
}

/// A state that is saved while the parcel sticks, and one saved while it slips, continue identically.
#[test]
fn saved_states_continue_identically() {
    let exact = StickSlip::new(0.1);
    for time in [0.5 * exact.first(), exact.first() + 0.5 * exact.slip_time(), exact.first() + 0.95 * exact.period()] {
        let definition = sprung(0.1).with(json!({ "start": { "speed": 0.1 } }));
        let mut run = Run::new(&definition).started();
        run.steps(7, time);
        assert_eq!(run.is("friction.sticking"), exact.at(time).2);
        let saved = run.saved();
        run.repeats(|run| run.steps(9, 1.3 * exact.period()));
        let mut again = Run::new(&definition).started();
        again.take(&saved);
        again.steps(9, 1.3 * exact.period());
        let names = ["slide.position", "slide.speed", "slide.friction_force", "energy.drift"];
        assert_eq!(again.bits(names), run.bits(names));
    }
}

/// Random histories of the speed of the surface and of a drive with losses, with other friction, springs and stops: one
/// step is seven steps, energy is conserved, and a body that sticks has no slip and friction within its limit.
#[test]
fn one_step_is_many_in_random_histories() {
    let check = |unit: Vec<f64>| {
        let mut unit = unit.into_iter();
        let mut within = |low: f64, high: f64| low + (high - low) * unit.next().unwrap();
        let (is_crank, start) = (within(0.0, 1.0) < 0.4, within(-0.8, 0.8));
        let joint = if is_crank { "guide" } else { "slide" };
        let motor = if is_crank { "bearing" } else { "slide" };
        let force = if is_crank { "torque" } else { "force" };
        let mut definition = if is_crank { machine(start, json!({})) } else { parcel(start) }.with(json!({
            "joints": { joint: { "frictionloss": within(-4.0, 6.0).max(0.0) } },
            "start": { "speed": within(-0.8, 0.8) },
            "springs": {
                "spring": { "joint": joint, "stiffness": within(1.0, 200.0), "damping": within(0.0, 5.0) }
            },
            "actuators": { "motor": { "joint": motor, force: 0, "efficiency": within(0.5, 1.3).min(1.0) } },
            "solver": { "tolerance": 1e-10 },
        }));
        if !is_crank {
            let (high, low, restitution) = (within(0.05, 0.3), within(-0.3, -0.05), within(0.0, 0.8));
            definition = definition.with(json!({ "stops": {
                "high": { "joint": joint, "limit": "upper", "position": high, "restitution": restitution },
                "low": {
                    "joint": joint, "limit": "lower", "position": low, "rigid": false, "stiffness": 2e3, "damping": 9
                },
            } }));
        }
        let mut one = Run::new(&definition).started();
        let mut many = one.clone();
        let [speed, slip, position] = ["surface_speed", "slip_speed", "position"].map(|name| format!("{joint}.{name}"));
        let mut v = start;
        for _ in 0..10 {
            let (h, load) = (within(0.02, 0.2), within(-8.0, 8.0) * if is_crank { 0.1 } else { 1.0 });
            v = match within(0.0, 1.0) {
                part if part < 0.2 => within(-0.8, 0.8),
                part if part < 0.3 => 0.0,
                _ => v,
            };
            let [a, j] = [within(-12.0, 6.0), within(-90.0, 30.0)].map(|rate| if rate < -6.0 { 0.0 } else { rate });
            let advance = |run: &mut Run, t: f64, h: f64| {
                run.set(&format!("motor.{force}"), load);
                run.set(&speed, v + t * (a + 0.5 * t * j));
                run.set_derivative(&speed, 1, a + t * j);
                run.set_derivative(&speed, 2, j);
                run.step(h);
            };
            advance(&mut one, 0.0, h);
            (0..7).for_each(|k| advance(&mut many, h * f64::from(k) / 7.0, h / 7.0));
            v += h * (a + 0.5 * h * j);
            let expected = many.get(&position);
            one.near(&position, expected, 1e-7);
            assert_eq!(one.is("friction.sticking"), many.is("friction.sticking"));
            let is_held = many.is("friction.sticking") && many.get(&slip).abs() < 1e-9;
            assert!(!is_held || many.get(&slip).abs() < 1e-12);
            [&mut one, &mut many].into_iter().for_each(|run| run.near("energy.drift", 0.0, 1e-7));
        }
        Ok(())
    };
    runner(12).run(&vec(0.0..1.0, 90), check).unwrap();
}
