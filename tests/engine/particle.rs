//! A mass of 1 kg on a line, against closed forms: impacts, bumpers, locks, friction, drives, release.

use crate::support::Run;
use crate::support::definition::{G, With, block, friction};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

/// Rounding of a position of at most 2 m [m].
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// The mass at a start (position, speed), with these keys.
fn mass([x, v]: [f64; 2], more: Value) -> Run {
    let line = json!({
        "guess": { "slide": x }, "start": { "position": x, "speed": v }, "solver": { "tolerance": 1e-10 },
        "actuators": { "push": { "joint": "slide" } },
    });
    Run::new(block(1.0).with(line).with(more)).started()
}

fn stop(limit: &str, position: f64) -> Value {
    json!({ "joint": "slide", "position": position, "limit": limit })
}

fn rigid(limit: &str, position: f64, restitution: f64) -> Value {
    stop(limit, position).with(json!({ "restitution": restitution }))
}

/// A bumper before an upper stop: stiffness [N/m], damping [N.s/m] and position [m].
fn bumper([stiffness, damping, position]: [f64; 3]) -> Value {
    stop("upper", position).with(json!({ "rigid": false, "stiffness": stiffness, "damping": damping }))
}

/// The mass falls towards negative positions, onto a floor. sigma is 0 there, so that low flights are resolved.
fn falling(height: f64, floor: f64, restitution: f64) -> Run {
    let gravity = json!({ "acceleration": G, "up_angle": 0 });
    let stops = json!({ "floor": rigid("lower", floor, restitution) });
    mass([height, 0.0], json!({ "gravity": gravity, "stops": stops, "guess": { "slide": floor } }))
}

#[track_caller]
fn is_at(run: &mut Run, x: f64, v: f64, accuracy: f64) {
    run.near("slide.position", x, accuracy);
    run.near("slide.speed", v, accuracy);
}

/// Whether these bumpers push, and no others of them.
fn push(run: &mut Run, bumpers: &[(&str, bool)]) -> bool {
    bumpers.iter().all(|(bumper, pushes)| (run.get(&format!("{bumper}.force")) != 0.0) == *pushes)
}

#[test]
fn a_falling_ball_rests_on_the_floor() {
    let (height, floor) = (2.0, 0.3);
    let impact = (2.0 * height / G).sqrt();
    for count in [1, 10, 1000] {
        let mut ball = falling(floor + height, floor, 0.0);
        ball.steps(count, impact - 1e-6);
        is_at(&mut ball, floor + height - 0.5 * G * (impact - 1e-6).powi(2), -G * (impact - 1e-6), 1e-12);
        ball.near("floor.impact_count", 0.0, 0.0);
        ball.step(2e-6);
        for _ in 0..2 {
            is_at(&mut ball, floor, 0.0, ROUNDING);
            ball.near("slide.speed", 0.0, 0.0);
            // All the energy of the fall is lost.
            ball.near("energy.drift", 0.0, 1e-11);
            ball.steps(count, 1.0);
        }
    }
}

/// The n-th impact is at t_n = v_0/g (1 + 2 (e + ... + e^(n-1))). Rest is at the limit of t_n, v_0/g (1 + e)/(1 - e)
/// (Zeno).
#[test]
fn a_bouncing_ball_makes_zenos_series_of_impacts() {
    let height = 1.0;
    let speed = (2.0 * G * height).sqrt();
    for (restitution, count) in [(0.5, 1), (0.8, 1), (0.8, 7)] {
        let mut ball = falling(height, 0.0, restitution);
        let (mut t, mut rebound) = (speed / G, speed);
        ball.steps(count, t - 1e-9);
        ball.step(1e-9);
        for n in 1..20 {
            // To the top of the flight after the n-th impact.
            rebound *= restitution;
            ball.steps(count, rebound / G);
            t += 2.0 * rebound / G;
            is_at(&mut ball, 0.5 * rebound * rebound / G, 0.0, 1e-11);
            ball.near("energy.drift", 0.0, 1e-11);
            ball.near("floor.impact_count", f64::from(n), 0.0);
            ball.steps(count, rebound / G);
        }
        let rest = speed / G * (1.0 + restitution) / (1.0 - restitution);
        ball.step((rest - 1e-7) - t);
        assert!(ball.get("floor.force") == 0.0);
        ball.step(2e-7);
        is_at(&mut ball, 0.0, 0.0, 0.0);
        ball.near("floor.force", G, 1e-14 * G);
        ball.near("energy.drift", 0.0, 1e-11);
    }
}

/// Friction mu N beyond the speed V, c v with c = mu N / V below it.
#[test]
fn a_block_slides_up_a_slope_and_down_again() {
    let (slope, mu, band) = (0.6_f64, 0.3, 0.05);
    let (pull, normal, speed) = (G * slope.sin(), G * slope.cos(), 2.0);
    let damping = mu * normal / band;
    let terminal = pull / damping;
    let up = (speed - band) / (pull + mu * normal);
    let turn = ((terminal + band) / (terminal - band)).ln() / damping;
    let top = 0.5 * (speed + band) * up;
    let turned = top - terminal * turn + 2.0 * band / damping;
    for count in [1, 50] {
        let gravity = json!({ "acceleration": G, "up_angle": FRAC_PI_2 - slope });
        let mut run = mass([0.0, speed], json!({ "gravity": gravity, "friction": friction([mu; 2], [band, 0.5]) }));
        run.listen(true, true);
        let mut regimes = 0;
        let mut advance = |run: &mut Run, span: f64| {
            for _ in 0..count {
                run.step(span / f64::from(count));
                regimes += run.take_occurrences(0.0).iter().filter(|line| line.is_detail).count();
            }
        };
        advance(&mut run, up);
        is_at(&mut run, top, band, 1e-9);
        advance(&mut run, turn);
        is_at(&mut run, turned, -band, 1e-9);
        advance(&mut run, 1.0);
        let down = pull - mu * normal;
        is_at(&mut run, turned - band - 0.5 * down, -band - down, 1e-9);
        run.near("energy.drift", 0.0, 1e-9);
        // From kinetic friction upward by transition, viscous friction and transition to kinetic friction downward.
        assert_eq!(regimes, 4);
    }
}

/// Contact of a mass with a spring and a damper: half a period, if there is no damper.
#[test]
fn a_bumper_pushes_for_half_a_period() {
    let (speed, stiffness, gap) = (3.0, 4e4_f64, 0.5);
    for damping in [0.0, 120.0] {
        let decay = 0.5 * damping;
        let omega = (stiffness - decay * decay).sqrt();
        // Until the push would be a pull.
        let phase = PI - (2.0 * decay * omega / (stiffness - 2.0 * decay * decay)).atan();
        let contact = phase / omega;
        let away = (-decay * contact).exp();
        let (depth, leaving) =
            (speed / omega * away * phase.sin(), speed * away * (phase.cos() - decay / omega * phase.sin()));
        if damping == 0.0 {
            assert!((contact - PI / stiffness.sqrt()).abs() < 1e-15);
        }
        for count in [1, 40] {
            let mut run = mass([0.0, speed], json!({ "stops": { "soft": bumper([stiffness, damping, gap]) } }));
            run.steps(count, gap / speed + 0.5 * contact);
            assert!(push(&mut run, &[("soft", true)]));
            run.steps(count, 0.5 * contact * (1.0 + 1e-6));
            assert!(push(&mut run, &[("soft", false)]));
            is_at(&mut run, gap + depth + leaving * 0.5e-6 * contact, leaving, 1e-8);
            run.step(0.1);
            is_at(&mut run, gap + depth + leaving * (0.1 + 0.5e-6 * contact), leaving, 1e-8);
        }
    }
}

#[test]
fn a_lock_catches_holds_and_lets_go() {
    for end in [rigid("upper", 1.0, 0.9), bumper([1e4, 0.0, 1.0])] {
        let latch = json!({ "latch": { "stop": "end", "at": "block.origin" } });
        let mut run = mass([0.0, 1.0], json!({ "stops": { "end": end }, "locks": latch }));
        run.set("latch.engage", true);
        for force in [2.0, -3.0] {
            run.set("push.force", force);
            run.step(5.0);
            is_at(&mut run, 1.0, 0.0, ROUNDING);
            // A rigid stop carries what presses the mass against it, the lock the rest.
            let held = run.get("latch.force") + run.get("end.force");
            assert!((held + force).abs() < 1e-12, "{held}");
            run.near("energy.drift", 0.0, 1e-12);
        }
        run.set("latch.engage", false);
        run.step(0.2);
        is_at(&mut run, 1.0 - 0.5 * 3.0 * 0.04, -3.0 * 0.2, 1e-12);
        assert!(push(&mut run, &[("latch", false), ("end", false)]));
    }
}

#[test]
fn a_force_that_grows_with_time_lifts_the_mass_off_its_stop() {
    let (force, rate, span) = (2.0, 5.0, 1.0);
    let mut run = mass([0.7, 0.0], json!({ "stops": { "end": rigid("lower", 0.7, 0.5) } }));
    run.set("push.force", -force);
    run.set_derivative("push.force", 1, rate);
    run.step(span);
    let after = span - force / rate;
    is_at(&mut run, 0.7 + rate * after.powi(3) / 6.0, 0.5 * rate * after.powi(2), 1e-13);
    run.near("end.force", 0.0, 0.0);
}

/// Driven forward, a drive gives eta F; driven back, it holds up to F / eta.
#[test]
fn a_drive_with_losses_holds_the_mass_that_it_cannot_drive() {
    let (efficiency, load, speed) = (0.6, -9.0, 1.5);
    let decelerating = load + efficiency * 10.0;
    let motor = json!({ "actuators": { "motor": { "joint": "slide", "efficiency": efficiency } } });
    let mut run = mass([0.0, speed], motor).with(&[("motor.force", 10.0), ("push.force", load)]);
    run.step(2.0);
    let held = -0.5 * speed * speed / decelerating;
    is_at(&mut run, held, 0.0, 1e-12);
    // The load decreases: from -decelerating / rate on, the drive moves the mass.
    let (rate, span) = (10.0, 0.5);
    run.set_derivative("push.force", 1, rate);
    run.step(span);
    let after = span + decelerating / rate;
    is_at(&mut run, held + rate * after.powi(3) / 6.0, 0.5 * rate * after.powi(2), 1e-12);
}

/// A bumper with a rigid stop behind it: energy at the rigid stop, and back through the bumper.
#[test]
fn a_rigid_stop_behind_a_bumper_acts() {
    let (force, stiffness, at, end, restitution) = (100.0, 3000.0, 0.5, 0.51, 0.6_f64);
    for count in [1, 9, 300] {
        let stops = json!({ "soft": bumper([stiffness, 0.0, at]), "hard": rigid("upper", end, restitution) });
        let mut run = mass([0.0; 2], json!({ "stops": stops })).with(&[("push.force", force)]);
        let square = 2.0 * (force * end - 0.5 * stiffness * (end - at) * (end - at));
        let omega = stiffness.sqrt();
        let (first, arrival) = ((2.0 * at / force).sqrt(), square.sqrt());
        // In the bumper: x = middle + amplitude sin(omega t + phase), about its balance.
        let balance = at + force / stiffness;
        let speed = (2.0 * force * at).sqrt();
        let angle = |x: f64, v: f64| (omega * (x - balance)).atan2(v);
        let within = (angle(end, arrival) - angle(at, speed)) / omega;
        run.steps(count, first + within - 1e-6);
        assert!(
            run.get("slide.speed") > 0.0 && run.get("hard.impact_count") == 0.0 && push(&mut run, &[("soft", true)])
        );
        run.steps(count, 2e-6);
        let after = restitution * arrival;
        run.near("slide.speed", -after, 1e-3);
        run.near("hard.impact_impulse", arrival + after, 1e-9);
        run.near("energy.drift", 0.0, 1e-9);
        assert!(run.get("slide.position") < end && push(&mut run, &[("soft", true)]));
        // Back at the place of the bumper, which lets go.
        let back = (after * after - 2.0 * force * (end - at) + stiffness * (end - at) * (end - at)).sqrt();
        let within = (angle(at, -back) - angle(end, -after)).rem_euclid(2.0 * PI) / omega;
        run.steps(count, within - 1e-6 + 1e-9);
        is_at(&mut run, at - 1e-9 * back, -back, 1e-6);
        assert!(push(&mut run, &[("soft", false)]));
    }
}

/// At rest at a rigid stop with compressed bumpers before it: let go where the force equals their push.
#[test]
fn bumpers_push_a_resting_mass_off() {
    let stops = json!({
        "one": bumper([1000.0, 30.0, 0.98]), "end": rigid("upper", 1.0, 0.0), "two": bumper([500.0, 0.0, 0.99]),
    });
    let both = [("one", true), ("two", true)];
    let pushed = 1000.0 * 0.02 + 500.0 * 0.01;
    let mut run = mass([0.0; 2], json!({ "stops": stops })).with(&[("push.force", 40.0)]);
    run.step(2.0);
    is_at(&mut run, 1.0, 0.0, ROUNDING);
    run.near("end.force", pushed - 40.0, 1e-12);
    assert!(push(&mut run, &both));
    // It decreases by 10 N/s: (40 - 25) / 10 s.
    run.set_derivative("push.force", 1, -10.0);
    let released = (40.0 - pushed) / 10.0;
    run.step(released - 1e-9);
    is_at(&mut run, 1.0, 0.0, ROUNDING);
    assert!(run.get("end.force") < 0.0);
    run.set("push.force", 40.0 - 10.0 * (released - 1e-9));
    run.set_derivative("push.force", 1, -10.0);
    run.step(1e-3);
    let expected = -10.0 * 1e-6 / 2.0;
    run.near("slide.speed", expected, 0.05 * expected.abs());
    assert!(run.get("end.force") == 0.0 && push(&mut run, &both));
}

/// A mass that bounces off a rigid stop faster than its damped bumper can follow is not pulled.
#[test]
fn a_bumper_that_would_pull_after_an_impact_lets_go() {
    let stops = json!({ "soft": bumper([10.0, 50.0, 0.9]), "hard": rigid("upper", 0.95, 1.0) });
    let mut run = mass([0.0, 10.0], json!({ "stops": stops }));
    run.step(0.09 - 1e-9);
    assert!(push(&mut run, &[("soft", false)]));
    run.step(0.0075);
    let v = run.get("slide.speed");
    assert!(v < -5.0 && push(&mut run, &[("soft", false)]), "{v}");
    run.step(0.1);
    assert_eq!(run.get("slide.speed"), v, "free flight");
}

/// 5 ms in which the force draws the mass off its stop, in one step of 0.52 s.
#[test]
fn a_short_release_within_a_long_step_is_met() {
    let (peak, bend, center, span) = (1e4_f64, 1.6e9, 0.5078, 0.52);
    let resting = || {
        let mut run = mass([0.0; 2], json!({ "stops": { "end": rigid("lower", 0.0, 0.0) } }));
        run.set("push.force", peak - bend * center * center);
        run.set_derivative("push.force", 1, 2.0 * bend * center);
        run.set_derivative("push.force", 2, -2.0 * bend);
        run
    };
    let half = (peak / bend).sqrt();
    // From the release on, at tau: acceleration bend (2 half tau - tau^2).
    let tau = span - (center - half);
    let x = |tau: f64| bend * (half * tau.powi(3) / 3.0 - tau.powi(4) / 12.0);
    let v = |tau: f64| bend * (half * tau.powi(2) - tau.powi(3) / 3.0);
    let early = center - half + 0.8 * (4.0 * half).min(tau);
    let after = early - (center - half);
    let mut twin = resting();
    twin.step(early);
    is_at(&mut twin, x(after), v(after), 1e-7);
    // Back at the stop after 4 half widths, and held there.
    assert!(4.0 * half < tau, "{half} {tau}");
    let mut run = resting();
    run.step(span);
    is_at(&mut run, 0.0, 0.0, 0.0);
    let impulse = run.get("end.impact_impulse");
    assert!(0.5 * impulse * impulse > 1.0 && run.get("end.force") > 0.0, "{impulse}");
}

/// A bumper with much damping lets go and is pressed again within one step, as the force turns the mass and turns it
/// back before it has left the bumper.
#[test]
fn a_bumper_lets_go_and_pushes_again_within_one_step() {
    for force in [-2.0, -1.8, -1.74] {
        let mut ends = Vec::new();
        for count in [1, 4, 64, 1024] {
            let mut run = mass([-1e-3, 0.2], json!({ "stops": { "soft": bumper([0.0, 5.0, 0.0]) } }));
            run.listen(true, false);
            let h = 0.5 / f64::from(count);
            let mut changes = 0;
            for n in 0..count {
                run.set("push.force", force + 10.0 * h * f64::from(n));
                run.set_derivative("push.force", 1, 10.0);
                run.step(h);
                let lines = run.take_occurrences(0.0).into_iter();
                changes += lines.filter(|line| line.text.contains("push")).count();
            }
            ends.push((run.get("slide.position"), run.get("slide.speed"), changes));
        }
        let (x, v, _) = ends[3];
        assert!(ends.iter().all(|end| end.2 == 3), "it lets go and pushes again: {ends:?}");
        assert!(ends.iter().all(|e| (e.0 - x).abs() < 1e-9 && (e.1 - v).abs() < 1e-8), "{ends:?}");
    }
}

/// A slip speed that leaves the viscous regime and comes back within one step: a force that swings.
#[test]
fn a_regime_left_and_entered_again_within_one_step_is_met() {
    // Viscous friction 60 v: the speed follows force / 60 late, to its largest value just above 0.05 m/s.
    for peak in [3.3, 3.2, 3.15] {
        let mut ends = Vec::new();
        for count in [1, 200] {
            let (rate, bend) = (4.0 * peak / 0.5, -8.0 * peak / 0.25);
            let gravity = json!({ "acceleration": 10, "up_angle": FRAC_PI_2 });
            let law = friction([0.3, 0.2], [0.05, 0.5]);
            let mut run = mass([0.0; 2], json!({ "gravity": gravity, "friction": law }));
            run.listen(true, true);
            let h = 0.5 / f64::from(count);
            let mut regimes = 0;
            for n in 0..count {
                let t = h * f64::from(n);
                run.set("push.force", rate * t + 0.5 * bend * t * t);
                run.set_derivative("push.force", 1, rate + bend * t);
                run.set_derivative("push.force", 2, bend);
                run.step(h);
                regimes += run.take_occurrences(0.0).iter().filter(|line| line.is_detail).count();
            }
            assert_eq!(regimes, 2, "{peak} {count}");
            ends.push((run.get("slide.position"), run.get("slide.speed")));
        }
        let [(x, v), (fine_x, fine_v)] = ends[..] else { panic!() };
        assert!((x - fine_x).abs() < 1e-9 && (v - fine_v).abs() < 1e-8, "{ends:?}");
    }
}
