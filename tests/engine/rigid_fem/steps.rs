//! Steps of the finite elements: convergence to the strain of the rods, vibration, saved state, rejected steps.
use super::ELASTIC_LIMIT;
use super::both::Both;
use crate::gear_retraction::THETA_013;
use crate::support::{FOUR_BAR, GEAR, JIB, Run, SLIDER_CRANK, assert_says, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::linkage::Linkage;
use linkage_fmu::mechanism::loads::resolved::Loading;
use linkage_fmu::mechanism::rigid_fem::{RigidFem, RigidFemError};
use serde_json::json;

/// theta2 of scene S1 at 0.05, 0.10 and 0.13 s [rad].
fn gear_angles(factor: f64, h: f64) -> [f64; 3] {
    let mut gear = Both::new(GEAR, factor, h);
    [0.05, 0.05, 0.03].map(|span| {
        gear.fem_step(span).unwrap();
        gear.crank()
    })
}

/// Limit h -> 0 of a second-order sequence, from the steps h and h / 2.
fn limit(coarse: [f64; 3], fine: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| fine[k] + (fine[k] - coarse[k]) / 3.0)
}

#[test]
fn the_order_of_convergence_is_two() {
    let at = |h: f64| gear_angles(1.0, h);
    let finest = limit(at(2e-6), at(1e-6));
    let errors = [1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5, 2.5e-5, 1e-5].map(|h| {
        let theta = at(h);
        (h, [0, 1, 2].map(|k| (theta[k] - finest[k]).abs()))
    });
    for pair in errors.windows(2) {
        let ((h_before, last), (h, error)) = (pair[0], pair[1]);
        // The next error term is smaller by about (h omega)^2, with omega of a rod of 2e3 to 3e4 /s.
        let allowed = if h > 3e-4 { 0.1 } else { 0.02 };
        for k in 0..3 {
            let order = (last[k] / error[k]).ln() / (h_before / h).ln();
            assert!((order - 2.0).abs() < allowed, "h = {h:e}, time {k}: order {order}, error {:e}", error[k]);
        }
    }
}

#[test]
fn the_error_at_small_steps_is_the_strain_of_the_rods() {
    // The difference from the rigid reference tends to the elastic limit, within the error of the steps.
    for (h, own) in [(1e-3, 4e2), (1e-4, 4e2), (1e-5, 4e2)] {
        let error = gear_angles(1.0, h)[2] - THETA_013;
        assert!((error - ELASTIC_LIMIT).abs() < own * h * h + 1e-9, "h = {h:e}: {error:e}");
    }
    // The limit is proportional to 1 / (E A). The next term is smaller by the strain of 1e-4.
    let mut last = ELASTIC_LIMIT;
    for (factor, h) in [(10.0, 1e-5), (100.0, 5e-6), (1000.0, 2e-6)] {
        let elastic = limit(gear_angles(factor, 2.0 * h), gear_angles(factor, h))[2] - THETA_013;
        assert!((elastic * 10.0 - last).abs() < 3e-3 * last, "{factor}: {elastic:e} after {last:e}");
        last = elastic;
    }
}

#[test]
fn a_start_without_stretch_keeps_vibrating() {
    // During 10 ms.
    let swing = |stretched: bool| {
        let mut gear = Both::started(GEAR, 1.0, 1e-6, stretched);
        gear.largest_share(100, 1e-4)
    };
    let (steady, shaken) = (swing(true), swing(false));
    assert!(steady < 1e-4 && shaken > 0.3, "{steady} {shaken}");
}

#[test]
fn energy_drifts_with_the_square_of_the_step() {
    let drift = |h: f64| {
        let mut gear = Both::new(GEAR, 1.0, h);
        let start = gear.energy();
        (0..26).fold(0.0f64, |worst, _| {
            gear.fem_step(5e-3).unwrap();
            worst.max((gear.energy() - start).abs())
        })
    };
    let (coarse, fine, finest) = (drift(1e-4), drift(1e-5), drift(1e-6));
    // Relative to 8.5 kJ. Rounding adds some E A L 1e-16 per step.
    assert!((coarse / fine - 100.0).abs() < 5.0 && (fine / finest - 100.0).abs() < 5.0);
    assert!(finest < 1e-5);
}

#[test]
fn a_jump_of_an_input_changes_the_acceleration_immediately() {
    // The motion of the rigid links changes at once. A jump does not excite vibrations faster than the step.
    let mut gear = Both::new(GEAR, 1.0, 1e-3);
    gear.set(&[("actuator.force", 20_000.0)]);
    let (fem, reduced) = (gear.fem.angle(&gear.state, gear.body("crank"), 2), gear.get("crank.acceleration"));
    // The filter's part (h omega / 2)^-2 of the jump of 70 rad/s2, for the slowest rod with 2e4 /s.
    assert!((fem - reduced).abs() < 0.3, "{fem} {reduced}");
    let theta = |h: f64| {
        let mut gear = Both::new(GEAR, 1.0, h);
        gear.step(0.05);
        gear.set(&[("actuator.force", 24_000.0)]);
        gear.step(0.05);
        (gear.crank(), gear.get("crank.angle"))
    };
    let finest = theta(1e-6);
    assert!((finest.0 - finest.1).abs() < 1e-4, "elastic: {:e}", finest.0 - finest.1);
    // Second order, except for the vibration of some 1e-7 rad that the jump excites in the rods.
    let errors = [1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5].map(|h| theta(h).0 - finest.0);
    for (pair, ratio) in errors.windows(2).zip([4.0, 4.0, 6.25, 4.0]) {
        assert!((pair[1] - pair[0] / ratio).abs() < 2e-7 + 0.02 * pair[1].abs(), "{errors:?}");
    }
}

#[test]
fn a_state_is_all_that_a_step_needs() {
    let mut gear = Both::new(GEAR, 1.0, 1e-4);
    gear.fem_step(0.03).unwrap();
    let saved = gear.state.clone();
    gear.fem_step(0.05).unwrap();
    let after = gear.state.clone();
    let mut scratch = gear.fem.scratch();
    let mut again = saved.clone();
    gear.fem.advance(&mut again, &mut scratch, &gear.sizes, 0.05, 1e-4).unwrap();
    assert_eq!(again, after);
    // 1e-3 s is divided into 4 steps if the longest step is 3e-4 s.
    let divided = |h_fem: f64| {
        let mut state = saved.clone();
        gear.fem.advance(&mut state, &mut gear.fem.scratch(), &gear.sizes, 1e-3, h_fem).unwrap();
        state
    };
    assert_eq!(divided(3e-4), divided(2.5e-4));
    assert_ne!(divided(3e-4), divided(2e-4));
    assert_eq!(divided(1.0), divided(1e-3));
    assert_eq!(divided(5e-4), divided(5e-4 * (1.0 - 1e-9)));
}

#[test]
fn a_rejected_step_changes_nothing() {
    let mut gear = Both::new(GEAR, 1.0, 1e-3);
    let before = gear.state.clone();
    for (h, h_fem) in [(0.0, 1e-3), (f64::NAN, 1e-3), (1e-3, -1.0), (1e-3, f64::INFINITY)] {
        let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &gear.sizes, h, h_fem).unwrap_err();
        assert!(matches!(error, RigidFemError::StepSize { .. }), "{error}");
    }
    let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &gear.sizes, 1.0, 1e-300).unwrap_err();
    assert!(error.to_string().contains("increase solver.fem_step"), "{error}");
    for sizes in [vec![1e300; 7], vec![f64::NAN; 7]] {
        let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &sizes, 1e-2, 1e-3).unwrap_err();
        assert!(error.to_string().contains("smaller step"), "{error}");
        assert!(gear.fem.rebalance(&mut gear.state, &mut gear.scratch, &[f64::NAN; 7], 1e-3).is_err());
    }
    assert_eq!(gear.state, before);
}

#[test]
fn vibration_that_grows_is_an_error_not_a_motion() {
    // Oscillation through the toggles at 30 rad/s, with steps of thirty times 1 / omega of a rod.
    let text = changed(GEAR, |m| m["actuators"]["actuator"]["force"] = json!(20_000));
    let mut gear = Both::new(&text, 1.0, 2e-3);
    let start = gear.energy();
    let error = (0..200).find_map(|_| gear.fem_step(1e-2).err()).unwrap();
    assert!(matches!(error, RigidFemError::Strain { limit: 1e-2, .. }), "{error}");
    // Before the error, the energy error is at most the energy of this strain in each rod, E A L 1e-4 / 2.
    let most: f64 = [(2.1e9, 0.1755), (8.9376e7, 0.217), (3.0492e8, 0.34)].iter().map(|(ea, l)| ea * l * 5e-5).sum();
    assert!((gear.energy() - start).abs() < 2.0 * most, "{} J of {most} J", gear.energy() - start);
}

#[test]
fn bodies_that_are_no_binary_link_are_rejected_with_their_name() {
    let refused = |text: &str, ea: f64| {
        let reduced = Run::new(text).reduced().unwrap().clone();
        RigidFem::new(reduced.linkage(), reduced.loading(), &|_| ea).unwrap_err()
    };
    let error = refused(SLIDER_CRANK, 1e9);
    assert!(matches!(error, RigidFemError::Prismatic { .. }));
    assert_says(&error, &["prismatic", "revolute"]);
    let ternary = changed(GEAR, |m| {
        m["bodies"]["coupler"]["points"] = json!({ "middle": [0.1, 0.05] });
        m["bodies"]["link"] = json!({ "length": 0.2, "mass": 1 });
        m["joints"]["joint5"] = json!({ "type": "revolute", "first": "coupler.middle", "second": "link.origin" });
        m["guess"]["link"] = json!(0);
    });
    let mechanism = Mechanism::from_json(&ternary).unwrap();
    let linkage = Linkage::new(&mechanism).unwrap();
    let loading = Loading::new(&mechanism, &linkage).unwrap();
    let error = RigidFem::new(&linkage, &loading, &|_| 1e9).unwrap_err();
    assert!(matches!(error, RigidFemError::Nodes { count: 3, .. }));
    assert_says(&error, &["coupler", "3 points", "exactly 2"]);
    let error = refused(JIB, 1e9);
    assert!(matches!(error, RigidFemError::Nodes { count: 1, .. }));
    for ea in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refused(GEAR, ea);
        assert!(matches!(error, RigidFemError::AxialStiffness { .. }));
        assert_says(&error, &["crank", "> 0"]);
    }
    let error = refused(&changed(FOUR_BAR, |m| m["actuators"]["drive"]["efficiency"] = json!(0.9)), 1e9);
    assert_says(&error, &["drive", "0.9", "set the efficiency to 1"]);
    // The crank and the rocker of the shipped four-bar have no mass, so the strain of its coupler would move no mass.
    let reduced = Run::new(FOUR_BAR).reduced().unwrap().clone();
    let fem = RigidFem::new(reduced.linkage(), reduced.loading(), &|_| 1e9).unwrap();
    let c = reduced.curve().configuration(0.0);
    let error = fem.start(reduced.linkage(), &c.q, &c.q_sigma, &[0.0; 8]).unwrap_err();
    assert!(matches!(&error, RigidFemError::Massless { mass: 0.0, .. }), "{error}");
    assert_says(&error, &["give", "a mass"]);
}
