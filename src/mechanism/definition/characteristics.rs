//! Curves by points: pull of a spring over its length, of a damper over its speed, force of a drive over its speed,
//! push of a bumper over its depth.
//!
//! In: the definition of a spring, a drive or a stop. Out: faults of its curves, and warnings about curves that are
//! probably not those that are meant. It must not know geometry.
use super::Mechanism;
use super::contact::Stop;
use super::loads::{Actuator, Spring};
use super::refusal::{Check, refused};
use crate::format::Range;
use crate::inspection::Finding;
use crate::numerics::decimal::Decimal;
use crate::numerics::monotone::monotone;
use crate::numerics::piecewise::Piecewise;

/// The function through points under this key; `abscissa`: what their first numbers are.
fn function(key: &str, points: &[[f64; 2]], abscissa: &str) -> Result<Piecewise, super::DefinitionError> {
    for (i, value) in points.iter().enumerate().flat_map(|(i, point)| point.iter().map(move |value| (i, *value))) {
        Range::Coordinate.check(format_args!("{key}[{i}]"), value)?;
    }
    if points.len() < 2 {
        let message =
            format_args!("the curve has {} points [{abscissa}, force], but a curve needs 2 or more", points.len());
        return refused(key, message);
    }
    if let Some(i) = points.windows(2).position(|pair| pair[0][0] >= pair[1][0]) {
        let [before, after] = [points[i][0], points[i + 1][0]];
        return refused(
            format_args!("{key}[{}]", i + 1),
            format_args!(
                "{abscissa} = {after} must be larger than {abscissa} = {before} of the preceding point: sort the \
                 points by {abscissa}"
            ),
        );
    }
    match monotone(points) {
        Some(function) => Ok(function),
        None => refused(key, "two points are so close that the slope between them is infinite: remove one point"),
    }
}

/// A spring's points are those of a function, and its gas has a length to refer to.
pub(super) fn check_spring(key: &str, spring: &Spring, is_rotary: bool) -> Check {
    if spring.gas.is_some() {
        if is_rotary {
            return refused(
                format_args!("{key}.gas"),
                "a gas spring acts along a line: give the keys \"first\" and \"second\", or name a prismatic joint",
            );
        }
        if spring.points.is_some() {
            let message = "a spring cannot have both the key `points` and the key `gas`: define two springs";
            return refused(format_args!("{key}.gas"), message);
        }
        if spring.free_length.is_none() {
            return refused(key, "the gas volume refers to the free length of the spring: add the key `free_length`");
        }
    }
    let Some(points) = &spring.points else { return Ok(()) };
    let abscissa = match (is_rotary, &spring.joint) {
        (true, _) => "angle",
        (false, Some(_)) => "position",
        (false, None) => "length",
    };
    function(&format!("{key}.points"), points, abscissa).map(drop)
}

/// The points of a damper take power at every speed, also beyond the first and the last one.
pub(super) fn check_damper(key: &str, spring: &Spring) -> Check {
    let Some(points) = &spring.damping_points else { return Ok(()) };
    let key = format!("{key}.damping_points");
    let function = function(&key, points, "speed")?;
    if let Some((i, [speed, force])) = points.iter().enumerate().find(|(_, [speed, force])| speed * force < 0.0) {
        let message = format_args!(
            "the force {force} at the speed {speed} would drive the motion, but a damper must resist the motion: give \
             the force the same sign as the speed"
        );
        return refused(format_args!("{key}[{i}]"), message);
    }
    if !points.contains(&[0.0, 0.0]) {
        return refused(
            key,
            "a damper has no force at rest: add the point [0, 0], or model a force at rest as friction",
        );
    }
    let ends = function.ends().into_iter().zip([points.first(), points.last()]);
    match ends.filter_map(|([_, slope], point)| Some((slope, point?[0]))).find(|(slope, _)| *slope < 0.0) {
        Some((_, speed)) => {
            let message = format_args!(
                "beyond the point at the speed {speed} the curve continues as a straight line, on which the force \
                 changes its sign and drives the motion: add a point beyond the speed {speed}, with a force that is \
                 at least as large in magnitude as at the speed {speed}"
            );
            refused(key, message)
        }
        None => Ok(()),
    }
}

/// A drive's points are those of a function, and its command has points to act on.
pub(super) fn check_drive(key: &str, drive: &Actuator) -> Check {
    let Some(points) = &drive.points else {
        return match drive.command {
            Some(_) => refused(
                format_args!("{key}.command"),
                "this key scales the force-speed curve, but the drive has no curve: add the key `points` with pairs \
                 [speed, force], or remove `command`",
            ),
            None => Ok(()),
        };
    };
    if drive.hydraulics.is_some() {
        return refused(
            format_args!("{key}.points"),
            "the hydraulic circuit defines the force of this drive: remove the key `points` or the key `hydraulics`",
        );
    }
    if drive.motion.is_some() {
        let message = "the key `motion` prescribes the speed of this drive, so a force-speed curve is not allowed: \
                       remove the key `points` or the key `motion`";
        return refused(format_args!("{key}.points"), message);
    }
    function(&format!("{key}.points"), points, "speed").map(drop)
}

/// The points of a bumper push from its contact on, and never less the deeper it is pressed.
pub(super) fn check_bumper(key: &str, stop: &Stop) -> Check {
    let Some(points) = &stop.points else { return Ok(()) };
    let key = format!("{key}.points");
    function(&key, points, "compression")?;
    if points[0] != [0.0, 0.0] {
        let message = "the force of a bumper is 0 at the first contact: start with [0, 0] as the first point";
        return refused(format_args!("{key}[0]"), message);
    }
    match points.windows(2).position(|pair| pair[1][1] < pair[0][1]) {
        Some(i) => {
            let [before, after] = [points[i][1], points[i + 1][1]];
            let message = format_args!(
                "the force {after} is smaller than {before} at the preceding point: the force of a bumper must not \
                 fall with the compression"
            );
            refused(format_args!("{key}[{}]", i + 1), message)
        }
        None => Ok(()),
    }
}

impl Mechanism {
    /// Warnings about curves of dampers, drives and bumpers.
    pub(super) fn warn_of_curves(&self, all: &mut Vec<Finding>) {
        for (name, spring) in self.springs.iter() {
            let Some(points) = spring.damping_points.as_deref() else { continue };
            warn_of_damper(&format!("springs.{name}.damping_points"), points, all);
        }
        for (name, drive) in self.actuators.iter() {
            let Some(points) = drive.points.as_deref() else { continue };
            warn_of_drive(&format!("actuators.{name}.points"), points, all);
        }
        for (name, stop) in self.stops.iter() {
            let Some(points) = stop.points.as_deref() else { continue };
            let (Some([_, [_, slope]]), [.., last]) = (monotone(points).map(|f| f.ends()), points) else {
                continue;
            };
            if slope == 0.0 && stop.stiffness == 0.0 && last[1] > 0.0 {
                let (depth, unit) = (Decimal(last[0]), if stop.angle.is_some() { "rad" } else { "m" });
                let message = format_args!(
                    "the bumper has a constant force beyond {depth} {unit} of compression, even in an impact"
                );
                let remedy = "add a point at the largest compression of an impact, or add the key `stiffness`";
                all.push(Finding::warning(format_args!("stops.{name}.points"), message, remedy));
            }
        }
    }
}

fn warn_of_damper(key: &str, points: &[[f64; 2]], all: &mut Vec<Finding>) {
    if points.iter().all(|[_, force]| *force == 0.0) {
        all.push(Finding::warning(
            key,
            "all points have the force 0, so the damper has no effect",
            "give at least one point of the curve a force other than 0, or remove the curve",
        ));
        return;
    }
    if let Some([a, b]) = points.windows(2).find(|pair| pair[1][1] < pair[0][1]).map(|pair| [pair[0][0], pair[1][0]]) {
        let message = format_args!(
            "the forces fall from the speed {} to the speed {}. In this range the damper force decreases with the \
             speed, which can excite vibrations",
            Decimal(a),
            Decimal(b)
        );
        all.push(Finding::warning(
            key,
            message,
            "use damper forces that rise with the speed, unless the fall is intended",
        ));
    }
    for (is_missing, word) in [
        (points.first().is_some_and(|point| point[0] >= 0.0), "negative"),
        (points.last().is_some_and(|point| point[0] <= 0.0), "positive"),
    ] {
        if is_missing {
            let message = format_args!(
                "the curve has no point at a {word} speed, so the force at {word} speeds continues with the slope at \
                 rest"
            );
            all.push(Finding::warning(key, message, "add points of the curve for both directions of motion"));
        }
    }
}

fn warn_of_drive(key: &str, points: &[[f64; 2]], all: &mut Vec<Finding>) {
    let (Some(function), [[first, _], .., [last, _]]) = (monotone(points), points) else { return };
    if points.iter().all(|[_, force]| *force == 0.0) {
        all.push(Finding::warning(
            key,
            "all points have the force 0, so the drive never moves the mechanism",
            "give at least one point of the curve a force other than 0, or remove the curve",
        ));
        return;
    }
    if !(*first..=*last).contains(&0.0) {
        let end = if *first > 0.0 { first } else { last };
        let message = format_args!(
            "the points do not include the speed 0, so the force at rest is extrapolated with the slope at the \
             speed {}",
            Decimal(*end)
        );
        all.push(Finding::warning(key, message, "add a point at the speed 0"));
    }
    for ([value, slope], speed) in function.ends().into_iter().zip([*first, *last]) {
        // With the sign of the speed the force adds to it.
        if slope > 0.0 && value * speed > 0.0 {
            let message = format_args!(
                "the forces rise beyond the speed {}: the force of the drive grows with the speed without limit",
                Decimal(speed)
            );
            all.push(Finding::warning(key, message, "add a point at the speed at which the drive has no force"));
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn warnings(more: Value) -> Vec<String> {
        let mut text = json!({
            "name": "Part", "bodies": { "ground": {}, "part": { "mass": 1 } },
            "joints": { "way": { "type": "prismatic", "first": "ground.origin", "second": "part.origin" } },
            "start": { "joint": "way", "position": 0 }, "guess": { "way": 0 },
        });
        text.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let mechanism = Mechanism::from_json(&text.to_string()).unwrap();
        mechanism.warnings().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn doubtful_curves_are_warned_of() {
        let damper = |points: Value| json!({ "springs": { "d": { "joint": "way", "damping_points": points } } });
        let drive = |points: Value| json!({ "actuators": { "m": { "joint": "way", "points": points } } });
        let stop = |points: Value| {
            let stop = json!({ "joint": "way", "limit": "upper", "position": 1, "rigid": false, "points": points });
            json!({ "stops": { "b": stop } })
        };
        for (more, pieces) in [
            (damper(json!([[-1, -2], [0, 0], [1, 5]])), &[][..]),
            (damper(json!([[-1, 0], [0, 0], [1, 0]])), &["springs.d.damping_points", "has no effect"]),
            (
                damper(json!([[-1, -1], [0, 0], [1, 5], [2, 3], [3, 3]])),
                &["fall from the speed 1 to the speed 2", "excite vibrations"],
            ),
            (damper(json!([[0, 0], [1, 5]])), &["no point at a negative speed"]),
            (damper(json!([[-1, -5], [0, 0]])), &["no point at a positive speed"]),
            (drive(json!([[0, 5], [10, 0]])), &[]),
            (drive(json!([[0, 0], [10, 0]])), &["actuators.m.points", "never moves the mechanism"]),
            (drive(json!([[2, 5], [10, 0]])), &["the force at rest", "slope at the speed 2"]),
            (drive(json!([[0, 5], [10, 8]])), &["rise beyond the speed 10", "no force"]),
            (drive(json!([[-10, -8], [0, 5], [9, 0]])), &["rise beyond the speed -10"]),
            (stop(json!([[0, 0], [1, 5]])), &[]),
            (stop(json!([[0, 0], [1, 0]])), &["stops.b", "never pushes"]),
            (stop(json!([[0, 0], [1, 5], [2, 5]])), &["stops.b.points", "constant force beyond 2 m of compression"]),
        ] {
            let told = warnings(more.clone());
            assert_eq!(told.len(), usize::from(!pieces.is_empty()), "{more}: {told:?}");
            assert!(pieces.iter().all(|piece| told[0].contains(piece)), "{told:?} lacks one of {pieces:?}");
        }
    }
}
