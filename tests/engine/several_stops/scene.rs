//! A block or a slider-crank with stops: its definition.

use crate::support::Run;
use crate::support::definition::{self, With};
use serde_json::{Value, json};

/// The quantity that a stop limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Position of the slide.
    Slide,
    /// Distance of the block or of the crank's end from a post.
    Distance,
}

/// A block of a mass [kg] on a slide, or a slider-crank with an inertia [kg.m2] of the crank, a mass [kg] of the slider
/// and a rod without mass.
#[derive(Clone, Copy, Debug)]
pub enum Machine {
    Block(f64),
    Crank(f64, f64),
}

const CRANK: f64 = 0.3;
const ROD: f64 = 0.8;
const POST: [f64; 2] = [0.2, 0.7];

#[derive(Clone, Copy, Debug)]
pub struct Stop {
    pub quantity: Quantity,
    /// 1 for an upper stop, -1 for a lower one.
    pub sign: f64,
    pub value: f64,
    /// Restitution of a rigid stop.
    pub rigid: Option<f64>,
    pub stiffness: f64,
    pub damping: f64,
}

/// Distance of the crank's end from the post at an angle [m].
pub fn distance(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    (CRANK * cos - POST[0]).hypot(CRANK * sin - POST[1])
}

/// A machine with its start and its stops.
#[derive(Clone, Debug)]
pub struct Scene {
    pub machine: Machine,
    pub start: [f64; 2],
    pub stops: Vec<Stop>,
    /// Stop that has a lock.
    pub lock: Option<usize>,
}

impl Scene {
    pub fn definition(&self) -> String {
        let stops = self.stops.iter().enumerate().map(|(k, stop)| {
            let point = if matches!(self.machine, Machine::Block(_)) { "block.origin" } else { "crank.end" };
            let mut out = match stop.quantity {
                Quantity::Slide => json!({ "joint": self.slide(), "position": stop.value }),
                Quantity::Distance => json!({ "first": "ground.post", "second": point, "length": stop.value }),
            };
            out["limit"] = json!(if stop.sign > 0.0 { "upper" } else { "lower" });
            match stop.rigid {
                Some(restitution) => out["restitution"] = json!(restitution),
                None => {
                    out["rigid"] = json!(false);
                    out["stiffness"] = json!(stop.stiffness);
                    out["damping"] = json!(stop.damping);
                }
            }
            (format!("s{k}"), out)
        });
        let stops: Value = stops.collect::<serde_json::Map<_, _>>().into();
        let [y, v] = self.start;
        let (machine, drive) = match self.machine {
            Machine::Block(mass) => (definition::block(mass).with(json!({ "guess": { "slide": y } })), "slide"),
            Machine::Crank(inertia, mass) => {
                let (crank, rod) = (json!({ "length": CRANK, "inertia": inertia }), json!({ "length": ROD }));
                (definition::slider_crank([crank, rod, json!({ "mass": mass })], y), "bearing")
            }
        };
        let start = if drive == "slide" { "position" } else { "angle" };
        let mut out = machine.with(json!({
            "bodies": { "ground": { "points": { "post": POST } } },
            "actuators": { "load": { "joint": drive } }, "start": { start: y, "speed": v },
        }));
        out["name"] = json!("Stops");
        out["stops"] = stops;
        if let Some(stop) = self.lock {
            out["locks"] = json!({ "latch": { "stop": format!("s{stop}"), "at": "block.origin" } });
        }
        out["solver"] = json!({ "tolerance": 1e-11 });
        out.to_string()
    }

    /// Name of the prismatic joint.
    fn slide(&self) -> &'static str {
        if matches!(self.machine, Machine::Block(_)) { "slide" } else { "guide" }
    }

    pub fn run(&self) -> Run {
        Run::new(self.definition()).started()
    }
}

pub fn bumper(quantity: Quantity, sign: f64, value: f64, stiffness: f64, damping: f64) -> Stop {
    Stop { quantity, sign, value, rigid: None, stiffness, damping }
}

pub fn rigid(quantity: Quantity, sign: f64, value: f64, restitution: f64) -> Stop {
    Stop { quantity, sign, value, rigid: Some(restitution), stiffness: 0.0, damping: 0.0 }
}

/// A block of 1 kg that starts from rest at 0.
pub fn block(stops: &[Stop]) -> Scene {
    Scene { machine: Machine::Block(1.0), start: [0.0; 2], stops: stops.to_vec(), lock: None }
}
