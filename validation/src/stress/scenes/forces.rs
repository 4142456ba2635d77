//! Inputs that change in every step, and huge ones.
use crate::stress::StateLoads;
use crate::stress::case::{Case, GEAR, MECHANISMS};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::Expected;
use linkage_fmu::variables::Value;

/// Every mechanism with an input that switches its sign in every step, or jumps at random; the gear without its stops.
pub fn changing() -> Vec<StateLoads> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let inputs = [
            ("switches its sign", Force::Switching),
            ("with noise of a half of it", Force::Noise(0.5)),
            ("with noise of 1000 times it", Force::Noise(1e3)),
        ];
        for (what, force) in inputs {
            for (steps, tolerance) in [(m.steps, 1e-6), (m.steps, 1e-11), (100 * m.steps, 1e-9)] {
                let case = if m.name == GEAR.name { Case::of(m).free() } else { Case::of(m) };
                // The gear's crank says where it is between its toggles only.
                let wild = m.name == GEAR.name && force == Force::Noise(1e3);
                scenes.push(StateLoads {
                    group: "Changing inputs",
                    what: format!("{} {what} in each of {steps} steps", m.input),
                    case,
                    plan: Plan::new(m.span, Cut::Equal(steps), force),
                    tolerance,
                    expected: if wild { Expected::Energy } else { Expected::Angle },
                });
            }
        }
    }
    scenes
}

/// Every mechanism under 1e9 N or N.m: as long as it takes to move about as far as under the stated input, and a hundred
/// times as long; and numbers beyond reason.
pub fn huge() -> Vec<StateLoads> {
    const GROUP: &str = "Huge inputs";
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let Ok(model) = Case::of(m).model(1e-9) else { continue };
        let input = model.variables().list().iter().find(|v| v.name == m.input);
        let Some(&Value::Real(stated)) = input.and_then(|v| v.start.as_ref()) else { continue };
        let case = |value: f64| {
            let free = if m.name == GEAR.name { Case::of(m).free() } else { Case::of(m) };
            free.with(m.input, value)
        };
        let span = m.span * (stated.abs() / 1e9).sqrt();
        let mut add = |what: String, case: Case, span: f64, steps: u64, expected: Expected| {
            let plan = Plan::new(span, Cut::Equal(steps), Force::Stated);
            scenes.push(StateLoads { group: GROUP, what, case, plan, tolerance: 1e-9, expected });
        };
        for steps in [1, 100] {
            add(
                format!("{} = 1e9, {span:.1e} s in {}", m.input, super::count(steps)),
                case(1e9),
                span,
                steps,
                Expected::Angle,
            );
        }
        add(
            format!("{} = 1e9, {:.1e} s in 1000 steps", m.input, 100.0 * span),
            case(1e9),
            100.0 * span,
            1000,
            Expected::Energy,
        );
        let refused = Expected::refusal(&["inputs", "sizes"]);
        add(format!("{} = 1e308", m.input), case(1e308), 1e-3, 1, refused);
    }
    let held = Expected::Closed {
        reading: "crank.angle".into(),
        value: -1.3,
        within: 1e-13,
        each: 0.0,
        why: "caught by the upstop: table".into(),
    };
    let plan = Plan::new(2e-3, Cut::Equal(200), Force::Stated);
    let case = Case::of(GEAR).with(GEAR.input, 1e9);
    let what = "actuator.force = 1e9 against the upstop".into();
    scenes.push(StateLoads { group: GROUP, what, case, plan, tolerance: 1e-9, expected: held });
    scenes
}
