//! Elements with force curves, compared with constant loads of the same size and with the finite elements.
use crate::support::{CURVES, FOUR_BAR, Run, changed, reals};
use linkage_fmu::variables::Causality;
use serde_json::json;

/// Step with which the contact with the bumper is located [s].
const CONTACT: f64 = 2e-3;

/// In any state an element with a curve acts like a constant load of its present size: all common outputs are equal.
#[test]
fn curves_act_like_constant_loads_of_their_size() {
    for (friction, angle, speed, command, h) in [
        (false, 0.9, 14.0, 0.8, 0.0),
        (true, 0.9, 14.0, 0.8, 0.0),
        (true, 2.5, -9.0, 0.4, 0.0),
        (true, 5.8, -33.0, -0.7, 0.0),
        // In contact with the bumper.
        (false, 0.9, -14.0, 0.0, CONTACT),
        (true, 0.9, -14.0, 0.8, CONTACT),
    ] {
        let flags = [("friction.enabled", friction)];
        let start = [("crank.start_angle", angle), ("crank.start_speed", speed), ("motor.command", command)];
        let demands = [("motor.demanded_acceleration", 40.0), ("ram.demanded_acceleration", -3.0)];
        let mut curves = Run::new(CURVES).with(&flags).with(&start).with(&demands).started();
        while h > 0.0 && curves.get("buffer.force") == 0.0 {
            curves.step(h);
        }
        let forces = ["motor.acting_torque", "ram.acting_force", "damper.force", "coil.torque", "rod_damper.torque"];
        let [torque, ram, damper, coil, rod] = forces.map(|name| curves.get(name));
        let push = -curves.get("buffer.force");
        assert_eq!(push > 0.0, h > 0.0, "{push}");
        let start =
            [("crank.start_angle", curves.get("crank.angle")), ("crank.start_speed", curves.get("crank.speed"))];
        let mut plain = Run::new(changed(CURVES, |m| {
            m["actuators"] = json!({ "motor": { "joint": "bearing", "torque": torque, "efficiency": 0.9 },
                                     "ram": { "joint": "guide", "force": ram } });
            m["springs"] = json!({ "damper": { "joint": "guide", "preload": damper },
                                   "coil": { "joint": "bearing", "preload": coil },
                                   "rod_damper": { "joint": "pin", "preload": rod },
                                   "push": { "joint": "guide", "preload": push } });
            m.as_object_mut().unwrap().remove("stops");
        }))
        .with(&flags)
        .with(&start)
        .with(&demands)
        .started();
        let mut compared = 0;
        for reference in reals(&plain, Causality::Output) {
            let name = plain.variables().get(reference).unwrap().name.clone();
            // At rest dampers exert no force, and the force of a drive differs from that in motion.
            if name.contains("holding")
                || name.starts_with("energy")
                || name.starts_with("breakaway")
                || name.contains(".breakaway")
            {
                continue;
            }
            let Ok(other) = curves.0.reference(&name) else { continue };
            let (a, b) = (plain.real(reference).unwrap(), curves.real(other).unwrap());
            assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()) || (a.is_nan() && b.is_nan()), "{name}: {a} {b}");
            compared += 1;
        }
        assert!(compared > 50, "{compared}");
    }
}

/// The finite elements support dampers with a curve, and torsional springs over several turns.
#[test]
fn the_finite_elements_move_with_dampers_and_coils_of_curves() {
    let coil = json!([[-10, -0.09], [-3, -0.01], [4, 0.02], [12, 0.02], [20, 0.11]]);
    let damper = json!([[-60, -0.3], [0, 0], [20, 0.02], [60, 0.2]]);
    let text = |method: &str| {
        changed(FOUR_BAR, |m| {
            m["springs"] = json!({ "coil": { "joint": "S", "points": coil },
                                   "damper": { "joint": "S", "damping_points": damper } });
            m["solver"] = json!({ "method": method, "fem_step": 2e-5, "tolerance": 1e-10 });
            m["start"]["speed"] = json!(40);
            for (body, length) in [("crank", 0.1), ("rocker", 0.25)] {
                m["bodies"][body] = json!({ "length": length, "mass": 0.5, "shape": "uniform_rod" });
            }
            for (_, body) in m["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
                body["axial_stiffness"] = json!(1e9);
            }
        })
    };
    let [mut one, mut other] = ["reduced", "rigid_fem"].map(|method| Run::new(text(method)).started());
    let names = ["coil.angle", "coil.torque", "damper.torque", "energy.potential", "energy.kinetic"];
    let mut largest = [0.0_f64; 5];
    for _ in 0..30 {
        one.step(0.01);
        other.step(0.01);
        for (name, largest) in names.into_iter().zip(&mut largest) {
            let (a, b) = (one.get(name), other.get(name));
            *largest = largest.max(a.abs());
            // The time error of the finite elements is of second order.
            assert!((a - b).abs() < 1e-3 * *largest, "{name}: {a} {b}");
        }
    }
    assert!(one.get("coil.angle").abs() > 6.3, "{}", one.get("coil.angle"));
}
