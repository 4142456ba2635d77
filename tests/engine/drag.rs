//! Drag of the air on the gear: force and moment, acceleration, reactions and energy against formulas in this file.

use crate::support::{Run, Vec2, changed, turned, without_stops};
use proptest::prelude::*;
use serde_json::json;

/// Density [kg/m3], drag coefficient of leg and wheel, length and width of the leg [m], area of the wheel [m2].
const DENSITY: f64 = 1.225;
const COEFFICIENT: f64 = 0.5;
const LEG: f64 = 0.759;
const WIDTH: f64 = 0.10;
const AREA: f64 = 0.09;
/// Flow direction: along the axis of the aircraft, normal to the upward direction at 1.13 rad.
const FLOW: f64 = 1.13 - std::f64::consts::FRAC_PI_2;
/// Error relative to the largest reaction or acceleration. The tables have errors of 1e-13 of their largest value, and
/// a reaction is a sum of a few terms that are up to a hundred times larger.
const TABLES: f64 = 1e-10;

/// The gear without its stops. `relative`: whether the velocities of leg and wheel count in the wind.
fn gear(relative: bool) -> Run {
    Run::shared(&changed(without_stops(), |m| m["air"]["relative_wind"] = json!(relative)))
}

/// The gear without its stops, with a force at the middle of the leg and a torque on the leg as additional inputs.
fn pushed() -> Run {
    Run::shared(&changed(without_stops(), |m| {
        m["bodies"]["leg"]["points"] = json!({ "middle": [0.5 * LEG, 0.0] });
        m["forces"]["push"] = json!({ "at": "leg.middle" });
        m["torques"]["twist"] = json!({ "on": "leg" });
    }))
}

/// Unit vector at this angle [rad].
fn unit(angle: f64) -> Vec2 {
    turned(Vec2::x(), angle)
}

/// The gear at this angle and speed of the crank.
fn at(mut gear: Run, (angle, speed): (f64, f64)) -> Run {
    gear.place(("crank.start_angle", angle), ("crank.start_speed", speed));
    gear
}

/// Drag force on the leg, its moment about the crank's pivot, and drag force on the wheel, for this angle and speed of
/// the crank.
///
/// dF = 1/2 rho c w |n . u| u ds. Where n . u has one sign, the integrand of the moment is cubic: two Gauss points are
/// exact.
fn drag(angle: f64, speed: f64, airspeed: f64, relative: bool) -> (Vec2, f64, Vec2) {
    let (along, normal) = (unit(angle - 2.4), turned(Vec2::y(), angle - 2.4));
    let omega = if relative { speed } else { 0.0 };
    let wind = |s: f64| airspeed * unit(FLOW) - omega * s * normal;
    let pressure = |s: f64| 0.5 * DENSITY * COEFFICIENT * normal.dot(&wind(s)).abs() * wind(s);
    let (a, b) = (normal.dot(&wind(0.0)), normal.dot(&wind(LEG)));
    let reversal = if a * b < 0.0 { LEG * a / (a - b) } else { 0.0 };
    let (mut force, mut moment) = (Vec2::zeros(), 0.0);
    for (from, to) in [(0.0, reversal), (reversal, LEG)] {
        for side in [-1.0, 1.0] {
            let s = 0.5 * (from + to) + side * (to - from) / 12_f64.sqrt();
            let part = 0.5 * (to - from) * WIDTH * pressure(s);
            force += part;
            moment += s * along.perp(&part);
        }
    }
    (force, moment, AREA * pressure(LEG))
}

fn near(a: f64, b: f64, of: f64) -> Result<(), TestCaseError> {
    prop_assert!((a - b).abs() <= TABLES * of, "{a} {b}, {:e} of {of}", (a - b).abs() / of);
    Ok(())
}

/// PHYSICS: 1/2 rho v^2 S c with S = S0 |sin| at the start, gear down.
#[test]
fn drag_at_the_start_has_its_closed_form() {
    let mut gear = at(gear(false), (0.8, 0.0));
    assert_eq!((gear.get("leg.drag"), gear.get("wheel.drag")), (0.0, 0.0));
    gear.set("airspeed", 70.0);
    let facing = (0.8 - 2.4 - FLOW).sin().abs();
    for (name, area) in [("leg.drag", LEG * WIDTH), ("wheel.drag", AREA)] {
        let expected = 0.5 * 1.225 * 70.0 * 70.0 * area * 0.5 * facing;
        assert!((gear.get(name) - expected).abs() < 1e-12 * expected, "{} {expected}", gear.get(name));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    /// Virtual work: the moment of all drag about the crank's pivot is the generalised force of the crank's angle. The
    /// generalised force divided by I = 2 T / omega^2 is the change of the acceleration. The reactions equal those
    /// under the same external forces.
    #[test]
    fn drag_acts_as_its_force_and_moment(
        angle in -1.3..1.3f64,
        speed in prop_oneof![-40.0..-0.1f64, 0.1..40.0f64],
        airspeed in -90.0..90.0f64,
        relative in any::<bool>(),
    ) {
        let state = (angle, speed);
        let mut still = at(gear(false), state);
        let mut blown = at(gear(relative).with(&[("airspeed", airspeed)]), state);
        let (leg, moment, wheel) = drag(angle, speed, airspeed, relative);
        let size = 0.5 * DENSITY * COEFFICIENT * AREA * (airspeed.abs() + 0.759 * speed.abs()).powi(2);
        near(blown.get("leg.drag"), leg.dot(&unit(FLOW)), size)?;
        near(blown.get("wheel.drag"), wheel.dot(&unit(FLOW)), size)?;
        let torque = moment + LEG * unit(angle - 2.4).perp(&wheel);
        let inertia = 2.0 * still.get("energy.kinetic") / (speed * speed);
        let (before, after) = (still.get("crank.acceleration"), blown.get("crank.acceleration"));
        near(after - before, torque / inertia, before.abs().max(torque.abs() / inertia))?;
        let forces = [
            ("push.force_x", leg.x),
            ("push.force_y", leg.y),
            ("twist.torque", moment - 0.5 * LEG * unit(angle - 2.4).perp(&leg)),
            ("wheel.force_x", wheel.x),
            ("wheel.force_y", wheel.y),
        ];
        let mut pushed = at(pushed().with(&forces), state);
        near(after, pushed.get("crank.acceleration"), before.abs() + torque.abs() / inertia)?;
        let names = (1..=4).flat_map(|joint| ["x", "y"].map(|axis| format!("joint{joint}.force_{axis}")));
        let forces: Vec<[f64; 2]> = names.map(|name| [blown.get(&name), pushed.get(&name)]).collect();
        let largest = forces.iter().fold(0.0, |a: f64, [_, force]| a.max(force.abs()));
        for [blown, pushed] in forces {
            near(blown, pushed, largest)?;
        }
    }
}

/// The energy gained since the start is the work of the actuator plus the work of the drag: by Simpson's rule over the
/// power of the drag, and by `energy.drift`.
#[test]
fn the_power_of_drag_is_lost() {
    const STEPS: usize = 2600;
    let (stop, airspeed, force) = (0.13, 70.0, 30_000.0);
    for relative in [false, true] {
        let settings = [("airspeed", airspeed), ("solver.tolerance", 1e-12)];
        let mut gear = at(gear(relative).with(&settings), (0.8, 0.0));
        let energy =
            |g: &mut Run| g.get("energy.kinetic") + g.get("energy.potential") - force * g.get("actuator.length");
        let power = |g: &mut Run| {
            let (angle, speed) = (g.get("crank.angle"), g.get("crank.speed"));
            let (_, moment, wheel) = drag(angle, speed, airspeed, relative);
            speed * (moment + LEG * unit(angle - 2.4).perp(&wheel))
        };
        let (before, length) = (energy(&mut gear), gear.get("actuator.length"));
        let mut work = power(&mut gear);
        for i in 1..=STEPS {
            gear.step(stop / STEPS as f64);
            let weight = if i == STEPS { 1.0 } else { (2 + 2 * (i % 2)) as f64 };
            work += weight * power(&mut gear);
        }
        work *= stop / STEPS as f64 / 3.0;
        let done = force * (gear.get("actuator.length") - length);
        // The drag opposes the retraction.
        assert!(work < -100.0 && done > 8000.0, "{work} {done}");
        let (drift, change) = (gear.get("energy.drift"), energy(&mut gear) - before);
        // The stated accuracy at the tolerance 1e-12 is 1e-9 of the work. The error of Simpson's rule is far smaller.
        assert!(drift.abs() < 1e-9 * done, "drift {drift:e} of {done}");
        assert!((change - work).abs() < 1e-9 * done, "{change} {work}");
    }
}

/// A plate on a crank in the wind: I omega^2 / 2 + 1/2 rho c S v^2 r G(theta) is constant, where G is the integral of
/// |sin| sin. The plate is edge-on to the wind twice per revolution. There its drag has a kink.
#[test]
fn a_plate_passes_edge_on_within_the_tolerance() {
    const INERTIA: f64 = 0.01;
    const ARM: f64 = 0.3;
    const PLATE: f64 = 0.02;
    const SPEED: f64 = 20.0;
    for tolerance in [1e-5, 1e-7, 1e-9, 1e-12] {
        let definition = json!({
            "name": "Vane",
            "bodies": { "ground": {}, "crank": { "mass": 0.0, "inertia": INERTIA, "points": { "tip": [ARM, 0] } } },
            "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" } },
            "air": { "density": DENSITY, "flow_angle": 0, "airspeed": SPEED },
            "surfaces": { "plate": { "at": "crank.tip", "area": PLATE, "surface_angle": 0, "drag_coefficient": 1.2 } },
            "start": { "body": "crank", "angle": 1.0, "speed": 30.0 },
            "guess": { "crank": 1.0 },
            "solver": { "tolerance": tolerance },
        });
        for steps in [1, 40] {
            let mut run = Run::new(definition.to_string()).started();
            let energy = |run: &mut Run| {
                let (theta, omega) = (run.get("crank.angle"), run.get("crank.speed"));
                let half = (theta / std::f64::consts::PI).floor();
                let rest = theta - half * std::f64::consts::PI;
                let part = 0.5 * rest - 0.25 * (2.0 * rest).sin();
                // Over one half revolution G grows by pi / 2, over the next it falls by pi / 2.
                let g = if half.rem_euclid(2.0) == 0.0 { part } else { std::f64::consts::FRAC_PI_2 - part };
                0.5 * INERTIA * omega * omega + 0.5 * DENSITY * 1.2 * PLATE * SPEED * SPEED * ARM * g
            };
            let start = energy(&mut run);
            run.steps(steps, 2.0);
            let error = energy(&mut run) / start - 1.0;
            println!("{tolerance:e} {steps}: {error:e}");
            assert!(error.abs() <= 10.0 * tolerance, "{tolerance} in {steps} steps: {error}");
        }
    }
}

/// Wind that reverses within a step: the drag of all surfaces is 0 at one instant. Energy and work agree.
#[test]
fn the_wind_may_turn_round_in_a_step() {
    for (relative, tolerance) in [(false, 1e-9), (true, 1e-9), (false, 1e-4), (true, 1e-12)] {
        for h in [1.0, 0.9, 0.01] {
            let mut run = gear(relative).with(&[("solver.tolerance", tolerance), ("actuator.force", 0.0)]).started();
            run.set("airspeed", 1.0);
            let steps = (1.0_f64 / h).ceil() as u32;
            for k in 0..steps {
                run.set("airspeed", 1.0 - 2.0 * f64::from(k) * h);
                run.set_derivative("airspeed", 1, -2.0);
                run.step(h);
            }
            let (drift, kinetic) = (run.get("energy.drift"), run.get("energy.kinetic"));
            assert!(drift.abs() < 100.0 * tolerance * kinetic.max(1000.0), "{relative} {h}: {drift} of {kinetic} J");
        }
    }
}
