//! Rigid-link finite elements ([HF08] section 3) against the reduced model, and against themselves.

use super::gear_retraction::THETA_013;
use crate::support::{ANDREWS, CHAIN, FOUR_BAR, GEAR, JIB, Run, SLIDER_CRANK, assert_says, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::linkage::Linkage;
use linkage_fmu::mechanism::loads::resolved::Loading;
use linkage_fmu::mechanism::reactions::Reaction;
use linkage_fmu::mechanism::rigid_fem::{RigidFem, RigidFemError, Scratch, State};
use serde_json::{Value, json};

/// theta2 of the gear with elastic rods less that of the rigid one at 0.13 s [rad]: measured here, and shown to be
/// proportional to 1 / (E A).
pub const ELASTIC_LIMIT: f64 = 1.389_484e-4;

/// E A of the gear's bodies [N]: E = 2.1e11 Pa, A of PHYSICS; of other mechanisms' bodies 1e9 N.
fn stiffness(linkage: &Linkage, body: usize) -> f64 {
    let area = match linkage.bodies[body].name.as_str() {
        "crank" => 1e-2,
        "coupler" => 4.256e-4,
        "follower" => 1.452e-3,
        _ => return 1e9,
    };
    2.1e11 * area
}

/// A spring with a damper between the gear's ground and its wheel.
pub fn strut() -> Value {
    json!({ "first": "ground.end", "second": "wheel.origin", "stiffness": 4e3, "damping": 60, "free_length": 0.6,
        "preload": 50 })
}

/// The four-bar with masses of crank and rocker, fast enough for a whole turn.
pub fn heavy_four_bar() -> String {
    changed(FOUR_BAR, |m| {
        for (body, length) in [("crank", 0.1), ("rocker", 0.25)] {
            m["bodies"][body] = json!({ "length": length, "mass": 0.5, "shape": "uniform_rod" });
        }
        m["start"]["speed"] = json!(25);
    })
}

/// Present sizes of all loads.
fn sizes(run: &mut Run) -> Vec<f64> {
    let reduced = run.reduced().unwrap().clone();
    let inputs: Vec<f64> = reduced.loading().inputs.iter().map(|name| run.get(name)).collect();
    reduced.sizes(&inputs)
}

/// A mechanism in both formulations.
struct Both {
    run: Run,
    linkage: Linkage,
    fem: RigidFem,
    state: State,
    scratch: Scratch,
    sizes: Vec<f64>,
    h_fem: f64,
    lost: f64,
}

impl Both {
    /// With E A times `factor`; the start with the static stretch or let go of without it.
    fn started(text: &str, factor: f64, h_fem: f64, stretched: bool) -> Self {
        let mechanism = Mechanism::from_json(text).unwrap();
        let mut run = Run::new(text).with(&[("solver.tolerance", 1e-13)]).started();
        let reduced = run.reduced().unwrap().clone();
        let linkage = reduced.linkage().clone();
        let fem = RigidFem::new(&linkage, reduced.loading(), &|body| factor * stiffness(&linkage, body)).unwrap();
        let start = &mechanism.start;
        let body = start.body.as_deref().unwrap();
        let coordinate = linkage.bodies[linkage.carrier(&mechanism, body).unwrap().0].angle_coordinate.unwrap();
        let (sigma, revolutions) = reduced.find(coordinate, start.angle.unwrap(), body).unwrap();
        let c = reduced.curve().configuration(sigma);
        let q: Vec<f64> = c.q.iter().enumerate().map(|(i, q)| q + revolutions * reduced.curve().growth(i)).collect();
        let q_dot: Vec<f64> = c.q_sigma.iter().map(|slope| slope * start.speed / c.q_sigma[coordinate]).collect();
        let (mut scratch, sizes) = (fem.scratch(), sizes(&mut run));
        let state = if stretched {
            fem.start(&linkage, &q, &q_dot, &sizes).unwrap()
        } else {
            let mut state = fem.unstretched(&linkage, &q, &q_dot);
            fem.rebalance(&mut state, &mut scratch, &sizes, 1e-8).unwrap();
            state
        };
        Self { run, linkage, fem, state, scratch, sizes, h_fem, lost: 0.0 }
    }

    fn new(text: &str, factor: f64, h_fem: f64) -> Self {
        Self::started(text, factor, h_fem, true)
    }

    /// Steps of the finite elements only.
    fn fem_step(&mut self, h: f64) -> Result<(), RigidFemError> {
        self.lost += self.fem.advance(&mut self.state, &mut self.scratch, &self.sizes, h, self.h_fem)?;
        Ok(())
    }

    /// A step of both.
    fn step(&mut self, h: f64) {
        self.fem_step(h).unwrap();
        self.run.step(h);
    }

    fn get(&mut self, name: &str) -> f64 {
        self.run.get(name)
    }

    fn steps(&mut self, count: u32, h: f64) {
        (0..count).for_each(|_| self.step(h));
    }

    /// Set inputs of both.
    fn set(&mut self, values: &[(&str, f64)]) {
        self.run.set_all(values);
        self.sizes = sizes(&mut self.run);
        self.fem.rebalance(&mut self.state, &mut self.scratch, &self.sizes, self.h_fem).unwrap();
    }

    fn body(&self, name: &str) -> usize {
        self.linkage.bodies.iter().position(|b| b.name == name).unwrap()
    }

    fn crank(&self) -> f64 {
        self.fem.angle(&self.state, self.body("crank"), 0)
    }

    fn energy(&self) -> f64 {
        self.fem.energy(&self.state, &self.sizes)
    }

    fn reactions(&mut self) -> Vec<Reaction> {
        let mut out = vec![Reaction::default(); self.linkage.joints.len()];
        self.fem.reactions(&self.state, &self.state, &mut self.scratch, &self.sizes, 0.0, &mut out);
        out
    }

    /// Largest difference of forces after each of these steps, as a part of the largest force.
    fn largest_share(&mut self, count: u32, h: f64) -> f64 {
        (0..count).fold(0.0, |worst: f64, _| {
            self.step(h);
            let largest = self.reactions().iter().map(|r| r.force.norm()).fold(0.0, f64::max);
            worst.max(self.differences()[3] / largest)
        })
    }

    /// Largest difference of angle [rad], speed [rad/s] and acceleration [rad/s2] of all bodies, and of forces [N].
    fn differences(&mut self) -> [f64; 4] {
        let mut worst = [0.0f64; 4];
        for body in 1..self.linkage.bodies.len() {
            let (fem, state, name) = (&self.fem, &self.state, self.linkage.bodies[body].name.clone());
            let own = [0, 1, 2].map(|order| fem.angle(state, body, order));
            for (k, quantity) in ["angle", "speed", "acceleration"].into_iter().enumerate() {
                worst[k] = worst[k].max((own[k] - self.get(&format!("{name}.{quantity}"))).abs());
            }
        }
        for (joint, reaction) in self.reactions().iter().enumerate() {
            let name = self.linkage.joints[joint].name.clone();
            let (x, y) = (self.get(&format!("{name}.force_x")), self.get(&format!("{name}.force_y")));
            worst[3] = worst[3].max((reaction.force.x - x).hypot(reaction.force.y - y));
        }
        worst
    }
}

/// theta2 of scene S1 at 0.05, 0.10 and 0.13 s [rad].
fn gear_angles(factor: f64, h: f64) -> [f64; 3] {
    let mut gear = Both::new(GEAR, factor, h);
    [0.05, 0.05, 0.03].map(|span| {
        gear.fem_step(span).unwrap();
        gear.crank()
    })
}

/// The limit h -> 0 of a second-order sequence, from steps h and h / 2.
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
        // The next term of the error is smaller by some (h omega)^2 with a rod's omega of 2e3 to 3e4 /s.
        let allowed = if h > 3e-4 { 0.1 } else { 0.02 };
        for k in 0..3 {
            let order = (last[k] / error[k]).ln() / (h_before / h).ln();
            assert!((order - 2.0).abs() < allowed, "h = {h:e}, time {k}: order {order}, error {:e}", error[k]);
        }
    }
}

#[test]
fn the_error_left_at_small_steps_is_the_rods_strain() {
    // Against the rigid reference the error falls to the elastic limit, within the error of the steps.
    for (h, own) in [(1e-3, 4e2), (1e-4, 4e2), (1e-5, 4e2)] {
        let error = gear_angles(1.0, h)[2] - THETA_013;
        assert!((error - ELASTIC_LIMIT).abs() < own * h * h + 1e-9, "h = {h:e}: {error:e}");
    }
    // And the limit is proportional to 1 / (E A): the next term is smaller by the strain of 1e-4.
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
fn accelerations_and_forces_are_those_of_the_reduced_model() {
    // Moving, so that terms with the speed are seen: none is missing, else the differences would not fall.
    let text = changed(GEAR, |m| m["start"] = json!({ "body": "crank", "angle": 0.3, "speed": -12 }));
    let mut last = [f64::INFINITY; 4];
    for factor in [1.0, 10.0, 100.0, 1000.0] {
        let differences = Both::new(&text, factor, 1e-6).differences();
        for k in 0..4 {
            assert!(differences[k] < 0.11 * last[k], "{factor}, {k}: {:e} after {:e}", differences[k], last[k]);
        }
        last = differences;
    }
    // Some 1e3 rad/s2 and 1e5 N.
    assert!(last[2] < 1e-4 && last[3] < 1e-1, "{last:?}");
}

#[test]
fn all_loads_of_the_gear_act_alike_in_both() {
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
    // The elastic limit, 1.4e-4 / 100, and the step's error, 3e2 h^2.
    assert!(worst[0] < 1e-5 && worst[1] < 1e-6, "{worst:?}");
}

#[test]
fn each_load_alone_accelerates_both_alike() {
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
        // The elastic error is below 1e-9, rounding in the rods' forces is E A 1e-16 / l = 0.1 N: 3e-6 of the force.
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
    // By the stretch, some 1e-4 and ten times that near the toggle.
    assert!(shares[0] < 2e-3 && shares[1] < 2e-5, "{shares:?}");
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
    // Of 8.5 kJ; rounding adds E A L times some 1e-16 a step.
    assert!((coarse / fine - 100.0).abs() < 5.0 && (fine / finest - 100.0).abs() < 5.0);
    assert!(finest < 1e-5);
}

#[test]
fn a_chain_of_four_bars_and_a_turning_crank_follow_too() {
    let mut chain = Both::new(CHAIN, 1.0, 2e-5);
    chain.steps(60, 1e-2);
    let [angle, speed, ..] = chain.differences();
    assert!(angle < 1e-6 && speed < 1e-5, "{angle:e} {speed:e}");
    // Joints where three bodies meet: before it moves on, all forces.
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
    // A sixth rod across both parallelograms: balance alone no longer determines the rods' forces.
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

#[test]
fn a_jump_of_an_input_is_taken_up() {
    // The motion of the rigid links changes at once; vibrations faster than the step are not set off.
    let mut gear = Both::new(GEAR, 1.0, 1e-3);
    gear.set(&[("actuator.force", 20_000.0)]);
    let (fem, reduced) = (gear.fem.angle(&gear.state, gear.body("crank"), 2), gear.get("crank.acceleration"));
    // The filter's part (h omega / 2)^-2 of the jump of 70 rad/s2, for the slowest of the rods, 2e4 /s.
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
    // Second order, but for the vibration that the jump sets off in the rods: some 1e-7 rad.
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
    // 1e-3 s is divided into 4 steps if none may be longer than 3e-4 s.
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
fn a_refused_step_changes_nothing() {
    let mut gear = Both::new(GEAR, 1.0, 1e-3);
    let before = gear.state.clone();
    for (h, h_fem) in [(0.0, 1e-3), (f64::NAN, 1e-3), (1e-3, -1.0), (1e-3, f64::INFINITY)] {
        let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &gear.sizes, h, h_fem).unwrap_err();
        assert!(matches!(error, RigidFemError::StepSize { .. }), "{error}");
    }
    let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &gear.sizes, 1.0, 1e-300).unwrap_err();
    assert!(error.to_string().contains("raise h_fem"), "{error}");
    for sizes in [vec![1e300; 7], vec![f64::NAN; 7]] {
        let error = gear.fem.advance(&mut gear.state, &mut gear.scratch, &sizes, 1e-2, 1e-3).unwrap_err();
        assert!(error.to_string().contains("smaller step"), "{error}");
        assert!(gear.fem.rebalance(&mut gear.state, &mut gear.scratch, &[f64::NAN; 7], 1e-3).is_err());
    }
    assert_eq!(gear.state, before);
}

#[test]
fn vibration_that_grows_is_an_error_not_a_motion() {
    // Up and down at 30 rad/s through the toggles, at steps of thirty times a rod's radian.
    let text = changed(GEAR, |m| m["actuators"]["actuator"]["force"] = json!(20_000));
    let mut gear = Both::new(&text, 1.0, 2e-3);
    let start = gear.energy();
    let error = (0..200).find_map(|_| gear.fem_step(1e-2).err()).unwrap();
    assert!(matches!(error, RigidFemError::Strain { limit: 1e-2, .. }), "{error}");
    // Before the error, it is no more than the energy of this strain, E A L 1e-4 / 2, in each rod.
    let most: f64 = [(2.1e9, 0.1755), (8.9376e7, 0.217), (3.0492e8, 0.34)].iter().map(|(ea, l)| ea * l * 5e-5).sum();
    assert!((gear.energy() - start).abs() < 2.0 * most, "{} J of {most} J", gear.energy() - start);
}

#[test]
fn bodies_that_are_no_binary_link_are_refused_by_name() {
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
    assert_says(&error, &["drive", "0.9", "set it to 1"]);
    // The crank and the rocker of the shipped four-bar weigh nothing: its coupler's stretch would move no mass.
    let reduced = Run::new(FOUR_BAR).reduced().unwrap().clone();
    let fem = RigidFem::new(reduced.linkage(), reduced.loading(), &|_| 1e9).unwrap();
    let c = reduced.curve().configuration(0.0);
    let error = fem.start(reduced.linkage(), &c.q, &c.q_sigma, &[0.0; 8]).unwrap_err();
    assert!(matches!(&error, RigidFemError::Massless { mass: 0.0, .. }), "{error}");
    assert_says(&error, &["give", "a mass"]);
}
