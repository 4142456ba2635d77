//! Masses, lengths and forces from a millionth to a million times their size, and bodies of very unlike masses.
use crate::stress::Scene;
use crate::stress::case::{Case, MECHANISMS, Scaling};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::Expected;
use linkage_fmu::variables::Unit;

/// Every mechanism in other units: the same angles must come out at times that are multiplied alike.
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
                scenes.push(Scene {
                    group: "Sizes",
                    what: format!("{what} x {s:e}"),
                    case: Case::of(m).scaled(scaling),
                    plan: Plan::new(m.span * scaling.time, Cut::Equal(m.steps), Force::Stated),
                    tolerance: 1e-9,
                    expected: Expected::Angle,
                });
            }
        }
    }
    scenes
}

/// One body of every mechanism a billion times as heavy, or lighter, than stated.
pub fn mass_ratios() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let Ok(model) = Case::of(m).model(1e-9) else { continue };
        let inert = |unit| matches!(unit, Some(Unit::Kilogram | Unit::KilogramSquareMetre));
        let parameters = model.variables().list().iter().filter(|v| inert(v.unit));
        for parameter in parameters {
            let Some(linkage_fmu::variables::Value::Real(stated)) = parameter.start else { continue };
            for factor in [1e-9, 1e9] {
                scenes.push(Scene {
                    group: "Mass ratios",
                    what: format!("{} x {factor:e}", parameter.name),
                    case: Case::of(m).with(parameter.name.clone(), factor * stated),
                    plan: Plan::new(m.span, Cut::Equal(m.steps), Force::Stated),
                    tolerance: 1e-9,
                    expected: Expected::Angle,
                });
            }
        }
    }
    scenes
}
