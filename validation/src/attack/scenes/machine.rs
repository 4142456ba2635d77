//! Random machines of the scenes: a block on a slope, a slider-crank, a four-bar linkage, with friction, stops,
//! bumpers, a lock, a drive with losses.
//!
//! In: random numbers. Out: sketches at their start. Must not depend on an equation of motion.
use super::super::random::Random;
use super::newton::turned;
use crate::kinds::jet::{Jet, Vector};
use crate::kinds::sketch::{Body, Coordinate, Sketch, Stop};
use std::f64::consts::PI;

/// A fixed point of the ground from which stops measure a distance [m].
const POST: [f64; 2] = [0.2, 0.7];

/// A machine with a force or a torque that moves it.
pub struct Machine {
    pub sketch: Sketch,
    pub load: f64,
}

/// A quantity that a stop may limit, and the size of its motion.
type Limited = (Coordinate, f64);

impl Machine {
    /// A random machine with random stops, whose start is beyond none of them.
    pub fn random(random: &mut Random) -> Self {
        let mut machine = match random.below(3) {
            0 => block(random),
            1 => slider_crank(random),
            _ => four_bar(random),
        };
        let Sketch { loads, tolerance, .. } = &mut machine.sketch;
        if random.chance(0.6) {
            let slow = random.decades(3e-3, 0.1);
            loads.friction =
                Some([random.within(0.0, 0.3), random.within(0.0, 0.2), slow, slow * random.decades(2.0, 50.0)]);
        }
        if random.chance(0.3)
            && let Some((_, efficiency)) = &mut loads.drive
        {
            *efficiency = random.within(0.4, 1.0);
        }
        *tolerance = random.decades(1e-9, 1e-5);
        machine
    }

    /// Names of the coordinate, of its speed and of the drive's input.
    pub fn names(&self) -> [String; 3] {
        let Sketch { bodies, slides, coordinate, loads, .. } = &self.sketch;
        let (stem, quantity) = match coordinate {
            Coordinate::Position(slide) => (&slides[*slide].name, "position"),
            _ => (&bodies[0].name, "angle"),
        };
        let pushes = matches!(loads.drive, Some((Coordinate::Position(_), _)));
        let input = if pushes { "load.force" } else { "load.torque" };
        [format!("{stem}.{quantity}"), format!("{stem}.speed"), input.to_owned()]
    }

    /// Gravity, the drive, and the speed at the start.
    fn of(mut sketch: Sketch, drive: Coordinate, random: &mut Random) -> Self {
        sketch.loads.gravity = [if random.chance(0.7) { 9.81 } else { 0.0 }, random.within(-PI, PI)];
        sketch.loads.drive = Some((drive, 1.0));
        sketch.coordinate = drive;
        Self { sketch, load: 1.0 }
    }

    /// Set a speed at the start of this size, and a load.
    fn driven(&mut self, random: &mut Random, speed: f64, load: f64) {
        self.sketch.start[1] = if random.chance(0.3) { 0.0 } else { random.within(-speed, speed) };
        self.load = load;
    }

    /// Add up to six stops; a lock at one of the first `monotone` quantities.
    fn add_stops(&mut self, random: &mut Random, quantities: &[Limited], monotone: usize, stiffness: f64) {
        let sketch = &mut self.sketch;
        let places = (sketch.places)(Jet::default()).unwrap_or_default();
        let poses = sketch.poses(&places);
        for _ in 0..random.below(7) {
            let n = random.below(quantities.len());
            let (on, size) = quantities[n];
            let sign = random.pick(&[-1.0, 1.0]);
            let value = sketch.value(on, &places, &poses).value() + sign * size * random.decades(0.03, 1.0);
            if matches!(on, Coordinate::Distance(..)) && value < 0.05 {
                continue;
            }
            let rigid = random.chance(0.4).then(|| if random.chance(0.3) { 0.0 } else { random.within(0.0, 0.95) });
            let stiffness = stiffness * random.decades(0.03, 10.0);
            let damping = if random.chance(0.3) { 0.0 } else { stiffness * random.decades(1e-4, 0.03) };
            if n < monotone && random.chance(0.3) {
                sketch.lock = Some(sketch.stops.len());
            }
            sketch.stops.push(Stop { on, sign, value, rigid, stiffness, damping });
        }
    }
}

/// A sketch with its points at these positions at the start.
fn standing(points: &[[f64; 2]]) -> Sketch {
    let places: Vec<Vector> = points.iter().map(|point| Vector::fixed(*point)).collect();
    Sketch::new("Scene", 0.0, move |_| Ok(places.clone()))
}

fn length([x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) -> f64 {
    (to_x - x).hypot(to_y - y)
}

/// A mass with a negligible moment of inertia.
fn point_mass(body: &mut Body, mass: f64) {
    (body.mass, body.inertia) = (mass, 1.0);
}

fn radius(random: &mut Random, size: f64) -> f64 {
    if random.chance(0.2) { 0.0 } else { size * random.within(0.0, 0.1) }
}

fn block(random: &mut Random) -> Machine {
    let (mass, at, axis) = (random.decades(0.1, 20.0), random.within(-1.0, 1.0), random.within(-PI, PI));
    let points = [[0.0; 2], turned([at, 0.0], axis)];
    let mut sketch = standing(&points).ground(&[(0, points[0])]).slider("block", 1, None, 0, axis);
    point_mass(&mut sketch.bodies[0], mass);
    let slide = Coordinate::Position(0);
    let mut machine = Machine::of(sketch, slide, random);
    machine.driven(random, 4.0, 40.0 * mass);
    machine.add_stops(random, &[(slide, 0.6), (Coordinate::Distance(POST, 1), 0.3)], 1, 500.0 * mass);
    machine
}

fn slider_crank(random: &mut Random) -> Machine {
    let crank = random.within(0.1, 0.3);
    let rod = crank * random.within(1.5, 4.0);
    let offset = (rod - crank) * random.within(-0.5, 0.5);
    let (angle, axis) = (random.within(-PI, PI), random.within(-PI, PI));
    let end = turned([crank, 0.0], angle);
    // In the frame of the slide's axis.
    let [x, y] = turned(end, -axis);
    let lift: f64 = y - offset;
    let wrist = turned([x + (rod * rod - lift * lift).sqrt(), offset], axis);
    let (mass, part) = (random.decades(0.3, 10.0), random.decades(0.2, 3.0));
    let points = [[0.0; 2], turned([0.0, offset], axis), end, wrist];
    let mut sketch = standing(&points)
        .ground(&[(0, points[0]), (1, points[1])])
        .plate("crank", 0, 2, length(points[0], end), &[])
        .plate("rod", 2, 3, length(end, wrist), &[])
        .slider("slider", 3, None, 1, axis);
    sketch.bodies[0].weigh(mass, 0.0, random);
    sketch.bodies[1].weigh(0.6 * mass, 0.0, random);
    point_mass(&mut sketch.bodies[2], mass * part);
    sketch.loads.radii = (0..3).map(|_| radius(random, crank)).collect();
    let mut machine = Machine::of(sketch, Coordinate::Angle(0), random);
    machine.driven(random, 6.0, 30.0 * mass * crank);
    let stiffness = machine.load;
    let quantities =
        [(Coordinate::Angle(0), 5.0), (Coordinate::Position(0), crank), (Coordinate::Distance(POST, 2), crank)];
    if random.chance(0.3) {
        // The drive acts on the slider: at the dead centres its force has no effect.
        machine.sketch.loads.drive = Some((Coordinate::Position(0), 1.0));
        machine.load /= crank;
        machine.add_stops(random, &quantities[..2], 1, stiffness);
    } else {
        machine.add_stops(random, &quantities, 1, stiffness);
    }
    machine
}

fn four_bar(random: &mut Random) -> Machine {
    let base: f64 = random.within(0.2, 0.6);
    let (crank, angle) = (random.within(0.1, 0.4), random.within(-PI, PI));
    let end = turned([crank, 0.0], angle);
    let far = [random.within(0.0, 0.8), random.within(0.15, 0.7) * random.pick(&[-1.0, 1.0])];
    let mass = random.decades(0.3, 10.0);
    let points = [[0.0; 2], end, far, [base, 0.0]];
    let mut sketch = standing(&points)
        .ground(&[(0, points[0]), (3, points[3])])
        .plate("crank", 0, 1, length(points[0], end), &[])
        .plate("coupler", 1, 2, length(end, far), &[])
        .plate("follower", 3, 2, length(points[3], far), &[]);
    for (body, part) in sketch.bodies.iter_mut().zip([1.0, 0.5, 2.0]) {
        body.weigh(part * mass, 0.0, random);
    }
    sketch.loads.radii = (0..4).map(|_| radius(random, crank)).collect();
    let mut machine = Machine::of(sketch, Coordinate::Angle(0), random);
    machine.driven(random, 4.0, 30.0 * mass * crank);
    let quantities = [(Coordinate::Angle(0), 2.0), (Coordinate::Angle(2), 0.7), (Coordinate::Distance(POST, 1), crank)];
    machine.add_stops(random, &quantities, 0, 30.0 * mass);
    machine
}
