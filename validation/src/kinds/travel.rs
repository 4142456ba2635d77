//! The travel of a mechanism as its closed form has it.
use super::lagrange::Place;
use super::sketch::{Coordinate, Sketch, Stops};

/// Step of the search, as a part of the farthest place.
const STEP: f64 = 0.005;

/// The span of the parameter about the start, at most `most` to each side, in which the closed form has values and the
/// coordinate changes with the parameter at a tenth of its rate at the start or more.
pub fn reach(sketch: &Sketch, most: f64) -> [f64; 2] {
    let slope = |s: f64| Place::of(sketch, s).map(|place| place.value(sketch).slope());
    let start = sketch.start[0];
    let Ok(usual) = slope(start) else { return [start; 2] };
    [-1.0, 1.0].map(|side| {
        let mut at = start;
        for k in 1..=(1.0 / STEP) as u32 {
            let next = start + side * most * STEP * f64::from(k);
            if !slope(next).is_ok_and(|slope| slope * usual > 0.1 * usual * usual) {
                break;
            }
            at = next;
        }
        at
    })
}

/// Stops at these parts of the way from the start to the ends of a reach; None if a way is too short.
pub fn stops(sketch: &Sketch, reach: [f64; 2], parts: [f64; 2], restitution: f64) -> Option<Stops> {
    let start = Place::of(sketch, sketch.start[0]).ok()?.value(sketch).value();
    let mut values = [0.0; 2];
    for ((value, end), part) in values.iter_mut().zip(reach).zip(parts) {
        let end = sketch.start[0] + part * (end - sketch.start[0]);
        let there = Place::of(sketch, end).ok()?.value(sketch).value();
        *value = match sketch.coordinate {
            Coordinate::Angle(_) => start + super::angle_apart(there, start),
            Coordinate::Position(_) => there,
        };
        let scale = if matches!(sketch.coordinate, Coordinate::Angle(_)) { 1.0 } else { sketch.size() };
        if (*value - start).abs() < 0.002 * scale {
            return None;
        }
    }
    values.sort_by(f64::total_cmp);
    Some(Stops { values, restitution })
}
