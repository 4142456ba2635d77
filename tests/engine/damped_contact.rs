//! Strong damping near events: a block on a slide that leaves a stop, a lock, a bumper, static friction or a drive's
//! losses, and a block thrown towards a stop. The steps are far longer than the decay. References are closed forms.
use crate::support::{Run, TAILGATE, cases};
use serde_json::{Value, json};

const G: f64 = 9.81;
const MU: f64 = 0.3;
const ETA: f64 = 0.8;
/// Allowed error, as a multiple of the tolerance times the relevant distance.
const ALLOWED: f64 = 10.0;
/// Additional allowed error [m]: rounding of a motion of size 1, to which the tolerance of positions refers.
const ROUNDING: f64 = 1e-16;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Stop,
    Lock,
    Bumper,
    Stick,
    Efficiency,
    Thrown,
}

const KINDS: [Kind; 6] = [Kind::Stop, Kind::Lock, Kind::Bumper, Kind::Stick, Kind::Efficiency, Kind::Thrown];

/// A block of 1 kg with damping c [N.s/m] under a force F [N]. It starts at rest at 0, or with the speed v [m/s]
/// towards a stop at the distance d [m].
#[derive(Clone, Copy, Debug)]
struct Case {
    kind: Kind,
    tolerance: f64,
    c: f64,
    force: f64,
    speed: f64,
    distance: f64,
    span: f64,
    steps: u32,
}

impl Case {
    fn definition(&self) -> Value {
        let mut definition = json!({
            "name": "Block",
            "gravity": { "acceleration": G, "up_angle": std::f64::consts::FRAC_PI_2 },
            "bodies": { "ground": {}, "block": { "mass": 1, "inertia": 0.1 } },
            "joints": { "slide": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
            "actuators": { "push": { "joint": "slide", "force": self.force } },
            "springs": { "damper": { "joint": "slide", "damping": self.c } },
            "start": { "joint": "slide", "position": 0, "speed": self.speed },
            "guess": { "slide": 0 },
            "solver": { "tolerance": self.tolerance },
        });
        let stop = json!({ "joint": "slide", "position": 0, "limit": "lower" });
        match self.kind {
            Kind::Stop => definition["stops"]["end"] = stop,
            Kind::Lock => {
                definition["stops"]["end"] = stop;
                definition["locks"] = json!({ "latch": { "stop": "end", "at": "block.origin" } });
            }
            Kind::Bumper => {
                definition["stops"]["end"] = stop;
                definition["stops"]["end"]["rigid"] = json!(false);
                definition["stops"]["end"]["stiffness"] = json!(1e4);
                definition["stops"]["end"]["damping"] = json!(10);
            }
            Kind::Stick => {
                definition["friction"] = json!({
                    "enabled": true, "law": "stick", "static_coefficient": MU, "kinetic_coefficient": MU,
                    "static_speed": 0, "kinetic_speed": 0,
                });
            }
            Kind::Efficiency => definition["actuators"]["push"]["efficiency"] = json!(ETA),
            Kind::Thrown => {
                definition["stops"]["end"] = json!({ "joint": "slide", "position": self.distance, "limit": "upper" });
            }
        }
        definition
    }

    /// Force that moves the block [N].
    fn driving(&self) -> f64 {
        match self.kind {
            Kind::Stick => self.force - MU * G,
            Kind::Efficiency => ETA * self.force,
            _ => self.force,
        }
    }

    /// Position without the stop at a time [m].
    fn free(&self, t: f64) -> f64 {
        let last = self.driving() / self.c;
        last * t - (self.speed - last) * (-self.c * t).exp_m1() / self.c
    }

    /// Time at which the block turns back from a throw [s].
    fn turns(&self) -> f64 {
        let last = self.driving() / self.c;
        ((self.speed - last) / -last).ln() / self.c
    }

    /// Position at the end of the span [m].
    fn exact(&self) -> f64 {
        if self.kind != Kind::Thrown || self.free(self.turns().min(self.span)) < self.distance {
            return self.free(self.span);
        }
        let (mut low, mut high) = (0.0, self.turns().min(self.span));
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.free(middle) < self.distance { low = middle } else { high = middle }
        }
        // The impact takes all kinetic energy. Then the force moves the block back.
        let back = Self { speed: 0.0, ..*self };
        self.distance + back.free(self.span - high)
    }

    /// Error divided by the allowed error.
    fn error(&self) -> Result<f64, String> {
        let mut run = Run::new(self.definition().to_string());
        if self.kind == Kind::Lock {
            run.set("latch.engage", true);
            run.initialize();
            run.step(0.25);
            assert_eq!(run.get("slide.position"), 0.0);
            run.set("latch.engage", false);
        } else {
            run.initialize();
        }
        for _ in 0..self.steps {
            run.0.step(self.span / f64::from(self.steps)).map_err(|e| e.to_string())?;
        }
        Ok((run.get("slide.position") - self.exact()).abs() / self.allowed())
    }

    /// Error allowed [m].
    fn allowed(&self) -> f64 {
        let size = self.exact().abs().max(self.distance).max(if self.kind == Kind::Thrown { 1.0 } else { 0.0 });
        ALLOWED * self.tolerance.max(1e-13) * size + ROUNDING
    }
}

/// Random numbers: SplitMix64.
struct Numbers(u64);

impl Numbers {
    /// Uniform in the logarithm between two bounds.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low * (high / low).powf((z ^ (z >> 31)) as f64 / u64::MAX as f64)
    }

    fn case(&mut self, kind: Kind, tolerance: f64, steps: u32) -> Case {
        let c = self.between(10.0, 1e6);
        let force = self.between(10.0, 1e4);
        let span = self.between(0.03, 30.0);
        let mut case = Case { kind, tolerance, c, force, speed: 0.0, distance: 0.0, span, steps };
        if kind == Kind::Thrown {
            (case.force, case.speed) = (-force, self.between(0.1, 1e3));
            let most = case.free(case.turns());
            // The stop is not so near to the turning point that the tolerance decides whether there is an impact.
            let part = self.between(0.01, 100.0);
            case.distance = most * if (part - 1.0).abs() < 0.05 { 0.9 } else { part };
        }
        case
    }
}

/// Steps far longer than the decay report every impact, rest and contact, and no other.
#[test]
fn damped_motions_leave_and_reach_stops_and_locks() {
    let count = cases().unwrap_or(4);
    let mut wrong = Vec::new();
    for kind in KINDS {
        for exponent in [2, 3, 4, 5, 6, 8, 10, 12] {
            for steps in [1, 300] {
                let mut numbers = Numbers(exponent as u64 + 100 * u64::from(steps));
                for _ in 0..count {
                    let case = numbers.case(kind, 10f64.powi(-exponent), steps);
                    let error = case.error().unwrap_or_else(|e| panic!("{e}: {case:?}"));
                    assert!(error <= 2.0, "{error} times what is allowed: {case:?}");
                    if error > 1.0 {
                        wrong.push(format!("{error} times what is allowed: {case:?}"));
                    }
                }
            }
        }
    }
    // The tolerance is relative to a motion of 1 m and to the speed that the force gives over 1 m. For motions of
    // millimetres this matters in one run of ten thousand.
    let runs = KINDS.len() * 16 * count as usize;
    assert!(wrong.len() <= runs / 10_000, "{} runs: {}", wrong.len(), wrong.join("\n"));
}

/// A tailgate with a strong damper leaves its latch: one step at a loose tolerance against a tight tolerance.
#[test]
fn a_damped_tailgate_moves_away_from_its_latch() {
    let angle = |damping: f64, tolerance: f64| {
        let mut run = Run::replaced(TAILGATE, &[]);
        run.set("struts.damping", damping);
        run.set("solver.tolerance", tolerance);
        run.initialize();
        run.step(2.0);
        run.get("gate.angle")
    };
    for damping in [20_000.0, 28_100.0] {
        let exact = angle(damping, 1e-10);
        for tolerance in [1e-3, 1e-4, 1e-6] {
            let error = angle(damping, tolerance) - exact;
            assert!(error.abs() <= 10.0 * tolerance, "{damping} N.s/m at {tolerance}: {error} rad from {exact}");
        }
    }
}
