//! Curves through the points of a table whose second derivative is an acceleration: the lift of a cam, the motion of a
//! drive.
//!
//! In: points and the kind of curve that the definition states. Out: the curve, and a warning where it goes beyond its
//! points. It must not know geometry.
use super::Mechanism;
use crate::format::words;
use crate::inspection::Finding;
use crate::numerics::decimal::Decimal;
use crate::numerics::monotone::monotone;
use crate::numerics::order;
use crate::numerics::periodic::Periodic;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::spline::spline;
use std::f64::consts::TAU;

/// Part of the points' range by which a curve may go beyond it: at 12 points a revolution a sine does by 0.9 of a
/// hundred.
const BEYOND: f64 = 0.02;
/// Number of samples between two points.
const SAMPLES: usize = 16;
/// Least number of points of a table whose digits are looked at: fewer are written by hand.
const DENSE: usize = 24;
/// Most digits behind the point that a rounded number has.
const DIGITS: i32 = 12;
/// Part of the largest second derivative that rounding of the values may make up.
const ROUNDED: f64 = 0.1;
/// Second derivative of a spline by a rounding of its values by half a unit, in units over the square of the spacing:
/// the mean over random roundings is less than half of it.
const SHARPNESS: f64 = 3.0;

words! {
    /// Curve through the points of a table.
    pub enum Interpolation {
        /// Quintic spline: its acceleration tends to that of a smooth law through the points, and it may go beyond
        /// them.
        Spline = "spline",
        /// Curve that rises or falls only where the points do, at the price of its acceleration beside an extreme.
        Monotone = "monotone",
    }
}

impl Interpolation {
    /// The curve through points; None for points of no function.
    pub fn curve(self, points: &[[f64; 2]]) -> Option<Piecewise> {
        match self {
            Self::Spline => spline(points),
            Self::Monotone => monotone(points),
        }
    }

    /// The curve through points of one revolution; None for points of no periodic function.
    pub fn periodic(self, points: &[[f64; 2]]) -> Option<Periodic> {
        match self {
            Self::Spline => Periodic::spline(points),
            Self::Monotone => Periodic::monotone(points),
        }
    }
}

impl Mechanism {
    /// Warnings about cams and motions whose spline goes beyond the points of its table.
    pub(super) fn warn_of_tables(&self, all: &mut Vec<Finding>) {
        for (name, coupling) in self.couplings.iter() {
            let (Some(points), Ok(lift)) = (&coupling.points, coupling.lift(name)) else { continue };
            let [[first, value], ..] = points[..] else { continue };
            let closed = [&points[..], &[[first + TAU, value]]].concat();
            let unit = if coupling.joint.is_none() { "rad" } else { "m" };
            warn_of_table(&format!("couplings.{name}"), ["angle", "rad", unit], &closed, |u| lift.at(u)[0], all);
            warn_of_digits(&format!("couplings.{name}"), unit, &closed, |u| lift.at(u)[2], all);
        }
        for (name, drive) in self.actuators.iter() {
            let Some(motion) = &drive.motion else { continue };
            let (Some(points), Some(curve)) = (&motion.points, motion.curve()) else { continue };
            let unit = if self.turns(drive) { "rad" } else { "m" };
            warn_of_table(&format!("actuators.{name}.motion"), ["time", "s", unit], points, |t| curve.at(t)[0], all);
            warn_of_digits(&format!("actuators.{name}.motion"), unit, points, |t| curve.at(t)[2], all);
        }
    }
}

/// Warn of a spline that goes beyond its points; of these: name and unit of the first number, unit of the second.
fn warn_of_table(
    key: &str,
    [of, first, second]: [&str; 3],
    points: &[[f64; 2]],
    at: impl Fn(f64) -> f64,
    all: &mut Vec<Finding>,
) {
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [_, value]| (low.min(*value), high.max(*value)));
    let samples = points
        .windows(2)
        .flat_map(|pair| (1..SAMPLES).map(move |k| pair[0][0] + (pair[1][0] - pair[0][0]) * k as f64 / SAMPLES as f64));
    let beyond = |value: f64| (value - high).max(low - value);
    let farthest = samples.map(|x| (x, at(x))).max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)));
    let Some((x, value)) = farthest.filter(|(_, value)| beyond(*value) > BEYOND * (high - low)) else { return };
    let message = format_args!(
        "the spline overshoots the points: the spline reaches {} {second} at the {of} {} {first}, but the points lie \
         between {} {second} and {} {second}",
        Decimal::rounded(value),
        Decimal::rounded(x),
        Decimal(low),
        Decimal(high)
    );
    let remedy = "add points in this range (three equal values for a dwell), or write \"interpolation\": \"monotone\"";
    all.push(Finding::warning(format_args!("{key}.points"), message, remedy));
}

/// Warn of a dense table of rounded values, whose second derivative comes from the last digits.
fn warn_of_digits(key: &str, of: &str, points: &[[f64; 2]], second: impl Fn(f64) -> f64, all: &mut Vec<Finding>) {
    let unit = (0..=DIGITS).map(|k| 10.0_f64.powi(-k)).find(|unit| {
        let is_multiple = |value: f64| (value / unit - (value / unit).round()).abs() < 1e-6;
        points.iter().all(|[_, value]| is_multiple(*value))
    });
    let Some(unit) = unit.filter(|_| points.len() >= DENSE) else { return };
    let middles = points.windows(2).map(|pair| 0.5 * (pair[0][0] + pair[1][0]));
    let largest =
        points.iter().map(|point| point[0]).chain(middles).fold(0.0, |most: f64, x| most.max(second(x).abs()));
    let mut widths: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    order::sort(&mut widths);
    let rounded = SHARPNESS * unit / widths[widths.len() / 2].powi(2);
    if rounded > ROUNDED * largest {
        let part = (100.0 * rounded / largest).min(100.0);
        let message = format_args!(
            "the points have values in steps of {} {of}. At this spacing of the points, the rounding of the values \
             causes up to about {part:.0} % of the acceleration",
            Decimal(unit)
        );
        let remedy = "give the values of the points with more digits, or give fewer points";
        all.push(Finding::warning(format_args!("{key}.points"), message, remedy));
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn definition(motion: Value) -> Value {
        json!({
            "name": "Part", "bodies": { "ground": {}, "part": { "mass": 1 } },
            "joints": { "way": { "type": "prismatic", "first": "ground.origin", "second": "part.origin" } },
            "actuators": { "servo": { "joint": "way", "motion": motion } },
            "start": { "joint": "way", "position": 0 }, "guess": { "way": 0 },
        })
    }

    fn warnings(motion: Value) -> Vec<String> {
        let text = definition(motion);
        Mechanism::from_json(&text.to_string()).unwrap().warnings().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_spline_beyond_its_points_is_warned_of() {
        let steep = json!([[0, 0], [1, 0], [1.1, 1], [2, 1], [2.1, 1]]);
        for (motion, pieces) in [
            (json!({ "profile": "table", "points": [[0, 0], [0.5, 0.4], [1, 1]] }), &[][..]),
            (
                json!({ "profile": "table", "points": [[0, 0], [1, 0], [1.1, 0.9], [1.2, 1], [2, 0.9], [3, 1]] }),
                &["servo.motion.points", "8.9", "at the time 2.5", "between 0 m and 1 m", "monotone"],
            ),
            (json!({ "profile": "table", "points": steep, "interpolation": "monotone" }), &[]),
            // Rests by two points at one end and by three at the other.
            (json!({ "profile": "table", "points": steep }), &[]),
        ] {
            let told = warnings(motion.clone());
            assert_eq!(told.len(), usize::from(!pieces.is_empty()), "{motion}: {told:?}");
            assert!(pieces.iter().all(|piece| told[0].contains(piece)), "{told:?} lacks one of {pieces:?}");
        }
    }

    #[test]
    fn a_speed_of_the_start_that_a_motion_ignores_is_warned_of() {
        let told = |enabled: bool, speed: f64| {
            let motion = json!({ "position": 0, "enabled": enabled });
            let mut text = definition(motion);
            text["start"]["speed"] = json!(speed);
            Mechanism::from_json(&text.to_string())
                .unwrap()
                .warnings()
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
        };
        assert!(told(true, 0.0).is_empty() && told(false, 5.0).is_empty());
        let [one] = &told(true, 5.0)[..] else { panic!("one warning") };
        assert!(
            one.starts_with("start.speed: this key has no effect, because actuators.servo.motion prescribes"),
            "{one}"
        );
    }

    #[test]
    fn rounded_values_of_a_dense_table_are_warned_of() {
        let points = |count: i32, digits: i32| {
            let unit = 10.0_f64.powi(digits);
            let value = |t: f64| t - (std::f64::consts::TAU * t).sin() / std::f64::consts::TAU;
            let at = |t: f64| if digits < 0 { value(t) } else { (value(t) * unit).round() / unit };
            (0..=count).map(|k| f64::from(k) / f64::from(count)).map(|t| json!([t, at(t)])).collect::<Vec<_>>()
        };
        for (count, digits, is_told) in
            [(200, 4, true), (200, 8, false), (20, 4, false), (200, -1, false), (36, 5, false)]
        {
            let told = warnings(json!({ "profile": "table", "points": points(count, digits) }));
            assert_eq!(told.len(), usize::from(is_told), "{count} {digits}: {told:?}");
            let start = "servo.motion.points: the points have values in steps of 0.0001";
            assert!(!is_told || told[0].contains(start), "{told:?}");
        }
    }
}
