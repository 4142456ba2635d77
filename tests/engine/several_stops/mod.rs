//! Several stops on one side: bumpers with a rigid stop behind, dead centres behind a bumper, locks at any of these
//! stops.
//!
//! `validation/src/attack/scenes` compares random scenes of this kind with an independent integration.

mod release;
mod scene;

use crate::support::{Run, assert_says};
use linkage_fmu::simulation::Simulation;
use scene::{Machine, Quantity, Scene, Stop, block, bumper, rigid};

/// A block passes its bumper and stops at the rigid stop behind it. The flags follow.
#[test]
fn a_rigid_stop_behind_a_bumper_ends_the_travel() {
    let stops = [bumper(Quantity::Slide, 1.0, 0.5, 3000.0, 0.0), rigid(Quantity::Slide, 1.0, 0.51, 0.0)];
    for order in [[0, 1], [1, 0]] {
        let mut run = block(&order.map(|k| stops[k])).run();
        run.set("load.force", 100.0);
        let [soft, hard] = [0, 1].map(|k| format!("s{}.reached", order.iter().position(|&o| o == k).unwrap()));
        let mut farthest: f64 = 0.0;
        for _ in 0..400 {
            run.step(1e-3);
            let x = run.get("slide.position");
            farthest = farthest.max(x);
            assert_eq!((run.is(&soft), run.is(&hard)), (x >= 0.5, x >= 0.51 - 1e-15), "{x}");
        }
        assert!((farthest - 0.51).abs() < 1e-15 && run.get("slide.speed") == 0.0, "{farthest}");
        // The bumper carries 30 N, the rigid stop carries the rest.
        let [soft, hard] = [soft, hard].map(|name| name.replace("reached", "force"));
        assert!((run.get(&soft) + 30.0).abs() < 1e-9 && (run.get(&hard) + 70.0).abs() < 1e-9);
        assert!(run.get("energy.drift").abs() < 1e-9);
        // A force of less than 30 N does not keep the block at the stop.
        run.set("load.force", 20.0);
        run.step(1e-3);
        assert!(run.get("slide.speed") < 0.0 && !run.is(&hard.replace("force", "reached")));
    }
}

/// The crank overruns its bumper and the dead centre, reaches the lower rigid stop, and returns.
#[test]
fn a_crank_that_overruns_its_bumper_reaches_the_stop_behind_the_dead_centre() {
    let stops = [bumper(Quantity::Slide, 1.0, 1.09, 300.0, 5.0), rigid(Quantity::Slide, -1.0, 0.7, 0.3)];
    let scene = Scene { machine: Machine::Crank(0.5, 1.0), start: [-1.2, 2.5], stops: stops.to_vec(), lock: None };
    let mut run = scene.run();
    run.set("load.torque", 5.0);
    run.steps(200, 3.0);
    let (angle, slide) = (run.get("crank.angle"), run.get("guide.position"));
    assert!(angle > 0.0 && (slide - 0.7).abs() < 1e-9, "{angle} {slide}");
    assert!(run.is("s1.reached") && !run.is("s0.reached"), "within the bumper again");
}

/// With a rigid stop and a bumper at one position, the rigid stop acts and the bumper is never compressed. Each flag is
/// true, and each lock holds.
#[test]
fn stops_at_one_place() {
    // At x = 0.9 the distance is hypot(0.7, 0.7).
    let length = 0.7_f64.hypot(0.7);
    for (n, others) in [
        [bumper(Quantity::Slide, 1.0, 0.9, 3000.0, 10.0), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [bumper(Quantity::Distance, 1.0, length, 3000.0, 10.0), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [rigid(Quantity::Distance, 1.0, length, 0.5), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [rigid(Quantity::Slide, 1.0, 0.9, 0.5), bumper(Quantity::Distance, 1.0, length, 3000.0, 10.0)],
    ]
    .iter()
    .enumerate()
    {
        let mut stops = others.to_vec();
        stops.push(bumper(Quantity::Slide, 1.0, 0.6, 200.0, 3.0));
        for lock in [None, Some(0), Some(1)] {
            let mut scene = block(&stops);
            scene.lock = lock;
            let mut run = scene.run();
            run.set("load.force", 200.0);
            if lock.is_some() {
                run.set("latch.engage", true);
            }
            run.step(2.0);
            let x = run.get("slide.position");
            assert!((x - 0.9).abs() < 1e-12 && run.get("slide.speed") == 0.0, "{n} {lock:?}: {x}");
            assert!((0..3).all(|k| run.is(&format!("s{k}.reached"))), "{n} {lock:?}");
            for k in (0..2).filter(|&k| stops[k].rigid.is_none()) {
                assert_eq!(run.get(&format!("s{k}.force")), 0.0, "not compressed");
            }
            run.set("load.force", -200.0);
            if lock.is_some() {
                assert!((run.get("latch.force") - 140.0).abs() > 1.0 && run.get("latch.force") > 0.0);
            }
            run.step(0.01);
            assert_eq!(run.get("slide.position") == x, lock.is_some(), "{n} {lock:?}");
        }
    }
    // Several bumpers at one position act together.
    let two = [bumper(Quantity::Slide, 1.0, 0.5, 1000.0, 3.0), bumper(Quantity::Slide, 1.0, 0.5, 2000.0, 6.0)];
    let (mut pair, mut sum) = (block(&two).run(), block(&[bumper(Quantity::Slide, 1.0, 0.5, 3000.0, 9.0)]).run());
    for run in [&mut pair, &mut sum] {
        run.set("load.force", 50.0);
        run.steps(30, 0.6);
    }
    let [a, b] = [&mut pair, &mut sum].map(|run| run.get("slide.position"));
    assert!((a - b).abs() < 1e-9 && a > 0.4, "{a} {b}");
}

/// The start is between two opposite stops at one position: the block stays at rest from the start on under any load,
/// and the stop in the direction of the load carries it.
#[test]
fn two_opposite_stops_hold_a_start_against_any_load() {
    let (lower, upper) = (rigid(Quantity::Slide, -1.0, 0.3, 0.5), rigid(Quantity::Slide, 1.0, 0.3, 0.5));
    for (stops, [low, high]) in [([lower, upper], ["s0", "s1"]), ([upper, lower], ["s1", "s0"])] {
        let scene = Scene { start: [0.3, 0.0], ..block(&stops) };
        for force in [81.8, -81.8, 0.0] {
            let mut run = Run::new(scene.definition());
            run.set("load.force", force);
            run.initialize();
            let start = run.get("slide.position");
            // The force reverses at each communication point.
            for sign in [1.0, -1.0, -1.0, 1.0] {
                let force = sign * force;
                run.set("load.force", force);
                assert_eq!((run.get("slide.acceleration"), run.get("slide.speed")), (0.0, 0.0), "{force}");
                let forces = [low, high].map(|stop| run.get(&format!("{stop}.force")));
                assert!((forces[0] - (-force).max(0.0)).abs() < 1e-12, "{force}: {forces:?}");
                assert!((forces[1] + force.max(0.0)).abs() < 1e-12, "{force}: {forces:?}");
                assert!((0..2).all(|k| run.is(&format!("s{k}.reached"))));
                run.step(0.1);
                assert_eq!(run.get("slide.position"), start);
            }
        }
    }
}

/// A bumper and a rigid stop at smaller and smaller distances.
#[test]
fn a_gap_between_bumper_and_stop_may_be_any() {
    for decade in 1..16 {
        let gap = 10f64.powi(-decade);
        for steps in [1, 50] {
            let stops = [bumper(Quantity::Slide, 1.0, 0.5, 1e5, 20.0), rigid(Quantity::Slide, 1.0, 0.5 + gap, 0.4)];
            let mut run = block(&stops).run();
            run.set("load.force", 1e5);
            run.steps(steps, 1.0);
            let x = run.get("slide.position");
            assert!(x <= 0.5 + gap + 1e-15 && x > 0.5 - 1e-12 && run.get("slide.speed").abs() < 1e-6, "{gap} {x}");
            assert!(run.is("s0.reached"), "{gap}");
            assert!(run.get("energy.drift").abs() < 1e-4, "{}", run.get("energy.drift"));
        }
    }
}

/// A lock at a bumper before a rigid stop catches the block on its way out. If engaged beyond the bumper, it catches
/// the block on its way back.
#[test]
fn a_lock_at_a_bumper_before_a_rigid_stop() {
    for damping in [0.0, 20.0] {
        let stops = [bumper(Quantity::Slide, 1.0, 0.5, 3000.0, damping), rigid(Quantity::Slide, 1.0, 0.51, 0.5)];
        let mut scene = block(&stops);
        scene.lock = Some(0);
        let mut run = scene.run();
        run.set("load.force", 100.0);
        run.set("latch.engage", true);
        run.steps(7, 1.0);
        // The position is the value of the stop except for one rounding.
        assert!((run.get("slide.position") - 0.5).abs() <= 0.5 * f64::EPSILON && run.get("slide.speed") == 0.0);
        assert!((run.get("latch.force") + 100.0).abs() < 1e-9);
        run.set("latch.engage", false);
        run.step(1.0);
        assert!(run.get("slide.position") > 0.505 && run.is("s0.reached"));
        run.set("latch.engage", true);
        run.set("load.force", -10.0);
        run.steps(3, 1.0);
        assert_eq!((run.get("slide.position"), run.get("slide.speed")), (0.5, 0.0), "{damping}");
        assert!((run.get("latch.force") - 10.0).abs() < 1e-9);
        assert!(run.get("energy.drift").abs() < 1e-9);
    }
}

/// Bumpers on both sides, of which several act at once, before a rigid stop.
pub fn crowded() -> Scene {
    block(&[
        bumper(Quantity::Slide, 1.0, 0.3, 300.0, 2.0),
        bumper(Quantity::Distance, 1.0, 0.75, 500.0, 0.0),
        bumper(Quantity::Slide, 1.0, 0.4, 100.0, 40.0),
        rigid(Quantity::Slide, 1.0, 0.55, 0.6),
        bumper(Quantity::Slide, -1.0, -0.2, 800.0, 3.0),
    ])
}

#[test]
fn too_many_bumpers_are_rejected() {
    let at = |k: usize| 1.0 + 0.01 * k as f64;
    let mut stops: Vec<Stop> = (0..65).map(|k| bumper(Quantity::Slide, 1.0, at(k), 1e3, 1.0)).collect();
    let refusal = Simulation::open(&block(&stops).definition()).err().unwrap();
    assert_says(refusal, &["65 bumpers", "64", "enabled", "rigid"]);
    stops[64] = rigid(Quantity::Slide, 1.0, at(64), 0.0);
    let mut run = block(&stops).run();
    run.set("load.force", 1e6);
    run.step(2.0);
    assert!((0..65).all(|k| run.is(&format!("s{k}.reached"))), "{}", run.get("slide.position"));
}
