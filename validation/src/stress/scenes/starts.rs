//! Starts at singular or rejected positions: toggles, stops, intersections of branches.
use crate::stress::case::{CHAIN, Case, GEAR, MECHANISMS, Mechanism};
use crate::stress::plan::Plan;
use crate::stress::reference::TABLE;
use crate::stress::scene::{Expected, Scene};
use std::f64::consts::PI;

const GROUND: f64 = 0.5729;
const CRANK: f64 = 0.1755;
const COUPLER: f64 = 0.217;
const FOLLOWER: f64 = 0.34;

/// The gear's crank angle with coupler and follower in line: c^2 = a^2 + b^2 - 2 a b cos(angle), with c their sum.
pub fn toggle() -> f64 {
    let together = COUPLER + FOLLOWER;
    ((GROUND * GROUND + CRANK * CRANK - together * together) / (2.0 * GROUND * CRANK)).acos()
}

/// Height of the joint C above the line B-D, and the angles of coupler and follower, at a crank angle on the gear's
/// branch.
fn closed(crank: f64) -> (f64, f64, f64) {
    let (x, y) = (CRANK * crank.cos() - GROUND, CRANK * crank.sin());
    let across = x.hypot(y);
    let along = (across * across + FOLLOWER * FOLLOWER - COUPLER * COUPLER) / (2.0 * across);
    let height = (FOLLOWER * FOLLOWER - along * along).max(0.0).sqrt();
    let (u, v) = (x / across, y / across);
    // C is to the left of B -> D, so to the right of D -> B.
    let c = [along * u + height * v, along * v - height * u];
    (height, (c[1] - y).atan2(c[0] - x), c[1].atan2(c[0]))
}

fn scene(group: &'static str, what: String, case: Case, plan: (f64, u64), expected: Expected) -> Scene {
    let plan = Plan::steady(plan.0, plan.1);
    Scene { group, what, case, plan, tolerance: 1e-12, expected }
}

/// The text with another start.
fn starting(m: &Mechanism, start: &str) -> String {
    let from = m.text.find("\"start\": {").unwrap_or(0);
    let to = m.text[from..].find('}').map_or(m.text.len(), |n| from + n + 1);
    format!("{}\"start\": {{ {start} }}{}", &m.text[..from], &m.text[to..])
}

/// The gear at both ends of its crank's range, at and near its toggles; and other bodies at their reversals.
pub fn toggles() -> Vec<Scene> {
    const GROUP: &str = "Starts at a toggle";
    let mut scenes = Vec::new();
    for (side, sign) in [("upper", 1.0), ("lower", -1.0)] {
        for inside in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3] {
            let crank = sign * (toggle() - inside);
            let at = Case::of(GEAR).free().with("crank.start_angle", crank);
            let what = format!("{inside:e} rad within the {side} toggle");
            scenes.push(scene(GROUP, what, at.clone(), (0.2, 200), Expected::Energy));
            // The same position by the follower, which turns uniformly there: an error d of the crank's angle is an
            // error of l1 l2 sin(theta2) d in half the square of B-D, and for height h one of a d / h in the height.
            let (height, coupler, follower) = closed(crank);
            let error = 8.0 * f64::EPSILON * FOLLOWER;
            let apart = (2.0 * error / FOLLOWER).sqrt().min(error / height.max(f64::MIN_POSITIVE)) * 2.0;
            let text = starting(GEAR, &format!("\"body\": \"follower\", \"angle\": {follower:?}"));
            let old = "\"crank\": 0.8, \"coupler\": 0.46, \"follower\": 2.43";
            let guess = format!("\"crank\": {crank:?}, \"coupler\": {coupler:?}, \"follower\": {follower:?}");
            let other =
                Case::of(GEAR).text(text.replace(old, &guess).replace("\"flag\"", "\"enabled\": false, \"flag\""));
            let same = Expected::Same { case: Box::new(other), body: "follower", apart };
            let what = format!("{inside:e} rad within the {side} toggle, or by the follower");
            scenes.push(scene(GROUP, what, at, (0.05, 50), same));
        }
        let beyond = |by: f64| Case::of(GEAR).free().with("crank.start_angle", sign * (toggle() + by));
        let what = format!("1e-12 rad beyond the {side} toggle");
        scenes.push(scene(GROUP, what, beyond(1e-12), (0.2, 200), Expected::Energy));
        let refused = Expected::refusal(&["crank.start_angle", "1.32"]);
        scenes.push(scene(GROUP, format!("1e-8 rad beyond the {side} toggle"), beyond(1e-8), (0.2, 200), refused));
        let fast = beyond(0.0).with("crank.start_speed", 1.0);
        let refused = Expected::refusal(&["crank.start_speed = 1", "dead centre"]);
        scenes.push(scene(GROUP, format!("a crank speed stated at the {side} toggle"), fast, (0.2, 200), refused));
    }
    // The jib of the crane, |E - B| = 11.5 + 3: -2.5 cos + 5 sin = (16^2 + 31.25 - 14.5^2) / 32.
    let jib = ((256.0 + 31.25 - 210.25) / 32.0 / 31.25_f64.sqrt()).asin() + 2.5_f64.atan2(5.0);
    // The four-bar's rocker where crank and coupler are in line: |S - B| = 0.35 + 0.1 or 0.35 - 0.1.
    let rocker = |reach: f64| ((reach * reach - 0.3 * 0.3 - 0.25 * 0.25) / (2.0 * 0.3 * 0.25)).acos();
    let body = |body: &str, angle: f64| format!("\"body\": \"{body}\", \"angle\": {angle:?}");
    let joint = |joint: &str, position: f64| format!("\"joint\": \"{joint}\", \"position\": {position:?}");
    let ends = [
        ("CraneJib", body("jib", jib), "jib, connector and beak in line"),
        ("CraneJib", body("jib", jib + 1e-12), "jib, 1e-12 rad from there"),
        ("CraneJib", body("jib", jib - 1e-12), "jib, 1e-12 rad from there"),
        ("FourBar", body("rocker", rocker(0.45)), "rocker, crank and coupler in line"),
        ("FourBar", body("rocker", rocker(0.25)), "rocker, crank and coupler folded"),
        ("SliderCrank", joint("cylinder", 0.25), "piston, top dead centre"),
        ("SliderCrank", joint("cylinder", 0.249_999_999_999), "piston, 1e-12 m below it"),
        ("SliderCrank", joint("cylinder", 0.15), "piston, bottom dead centre"),
        ("SlCrank", joint("slide", 1.5), "slider, outer dead centre"),
        ("SlCrank", joint("slide", 1.499_999_999_999), "slider, 1e-12 m within it"),
        ("SlCrank", joint("slide", 0.5), "slider, inner dead centre"),
    ];
    for (name, start, what) in ends {
        for m in MECHANISMS.iter().filter(|m| m.name == name) {
            let case = Case::of(m).text(starting(m, &start));
            scenes.push(scene(GROUP, what.into(), case, (m.span, m.steps), Expected::Energy));
        }
    }
    scenes
}

/// The gear at its stops.
pub fn stops() -> Vec<Scene> {
    const GROUP: &str = "Starts at a stop";
    let mut scenes = Vec::new();
    for (stop, angle, inward, press) in [("upstop", -1.3, 1.0, 30e3), ("downstop", 0.8, -1.0, -30e3)] {
        let at = |by: f64, force: f64| {
            Case::of(GEAR).with("crank.start_angle", angle + inward * by).with("actuator.force", force)
        };
        for by in [0.0, 1e-15, 1e-12, -1e-15, -1e-12] {
            let rests = Expected::closed(
                "crank.angle",
                angle,
                f64::abs(by) + 4.0 * f64::EPSILON * angle.abs() + TABLE,
                0.0,
                "a start within 1e-10 rad of a stop is at it, and pressed on it stays; rounding and table",
            );
            let what = format!("{by:e} rad within the {stop}, pressed on");
            scenes.push(scene(GROUP, what, at(by, press), (1.0, 100), rests));
            let free = Expected::Same {
                case: Box::new(at(by.max(0.0), -press).free()),
                body: "crank",
                apart: by.abs() + 1e-15,
            };
            let what = format!("{by:e} rad within the {stop}, pulled off");
            scenes.push(scene(GROUP, what, at(by, -press), (0.05, 50), free));
        }
        let refused = Expected::refusal(&[&format!("{stop}.angle = {angle}"), "beyond this stop"]);
        scenes.push(scene(GROUP, format!("1e-9 rad beyond the {stop}"), at(-1e-9, press), (1.0, 100), refused));
        for restitution in [0.0, 0.5, 1.0] {
            let case = at(0.3, press).with(format!("{stop}.restitution"), restitution);
            let what = format!("0.3 rad within the {stop}, pressed on, restitution {restitution}");
            scenes.push(scene(GROUP, what, case, (2.0, 2000), Expected::Energy));
        }
    }
    scenes
}

/// Four bars that are flat at 0 and pi, as parallelogram or crossed.
static FLAT: Mechanism = Mechanism {
    name: "Parallelogram",
    text: include_str!("../../../scenes/parallelogram.json"),
    body: "left",
    span: 100.0,
    steps: 1000,
    input: "left.torque",
    slide: None,
    known: &[],
};

/// Positions where two branches intersect.
pub fn crossings() -> Vec<Scene> {
    const GROUP: &str = "Starts at a crossing";
    let mut scenes = Vec::new();
    for flat in [0.0, PI] {
        for by in [0.0, 1e-12, -1e-12, 1e-9] {
            let case = Case::of(CHAIN).with("bar0.start_angle", flat + by);
            let what = format!("bars {by:e} rad from flat at {flat:.2} rad");
            scenes.push(scene(GROUP, what, case, (10.0, 1000), Expected::Angle));
            for speed in [5.0, -1e-6] {
                let turn = speed * FLAT.span;
                let uniform = Expected::closed(
                    "left.angle",
                    flat + by + turn,
                    TABLE * (2.0 + turn.abs()),
                    f64::EPSILON * (1.0 + turn.abs()),
                    "no load, constant inertia: it turns evenly; table and rounding",
                );
                let case = Case::of(&FLAT).with("left.start_angle", flat + by).with("left.start_speed", speed);
                let what = format!("parallelogram {by:e} rad from flat at {flat:.2} rad, {speed} rad/s");
                scenes.push(scene(GROUP, what, case, (FLAT.span, FLAT.steps), uniform));
            }
        }
    }
    let guess =
        FLAT.text.replace("\"left\": 0.5, \"coupler\": 0, \"right\": 0.5", "\"left\": 0, \"coupler\": 0, \"right\": 0");
    let refused = Expected::refusal(&["branches", "away from the crossing"]);
    let what = "guessed flat: no branch is named".into();
    scenes.push(scene(GROUP, what, Case::of(&FLAT).text(guess), (1.0, 10), refused));
    let crossed = FLAT.text.replace("\"coupler\": 0, \"right\": 0.5", "\"coupler\": -0.55, \"right\": -1.05");
    for torque in [0.0, 0.1] {
        let case = Case::of(&FLAT).text(crossed.clone()).with("left.torque", torque);
        let what = format!("crossed bars started flat, torque {torque} N.m");
        scenes.push(scene(GROUP, what, case, (10.0, 1000), Expected::Energy));
    }
    scenes
}
