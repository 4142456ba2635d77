//! Masses, lengths and forces from a millionth to a million times their size, and bodies of very unlike masses.
use crate::stress::StateLoads;
use crate::stress::case::{Case, MECHANISMS, Scaling};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::Expected;
use linkage_fmu::variables::{Unit, Value};

/// Every mechanism in other units: the same angles must come out at times that are multiplied alike.
pub fn units() -> Vec<StateLoads> {
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
                scenes.push(StateLoads {
                    group: "Sizes",
                    what: format!("{what} x {s:e}"),
                    case: Case::of(m).scaled(scaling),
                    plan: Plan::new(m.span * scaling.time, Cut::Equal(1), Force::Stated),
                    tolerance: 1e-13,
                    expected: Expected::Angle,
                });
            }
        }
    }
    scenes
}

/// Bodies that stand still somewhere in the motion: a billion times as heavy as the rest, they leave a billionth of the
/// reduced inertia there. sigma then passes a place of 1e-9 of its length, which rounding resolves to 1e-7: no table.
const STILL: [(&str, &str, f64); 17] = [
    ("AndrewsSqueezer", "K2.inertia", 1e9),
    ("AndrewsSqueezer", "K3.mass", 1e9),
    ("AndrewsSqueezer", "K3.inertia", 1e9),
    ("AndrewsSqueezer", "K4.mass", 1e9),
    ("AndrewsSqueezer", "K4.inertia", 1e9),
    ("AndrewsSqueezer", "K5.mass", 1e9),
    ("AndrewsSqueezer", "K5.inertia", 1e9),
    ("AndrewsSqueezer", "K6.mass", 1e9),
    ("AndrewsSqueezer", "K6.inertia", 1e9),
    ("AndrewsSqueezer", "K7.mass", 1e9),
    ("AndrewsSqueezer", "K7.inertia", 1e9),
    ("CraneJib", "beak.inertia", 1e9),
    ("FourBar", "coupler.inertia", 1e9),
    ("SlCrank", "rod.inertia", 1e9),
    ("SlCrank", "slider.mass", 1e9),
    ("SliderCrank", "piston.mass", 1e9),
    ("SliderCrank", "crank.inertia", 1e-9),
];

/// One body of every mechanism a million and a billion times as heavy, or light, as stated.
pub fn mass_ratios() -> Vec<StateLoads> {
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
                // The beak and the coupler have a mass and an inertia: without the one the other stands still.
                let alone =
                    matches!(m.name, "CraneJib" | "FourBar") && parameter.name.ends_with("mass") && factor == 1e-9;
                let still = alone || STILL.contains(&(m.name, &parameter.name, factor));
                scenes.push(StateLoads {
                    group: "Mass ratios",
                    what: format!("{} x {factor:e}", parameter.name),
                    case: Case::of(m).with(parameter.name.clone(), factor * stated),
                    plan: Plan::new(m.span, Cut::Equal(m.steps), Force::Stated),
                    tolerance: 1e-9,
                    expected: if still {
                        Expected::refusal(&["almost nothing with mass moves there"])
                    } else {
                        Expected::Angle
                    },
                });
            }
        }
    }
    scenes
}
