//! Random mechanisms of the kinds: usual lengths or random ones near them, masses, loads, starts, and stops within the
//! travel of the closed form.
use super::lagrange::Place;
use super::sketch::{Frame, Miss, Sketch, Spring, Stop};
use super::{ROUND, all};
use crate::attack::random::Random;
use std::f64::consts::PI;

/// Source of the lengths of a mechanism.
pub struct Vary {
    random: Option<Random>,
    spread: f64,
}

impl Vary {
    /// Usual lengths.
    pub fn none() -> Self {
        Self { random: None, spread: 0.0 }
    }

    /// Random lengths, each longer or shorter than the usual one by up to the fraction `spread`.
    pub fn random(random: Random, spread: f64) -> Self {
        Self { random: Some(random), spread }
    }

    /// A length [m].
    pub fn length(&mut self, usual: f64) -> f64 {
        let spread = self.spread;
        self.random.as_mut().map_or(usual, |random| usual * (1.0 + spread * random.within(-1.0, 1.0)))
    }

    /// An angle with a deviation of up to `most` [rad].
    pub fn angle(&mut self, usual: f64, most: f64) -> f64 {
        self.random.as_mut().map_or(usual, |random| usual + most * random.within(-1.0, 1.0))
    }

    /// A number of equal parts.
    pub fn count(&mut self, usual: usize, least: usize, most: usize) -> usize {
        self.random.as_mut().map_or(usual, |random| least + random.below(most - least + 1))
    }
}

/// Step of the search, relative to its greatest distance.
const STEP: f64 = 0.005;

/// The range of the parameter about the start, at most `most` to each side, in which the closed form has values and the
/// derivative of the coordinate is at least a tenth of that at the start.
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

/// Rigid stops at these fractions of the distance from the start to the ends of a range; none if a distance is too
/// short.
pub fn stops(sketch: &Sketch, reach: [f64; 2], parts: [f64; 2], restitution: f64) -> Vec<Stop> {
    let value = |s: f64| Some(Place::of(sketch, s).ok()?.value(sketch).value());
    let start = sketch.start[0];
    let Some(from) = value(start) else { return Vec::new() };
    let places = reach.into_iter().zip(parts).filter_map(|(end, part)| value(start + part * (end - start)));
    let mut values: Vec<f64> = places.map(|there| from + sketch.apart(there, from)).collect();
    values.sort_by(f64::total_cmp);
    if values.len() < 2 || values.iter().any(|value| (value - from).abs() < 0.002 * sketch.scale()) {
        return Vec::new();
    }
    let stop = |(value, sign)| Stop {
        on: sketch.coordinate,
        sign,
        value,
        rigid: Some(restitution),
        stiffness: 0.0,
        damping: 0.0,
    };
    values.into_iter().zip([-1.0, 1.0]).map(stop).collect()
}

/// Masses of the bodies [kg].
const MASSES: [f64; 2] = [0.02, 20.0];

/// A random mechanism.
pub enum Draw {
    /// A mechanism, and the text of its definition.
    Possible(Box<Sketch>, String),
    /// The lengths cannot be assembled at the start; the guess is that of the usual lengths.
    Impossible(Box<Sketch>, String),
    /// The start is so near a limit of the travel that the closed form is unsuitable: nothing is checked.
    Near,
}

/// A random mechanism of a random kind.
pub fn wild(random: &mut Random) -> (&'static str, Draw) {
    let kind = &all()[random.below(all().len())];
    let name = kind.name.as_str();
    let spread = random.pick(&[0.02, 0.1, 0.25]);
    let mut sketch = kind.sketch(&mut Vary::random(Random::new(random.word()), spread));
    sketch.weigh(random, MASSES);
    sketch.tolerance = random.decades(1e-11, 1e-6);
    sketch.loads.gravity = [if random.chance(0.7) { 9.81 } else { 0.0 }, random.within(-PI, PI)];
    sketch.start[1] = sketch.own_motion() * if random.chance(0.2) { 0.0 } else { random.within(-6.0, 6.0) };
    if random.chance(0.5) {
        sketch.rough = 0.01;
    }
    let place = match Place::of(&sketch, sketch.start[0]) {
        Ok(place) => place,
        Err(Miss::Near) => return (name, Draw::Near),
        Err(Miss::Apart) => {
            let usual = kind.sketch(&mut Vary::none());
            return (
                name,
                match Place::of(&usual, usual.start[0]) {
                    Ok(place) if usual.bodies.len() == sketch.bodies.len() => {
                        sketch.rough = 0.0;
                        let text = sketch.definition_at(&place.places);
                        Draw::Impossible(Box::new(sketch), text)
                    }
                    _ => Draw::Near,
                },
            );
        }
    };
    // Where the derivative of the coordinate is 0, its speed is not defined by the rate.
    if place.value(&sketch).slope().abs() < 0.02 * sketch.scale() {
        return (name, Draw::Near);
    }
    load(&mut sketch, random);
    if random.chance(0.5) {
        let parts = [random.within(0.3, 0.95), random.within(0.3, 0.95)];
        let restitution = if random.chance(0.3) { 0.0 } else { random.within(0.1, 0.8) };
        sketch.stops = stops(&sketch, reach(&sketch, 0.3 * ROUND), parts, restitution);
    }
    let text = sketch.definition_at(&place.places);
    (name, Draw::Possible(Box::new(sketch), text))
}

/// Add a torque on a rotating body, and a spring with a damper to a far point.
fn load(sketch: &mut Sketch, random: &mut Random) {
    let (size, count) = (sketch.size(), sketch.bodies.len());
    let weight = 9.81 * sketch.bodies.iter().map(|body| body.mass).sum::<f64>();
    let body = random.below(count);
    if random.chance(0.5) && sketch.turns(body) {
        sketch.loads.torques.push((body, 0.3 * weight * size * random.within(-1.0, 1.0)));
    }
    if random.chance(0.5) {
        let ends = sketch.bodies.iter().map(|body| match body.frame {
            Frame::To(end, _) if sketch.owner(end).is_some() => end,
            _ => body.origin,
        });
        let ends: Vec<usize> = ends.filter(|&end| sketch.owner(end).is_some()).collect();
        let end = ends[random.below(ends.len())];
        let (away, far) = (random.within(-PI, PI), random.within(6.0, 9.0) * size);
        let stiffness = weight / size * random.decades(0.01, 3.0);
        // The damping force at a rate of own_motion * size is about the weight at most.
        let damping =
            weight / (size * sketch.own_motion()) * if random.chance(0.3) { 0.0 } else { random.decades(1e-3, 1.0) };
        let anchor = [far * away.cos(), far * away.sin()];
        sketch.loads.springs.push(Spring { anchor, end, stiffness, damping, free: far });
    }
}
