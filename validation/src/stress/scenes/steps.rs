//! Tolerances and communication steps.
use crate::stress::StateLoads;
use crate::stress::case::{Case, MECHANISMS};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::scene::Expected;

/// Every mechanism at every power of ten, in one step and in those of its default experiment.
pub fn tolerances() -> Vec<StateLoads> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        for (exponent, steps) in (2..=13).flat_map(|exponent| [(exponent, 1), (exponent, m.steps)]) {
            scenes.push(StateLoads {
                group: "Tolerances",
                what: format!("{} s in {}", m.span, super::count(steps)),
                case: Case::of(m),
                plan: Plan::new(m.span, Cut::Equal(steps), Force::Stated),
                tolerance: 10f64.powi(-exponent),
                expected: Expected::Angle,
            });
        }
    }
    scenes
}

/// Every mechanism in steps of 1 us to 1 s, irregular ones, and steps one unit in the last place of the time.
pub fn communication() -> Vec<StateLoads> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let mut add = |what: String, span: f64, cut: Cut| {
            scenes.push(StateLoads {
                group: "Communication steps",
                what,
                case: Case::of(m),
                plan: Plan::new(span, cut, Force::Stated),
                tolerance: 1e-9,
                expected: Expected::Angle,
            });
        };
        for h in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
            let count = (m.span / h).round().max(1.0);
            // The span is kept where whole steps fill it.
            let span = if (count * h - m.span).abs() < 1e-12 { m.span } else { count * h };
            add(format!("{} of {h:e} s", super::count(count as u64)), span, Cut::Equal(count as u64));
        }
        add("1000 irregular steps, over six decades".into(), m.span, Cut::Irregular(1000));
        add("1000 steps of 1 us and 1000 long ones by turns".into(), m.span, Cut::Turns(1000));
        add("1000 steps, each followed by one of an ulp".into(), m.span, Cut::Ulps(1000));
    }
    scenes
}
