//! Coulomb friction on driven surfaces, which hold their body: closed forms, balances, rejected definitions.
use crate::support::definition::{G, With, block, friction, rod, slider_crank, weight, wheel};
use crate::support::{Run, assert_near, assert_rejected};
use serde_json::{Value, json};

pub const MASS: f64 = 2.0;
pub const MU_S: f64 = 0.4;
pub const MU_D: f64 = 0.25;
pub const STIFFNESS: f64 = 50.0;

/// A parcel of 2 kg on a level belt with this speed.
pub fn parcel(speed: f64) -> Value {
    block(MASS).with(json!({
        "gravity": weight(), "joints": { "slide": { "surface_speed": speed } },
        "friction": friction([MU_S, MU_D], [0.0; 2]).with(json!({ "law": "stick" })),
        "forces": { "pull": { "at": "block.origin" } }, "solver": { "tolerance": 1e-12 },
    }))
}

/// The same with a spring to the ground.
pub fn sprung(speed: f64) -> Value {
    parcel(speed).with(json!({ "springs": { "spring": { "joint": "slide", "stiffness": STIFFNESS } } }))
}

/// A parcel is accelerated by mu_d g until it has the speed of the belt, and then moves with the belt exactly, in steps
/// of any size.
#[test]
fn a_parcel_takes_the_speed_of_its_belt() {
    for (belt, steps) in [(0.8, 1), (0.8, 7), (-0.8, 100)] {
        let sign = f64::signum(belt);
        let time = 0.8 / (MU_D * G);
        let mut run = Run::new(parcel(belt)).started();
        run.near("slide.acceleration", sign * MU_D * G, 1e-13);
        assert!(!run.is("friction.sticking"));
        run.steps(steps, 2.0);
        run.near("slide.position", belt * (2.0 - 0.5 * time), 1e-12);
        assert!(run.is("friction.sticking"));
        for name in ["slide.acceleration", "slide.friction_force", "slide.surface_power"] {
            run.near(name, 0.0, 1e-13);
        }
        run.near("slide.speed", belt, 1e-15);
        run.near("energy.drift", 0.0, 1e-12);
        run.step(1e6);
        run.near("slide.position", belt * (1e6 + 2.0 - 0.5 * time), 1e-8);
        run.near("slide.slip_speed", 0.0, 1e-15);
        // A force within the limit of static friction changes nothing but the friction and the power of the belt.
        let force = 0.99 * MU_S * MASS * G;
        run.set("pull.force_x", force);
        run.step(1.0);
        assert!(run.is("friction.sticking"));
        run.near("slide.friction_force", -force, 1e-13);
        run.near("slide.surface_power", -force * belt, 1e-13);
        run.near("slide.force_y", MASS * G, 1e-12);
        // A larger one does.
        run.set("pull.force_x", 1.01 * MU_S * MASS * G);
        assert!(!run.is("friction.sticking"));
        run.near("slide.friction_force", -MU_D * MASS * G, 1e-13);
        run.step(0.5);
        let rate = (1.01 * MU_S - MU_D) * G;
        run.near("slide.slip_speed", 0.5 * rate, 1e-12);
    }
}

/// A belt with the acceleration a from rest: the parcel goes along for a <= mu_S g, and else slips with mu_d g. With
/// the jerk j of the belt it starts to slip where the acceleration of the belt exceeds mu_S g.
#[test]
fn an_accelerating_belt_takes_its_parcel_along_up_to_the_static_limit() {
    for steps in [1, 40] {
        for (part, own) in [(0.999, 0.999 * MU_S), (-0.999, -0.999 * MU_S), (1.001, MU_D), (-1.001, -MU_D)] {
            let belt = part * MU_S * G;
            let mut run = Run::new(parcel(0.0)).started();
            run.follow("slide.surface_speed", [0.0, belt, 0.0], (steps, 0.5), |run, _| {
                run.near("slide.acceleration", own * G, 1e-11);
                run.near("slide.friction_force", own * MASS * G, 1e-11);
            });
            assert_eq!(run.is("friction.sticking"), part.abs() < 1.0);
            run.near("slide.speed", 0.5 * own * G, 1e-12);
            run.near("slide.position", 0.125 * own * G, 1e-12);
            run.near("energy.drift", 0.0, 1e-11);
        }
        let jerk = 10.0;
        let mut run = Run::new(parcel(0.0)).started();
        let first = MU_S * G / jerk;
        run.follow("slide.surface_speed", [0.0, 0.0, jerk], (steps, 0.5), |run, t| {
            let after = f64::max(t - first, 0.0);
            let speed = 0.5 * jerk * (t - after).powi(2) + MU_D * G * after;
            run.near("slide.speed", speed, 1e-11);
        });
    }
}

/// A belt that slows down, stops and turns back within one step carries the parcel, whose position is the integral of
/// the speed of the belt.
#[test]
fn a_belt_that_turns_back_carries_its_parcel() {
    for steps in [1, 3, 64] {
        let mut run = Run::new(parcel(0.6).with(json!({ "start": { "speed": 0.6 } }))).started();
        run.follow("slide.surface_speed", [0.6, -3.0, 0.0], (steps, 0.5), |run, _| {
            assert!(run.is("friction.sticking"));
        });
        run.near("slide.position", 0.6 * 0.5 - 1.5 * 0.25, 1e-14);
        run.near("slide.speed", -0.9, 1e-14);
        run.near("slide.friction_force", -3.0 * MASS, 1e-13);
        run.near("energy.drift", 0.0, 1e-13);
    }
}

/// Constant friction f against the ground next to the friction of the belt. The parcel moves with the belt while the
/// friction of the belt, f + m a, is within its limit; it rests while the belt slips if f is larger than that limit.
#[test]
fn other_friction_acts_while_a_parcel_moves_with_its_belt() {
    let normal = MASS * G;
    let with = |loss: f64, speed: f64| {
        let keys = json!({ "joints": { "slide": { "frictionloss": loss } }, "start": { "speed": speed } });
        Run::new(parcel(speed).with(keys)).started()
    };
    for steps in [1, 20] {
        // From rest: m a + f within the limit, and beyond.
        let loss = 0.3 * MU_S * normal;
        for (belt, own) in [(0.6 * MU_S * G, 0.6 * MU_S * G), (0.8 * MU_S * G, MU_D * G - loss / MASS)] {
            let mut run = with(loss, 0.0);
            run.follow("slide.surface_speed", [0.0, belt, 0.0], (steps, 0.5), |run, _| {
                run.near("slide.acceleration", own, 1e-12);
                assert_eq!(run.is("friction.sticking"), own == belt);
            });
            run.near("slide.position", 0.125 * own, 1e-12);
            run.near("energy.drift", 0.0, 1e-11);
        }
        // More friction than the belt gives: rest, with kinetic friction of the belt.
        let mut run = with(1.2 * MU_S * normal, 0.0);
        let place = run.get("slide.position");
        run.follow("slide.surface_speed", [0.0, 1.0, 0.0], (steps, 0.5), |run, _| {
            assert_eq!(run.get("slide.position").to_bits(), place.to_bits());
            assert!(run.is("friction.sticking"));
        });
        // Through 0 at any time, with f + m a below the limit and above kinetic friction.
        for part in [0.1, 0.137, 0.41, 0.775] {
            let (belt, loss) = (0.65 * MU_S * G, 0.3 * MU_S * normal);
            let mut run = with(loss, -part * 0.5 * belt);
            run.follow("slide.surface_speed", [-part * 0.5 * belt, belt, 0.0], (steps, 0.5), |_, _| {});
            assert!(run.is("friction.sticking"));
            run.near("slide.speed", belt * 0.5 * (1.0 - part), 1e-12);
        }
        // Through 0 with a deceleration at which f + m a exceeds the limit, and f - m a does not.
        let (belt, loss) = (-0.8 * MU_S * G, 0.3 * MU_S * normal);
        let mut run = with(loss, 0.25 * belt.abs());
        run.follow("slide.surface_speed", [-0.25 * belt, belt, 0.0], (steps, 0.5), |run, t| {
            if (t - 0.25).abs() > 1e-9 {
                assert_eq!(run.is("friction.sticking"), t < 0.25, "{t}");
            }
        });
        run.near("slide.speed", -0.25 * (MU_D * G - loss / MASS), 1e-11);
        run.near("energy.drift", 0.0, 1e-11);
    }
}

/// A belt at rest is an ordinary guide with static friction, with and without other friction.
#[test]
fn a_belt_at_rest_is_a_guide() {
    for loss in [0.0, 1.0] {
        let mut definition = sprung(0.0).with(json!({ "start": { "position": 0.5, "speed": 0.2 } }));
        definition["joints"]["slide"]["frictionloss"] = json!(loss);
        if loss == 0.0 {
            definition["joints"]["slide"].as_object_mut().unwrap().remove("frictionloss");
        }
        let mut belt = Run::new(&definition).started();
        definition["joints"]["slide"].as_object_mut().unwrap().remove("surface_speed");
        let mut guide = Run::new(&definition).started();
        for _ in 0..80 {
            [&mut belt, &mut guide].into_iter().for_each(|run| run.step(0.05));
            for name in ["slide.position", "slide.speed", "slide.friction_force"] {
                let expected = guide.get(name);
                belt.near(name, expected, 1e-9);
            }
            assert_eq!(belt.is("friction.sticking"), guide.is("friction.sticking"));
        }
        assert!(guide.is("friction.sticking"));
    }
}

/// A belt presses a parcel against a rigid stop, and takes it off as it turns back within a step.
#[test]
fn a_belt_that_turns_back_takes_its_parcel_off_a_stop() {
    let stop = json!({ "stops": { "end": { "joint": "slide", "limit": "upper", "position": 0.1 } } });
    let mut run = Run::new(parcel(0.5).with(stop)).started();
    run.step(3.0);
    run.near("slide.position", 0.1, 1e-12);
    run.near("end.force", -MU_D * MASS * G, 1e-10);
    assert!(!run.is("friction.sticking"));
    run.set_derivative("slide.surface_speed", 1, -1.0);
    run.step(1.0);
    assert!(run.is("friction.sticking"));
    run.near("slide.speed", -0.5, 1e-14);
    run.near("slide.position", 0.1 - 0.125, 1e-12);
    run.near("energy.drift", 0.0, 1e-11);
}

/// The law `viscous` tends to this law as its static speed tends to 0: so do the motions.
#[test]
fn viscous_friction_tends_to_this_law() {
    let mut exact = Run::new(machine(-0.3, json!({}))).started();
    exact.step(0.6);
    let error = |static_speed: f64| {
        let law = friction([0.5, 0.3], [static_speed, 2.0 * static_speed]).with(json!({ "law": "viscous" }));
        let mut run = Run::new(machine(-0.3, json!({ "friction": law }))).started();
        run.step(0.6);
        (run.get("crank.angle") - exact.get("crank.angle")).abs()
    };
    let errors = [1e-2, 1e-3, 1e-4].map(error);
    assert!(errors[0] < 3e-2 && errors[1] < 4e-3 && errors[2] < 6e-4, "{errors:?}");
}

/// A belt carries its parcel up an incline whose slope is below mu_S; beyond, the parcel slides down it.
#[test]
fn a_belt_carries_its_parcel_up_an_incline() {
    for (part, sticks) in [(0.999, true), (1.001, false)] {
        let (belt, slope) = (0.5, f64::atan(part * MU_S));
        let incline = json!({ "joints": { "slide": { "axis_angle": slope } }, "start": { "speed": belt } });
        let mut run = Run::new(parcel(belt).with(incline)).started();
        run.step(0.3);
        assert_eq!(run.is("friction.sticking"), sticks);
        let rate = if sticks { 0.0 } else { G * (MU_D * slope.cos() - slope.sin()) };
        run.near("slide.position", 0.3 * belt + 0.045 * rate, 1e-12);
        run.near("slide.friction_force", MASS * (rate + G * slope.sin()), 1e-11);
        run.near("slide.surface_power", belt * MASS * (rate + G * slope.sin()), 1e-11);
        run.near("energy.drift", 0.0, 1e-11);
    }
}

/// A sleeve that turns about the pin of a wheel, r = 0.03 m, takes the wheel along: with mu_d F r while it slips, then
/// at the speed V / r, up to the couple mu_S F r of a brake. An accelerating sleeve needs I V_dot / r.
#[test]
fn a_sleeve_takes_its_wheel_along() {
    let (inertia, radius, load) = (0.02, 0.03, 40.0);
    let sleeve = |speed: f64| {
        Run::new(wheel(inertia).with(json!({
            "joints": { "hub": { "pin_radius": radius, "surface_speed": speed } },
            "forces": { "load": { "at": "wheel.origin", "force": [0, -load] } },
            "actuators": { "brake": { "joint": "hub", "torque": 0 } },
            "friction": friction([MU_S, MU_D], [0.0; 2]).with(json!({ "law": "stick" })),
            "solver": { "tolerance": 1e-12 },
        })))
        .started()
    };
    let mut run = sleeve(0.06);
    let (rate, time) = (MU_D * load * radius / inertia, 2.0 * inertia / (MU_D * load * radius));
    run.near("wheel.acceleration", rate, 1e-12);
    run.step(0.5);
    run.near("wheel.speed", 2.0, 1e-14);
    run.near("wheel.angle", 2.0 * (0.5 - 0.5 * time), 1e-12);
    let limit = MU_S * load * radius;
    for (torque, sticks) in [(-0.999 * limit, true), (-1.001 * limit, false)] {
        run.set("brake.torque", torque);
        run.step(0.01);
        assert_eq!(run.is("friction.sticking"), sticks);
        run.near("hub.friction_torque", if sticks { -torque } else { MU_D * load * radius }, 1e-12);
    }
    for part in [0.999, 1.001] {
        let mut run = sleeve(0.0);
        run.set_derivative("hub.surface_speed", 1, part * limit * radius / inertia);
        run.step(0.1);
        run.near("wheel.speed", 0.1 * if part < 1.0 { part * limit / inertia } else { rate }, 1e-11);
        run.near("energy.drift", 0.0, 1e-11);
    }
}

/// The force of a drive for an acceleration has the friction of the slip that this acceleration makes.
#[test]
fn a_drive_overcomes_the_static_friction_of_a_belt() {
    let drive = json!({
        "actuators": { "pusher": { "joint": "slide", "force": 0 } }, "start": { "speed": 0.5 },
    });
    let mut run = Run::new(parcel(0.5).with(drive)).started();
    let limit = MU_S * MASS * G;
    for (acceleration, friction) in [(0.0, 0.0), (1.0, limit), (-1.0, -limit)] {
        run.set("pusher.demanded_acceleration", acceleration);
        run.near("pusher.required_force", MASS * acceleration + friction, 1e-12);
    }
}

/// A slider-crank whose slider lies on a belt, with Coulomb friction on the belt and in its pins.
pub fn machine(speed: f64, keys: Value) -> Value {
    slider_crank([rod(0.1, 0.2), rod(0.3, 0.3), json!({ "mass": 3 })], 0.7)
        .with(json!({
            "joints": {
                "guide": { "surface_speed": speed }, "bearing": { "pin_radius": 0.01 }, "wrist": { "pin_radius": 0.01 }
            },
            "gravity": weight(), "actuators": { "motor": { "joint": "bearing", "torque": 0.2 } },
            "friction": friction([0.5, 0.3], [0.0; 2]).with(json!({ "law": "stick" })),
            "start": { "speed": 4 }, "solver": { "tolerance": 1e-11 },
        }))
        .with(keys)
}

/// A slider with a crank moves with its belt, slips and sticks again: momentum of the slider, law of friction, energy,
/// torque of inverse dynamics and derivatives in time.
#[test]
fn a_slider_with_a_crank_sticks_to_its_belt() {
    let mut run = Run::new(machine(-0.3, json!({}))).started();
    let (mut stuck, mut slipped, mut turns) = (0, 0, 0);
    let mut before = false;
    for k in 0..400 {
        let t = 0.005 * f64::from(k);
        run.set("guide.surface_speed", -0.3 * (4.0 * t).cos());
        run.set_derivative("guide.surface_speed", 1, 1.2 * (4.0 * t).sin());
        run.set_derivative("guide.surface_speed", 2, 4.8 * (4.0 * t).cos());
        run.step(0.005);
        let (along, normal) = (run.get("guide.friction_force"), run.force("guide").y);
        let (force, acceleration) = (run.force("guide") + run.force("wrist"), run.get("guide.acceleration"));
        assert_near(force.y, 3.0 * G, 1e-8, "weight");
        assert_near(force.x + along, 3.0 * acceleration, 1e-7, "force along the guide");
        let slip = run.get("guide.slip_speed");
        if run.is("friction.sticking") && run.get("crank.speed") != 0.0 {
            stuck += 1;
            assert!(along.abs() <= 0.5 * normal.abs() * (1.0 + 1e-9), "{along} {normal}");
            assert!(slip.abs() < 1e-14, "{slip}");
            let rate = 1.2 * (4.0 * t).sin() + 0.005 * 4.8 * (4.0 * t).cos();
            run.near("guide.acceleration", rate, 1e-10);
            assert_near(run.derivative("guide.slip_speed"), 0.0, 1e-9, "rate of the slip speed");
            let mut ahead = run.clone();
            ahead.set_derivative("guide.surface_speed", 1, rate);
            ahead.set_derivative("guide.surface_speed", 2, 4.8 * (4.0 * t).cos());
            let change = ahead.derivative("guide.friction_force");
            ahead.step(1e-6);
            if ahead.is("friction.sticking") {
                let slope = (ahead.get("guide.friction_force") - along) / 1e-6;
                assert_near(change, slope, 1e-3 * (1.0 + change.abs()), "rate of the friction");
            }
        } else if slip.abs() > 1e-6 {
            slipped += 1;
            assert_near(along, -0.3 * normal.abs() * slip.signum(), 1e-8, "kinetic friction");
        }
        turns += u32::from(before != run.is("friction.sticking"));
        before = run.is("friction.sticking");
        run.near("energy.drift", 0.0, 1e-8);
    }
    assert!(stuck > 20 && slipped > 20 && turns > 2, "{stuck} {slipped} {turns}");
}

#[test]
fn what_cannot_be_computed_while_a_surface_holds_its_body_is_rejected() {
    assert_rejected("surfaces that hold their body", parcel(0.5));
}
