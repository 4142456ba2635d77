//! Efficiency, [CK16] eqs. (5), (26): P_u = eta P_in if power flows into the mechanism. If power flows back, the drive
//! gets eta times the power of the mechanism. For an input work W the mechanism gains eta W if driven (W > 0), and W /
//! eta if driven back (W < 0). The losses are (1 - eta) W and (1 / eta - 1) |W|.
use super::jib;
use super::slider::{self, Slider};
use super::worst::{ACCURACY, Worst, wave};
use crate::support::{JIB, Run, SLIDER_CRANK};

const ETA: f64 = 0.7;

fn with_efficiency(json: &str, eta: f64) -> Run {
    Run::replaced(json, &[("\"efficiency\": 1", &format!("\"efficiency\": {eta}"))])
}

/// [CK16] after eqs. (17), (38): divide by eta, or multiply by eta if power flows back.
#[test]
fn the_formulas_change_where_power_flows_back() {
    let (mut ideal, mut real) = (Run::new(JIB), with_efficiency(JIB, ETA));
    let mut worst = Worst::default();
    let (mut driven, mut back) = (0, 0);
    for k in 0..400 {
        let (x, speed, force) = (2.2 + 0.0025 * f64::from(k), 0.8 * wave(k, 0.7), 6e4 * wave(k, 1.1));
        let demand = 30.0 * wave(k, 2.3);
        for run in [&mut ideal, &mut real] {
            jib::place(run, x, speed);
            run.set_all(&[("cylinder.force", force), ("cylinder.demanded_acceleration", demand)]);
        }
        let divided = |power: f64, value: f64| if power < 0.0 { value * ETA } else { value / ETA };
        let required = ideal.get("cylinder.required_force");
        let count = if required * speed < 0.0 { &mut back } else { &mut driven };
        *count += 1;
        let expected = divided(required * speed, required);
        worst.compare("(30) F_S", real.get("cylinder.required_force"), expected, required);
        for name in ["reduced_mass", "reduced_mass_derivative", "static_load", "additional_force"] {
            let name = format!("cylinder.{name}");
            let value = ideal.get(&name);
            worst.compare("(32), (33), (36)", real.get(&name), divided(force * speed, value), value);
        }
        let acceleration = real.get("cylinder.acceleration");
        ideal.set("cylinder.force", if force * speed > 0.0 { force * ETA } else { force / ETA });
        let size = force.abs() / ETA / ideal.get("cylinder.reduced_mass");
        worst.compare("(38) a_S", acceleration, ideal.get("cylinder.acceleration"), size);
    }
    assert!(driven > 100 && back > 100);
    worst.assert_within(ACCURACY);
}

/// Input work, and energy gained by jib and load.
fn lift(force: f64, speed: f64, steps: usize) -> (f64, f64) {
    let mut run = with_efficiency(JIB, ETA);
    run.set("solver.tolerance", 1e-13);
    run.set("cylinder.force", force);
    jib::place(&mut run, 2.6, speed);
    let energy = |run: &mut Run| run.get("energy.kinetic") + run.get("energy.potential");
    let (x, before) = (run.get("cylinder.length"), energy(&mut run));
    for _ in 0..steps {
        run.step(0.01);
        let v = run.get("cylinder.speed");
        assert_eq!(v > 0.0, speed > 0.0, "moves one way");
        let work = force * (run.get("cylinder.length") - x);
        assert!(run.get("energy.drift").abs() < 1e-10 * work.abs().max(1e4), "drift");
    }
    (force * (run.get("cylinder.length") - x), energy(&mut run) - before)
}

#[test]
fn the_mechanism_gains_the_work_less_losses() {
    // Driven up, and lowered against the push.
    let (work, gain) = lift(80_000.0, 0.01, 40);
    assert!(work > 1e3 && (gain - ETA * work).abs() < 1e-11 * work, "{work} {gain}");
    let (work, gain) = lift(10_000.0, -0.01, 20);
    assert!(work < -3e2 && (gain - work / ETA).abs() < 1e-11 * work.abs() / ETA, "{work} {gain}");
}

/// The same for a rotary drive over several turns: K = K0 + eta T (theta - theta0) - work of the piston's weight.
#[test]
fn a_crank_gains_the_work_of_its_torque_less_losses_over_several_turns() {
    for (torque, part) in [(12.0, ETA), (-4.0, 1.0 / ETA)] {
        let mut run = with_efficiency(SLIDER_CRANK, ETA);
        run.set("solver.tolerance", 1e-13);
        run.set_all(&[("drive.torque", torque), ("piston.force_y", 0.0)]);
        run.place(("crank.start_angle", 0.3), ("crank.start_speed", 200.0));
        let (kinetic, y) = (run.get("energy.kinetic"), run.get("piston.y"));
        for _ in 0..100 {
            run.step(1e-3);
            let angle = run.get("crank.angle") - 0.3;
            let expected = kinetic + part * torque * angle - 0.8 * 9.81 * (run.get("piston.y") - y);
            let error = (run.get("energy.kinetic") - expected).abs();
            assert!(error < 1e-10 * kinetic, "{error:e}");
            assert!(run.get("energy.drift").abs() < 1e-10 * kinetic);
        }
        assert!(run.get("crank.angle") - 0.3 > 2.0 * std::f64::consts::TAU);
    }
}

/// Driving up needs more than H / eta, lowering less than eta H. In between the drive holds its load.
#[test]
fn a_drive_with_losses_holds_its_load() {
    // At rest under this part of the holding force.
    let pushed = |force_part: f64| {
        let mut run = with_efficiency(JIB, ETA);
        jib::place(&mut run, 2.6, 0.0);
        let holding = run.get("cylinder.holding_force");
        run.set("cylinder.force", force_part * holding);
        (run, holding)
    };
    for force_part in [ETA * (1.0 + 1e-9), 0.9, 1.0, 1.2, (1.0 - 1e-9) / ETA] {
        let (mut run, holding) = pushed(force_part);
        let (angle, drift) = (run.get("jib.angle"), run.get("energy.drift"));
        for _ in 0..100 {
            run.step(0.1);
            assert_eq!(run.get("jib.angle").to_bits(), angle.to_bits());
            assert_eq!((run.get("jib.speed"), run.get("jib.acceleration")), (0.0, 0.0));
        }
        assert!((run.get("energy.drift") - drift).abs() < 1e-9);
        // The joint carries the difference of weight and holding force, for every input at which the drive holds.
        let (end, theta) = ([2.2 * jib::angle(2.6).cos(), 2.2 * jib::angle(2.6).sin() + 1.3], jib::angle(2.6));
        let iv = jib::ratio(2.6);
        assert!((holding - 9810.0 * theta.cos() / iv).abs() < ACCURACY * holding);
        let expected = [-holding * end[0] / 2.6, 9810.0 - holding * end[1] / 2.6];
        let (x, y) = (run.get("A.force_x"), run.get("A.force_y"));
        let error = (x - expected[0]).hypot(y - expected[1]) / holding;
        assert!(error < 10.0 * ACCURACY, "{force_part}: ({x}, {y}), in balance {expected:?}");
    }
    for (force_part, sign) in [(ETA * (1.0 - 1e-9), -1.0), ((1.0 + 1e-9) / ETA, 1.0)] {
        let (mut run, _) = pushed(force_part);
        run.step(0.1);
        assert!(run.get("jib.speed") * sign > 0.0, "{force_part}");
    }
}

/// A block under a drive force that changes from step to step and a constant opposing force: reversals, rest, start
/// from rest. Each step has a closed form.
#[test]
fn reversals_under_a_changing_force_follow_the_closed_form() {
    for tolerance in [1e-4, 1e-9, 1e-12] {
        let mut slider = Slider { eta: Some(0.8), ..Slider::default() };
        let mut run = slider.run(tolerance);
        run.set("load.force_x", -10.0);
        (slider.x, slider.v) = (0.0, 0.3);
        run.place(("slide.start_position", slider.x), ("slide.start_speed", slider.v));
        let (mut reversals, mut still) = (0, 0);
        for k in 0..400 {
            let push = 10.0 + 3.5 * (0.05 * f64::from(k)).sin() + 4.0 * (0.4 * f64::from(k)).sin();
            run.set("drive.force", push);
            reversals += slider.advance(push, -10.0, 0.0137);
            run.step(0.0137);
            still += u32::from(slider.v == 0.0);
            let error = (run.get("slide.position") - slider.x).abs().max((run.get("slide.speed") - slider.v).abs());
            assert!(error < 1e-12, "{tolerance:e}, step {k}: {error:e}");
            assert_eq!(run.get("slide.speed") == 0.0, slider.v == 0.0, "step {k}");
            assert!(run.get("energy.drift").abs() < 1e-11);
        }
        assert!(reversals > 10 && still > 20);
        // No chattering: about two steps per call, and three more per reversal.
        assert!(run.statistics().accepted < 400 * 2 + 3 * u64::from(reversals));
    }
}

/// A block on a spring under a constant drive force with losses oscillates about eta F / k forward and about F / (eta
/// k) backward. The amplitude decreases by twice the distance of these centres per swing, and the block stops between
/// them.
#[test]
fn a_swing_under_a_lossy_push_dies_out_and_stops() {
    const STIFFNESS: f64 = 50.0;
    let (push, eta) = (20.0, 0.9);
    for (tolerance, start) in [(1e-12, 1.5), (1e-9, 1.5), (1e-4, 1.5), (1e-9, 0.6), (1e-4, 0.6)] {
        let mut run = Slider { eta: Some(eta), stiffness: STIFFNESS, ..Slider::default() }.run(tolerance);
        run.set("drive.force", push);
        run.place(("slide.start_position", start), ("slide.start_speed", 0.0));
        let (forward, back) = (eta * push / STIFFNESS, push / (eta * STIFFNESS));
        let omega = (STIFFNESS / slider::MASS).sqrt();
        let half = std::f64::consts::PI / omega;
        // Turning points alternate: first the backward one, then the forward one.
        let mut turning = vec![start];
        loop {
            let x = turning[turning.len() - 1];
            if (forward..=back).contains(&x) {
                break;
            }
            turning.push(2.0 * x.clamp(forward, back) - x);
        }
        let h = 0.0123;
        for k in 1..400 {
            run.step(h);
            let t = f64::from(k) * h;
            let swing = (t / half).floor() as usize;
            let (x, v) = if swing + 1 < turning.len() {
                let center = 0.5 * (turning[swing] + turning[swing + 1]);
                let (amplitude, phase) = (turning[swing] - center, omega * (t - swing as f64 * half));
                (center + amplitude * phase.cos(), -amplitude * omega * phase.sin())
            } else {
                (turning[turning.len() - 1], 0.0)
            };
            let error = (run.get("slide.position") - x).abs().max((run.get("slide.speed") - v).abs() / omega);
            // The tolerance, relative to about 1 m, bounds the error of each step. The number of steps is at most the
            // number of calls.
            let allowed = 100.0 * tolerance;
            assert!(error < allowed.max(1e-13), "{tolerance:e}, {start}, t = {t}: {error:e}");
            if swing > turning.len() {
                assert_eq!(run.get("slide.speed"), 0.0, "{tolerance:e}, {start}");
            }
        }
    }
}

/// Swings larger than the tolerance end between the two centres, also in one long step.
#[test]
fn one_long_step_locates_each_reversal() {
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-9, 1e-12] {
        for (eta, start) in [(0.9, 0.5), (0.9, 1.5), (0.999, 0.41), (0.999, 0.401), (0.99999, 0.4001)] {
            let mut run = Slider { eta: Some(eta), stiffness: 50.0, ..Slider::default() }.run(tolerance);
            run.set("drive.force", 20.0);
            run.place(("slide.start_position", start), ("slide.start_speed", 0.0));
            if start - 0.4 < 1.1 * tolerance {
                continue;
            }
            run.step(1000.0);
            let (x, v) = (run.get("slide.position"), run.get("slide.speed"));
            assert_eq!(v, 0.0, "{tolerance:e}, eta {eta} from {start}");
            assert!(0.4 * eta - 1e-9 < x && x < 0.4 / eta + 1e-9, "{tolerance:e}, eta {eta} from {start}: {x}");
        }
    }
}

/// A drive with losses oscillates a crank over its dead centres, with a damper. The energy supplied by the changing
/// input, the piston's force and the weight equals the energy of the crank and the losses.
#[test]
fn the_energy_balance_stays_closed_over_reversals_of_a_crank() {
    let spring = "\"springs\": { \"damper\": { \"joint\": \"cylinder\", \"damping\": 60 } }, \"markers\"";
    let mut run = Run::replaced(SLIDER_CRANK, &[("\"efficiency\": 1", "\"efficiency\": 0.7"), ("\"markers\"", spring)]);
    run.set("solver.tolerance", 1e-12);
    run.place(("crank.start_angle", 0.3), ("crank.start_speed", 20.0));
    let (mut reversals, mut before, mut most) = (0, 1.0, 0.0f64);
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3;
        run.set("drive.torque", 8.0 * (11.0 * t).sin() + 2.0 * (2.0 * t).cos());
        run.set("piston.force_y", -60.0 + 40.0 * (5.0 * t).sin());
        run.step(1e-3);
        let omega = run.get("crank.speed");
        reversals += u32::from(omega * before < 0.0);
        before = if omega == 0.0 { before } else { omega };
        most = most.max(run.get("energy.kinetic"));
        assert!(run.get("energy.drift").abs() < 1e-9 * most, "{t}: {}", run.get("energy.drift"));
    }
    assert!(reversals > 3);
}
