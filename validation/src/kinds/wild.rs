//! Random mechanisms of the kinds: lengths, masses, loads, stops, starts.
use super::lagrange::Place;
use super::sketch::{Frame, Miss, Sketch, Spring};
use super::vary::Vary;
use super::{ROUND, all, travel};
use crate::attack::random::Random;
use std::f64::consts::PI;

/// Masses of the bodies [kg].
const MASSES: [f64; 2] = [0.02, 20.0];

/// What was drawn.
pub enum Draw {
    /// A mechanism, and the text of its definition.
    Possible(Box<Sketch>, String),
    /// The lengths cannot be joined at the start; the guess is that of the usual lengths.
    Impossible(Box<Sketch>, String),
    /// The start is so near a limit of the travel that the closed form does not suit: nothing is asked.
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
    // Where the coordinate stands still a speed of it says nothing.
    let scale = if matches!(sketch.coordinate, super::Coordinate::Angle(_)) { 1.0 } else { sketch.size() };
    if place.value(&sketch).slope().abs() < 0.02 * scale {
        return (name, Draw::Near);
    }
    load(&mut sketch, random);
    if random.chance(0.5) {
        let parts = [random.within(0.3, 0.95), random.within(0.3, 0.95)];
        let restitution = if random.chance(0.3) { 0.0 } else { random.within(0.1, 0.8) };
        sketch.stops = travel::stops(&sketch, travel::reach(&sketch, 0.3 * ROUND), parts, restitution);
    }
    let text = sketch.definition_at(&place.places);
    (name, Draw::Possible(Box::new(sketch), text))
}

/// A torque on a body that turns, and a spring with a damper to a far place.
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
        // A rate of own_motion * size is damped with about the weight at most.
        let damping =
            weight / (size * sketch.own_motion()) * if random.chance(0.3) { 0.0 } else { random.decades(1e-3, 1.0) };
        let anchor = [far * away.cos(), far * away.sin()];
        sketch.loads.springs.push(Spring { anchor, end, stiffness, damping, free: far });
    }
}
