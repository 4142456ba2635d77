//! The prescribed motion of a drive, as the file states it.
use super::Mechanism;
use super::interpolation::Interpolation;
use crate::format::{Described, Faults, Key, Keyed, Range, Role, curve, either, keys, number, words};
use crate::inspection::Finding;
use crate::numerics::piecewise::Piecewise;
use crate::variables::Unit::{
    Metre, MetrePerSecond, MetrePerSecondSquared, Radian, RadianPerSecond, RadianPerSecondSquared, Second,
};

keys! {
    /// Prescribed motion of a drive, either by the inputs `<name>.motion.position`, `.speed` and `.acceleration` or by
    /// a profile over time.
    pub struct PrescribedMotion {
        /// Start value of the input `<name>.motion.enabled`. true: the motion of the drive is prescribed. false: the
        /// input force or torque of the drive acts.
        enabled: bool = true;
        /// Start value of the input `<name>.motion.position`: length, position or angle of the drive [m or rad]. The
        /// key `position` is allowed only without the key `profile`.
        position: Option<f64> => either([Metre, Radian], Range::Finite);
        /// Motion law of the drive as a function of time. Without the key `profile`, position, speed and acceleration
        /// of the drive are inputs of the FMU.
        profile: Option<ProfileKind>;
        /// Time at rest before the profile starts, measured from the instant at which the motion is first prescribed
        /// [s], >= 0.
        start_time: Option<f64> => number(Second, Range::NonNegative)
            .parameter(Role::Load, "Time at rest before the start of the prescribed motion").absent("0");
        /// Duration of the motion that the profile describes [s], > 0. The key `duration` is not allowed for the
        /// profiles `trapezoid` and `table`, whose other keys determine the duration, and for `constant_speed`, which
        /// has no end.
        duration: Option<f64> => number(Second, Range::Positive)
            .parameter(Role::Load, "Duration of the prescribed motion");
        /// Distance over which the profile moves the drive, positive or negative [m or rad], from the position at which
        /// the motion is first prescribed.
        distance: Option<f64> =>
            either([Metre, Radian], Range::Coordinate).parameter(Role::Load, "Distance of the prescribed motion");
        /// Profile `trapezoid`: largest speed of the drive [m/s or rad/s], > 0. Profile `constant_speed`: speed of the
        /// drive, positive or negative.
        speed: Option<f64> => either([MetrePerSecond, RadianPerSecond], Range::Coordinate)
            .parameter(Role::Load, "Largest or constant speed of the prescribed motion");
        /// Only for the profile `trapezoid`: acceleration and deceleration of the drive [m/s2 or rad/s2], > 0.
        acceleration: Option<f64> => either([MetrePerSecondSquared, RadianPerSecondSquared], Range::Positive)
            .parameter(Role::Load, "Acceleration and deceleration of the prescribed motion");
        /// Only for the profile `table`: pairs of time and distance [s, m or rad], in the order of increasing time.
        points: Option<Vec<[f64; 2]>> => curve([Second; 2], [Metre, Radian], Range::Finite);
        /// Only for the profile `table`: kind of the curve through `points`. `spline`: a smooth curve, which may
        /// overshoot the points. `monotone`: a curve that rises only where the points rise, and falls only where the
        /// points fall.
        interpolation: Option<Interpolation> => Key::PLAIN.absent("\"spline\"");
    }
}

words! {
    /// Law of a motion over time.
    pub enum ProfileKind {
        /// Constant acceleration, constant speed, constant deceleration.
        Trapezoid = "trapezoid",
        /// Acceleration as one period of a sine.
        Cycloidal = "cycloidal",
        /// Polynomial of degree 5, without acceleration at its ends.
        Polynomial345 = "polynomial_345",
        /// Polynomial of degree 7, without acceleration and jerk at its ends.
        Polynomial4567 = "polynomial_4567",
        /// Constant speed without an end.
        ConstantSpeed = "constant_speed",
        /// Smooth curve through points.
        Table = "table",
    }
}

impl PrescribedMotion {
    /// The curve of a table; None without points, and for points of no function.
    pub fn curve(&self) -> Option<Piecewise> {
        self.interpolation.unwrap_or_default().curve(self.points.as_ref()?)
    }

    /// A key of a drive and its motion, with the range that its profile allows.
    pub(super) fn refined(&self, key: Key) -> Key {
        match key.name {
            "speed" if self.profile == Some(ProfileKind::Trapezoid) => Key { range: Range::Positive, ..key },
            _ => key,
        }
    }

    /// Faults of the motion of a drive, under the key of that motion.
    pub(super) fn check(&self, key: &str, faults: &mut Faults) {
        use ProfileKind::{ConstantSpeed, Cycloidal, Polynomial345, Polynomial4567, Table, Trapezoid};
        let (what, wanted): (&str, &[&str]) = match self.profile {
            None => ("a motion without a profile", &["position"]),
            Some(Trapezoid) => ("a trapezoid", &["distance", "speed", "acceleration"]),
            Some(Cycloidal | Polynomial345 | Polynomial4567) => ("this profile", &["duration", "distance"]),
            Some(ConstantSpeed) => ("a constant speed", &["speed"]),
            Some(Table) => ("a table", &["points"]),
        };
        let mut own = self.clone();
        for (index, Key { name, .. }) in Self::TABLE.keys.iter().enumerate() {
            let (path, is_stated) = (format_args!("{key}.{name}"), own.slot(index).is_given());
            let is_optional = match *name {
                "enabled" | "profile" => true,
                "start_time" => self.profile.is_some(),
                "interpolation" => self.profile == Some(Table),
                _ => false,
            };
            match (is_stated, wanted.contains(name)) {
                (false, true) => faults.refuse(key, format_args!("{what} needs the key `{name}`: add this key")),
                (true, false) if !is_optional => {
                    let message =
                        format_args!("{what} does not use this key: remove the key, or choose another profile");
                    faults.refuse(path, message)
                }
                _ => {}
            };
        }
        let Some(points) = &self.points else { return };
        if points.iter().flatten().any(|value| !value.is_finite()) || self.curve().is_none() {
            let message = "give 2 or more points [time, distance] with finite numbers and ascending times";
            faults.refuse(format_args!("{key}.points"), message);
        }
    }
}

impl Mechanism {
    /// Warning about a speed of the start that a prescribed motion takes no notice of.
    pub(super) fn warn_of_start_speed(&self, all: &mut Vec<Finding>) {
        let Some((_, drive, motion)) = self.motion_drive() else { return };
        if motion.enabled && self.start.speed != 0.0 {
            let message = format_args!(
                "this key has no effect, because actuators.{drive}.motion prescribes the speed from the start"
            );
            let remedy = "remove `start.speed`, or write \"enabled\": false for a motion that is switched on later";
            all.push(Finding::warning("start.speed", message, remedy));
        }
    }
}
