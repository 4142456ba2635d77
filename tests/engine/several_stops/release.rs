//! Rest at a stop and release from it, within long steps and in any revolution.

use super::scene::{Machine, Quantity, Scene, block, distance, rigid};
use crate::support::{Run, changed};
use serde_json::json;

/// A four-bar linkage between a bumper and a rigid stop. Random scenes found this case.
const FOUR_BAR: &str = include_str!("../../fixtures/four_bar_between_stops.json");

/// Releases for a short time within a long step, such as 5 ms in 0.52 s, are found.
#[test]
fn a_release_of_any_duration_is_located() {
    let stops = [rigid(Quantity::Slide, -1.0, 0.0, 0.0)];
    let scene = Scene { machine: Machine::Block(2.0), ..block(&stops) };
    for (peak, bend, center, span) in
        [(1e4, 1.6e9, 0.5078, 0.52), (1.0, 1e6, 0.01, 0.02), (1e-2, 1e7, 0.3, 1.0), (1e3, 1e8, 7.77, 10.0)]
    {
        let half = f64::sqrt(peak / bend);
        // The speed at the end of the release agrees with that of steps shorter than the release.
        let mut ends = Vec::new();
        for cuts in [vec![center + half, span - center - half], vec![center - half, half, half, span - center - half]] {
            let mut run = scene.run();
            let mut t = 0.0;
            for h in cuts {
                run.set("load.force", peak - bend * (t - center) * (t - center));
                run.set_derivative("load.force", 1, -2.0 * bend * (t - center));
                run.set_derivative("load.force", 2, -2.0 * bend);
                run.step(h);
                t += h;
                if (t - center - half).abs() < 0.1 * half {
                    ends.push((run.get("slide.position"), run.get("slide.speed")));
                }
            }
        }
        let speed = 4.0 / 3.0 * peak * half / 2.0;
        for (x, v) in &ends {
            assert!((v - speed).abs() < 1e-3 * speed && *x > 0.0, "{peak} {bend}: {x} {v} {speed}");
        }
        assert_eq!(ends.len(), 2);
    }
}

/// Within a step that extends over two revolutions of a closed curve, a crank comes to rest at a stop in the other
/// revolution.
#[test]
fn rest_in_another_revolution_is_rest_at_the_stop() {
    let start = 1.0398903345316985;
    for k in 0..40 {
        let length = 0.46868801572172875 + 1e-3 * f64::from(k);
        let machine = Machine::Crank(0.4, 1.3750900431962578);
        let stop = rigid(Quantity::Distance, 1.0, length, 0.0);
        let scene = Scene { machine, start: [start, 0.0], stops: vec![stop], lock: None };
        for parts in [1, 7] {
            let mut run = scene.run();
            // The curve starts at the start position, so the first step ends in the previous revolution.
            run.set("load.torque", -10.515086458192942);
            run.step(0.02);
            run.set("load.torque", 76.0);
            (0..parts).for_each(|_| run.step(0.5 / f64::from(parts)));
            let distance = distance(run.get("crank.angle"));
            assert!((distance - length).abs() < 1e-12 && run.get("crank.speed") == 0.0, "{distance} {length}");
            assert!(run.is("s0.reached"), "at {length} in {parts} steps");
        }
    }
}

/// From rest at a stop under its weight, a block is lifted by a drive with losses whose force changes its sign, or by a
/// wind that changes its direction. The instant of release in closed form, in one long step.
#[test]
fn a_release_by_a_drive_with_losses_or_by_the_wind_is_located() {
    let (g, efficiency, area): (f64, f64, f64) = (9.81, 0.5, 0.3);
    let scene = Scene { machine: Machine::Block(1.0), ..block(&[rigid(Quantity::Slide, -1.0, 0.0, 0.0)]) };
    let definition = changed(scene.definition(), |json| {
        json["gravity"] = json!({ "acceleration": g, "up_angle": 0 });
        json["actuators"]["load"]["efficiency"] = json!(efficiency);
        json["air"] = json!({ "density": 1.2, "flow_angle": 0 });
        json["surfaces"] = json!({ "sail": { "at": "block.origin", "area": area, "drag_coefficient": 1 } });
    });
    // Excess of the input over the value that lifts the block, curvature of the input, time of its maximum, length of
    // the whole step.
    for (surplus, bend, center, span) in [(0.5, 1e3, 0.3, 1.0), (1e-3, 1e4, 4.321, 5.0), (1e-5, 300.0, 0.01, 2.0)] {
        let half = f64::sqrt(surplus / bend);
        let speed = f64::sqrt(g / (0.5 * 1.2 * area));
        for (input, least) in [("load.force", g / efficiency), ("airspeed", speed)] {
            let peak = least + surplus;
            let set = |run: &mut Run, t: f64| {
                run.set(input, peak - bend * (t - center) * (t - center));
                run.set_derivative(input, 1, -2.0 * bend * (t - center));
                run.set_derivative(input, 2, -2.0 * bend);
            };
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(center - half * (1.0 + 1e-6));
            assert!(
                run.get("slide.position").abs() < 1e-15 && run.get("slide.speed") == 0.0,
                "{input} {surplus}: held"
            );
            // One long step to the middle of the release.
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(center);
            // The excess force is a parabola that grows from 0 to its peak over `half`.
            let lift = if input == "airspeed" { 1.2 * area * speed * surplus } else { efficiency * surplus };
            let expected = lift * half * (2.0 / 3.0);
            run.near("slide.speed", expected, (0.2 * surplus + 1e-6) * expected + 1e-15);
            // At the end of the whole step the block is at rest again, after a flight.
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(span);
            assert!(run.get("slide.position").abs() < 1e-15 && run.get("slide.speed") == 0.0, "{input} {surplus}");
            assert!(run.get("energy.drift").abs() < 1e-9 && run.is("s0.reached"));
        }
    }
}

/// A four-bar linkage moves back beyond the origin of its curve and comes to rest at a stop on the other side. Its
/// position is exactly that of the stop, so that the flag is true and an engaged lock holds.
#[test]
fn rest_at_a_stop_is_at_the_stop_in_whatever_revolution_it_is_counted() {
    let mut run = Run::new(FOUR_BAR).started();
    run.set("load.torque", 43.30438005112297);
    run.steps(7, 0.32297009838491525);
    assert!((run.get("crank.angle") + 2.2771213335831813).abs() < 1e-14 && run.is("s1.reached"));
    run.set("latch.engage", true);
    run.set("load.torque", -40.0);
    run.steps(3, 0.5);
    assert!((run.get("crank.angle") + 2.2771213335831813).abs() < 1e-14 && run.is("s1.reached"));
    assert!(run.get("latch.force") != 0.0);
    run.set("latch.engage", false);
    run.step(0.1);
    assert!(!run.is("s1.reached"));
}
