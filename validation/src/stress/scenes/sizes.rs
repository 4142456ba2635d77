//! Tolerances and communication steps; masses, lengths and forces from a millionth to a million times their defaults,
//! and bodies with very different masses.
use crate::stress::case::{Case, MECHANISMS, Scaling};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::{Expected, Scene};
use linkage_fmu::variables::{Unit, Value};

/// Every mechanism at every power of ten of the tolerance, in one step and in the steps of its default experiment.
pub fn tolerances() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        for (exponent, steps) in (2..=13).flat_map(|exponent| [(exponent, 1), (exponent, m.steps)]) {
            let what = format!("{} s in {}", m.span, super::count(steps));
            let (case, plan, tolerance) = (Case::of(m), Plan::steady(m.span, steps), 10f64.powi(-exponent));
            scenes.push(Scene { group: "Tolerances", what, case, plan, tolerance, expected: Expected::Angle });
        }
    }
    scenes
}

/// Every mechanism in steps of 1 us to 1 s, irregular steps, and steps of one unit in the last place of the time.
pub fn communication() -> Vec<Scene> {
    const GROUP: &str = "Communication steps";
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let mut add = |what: String, span: f64, cut: Cut| {
            let (case, plan, expected) = (Case::of(m), Plan::new(span, cut, Force::Stated), Expected::Angle);
            scenes.push(Scene { group: GROUP, what, case, plan, tolerance: 1e-9, expected });
        };
        for h in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
            let count = (m.span / h).round().max(1.0);
            // The span is unchanged if whole steps fill it.
            let span = if (count * h - m.span).abs() < 1e-12 { m.span } else { count * h };
            add(format!("{} of {h:e} s", super::count(count as u64)), span, Cut::Equal(count as u64));
        }
        add("1000 irregular steps, over six decades".into(), m.span, Cut::Irregular(1000));
        add("1000 steps of 1 us and 1000 long ones by turns".into(), m.span, Cut::Turns(1000));
        add("1000 steps, each followed by one of an ulp".into(), m.span, Cut::Ulps(1000));
    }
    scenes
}

/// Every mechanism in other units: the same angles at scaled times.
pub fn units() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        for s in [1e-6_f64, 1e-3, 1e3, 1e6] {
            let root = s.sqrt();
            let scalings = [
                ("masses and forces together", Scaling { mass: s, length: 1.0, time: 1.0 }),
                ("masses alone", Scaling { mass: s, length: 1.0, time: root }),
                ("lengths alone", Scaling { mass: 1.0, length: s, time: root }),
                ("forces alone", Scaling { mass: 1.0, length: 1.0, time: 1.0 / root }),
                ("masses, lengths and forces together", Scaling { mass: s, length: s, time: root }),
                ("masses times, lengths by", Scaling { mass: s, length: 1.0 / s, time: 1.0 }),
                ("times", Scaling { mass: 1.0, length: 1.0, time: s }),
            ];
            for (what, scaling) in scalings {
                let (what, case) = (format!("{what} x {s:e}"), Case::of(m).scaled(scaling));
                let (plan, expected) = (Plan::steady(m.span * scaling.time, 1), Expected::Angle);
                scenes.push(Scene { group: "Sizes", what, case, plan, tolerance: 1e-13, expected });
            }
        }
    }
    scenes
}

/// Bodies that stand still somewhere in the motion: a billion times as heavy as the others, they leave a billionth of
/// the reduced inertia there. sigma then passes a region of 1e-9 of its length, which rounding resolves to 1e-7: no
/// table.
const STILL: [(&str, &str, f64); 6] = [
    (
        "AndrewsSqueezer",
        "K2.inertia K3.mass K3.inertia K4.mass K4.inertia K5.mass K6.mass K6.inertia K7.mass K7.inertia",
        1e9,
    ),
    ("CraneJib", "beak.inertia", 1e9),
    ("FourBar", "coupler.inertia", 1e9),
    ("SlCrank", "rod.inertia slider.mass", 1e9),
    ("SliderCrank", "piston.mass", 1e9),
    ("SliderCrank", "crank.inertia", 1e-9),
];

/// One body of every mechanism a million and a billion times as heavy, or as light, as its default.
pub fn mass_ratios() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let Ok(model) = Case::of(m).model(1e-9) else { continue };
        for parameter in model.variables().list() {
            let (Some(Unit::Kilogram | Unit::KilogramSquareMetre), Some(Value::Real(stated))) =
                (parameter.unit, &parameter.start)
            else {
                continue;
            };
            for factor in [1e-9, 1e-6, 1e6, 1e9] {
                // The beak and the coupler have a mass and an inertia: without one of them the other stands still.
                let alone =
                    matches!(m.name, "CraneJib" | "FourBar") && parameter.name.ends_with("mass") && factor == 1e-9;
                let name = parameter.name.as_str();
                let stated_still = (STILL.iter())
                    .any(|&(of, names, by)| of == m.name && by == factor && names.split(' ').any(|n| n == name));
                let refused = || Expected::refusal(&["almost no mass moves there"]);
                let expected = if alone || stated_still { refused() } else { Expected::Angle };
                // Without its load the jib oscillates so fast that 3 s take 4e5 steps, eight times `solver.max_steps`.
                let fast = m.name == "Jib" && name == "load.mass" && factor == 1e-9;
                let span = if fast { 0.01 * m.span } else { m.span };
                let (case, plan) = (Case::of(m).with(name, factor * stated), Plan::steady(span, m.steps));
                let what = format!("{name} x {factor:e}");
                scenes.push(Scene { group: "Mass ratios", what, case, plan, tolerance: 1e-9, expected });
            }
        }
    }
    scenes
}
