//! The start, and the default experiment.
use super::role::{Role, Visit};
use crate::format::{Parameter, Range};
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// Position and speed of a turning body or a prismatic joint at the start.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Turning body that states the start.
    pub body: Option<String>,
    /// Angle of the body [rad].
    pub angle: Option<f64>,
    /// Prismatic joint that states the start.
    pub joint: Option<String>,
    /// Position of the joint [m].
    pub position: Option<f64>,
    /// Speed of the body or joint [rad/s or m/s].
    #[serde(default)]
    pub speed: f64,
}

/// Default experiment of the FMU.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Stop time [s], > 0; the start time is 0.
    pub stop_time: f64,
    /// Preferred communication step [s], > 0.
    pub step_size: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, step_size: 1e-3 }
    }
}

impl Start {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        use Unit::{Metre, MetrePerSecond, Radian, RadianPerSecond};
        let (of, value, quantity, unit, speed_unit, range) =
            match (&self.body, &mut self.angle, &self.joint, &mut self.position) {
                (Some(body), Some(angle), ..) => (body, angle, "angle", Radian, RadianPerSecond, Range::Turn),
                (.., Some(joint), Some(position)) => {
                    (joint, position, "position", Metre, MetrePerSecond, Range::Finite)
                }
                _ => return,
            };
        let mut add = |quantity, kind, value| {
            let description = ["Start ", quantity, " of ", of];
            visit(Parameter::new([of, ".start_", quantity], ["start.", quantity], description, kind), value);
        };
        add(quantity, (unit, range, Role::StartPosition), value);
        add("speed", (speed_unit, Range::Finite, Role::StartSpeed), &mut self.speed);
    }
}
