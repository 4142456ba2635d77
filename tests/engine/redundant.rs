//! Redundant joints: accepted if they fit in all positions, with the reactions of least norm. Otherwise rejected with
//! their names.

use crate::support::definition::{With, arm, block, friction, pin, rod, slide, weight};
use crate::support::{Run, assert_says, refusal};
use linkage_fmu::mechanism::inspection::inspect;
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// A parallelogram with a third bar in the middle, of the length `third`. The coupler is a plate of 2 m.
fn three_bars(third: f64) -> Value {
    json!({ "name": "ThreeBars", "gravity": weight(),
        "bodies": {
            "ground": { "length": 2, "points": { "middle": [0.8, 0] } },
            "left": rod(1.0, 1.0), "right": rod(1.0, 2.0), "third": rod(third, 0.5),
            "plate": { "length": 2, "mass": 5, "center": [0.7, 0.1], "inertia": 1.5, "points": { "middle": [0.8, 0] } },
        },
        "joints": {
            "a1": pin("ground.origin", "left.origin"), "b1": pin("ground.end", "right.origin"),
            "c1": pin("ground.middle", "third.origin"), "a2": pin("left.end", "plate.origin"),
            "b2": pin("right.end", "plate.end"), "c2": pin("third.end", "plate.middle"),
        },
        "forces": { "tip": { "at": "plate.end", "force": [30, -20] } },
        "start": { "body": "left", "angle": 1.1, "speed": 2 },
        "guess": { "left": 1.1, "right": 1.1, "third": 1.1, "plate": 0 },
        "solver": { "tolerance": 1e-12 } })
}

#[test]
fn reactions_of_a_third_bar_are_those_of_least_norm() {
    let mut run = Run::new(three_bars(1.0)).started();
    for _ in 0..40 {
        run.step(0.01);
        let angle = run.get("left.angle");
        assert!((run.get("third.angle") - angle).abs() < 1e-12 && run.get("plate.angle").abs() < 1e-12);
        let (omega, alpha) = (run.get("left.speed"), run.get("left.acceleration"));
        let (s, c) = angle.sin_cos();
        // Newton-Euler equations of left, right, third, plate: 12 equations of rank 11 for 12 components. The
        // components a1, b1, c1, a2, b2, c2 are the forces on the second body of each joint.
        let mut matrix = DMatrix::<f64>::zeros(12, 12);
        let mut right = DVector::<f64>::zeros(12);
        for (bar, mass) in [(0, 1.0), (1, 2.0), (2, 0.5)] {
            let (row, lower, upper) = (3 * bar, 2 * bar, 6 + 2 * bar);
            for k in 0..2 {
                matrix[(row + k, lower + k)] = 1.0;
                matrix[(row + k, upper + k)] = -1.0;
            }
            // Moments about the centre: the ends are at -/+ (c, s) / 2.
            for end in [lower, upper] {
                matrix[(row + 2, end)] = 0.5 * s;
                matrix[(row + 2, end + 1)] = -0.5 * c;
            }
            right[row] = mass * 0.5 * (-alpha * s - omega * omega * c);
            right[row + 1] = mass * (0.5 * (alpha * c - omega * omega * s) + 9.81);
            right[row + 2] = mass * alpha / 12.0;
        }
        // The plate translates with the ends of the bars. Its centre of mass is at (0.7, 0.1).
        for (joint, x) in [(6, 0.0), (8, 2.0), (10, 0.8)] {
            matrix[(9, joint)] = 1.0;
            matrix[(10, joint + 1)] = 1.0;
            matrix[(11, joint)] = 0.1;
            matrix[(11, joint + 1)] = x - 0.7;
        }
        right[9] = 5.0 * (-alpha * s - omega * omega * c) - 30.0;
        right[10] = 5.0 * (alpha * c - omega * omega * s + 9.81) + 20.0;
        right[11] = -((2.0 - 0.7) * -20.0 + 0.1 * 30.0);
        let least = matrix.clone().svd(true, true).solve(&right, 1e-9).unwrap();
        assert!((&matrix * &least - &right).norm() < 1e-9, "the engine's accelerations must allow a balance");
        for (index, joint) in ["a1", "b1", "c1", "a2", "b2", "c2"].iter().enumerate() {
            for (k, axis) in ["x", "y"].iter().enumerate() {
                let value = run.get(&format!("{joint}.force_{axis}"));
                let error = (value - least[2 * index + k]).abs();
                assert!(error < 1e-9 * least.norm(), "{joint}.{axis}: {value} against {}", least[2 * index + k]);
            }
        }
        assert!(run.get("energy.drift").abs() < 1e-9);
    }
}

/// A guess of three angles that does not close contradicts the redundant loop. The closed position is found near the
/// guess, not at the singular position with the bars in line.
#[test]
fn redundant_loops_close_near_the_guess() {
    for case in 0..60 {
        let off = |k: u32| 5e-3 * f64::from(case * 7 + k).sin();
        let mut definition = three_bars(1.0);
        let guess = [("left", 1.1), ("right", 1.1), ("third", 1.1), ("plate", 0.0)];
        for (k, (body, angle)) in guess.iter().enumerate() {
            definition["guess"][*body] = json!(angle + off(k as u32));
        }
        let mut run = Run::new(&definition).started();
        let linkage = run.reduced().unwrap().linkage().clone();
        let closed = &run.reduced().unwrap().curve().guess;
        for (name, q) in linkage.coordinates.iter().zip(closed) {
            let guessed = definition["guess"][name].as_f64().unwrap();
            assert!((q - guessed).abs() < 0.02, "case {case}: {name} {guessed} closed at {q}");
        }
    }
}

#[test]
fn a_third_bar_that_does_not_fit_is_rejected() {
    // 1 mm too long: near the guess the bar fits only at a position in which the linkage is rigid.
    let error = refusal(three_bars(1.001));
    let named =
        error.contains("0 degrees of freedom") || error.contains("do not close") || error.contains("redundant joint");
    assert!(named, "{error}");
}

#[test]
fn wedges_move_although_their_sliders_hold_the_angle_twice() {
    // Two blocks on the ground that slide on each other at 0.6 rad: y = tan(0.6) x.
    let wedges = json!({ "name": "Wedges", "gravity": weight(),
        "bodies": { "ground": {}, "a": { "mass": 1 }, "b": { "mass": 2 } },
        "joints": { "x": slide("ground.origin", "a.origin", 0.0), "y": slide("ground.origin", "b.origin", FRAC_PI_2),
            "z": slide("a.origin", "b.origin", 0.6) },
        "start": { "joint": "x", "position": 0 }, "guess": { "x": 0, "y": 0 }, "solver": { "tolerance": 1e-12 } });
    let mut run = Run::new(wedges).started();
    run.step(0.3);
    // b slides down along y while a moves along x. The second point is on the axis through the first: y = -tan(0.6) x.
    let (x, y) = (run.get("x.position"), run.get("y.position"));
    let slope = -0.6f64.tan();
    assert!((y - slope * x).abs() < 1e-13, "{x} {y}");
    let acceleration = -2.0 * 9.81 * slope / (1.0 + 2.0 * slope * slope);
    assert!((x - 0.5 * acceleration * 0.09).abs() < 1e-11, "{x}");
    // Each guide carries the force that its block needs. The force between the blocks is normal to their contact.
    let (fx, fy) = (run.get("z.force_x"), run.get("z.force_y"));
    assert!((fx * 0.6f64.cos() + fy * 0.6f64.sin()).abs() < 1e-9);
    assert!((fx + acceleration).abs() < 1e-9, "on b; a needs 1 kg times its acceleration: {fx}");
}

/// Static friction with this coefficient.
fn sticks(coefficient: f64) -> Value {
    friction([coefficient; 2], [0.0; 2]).with(json!({ "law": "stick" }))
}

/// Findings of `check` about redundant joints.
fn redundant(definition: &Value) -> Vec<String> {
    let facts = inspect(&definition.to_string()).facts.into_iter().filter(|fact| fact.topic == "Redundant joints");
    facts.map(|fact| format!("{} {}", fact.of, fact.text)).collect()
}

/// With one coordinate and redundant joints there is no independent loop equation.
#[test]
fn a_carriage_on_two_rails_and_a_door_on_two_hinges() {
    let mut carriage = block(2.0).with(json!({ "gravity": weight(),
    "bodies": { "ground": { "points": { "upper": [0, 0.2] } }, "block": { "points": { "upper": [0, 0.2] } } },
    "joints": { "upper": slide("ground.upper", "block.upper", 0.0) },
    "forces": { "push": { "at": "block.upper", "force": [6, 0] } } }));
    let mut run = Run::new(&carriage).started();
    run.step(0.5);
    assert!((run.get("slide.position") - 0.5 * 3.0 * 0.25).abs() < 1e-9);
    // Each rail carries half of the weight. Both rails share the moment of the push and of the weight at 0.375 m
    // equally.
    for rail in ["slide", "upper"] {
        assert!((run.get(&format!("{rail}.force_y")) - 9.81).abs() < 1e-9, "{rail}");
        assert!(
            (run.get(&format!("{rail}.torque")) - 0.6).abs() < 1e-9,
            "{rail}: {}",
            run.get(&format!("{rail}.torque"))
        );
    }
    let [fact] = &redundant(&carriage)[..] else { panic!("{:?}", redundant(&carriage)) };
    assert_says(fact, &["upper", "share the reactions"]);
    // Friction on each rail, whose normal force is half of the weight.
    carriage["friction"] = sticks(0.1);
    let mut run = Run::new(&carriage).started();
    run.step(0.5);
    assert!((run.get("slide.position") - 0.125 * (3.0 - 0.981)).abs() < 1e-9, "{}", run.get("slide.position"));
    let twice = json!({ "joints": { "b": pin("ground.origin", "arm.origin") }, "start": { "speed": 3 } });
    let door = arm(1.0, 2.0, 0.0).with(twice);
    let mut run = Run::new(&door).started();
    assert!((run.get("pivot.force_x") + 4.5).abs() < 1e-12 && (run.get("b.force_x") + 4.5).abs() < 1e-12);
    assert_eq!(redundant(&door).len(), 1);
}

/// A carriage of 2 kg on n rails with friction. A torque presses some of the rails from above.
fn rails(n: usize) -> Value {
    let points: serde_json::Map<String, Value> = (0..n).map(|i| (format!("p{i}"), json!(place(i)))).collect();
    let joint = |i: usize| slide(&format!("ground.p{i}"), &format!("carriage.p{i}"), 0.0);
    let joints: serde_json::Map<String, Value> = (0..n).map(|i| (format!("r{i}"), joint(i))).collect();
    json!({ "name": "Rails", "gravity": weight(),
        "bodies": { "ground": { "points": points }, "carriage": { "mass": 2, "points": points } },
        "joints": joints, "forces": { "push": { "at": "carriage.origin", "force": [8, 0] } },
        "torques": { "turn": { "on": "carriage", "torque": 80 } },
        "friction": sticks(0.1),
        "start": { "joint": "r0", "position": 0 }, "guess": { "r0": 0 } })
}

/// Place of a rail on the carriage [m].
fn place(i: usize) -> [f64; 2] {
    [(0.37 * i as f64).sin(), 0.2 * (1.3 * i as f64).cos()]
}

/// Friction on many rails follows the normal forces of least norm, which depend on the moment of the friction.
#[test]
fn friction_of_many_rails_is_that_of_their_least_reactions() {
    const N: usize = 7;
    let mut run = Run::new(rails(N)).started();
    let size = run.reduced().unwrap().linkage().size;
    // Equations for forces along y and moments / size: sum, and moment about the origin of the carriage.
    let shares = DMatrix::from_fn(2, 2 * N, |row, k| match (row, k < N) {
        (0, on_y) => f64::from(u8::from(on_y)),
        (_, true) => place(k)[0],
        (_, false) => size,
    });
    let inverse = shares.pseudo_inverse(1e-12).unwrap();
    let mut least = DVector::<f64>::zeros(2 * N);
    for _ in 0..100 {
        let turned: f64 = (0..N).map(|i| place(i)[1] * 0.1 * least[i].abs()).sum();
        least = &inverse * DVector::from_vec(vec![2.0 * 9.81, -80.0 - turned]);
    }
    assert!((0..N).any(|i| least[i] < 0.0) && (0..N).any(|i| least[i] > 0.0), "{least}");
    let acceleration = (8.0 - (0..N).map(|i| 0.1 * least[i].abs()).sum::<f64>()) / 2.0;
    run.step(0.5);
    assert!((run.get("r0.position") - 0.125 * acceleration).abs() < 1e-12, "{} {acceleration}", run.get("r0.position"));
    for i in 0..N {
        let found = [run.get(&format!("r{i}.force_y")), run.get(&format!("r{i}.torque")) / size];
        assert!((found[0] - least[i]).abs() + (found[1] - least[N + i]).abs() < 1e-10, "{i}: {found:?} {least}");
    }
}

/// The work per rail does not grow with the number of rails: each evaluation reads one component per rail. With 200
/// rails, the set-up and a step need less than a tenth of the time of one system for all self-stresses and frictions.
#[test]
fn many_rails_are_no_cubic_work() {
    let clock = std::time::Instant::now();
    let [few, more, most] = [50, 100, 200].map(|n| {
        let mut run = Run::new(rails(n)).started();
        run.step(1.0);
        run.reduced().unwrap().state_loads(false).unwrap().unwrap().bundled()
    });
    assert_eq!((most - more, more - few), (2 * (more - few), 50 * 7));
    assert!(clock.elapsed().as_secs_f64() < 10.0, "{:?}", clock.elapsed());
}

/// Hinges at one point share their friction: a lever on n hinges oscillates like a lever on one hinge with the same
/// coefficients.
#[test]
fn friction_of_many_hinges_is_that_of_one() {
    let angle = |n: usize| {
        let hinge = |i: usize| {
            let ends = ["ground.origin", "arm.origin"];
            (
                format!("h{i}"),
                json!({ "type": "revolute", "first": ends[i % 2], "second": ends[1 - i % 2], "pin_radius": 0.02 }),
            )
        };
        let joints: serde_json::Map<String, Value> = (0..n).map(hinge).collect();
        let mut lever = arm(1.0, 2.0, 0.3).with(json!({
            "gravity": weight(), "friction": sticks(0.2), "solver": { "tolerance": 1e-10 },
        }));
        lever["joints"] = joints.into();
        let mut run = Run::new(lever).started();
        run.step(0.7);
        run.get("arm.angle")
    };
    let one = angle(1);
    for n in [2, 5, 60] {
        assert!((angle(n) - one).abs() < 1e-9, "{n}: {} {one}", angle(n));
    }
}
