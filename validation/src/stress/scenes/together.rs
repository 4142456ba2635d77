//! Friction, drag, stops, bumpers and drives with losses combined.
use crate::stress::case::{Case, GEAR, MECHANISMS, Scaling, get};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::{Expected, Scene};

const GROUP: &str = "Everything at once";

/// The gear with friction and wind.
fn loaded() -> Case {
    Case::of(GEAR).turned("friction.enabled", true).turned("air.relative_wind", true).with("airspeed", 70.0)
}

/// The gear's retraction with all of these, also in other units; the drives of other mechanisms with losses.
pub fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    let mut add = |what: String, case: Case, plan: Plan, tolerance: f64, expected: Expected| {
        scenes.push(Scene { group: GROUP, what, case, plan, tolerance, expected });
    };
    let bumper =
        |case: Case| case.turned("upstop.rigid", false).with("upstop.stiffness", 5e6).with("upstop.damping", 1e3);
    let bounce = |case: Case| case.with("upstop.restitution", 0.5);
    let cases = [
        ("a rigid stop", loaded(), 0.2),
        ("a stop of restitution 0.5", bounce(loaded()), 0.2),
        ("a bumper", bumper(loaded()), 0.2),
    ];
    for (what, case, span) in cases {
        for scaling in [
            Scaling::ONE,
            Scaling { time: 1e-3, ..Scaling::ONE },
            Scaling { time: 1e3, ..Scaling::ONE },
            Scaling { time: 1e6, ..Scaling::ONE },
            Scaling { length: 1e-6, ..Scaling::ONE },
            Scaling { length: 1e6, ..Scaling::ONE },
            Scaling { mass: 1e-6, ..Scaling::ONE },
            Scaling { mass: 1e6, ..Scaling::ONE },
        ] {
            let Scaling { mass, length, time } = scaling;
            let plan = Plan::steady(span * time, 200);
            let what = format!("friction, drag and {what}; masses x {mass:e}, lengths x {length:e}, times x {time:e}");
            add(what, case.clone().scaled(scaling), plan, 1e-9, Expected::Angle);
        }
        for (cut, name) in [
            (Cut::Irregular(1000), "irregular"),
            (Cut::Ulps(1000), "ulp after each of 1000"),
            (Cut::Turns(1000), "1 us and long"),
        ] {
            let plan = Plan::new(span, cut, Force::Stated);
            add(format!("friction, drag and {what}; steps: {name}"), case.clone(), plan, 1e-9, Expected::Angle);
        }
        for (force, name) in [(Force::Switching, "switches"), (Force::Noise(1.0), "with noise")] {
            for border in [1e-2, 1e-6] {
                let case = case.clone().with("friction.static_speed", border);
                let plan = Plan::new(2.0, Cut::Equal(2000), force);
                let what = format!("friction, drag and {what}; actuator.force {name}, V_S = {border:e} m/s");
                add(what, case, plan, 1e-9, Expected::Energy);
            }
        }
    }
    for m in MECHANISMS.iter().filter(|m| m.text.contains("\"efficiency\"")) {
        for efficiency in [0.9, 0.1, 1e-3] {
            for force in [Force::Stated, Force::Switching, Force::Noise(2.0)] {
                let drive = m.input.split('.').next().unwrap_or_default();
                let case = Case::of(m).with(format!("{drive}.efficiency"), efficiency);
                let plan = Plan::new(m.span, Cut::Equal(m.steps), force);
                let what = format!("efficiency {efficiency}, {} {}", m.input, force.word());
                add(what, case, plan, 1e-9, Expected::Energy);
            }
        }
    }
    // Regularised dry friction creeps below V_S: the gear with a hundredth less than the holding force.
    let rest = Case::of(GEAR).turned("friction.enabled", true).with("crank.start_angle", 0.0);
    let rest = rest.with("friction.static_coefficient", 1.0);
    let holding = rest.model(1e-9).and_then(|mut model| get(&mut model, "actuator.holding_force")).unwrap_or_default();
    for (border, seconds) in [(1e-2, 10.0), (1e-4, 1e3), (1e-6, 1e5)] {
        let case = rest.clone().with("friction.static_speed", border).with("actuator.force", 0.99 * holding);
        for steps in [1, 1000] {
            let plan = Plan::steady(seconds, steps);
            let what = format!("creep, V_S = {border:e} m/s, {seconds} s in {}", super::count(steps));
            // Angles at 1e-6 only: the reference, at 1e-9, has the tightest tolerance for which rounding near rest
            // costs few steps.
            add(what.clone(), case.clone(), plan.clone(), 1e-6, Expected::Angle);
            // The reference energies are sampled during the motion only.
            if steps > 1 {
                add(what, case.clone(), plan, 1e-9, Expected::Energy);
            }
        }
    }
    // At rest in equilibrium the rounding error exceeds the allowed error of a long step: many short steps follow.
    let case = rest.with("friction.static_speed", 1e-4).with("actuator.force", 0.99 * holding);
    let plan = Plan::steady(200.0, 200);
    add("creep to rest, V_S = 1e-4 m/s, 200 s in 200 steps".into(), case, plan, 1e-12, Expected::Energy);
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let case =
            Case::of(GEAR).turned("upstop.rigid", false).with("upstop.stiffness", 5e6).with("upstop.damping", 5e4);
        let plan = Plan::steady(0.5, 50);
        add("at rest on a damped bumper, 0.5 s in 50 steps".into(), case, plan, tolerance, Expected::Energy);
    }
    scenes
}
