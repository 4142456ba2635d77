//! A block on a rail with a drive, a load, a spring and a damper: motions in closed form.
use crate::support::Run;
use crate::support::definition::{With, block};
use serde_json::json;

pub const MASS: f64 = 2.0;

/// State of the block, and its loads.
#[derive(Default)]
pub struct Slider {
    pub x: f64,
    pub v: f64,
    /// Efficiency of the drive. None: a drive without the key.
    pub eta: Option<f64>,
    /// Stiffness and damping between ground and block. The free length is 0.
    pub stiffness: f64,
    pub damping: f64,
}

impl Slider {
    pub fn run(&self, tolerance: f64) -> Run {
        let mut drive = json!({ "joint": "slide" });
        if let Some(eta) = self.eta {
            drive["efficiency"] = json!(eta);
        }
        let mut spring = json!({ "joint": "slide", "stiffness": self.stiffness });
        if self.damping != 0.0 {
            spring["damping"] = json!(self.damping);
        }
        let mut run = Run::new(block(MASS).with(json!({
            "actuators": { "drive": drive }, "springs": { "spring": spring }, "start": { "position": 0.1 },
            "forces": { "load": { "at": "block.origin" } },
        })));
        run.set("solver.tolerance", tolerance);
        run
    }

    /// Motion over h [s] under a drive force with losses and a constant load, without spring. Returns the number of
    /// times at which the block stops.
    pub fn advance(&mut self, push: f64, load: f64, h: f64) -> u32 {
        let eta = self.eta.unwrap_or(1.0);
        let along = |direction: f64| (load + if push * direction > 0.0 { push * eta } else { push / eta }) / MASS;
        let (mut left, mut stops) = (h, 0);
        while left > 0.0 {
            let direction = if self.v != 0.0 {
                self.v.signum()
            } else if along(1.0) > 0.0 {
                1.0
            } else if along(-1.0) < 0.0 {
                -1.0
            } else {
                return stops;
            };
            let a = along(direction);
            let until_stop = if a * direction < 0.0 { -self.v / a } else { f64::INFINITY };
            let t = left.min(until_stop);
            self.x += self.v * t + 0.5 * a * t * t;
            self.v += a * t;
            left -= t;
            if t == until_stop {
                self.v = 0.0;
                stops += 1;
            }
        }
        stops
    }
}
