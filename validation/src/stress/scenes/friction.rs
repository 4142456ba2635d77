//! Friction: a border to rest that is almost a jump, and coefficients next to self-locking.
use crate::stress::StateLoads;
use crate::stress::case::{Case, GEAR, JIB};
use crate::stress::plan::{Cut, Force, Plan};
use crate::stress::reference::TABLE;
use crate::stress::scene::Expected;

/// The gear's retraction with friction; V_S from 1e-6 m/s.
pub fn slow_border() -> Vec<StateLoads> {
    let mut scenes = Vec::new();
    for border in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1] {
        for (steps, tolerance) in [(1, 1e-6), (130, 1e-6), (1, 1e-9), (130, 1e-9), (13_000, 1e-9)] {
            let case = Case::of(GEAR).turned("friction.enabled", true).with("friction.static_speed", border);
            scenes.push(StateLoads {
                group: "Friction",
                what: format!("V_S = {border:e} m/s, 0.13 s in {}", super::count(steps)),
                case,
                plan: Plan::new(0.13, Cut::Equal(steps), Force::Stated),
                tolerance,
                expected: Expected::Angle,
            });
        }
    }
    scenes
}

/// The jib in a plane without gravity, its mass m at the distance c, on a pin of radius r with constant mu. The pin bears
/// m c sqrt(w^4 + a^2), so m c^2 a = -mu r m c sqrt(w^4 + a^2): with k = mu r / c < 1 a = -q w^2, q = k / sqrt(1 - k^2), and
/// theta = ln(1 + q w0 t) / q. With k >= 1 a body that moves has no acceleration at all: friction locks.
pub fn self_locking() -> Vec<StateLoads> {
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
            let still =
                [("cylinder.force", 0.0), ("load_factor", 0.0), ("jib.start_angle", 0.0), ("jib.start_speed", SPEED)];
            let case = still.iter().fold(Case::of(JIB).text(text), |case, &(name, value)| case.with(name, value));
            let q = k / f64::sqrt(1.0 - k * k);
            let expected = if k < 1.0 {
                // An error e L of the angle stays; one of e V of the speed, V = w max(1, sqrt(q)), moves the end by at most
                // e V / (q w).
                let gain = 1.0 + q.max(q.sqrt()).max(1.0) / q;
                Expected::Closed {
                    reading: "jib.angle".into(),
                    value: (q * SPEED * SPAN).ln_1p() / q,
                    within: TABLE * (1.0 + gain / (1.0 - k * k)),
                    each: 2f64.sqrt() * tolerance * gain,
                    why: format!("sqrt(2) N tol {gain:.1}, rounding / (1 - k^2)"),
                }
            } else {
                Expected::refusal(&["friction locks the mechanism near jib", "pin radii", "reduce them"])
            };
            scenes.push(StateLoads {
                group: "Self-locking",
                what: format!("k = mu r / c = {k}"),
                case,
                plan: Plan::new(SPAN, Cut::Equal(30), Force::Stated),
                tolerance,
                expected,
            });
        }
    }
    scenes
}
