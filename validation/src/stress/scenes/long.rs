//! Long runs: slow motion, ten thousand passages of toggles, ten million short steps.
use super::starts::toggle;
use crate::stress::case::{Case, GEAR, MECHANISMS, Scaling};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::reference::TABLE;
use crate::stress::scene::{Expected, Scene};
use std::f64::consts::{FRAC_PI_2, PI};

/// Every mechanism so slow that its scene takes 1e6 s, in one step and in steps of 1 s.
pub fn slow() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        for steps in [1, 1_000_000] {
            let case = Case::of(m).scaled(Scaling { time: 1e6 / m.span, ..Scaling::ONE });
            let (what, plan) = (format!("1e6 s in {}", super::count(steps)), Plan::steady(1e6, steps));
            let expected = Expected::Angle;
            scenes.push(Scene { group: "Slow motion", what, case, plan, tolerance: 1e-10, expected });
        }
    }
    scenes
}

/// Reduced inertia of the gear in the crank angle ([HF08], section 2) on its branch [kg m2].
fn inertia(theta2: f64) -> f64 {
    let (l1, l2, l3, l4, l5) = (0.5729f64, 0.1755f64, 0.217f64, 0.34f64, 0.759f64);
    let (m2, m3, m4, m5, m5k) = (13.689, 0.72037056, 3.850704, 36.8, 19.5);
    let (x, y) = (l1 - l2 * theta2.cos(), -l2 * theta2.sin());
    let across = x.hypot(y);
    let theta3 = y.atan2(x) + ((across * across + l3 * l3 - l4 * l4) / (2.0 * across * l3)).acos();
    let c = [l2 * theta2.cos() + l3 * theta3.cos(), l2 * theta2.sin() + l3 * theta3.sin()];
    let theta4 = c[1].atan2(c[0] - l1);
    let k3 = l2 * (theta4 - theta2).sin() / (l3 * (theta3 - theta4).sin());
    let k4 = l2 * (theta2 - theta3).sin() / (l4 * (theta4 - theta3).sin());
    m2 * l2 * l2 / 3.0
        + (m5 / 3.0 + m5k) * l5 * l5
        + m4 * l4 * l4 * k4 * k4 / 3.0
        + m3 * (l2 * l2 + l3 * l3 * k3 * k3 / 3.0 + l2 * l3 * k3 * (theta2 - theta3).cos())
}

/// Time of the coasting gear for its closed curve, through both toggles and back [s], where the crank has the speed
/// `omega` at `theta2`: the integral of sqrt(I) over twice its range, at constant sqrt(I) omega. With theta2 = toggle
/// sin(phi) the integrand is smooth and periodic: the midpoint rule converges geometrically.
fn round_trip(theta2: f64, omega: f64) -> f64 {
    const POINTS: u32 = 4000;
    let step = PI / f64::from(POINTS);
    let value = |i: u32| {
        let phi = -FRAC_PI_2 + (f64::from(i) + 0.5) * step;
        inertia(toggle() * phi.sin()).sqrt() * toggle() * phi.cos()
    };
    2.0 * step * (0..POINTS).map(value).sum::<f64>() / (inertia(theta2).sqrt() * omega.abs())
}

/// 1e4 passages of toggles and dead centres.
pub fn toggles() -> Vec<Scene> {
    const GROUP: &str = "Ten thousand toggles";
    const TURNS: f64 = 5000.0;
    let mut scenes = Vec::new();
    let mut add = |what: String, case: Case, plan: Plan, tolerance: f64, expected: Expected| {
        scenes.push(Scene { group: GROUP, what, case, plan, tolerance, expected });
    };
    for (omega, cut) in [(-20.0, Cut::Equal(1)), (-20.0, Cut::Irregular(20_000)), (2e-3, Cut::Equal(7919))] {
        let still = Case::of(GEAR).free().with("actuator.force", 0.0).with("load_factor", 0.0);
        let case = still.with("crank.start_speed", omega);
        let period = round_trip(0.8, omega);
        // Both methods know the curve's length to the table's accuracy; the errors add up over the turns.
        let turn = period * omega.abs();
        let back = Expected::closed(
            "crank.angle",
            0.8,
            TABLE * (1.0 + 2.0 * TURNS * turn),
            f64::EPSILON * TURNS * turn,
            format!("no load: after 5000 turns of {turn:.3} rad it is back; table each turn, rounding each step"),
        );
        let plan = Plan::new(TURNS * period, cut, Force::Stated);
        add(format!("coasting at {omega} rad/s, in {}", super::count(plan.steps())), case, plan, 1e-9, back);
    }
    for tolerance in [1e-6, 1e-9, 1e-12] {
        // Half an oscillation takes about 0.3 s and passes the lower toggle.
        let (what, plan) = ("swinging under 30 kN for 3000 s in 100000 steps".into(), Plan::steady(3000.0, 100_000));
        add(what, Case::of(GEAR).free(), plan, tolerance, Expected::Energy);
        for m in MECHANISMS.iter().filter(|m| ["SliderCrank", "FourBar", "FourBarChain"].contains(&m.name)) {
            // With its weight as the only load and the default start speed: two dead centres in each turn.
            let turn = if m.name == "FourBarChain" { 1.942_514_922_607_084 } else { 0.5 * m.span };
            let plan = Plan::steady(TURNS * turn, 10_000);
            let case = Case::of(m).with(m.input, if m.name == "FourBarChain" { 1.0 } else { 0.0 });
            add(format!("{:.0} s in 10000 steps", TURNS * turn), case, plan, tolerance, Expected::Energy);
        }
    }
    scenes
}

/// Ten million steps: neither the motion nor its time drifts.
pub fn short_steps() -> Vec<Scene> {
    let scene = |(span, tolerance): (f64, f64)| Scene {
        group: "Ten million steps",
        what: format!("{span} s in 10000000 steps"),
        case: Case::of(GEAR),
        plan: Plan::steady(span, 10_000_000),
        tolerance,
        expected: Expected::Angle,
    };
    [(0.1, 1e-9), (0.1, 1e-12), (0.13, 1e-9)].into_iter().map(scene).collect()
}
