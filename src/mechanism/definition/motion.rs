//! The prescribed motion of a drive, as the file states it.
use super::interpolation::Interpolation;
use super::loads::Actuator;
use super::mechanism::Mechanism;
use super::{Role, Visit};
use crate::format::{DefinitionError, Faults, Owner, Range};
use crate::inspection::Finding;
use crate::numerics::piecewise::Piecewise;
use crate::variables::Unit;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Motion of a drive that is given, so that the force is what follows: by inputs, or by a profile over time.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct PrescribedMotion {
    /// Start value of the input `<drive>.motion.enabled`: whether the motion is prescribed; else the force of the input
    /// acts.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// Without a profile: start value of the input `<drive>.motion.position`, the length, position or angle [m or rad].
    pub position: Option<f64>,
    /// Law of the motion over time; where absent position, speed and acceleration are inputs.
    pub profile: Option<ProfileKind>,
    /// Time at rest before the profile begins [s], >= 0, from where the motion is first prescribed; 0 where absent.
    pub start_time: Option<f64>,
    /// Time that the profile takes [s], > 0; of a trapezoid it follows, of a table the points state it.
    pub duration: Option<f64>,
    /// Distance [m or rad] from where the motion is first prescribed, of any sign.
    pub distance: Option<f64>,
    /// Largest speed of a trapezoid [m/s or rad/s], > 0.
    pub speed: Option<f64>,
    /// Acceleration and deceleration of a trapezoid [m/s2 or rad/s2], > 0.
    pub acceleration: Option<f64>,
    /// Points of a table: pairs of time [s] and distance [m or rad], times ascending.
    pub points: Option<Vec<[f64; 2]>>,
    /// Curve of a table through its points; a spline where absent.
    pub interpolation: Option<Interpolation>,
}

fn enabled() -> bool {
    true
}

/// Law of a motion over time.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub enum ProfileKind {
    /// Constant acceleration, constant speed, constant deceleration.
    #[serde(rename = "trapezoid")]
    Trapezoid,
    /// Acceleration as one period of a sine.
    #[serde(rename = "cycloidal")]
    Cycloidal,
    /// Polynomial of degree 5, without acceleration at its ends.
    #[serde(rename = "polynomial_345")]
    Polynomial345,
    /// Polynomial of degree 7, without acceleration and jerk at its ends.
    #[serde(rename = "polynomial_4567")]
    Polynomial4567,
    /// Smooth curve through points.
    #[serde(rename = "table")]
    Table,
}

impl PrescribedMotion {
    /// The curve of a table; None without points, and for points of no function.
    pub fn curve(&self) -> Option<Piecewise> {
        self.interpolation.unwrap_or_default().curve(self.points.as_ref()?)
    }

    /// Faults of the motion of a drive, under the key of that motion.
    pub(super) fn check(&self, key: &str, faults: &mut Faults) {
        use ProfileKind::{Cycloidal, Polynomial345, Polynomial4567, Table, Trapezoid};
        let stated = [
            ("position", self.position.is_some()),
            ("start_time", self.start_time.is_some()),
            ("duration", self.duration.is_some()),
            ("distance", self.distance.is_some()),
            ("speed", self.speed.is_some()),
            ("acceleration", self.acceleration.is_some()),
            ("points", self.points.is_some()),
            ("interpolation", self.interpolation.is_some()),
        ];
        let (what, wanted): (&str, &[&str]) = match self.profile {
            None => ("without a profile", &["position"]),
            Some(Trapezoid) => ("a trapezoid", &["distance", "speed", "acceleration"]),
            Some(Cycloidal | Polynomial345 | Polynomial4567) => ("this profile", &["duration", "distance"]),
            Some(Table) => ("a table", &["points"]),
        };
        for (name, is_stated) in stated {
            let path = format_args!("{key}.{name}");
            let is_optional = match name {
                "start_time" => self.profile.is_some(),
                "interpolation" => self.profile == Some(Table),
                _ => false,
            };
            match (is_stated, wanted.contains(&name)) {
                (false, true) => faults.keep::<()>(refused(key, format_args!("{what} asks for {name}: add this key"))),
                (true, false) if !is_optional => {
                    let message = format_args!("{what} does not use it: remove it, or choose another profile");
                    faults.keep::<()>(refused(path, message))
                }
                _ => None,
            };
        }
        if let Some(position) = self.position {
            faults.keep(Range::Finite.check(format_args!("{key}.position"), position));
        }
        let Some(points) = &self.points else { return };
        if points.iter().flatten().any(|value| !value.is_finite()) || self.curve().is_none() {
            let message = "give 2 or more points [time, distance] of finite numbers with ascending times";
            faults.keep::<()>(refused(format_args!("{key}.points"), message));
        }
    }

    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        let [way, speed, acceleration] = match is_rotary {
            true => [Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared],
            false => [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared],
        };
        let mut list = Owner::new(Some("actuators"), name, Role::Load, visit);
        let (time, positive) = (Unit::Second, Range::Positive);
        let words = "Time at rest before the profile of the motion";
        list.add("motion.start_time", words, time, Range::NonNegative, &mut self.start_time);
        list.add("motion.duration", "Duration of the motion", time, positive, &mut self.duration);
        list.add("motion.distance", "Distance of the motion", way, Range::Coordinate, &mut self.distance);
        list.add("motion.speed", "Largest speed of the motion", speed, positive, &mut self.speed);
        let words = "Acceleration and deceleration of the motion";
        list.add("motion.acceleration", words, acceleration, positive, &mut self.acceleration);
    }
}

impl Mechanism {
    /// Warning about a speed of the start that a prescribed motion takes no notice of.
    pub(super) fn warn_of_start_speed(&self, all: &mut Vec<Finding>) {
        let Some((_, drive, motion)) = self.motion_drive() else { return };
        if motion.enabled && self.start.speed != 0.0 {
            let message = format!("does nothing, as actuators.{drive}.motion says the speed from the start on");
            let remedy = "remove it, or write \"enabled\": false for a motion that is switched on later";
            all.push(Finding::warning("start.speed", message, remedy));
        }
    }

    /// Faults of the motion of a drive, if it has one.
    pub(super) fn check_motion(&self, name: &str, drive: &Actuator, faults: &mut Faults) {
        let Some(motion) = &drive.motion else { return };
        let key = format!("actuators.{name}.motion");
        if let Some((_, other, _)) = self.hydraulic_drive() {
            let message = format!(
                "actuators.{other} has a hydraulic circuit, which takes no prescribed motion: remove one of both"
            );
            faults.keep::<()>(refused(&key, message));
        }
        if let Some((_, other, _)) = self.motion_drive().filter(|(_, other, _)| *other != name) {
            let message = format!("{other} has a motion already, which moves the whole mechanism: remove one");
            faults.keep::<()>(refused(&key, message));
        }
        if self.start.equilibrium && motion.enabled {
            let message = "the motion holds the mechanism at any position: state a start, or enabled = false";
            faults.keep::<()>(refused(&key, message));
        }
        motion.check(&key, faults);
    }
}

fn refused<T>(key: impl fmt::Display, message: impl fmt::Display) -> Result<T, DefinitionError> {
    Err(DefinitionError::key(key, message))
}
