//! Inputs that change in every step, and very large ones; friction with an almost discontinuous transition to rest, and
//! with coefficients near self-locking.
use crate::stress::case::{Case, GEAR, JIB, MECHANISMS, Mechanism};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::reference::TABLE;
use crate::stress::scene::{Expected, Scene};
use linkage_fmu::variables::Value;

/// A mechanism; the gear without its stops.
fn unstopped(m: &'static Mechanism) -> Case {
    if m.name == GEAR.name { Case::of(m).free() } else { Case::of(m) }
}

/// Every mechanism with an input whose sign alternates every step or that is random in every step; the gear without its
/// stops.
pub fn changing() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let inputs = [
            ("switches its sign", Force::Switching),
            ("with noise of a half of it", Force::Noise(0.5)),
            ("with noise of 1000 times it", Force::Noise(1e3)),
        ];
        for (what, force) in inputs {
            for (steps, tolerance) in [(m.steps, 1e-6), (m.steps, 1e-11), (100 * m.steps, 1e-9)] {
                // The gear's crank angle determines the position between the toggles only.
                let wild = m.name == GEAR.name && force == Force::Noise(1e3);
                let expected = if wild { Expected::Energy } else { Expected::Angle };
                let (case, plan) = (unstopped(m), Plan::new(m.span, Cut::Equal(steps), force));
                let what = format!("{} {what} in each of {steps} steps", m.input);
                scenes.push(Scene { group: "Changing inputs", what, case, plan, tolerance, expected });
            }
        }
    }
    scenes
}

/// Every mechanism with an input of 1e9 N or N.m, for about the time in which it moves as far as with the default
/// input, and for a hundred times that; and absurdly large numbers.
pub fn huge() -> Vec<Scene> {
    const GROUP: &str = "Huge inputs";
    let mut scenes = Vec::new();
    for m in &MECHANISMS {
        let Ok(model) = Case::of(m).model(1e-9) else { continue };
        let input = model.variables().list().iter().find(|v| v.name == m.input);
        let Some(&Value::Real(stated)) = input.and_then(|v| v.start.as_ref()) else { continue };
        let mut add = |what: String, value: f64, span: f64, steps: u64, expected: Expected| {
            let (case, plan) = (unstopped(m).with(m.input, value), Plan::steady(span, steps));
            scenes.push(Scene { group: GROUP, what, case, plan, tolerance: 1e-9, expected });
        };
        let span = m.span * (stated.abs() / 1e9).sqrt();
        for (span, steps, expected) in
            [(span, 1, Expected::Angle), (span, 100, Expected::Angle), (100.0 * span, 1000, Expected::Energy)]
        {
            add(format!("{} = 1e9, {span:.1e} s in {}", m.input, super::count(steps)), 1e9, span, steps, expected);
        }
        add(format!("{} = 1e308", m.input), 1e308, 1e-3, 1, Expected::refusal(&["check the values", "inputs"]));
    }
    let held = Expected::closed("crank.angle", -1.3, 1e-13, 0.0, "caught by the upstop: table");
    let plan = Plan::steady(2e-3, 200);
    let case = Case::of(GEAR).with(GEAR.input, 1e9);
    let what = "actuator.force = 1e9 against the upstop".into();
    scenes.push(Scene { group: GROUP, what, case, plan, tolerance: 1e-9, expected: held });
    scenes
}

/// The gear's retraction with friction; V_S from 1e-6 m/s.
pub fn slow_border() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for border in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1] {
        for (steps, tolerance) in [(1, 1e-6), (130, 1e-6), (1, 1e-9), (130, 1e-9), (13_000, 1e-9)] {
            let case = Case::of(GEAR).turned("friction.enabled", true).with("friction.static_speed", border);
            let what = format!("V_S = {border:e} m/s, 0.13 s in {}", super::count(steps));
            let (plan, expected) = (Plan::steady(0.13, steps), Expected::Angle);
            scenes.push(Scene { group: "Friction", what, case, plan, tolerance, expected });
        }
    }
    scenes
}

/// The jib in a plane without gravity, its mass m at the distance c, on a pin of radius r with constant mu. The pin
/// force is m c sqrt(w^4 + a^2), so m c^2 a = -mu r m c sqrt(w^4 + a^2): with k = mu r / c < 1, a = -q w^2, q = k /
/// sqrt(1 - k^2), and theta = ln(1 + q w0 t) / q. With k >= 1 a moving body has no acceleration at all: friction locks.
pub fn self_locking() -> Vec<Scene> {
    const ARM: f64 = 5.0;
    const MU: f64 = 0.5;
    const SPEED: f64 = 10.0;
    const SPAN: f64 = 3.0;
    let mut scenes = Vec::new();
    for k in [0.5, 0.9, 0.99, 0.999, 0.999_999, 1.001, 2.0, 1e3] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let pin = format!("\"second\": \"jib.origin\", \"pin_radius\": {:?} }}", k * ARM / MU);
            let friction = format!(
                "\"friction\": {{ \"enabled\": true, \"static_coefficient\": {MU}, \"kinetic_coefficient\": {MU}, \
                 \"static_speed\": 1e-6, \"kinetic_speed\": 2e-6 }},\n  \"actuators\": {{"
            );
            let text = JIB.text.replace("\"second\": \"jib.origin\" }", &pin).replace("\"actuators\": {", &friction);
            let still = Case::of(JIB).text(text).with("cylinder.force", 0.0).with("load_factor", 0.0);
            let case = still.with("jib.start_angle", 0.0).with("jib.start_speed", SPEED);
            let q = k / f64::sqrt(1.0 - k * k);
            let expected = if k < 1.0 {
                // An error e L of the angle persists; an error e V of the speed, V = w max(1, sqrt(q)), changes the end
                // by at most e V / (q w).
                let gain = 1.0 + q.max(q.sqrt()).max(1.0) / q;
                Expected::closed(
                    "jib.angle",
                    (q * SPEED * SPAN).ln_1p() / q,
                    TABLE * (1.0 + gain / (1.0 - k * k)),
                    2f64.sqrt() * tolerance * gain,
                    format!("sqrt(2) N tol {gain:.1}, rounding / (1 - k^2)"),
                )
            } else {
                Expected::refusal(&[
                    "friction locks the mechanism near jib",
                    "pin radii",
                    "reduce the coefficients or \
                    pin radii",
                ])
            };
            let (what, plan) = (format!("k = mu r / c = {k}"), Plan::steady(SPAN, 30));
            scenes.push(Scene { group: "Self-locking", what, case, plan, tolerance, expected });
        }
    }
    scenes
}
