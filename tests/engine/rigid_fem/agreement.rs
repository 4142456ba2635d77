//! Motion, accelerations and reactions in both formulations, for each load and for several linkages.
use super::both::Both;
use super::{heavy_four_bar, strut};
use crate::support::{ANDREWS, CHAIN, GEAR, changed};
use serde_json::json;

#[test]
fn accelerations_and_forces_are_those_of_the_reduced_model() {
    // In motion, so that a missing speed-dependent term would keep the differences from decreasing.
    let text = changed(GEAR, |m| m["start"] = json!({ "body": "crank", "angle": 0.3, "speed": -12 }));
    let mut last = [f64::INFINITY; 4];
    for factor in [1.0, 10.0, 100.0, 1000.0] {
        let differences = Both::new(&text, factor, 1e-6).differences();
        for k in 0..4 {
            assert!(differences[k] < 0.11 * last[k], "{factor}, {k}: {:e} after {:e}", differences[k], last[k]);
        }
        last = differences;
    }
    // Sizes are some 1e3 rad/s2 and 1e5 N.
    assert!(last[2] < 1e-4 && last[3] < 1e-1, "{last:?}");
}

#[test]
fn all_loads_of_the_gear_are_equal_in_both_formulations() {
    let text = changed(GEAR, |m| {
        let hinge = json!({ "joint": "joint3", "stiffness": 90, "damping": 3, "free_angle": 1.2 });
        m["springs"] = json!({ "strut": strut(), "hinge": hinge });
        m["torques"]["coupler"] = json!({ "on": "coupler", "torque": 40, "constant": true });
        m["forces"]["gust"] = json!({ "at": "leg.end", "force": [200, -100], "constant": true });
    });
    let mut worst = Vec::new();
    for factor in [100.0, 1000.0] {
        let mut gear = Both::new(&text, factor, 1e-5);
        let start = gear.energy();
        gear.set(&[("crank.torque", 300.0), ("follower.torque", -200.0)]);
        gear.set(&[("wheel.force_x", -700.0), ("wheel.force_y", 400.0)]);
        let mut work = gear.energy() - start;
        gear.steps(10, 5e-3);
        let before = gear.energy();
        gear.set(&[("actuator.force", 36_000.0), ("load_factor", 2.0)]);
        work += gear.energy() - before;
        gear.steps(10, 5e-3);
        let angle = gear.differences()[0];
        let drift = gear.energy() + gear.lost - work - start;
        assert!(gear.lost > 50.0 && drift.abs() < 1e-3, "{drift:e}");
        worst.push(angle);
    }
    // Elastic limit 1.4e-4 / 100, and error of the step 3e2 h^2.
    assert!(worst[0] < 1e-5 && worst[1] < 1e-6, "{worst:?}");
}

#[test]
fn each_load_alone_gives_equal_accelerations() {
    for (name, size) in [
        ("actuator.force", 2e4),
        ("load_factor", 3.0),
        ("wheel.force_x", 900.0),
        ("wheel.force_y", -900.0),
        ("crank.torque", 500.0),
        ("follower.torque", 500.0),
    ] {
        let text = changed(GEAR, |m| {
            m["actuators"]["actuator"]["force"] = json!(0);
            m["gravity"]["load_factor"] = json!(0);
            m["stops"]["downstop"]["enabled"] = json!(false);
            match name.split_once('.') {
                Some(("wheel", axis)) => {
                    m["forces"]["wheel"]["force"] = if axis == "force_x" { json!([size, 0]) } else { json!([0, size]) }
                }
                Some(("actuator", _)) => m["actuators"]["actuator"]["force"] = json!(size),
                Some((body, _)) => m["torques"][body]["torque"] = json!(size),
                None => m["gravity"][name] = json!(size),
            }
        });
        let mut gear = Both::new(&text, 1e5, 1e-6);
        let acceleration = gear.get("crank.acceleration");
        let [.., differs, force] = gear.differences();
        // The elastic error is below 1e-9. The rounding of the rod forces is E A 1e-16 / l = 0.1 N: 3e-6 of the force.
        assert!(acceleration.abs() > 1.0 && differs < 1e-6 * acceleration.abs(), "{name}: {differs:e}");
        assert!(force < 0.5, "{name}: {force:e}");
    }
}

#[test]
fn forces_in_joints_follow_the_reactions() {
    let shares = [(1.0, 1e-5), (100.0, 2e-6)].map(|(factor, h_fem)| {
        let mut gear = Both::new(GEAR, factor, h_fem);
        gear.largest_share(26, 5e-3)
    });
    // The strain is some 1e-4, and ten times larger near the toggle.
    assert!(shares[0] < 2e-3 && shares[1] < 2e-5, "{shares:?}");
}

#[test]
fn a_chain_of_four_bars_and_a_turning_crank_follow_too() {
    let mut chain = Both::new(CHAIN, 1.0, 2e-5);
    chain.steps(60, 1e-2);
    let [angle, speed, ..] = chain.differences();
    assert!(angle < 1e-6 && speed < 1e-5, "{angle:e} {speed:e}");
    // Joints of three bodies: compare all forces in the first steps.
    let mut chain = Both::new(CHAIN, 1e3, 2e-5);
    assert!(chain.differences()[3] < 1e-4, "{:e}", chain.differences()[3]);
    let mut four_bar = Both::new(&heavy_four_bar(), 10.0, 5e-6);
    let start = four_bar.crank();
    four_bar.steps(40, 1e-2);
    let [angle, speed, ..] = four_bar.differences();
    assert!((four_bar.crank() - start).abs() > 6.3, "a whole turn");
    assert!(angle < 1e-3 && speed < 1e-2, "{angle:e} {speed:e}");
}

#[test]
fn a_redundant_rod_follows_too() {
    // A sixth rod across both parallelograms: the rod forces do not follow from balance alone.
    let text = changed(CHAIN, |m| {
        m["bodies"]["long"] = json!({ "length": 2, "mass": 2, "shape": "uniform_rod" });
        m["joints"]["long1"] = json!({ "type": "revolute", "first": "bar0.end", "second": "long.origin" });
        m["joints"]["long2"] = json!({ "type": "revolute", "first": "long.end", "second": "bar2.end" });
        m["guess"]["long"] = json!(0);
    });
    let mut chain = Both::new(&text, 1.0, 2e-5);
    let differs = chain.differences();
    chain.steps(60, 1e-2);
    let [angle, speed, ..] = chain.differences();
    assert!(differs[2] < 1e-6, "acceleration differs by {:e}", differs[2]);
    assert!(angle < 1e-6 && speed < 1e-5, "{angle:e} {speed:e}");
}

#[test]
fn seven_bodies_with_a_joint_of_four_follow_too() {
    let worst = [1e-2, 1e-1].map(|factor| {
        let mut squeezer = Both::new(ANDREWS, factor, 1e-7);
        squeezer.step(5e-3);
        squeezer.differences()[0]
    });
    assert!(worst[1] < 0.2 * worst[0], "{worst:?}");
}
