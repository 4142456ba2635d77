//! A mechanism in the engine compared with its closed form at each position, and with its motion by Lagrange's
//! equation.
//!
//! Positions: all angles and positions in slides against the closed form at the engine's own coordinate. Speeds and
//! accelerations likewise. Reactions: the Newton-Euler equations of every body with the engine's reactions and the
//! accelerations of the closed form. Motion: the coordinate against Lagrange's equation.
use super::angle_apart;
use super::jet::{Jet, Vector};
use super::lagrange::{End, Motion, Place};
use super::sketch::{Coordinate, Joint, Miss, Sketch};
use linkage_fmu::simulation::{Simulation, SimulationError};

/// Errors of an engine's run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Off {
    /// Largest error of a position: of an angle [rad], or of a point relative to the mechanism's size, divided by the
    /// error due to the rounding of the coordinate.
    pub position: f64,
    /// Largest error of a speed or an acceleration, relative to the largest one.
    pub rates: f64,
    /// Largest residual force in the Newton-Euler equations of a body, relative to the largest force so far.
    pub balance: f64,
    /// Largest error of the coordinate [rad, or relative to the size] and its speed, relative to the largest one.
    pub motion: f64,
    /// Effect on the motion of a state displaced by the tolerance, where the ratio of `motion` to it is largest.
    pub moved: f64,
    /// Largest ratio of `motion` to the greater of the tolerance and `moved`.
    pub ratio: f64,
    /// Largest ratio of `motion` to the tolerance alone.
    pub plain: f64,
    /// Number of compared samples.
    pub samples: u32,
}

impl Off {
    fn take(&mut self, other: Self) {
        self.position = self.position.max(other.position);
        self.rates = self.rates.max(other.rates);
        self.balance = self.balance.max(other.balance);
    }
}

/// Error of the reference integration itself.
const OWN: f64 = 1e-12;
/// Distance of two motions above which a comparison has no significance.
const LOST: f64 = 1e-3;
/// Ratio of a body's angular speed to the speed of the coordinate from which on the coordinate counts as at a dead
/// centre.
const DEAD: f64 = 1e3;
/// Ratio of the error to the effect of a displaced start above which states during the motion are displaced too, and
/// the number of these states.
const SUSPECT: f64 = 10.0;
const PLACES: usize = 12;

/// A sketch in the engine, at its start.
pub fn open(text: &str) -> Result<Simulation, SimulationError> {
    let mut run = Simulation::open(text)?;
    run.initialize()?;
    Ok(run)
}

/// Names of the outputs read from the engine.
pub struct Names {
    value: String,
    joints: Vec<Joint>,
}

impl Names {
    fn of(sketch: &Sketch) -> Self {
        let value = match sketch.coordinate {
            Coordinate::Angle(body) => format!("{}.angle", sketch.bodies[body].name),
            Coordinate::Position(slide) => format!("{}.position", sketch.slides[slide].name),
            Coordinate::Distance(..) => String::new(),
        };
        Self { value, joints: sketch.joints() }
    }
}

fn get(run: &mut Simulation, name: &str) -> Result<f64, String> {
    run.get(name).map_err(|e| format!("{name}: {e}"))
}

/// Value and first and second time derivative of an angle or a position in the engine.
fn rates(run: &mut Simulation, name: &str) -> Result<[f64; 3], String> {
    let stem = name.trim_end_matches(".angle").trim_end_matches(".position");
    Ok([get(run, name)?, get(run, &format!("{stem}.speed"))?, get(run, &format!("{stem}.acceleration"))?])
}

/// The difference of two values of the sketch's coordinate, without whole turns [rad, or relative to the size].
fn apart(sketch: &Sketch, a: f64, b: f64) -> f64 {
    sketch.apart(a, b) / sketch.scale()
}

/// The parameter at which the coordinate has a value, near a guess.
fn parameter(sketch: &Sketch, value: f64, guess: f64) -> Result<f64, Miss> {
    let mut s = guess;
    for _ in 0..8 {
        let now = Place::of(sketch, s)?.value(sketch);
        s -= sketch.apart(now.value(), value) / now.slope();
    }
    Ok(s)
}

/// Compare positions, rates and reactions of the present state; `s` is the parameter of the reference, `strongest` the
/// largest force so far. None at a dead centre of the coordinate, where its rate does not determine the others, and
/// outside the range of the closed form.
fn state(
    sketch: &Sketch,
    run: &mut Simulation,
    names: &Names,
    s: f64,
    strongest: &mut f64,
) -> Result<Option<Off>, String> {
    let [value, speed, acceleration] = rates(run, &names.value)?;
    let Ok(s) = parameter(sketch, value, s) else { return Ok(None) };
    let Ok(place) = Place::of(sketch, s) else { return Ok(None) };
    let own = place.value(sketch);
    let fastest = place.poses.iter().fold(0.0_f64, |most, pose| most.max(pose.angle.slope().abs()));
    if fastest * sketch.scale() > DEAD * own.slope().abs() {
        return Ok(None);
    }
    let rate = speed / own.slope();
    let second = (acceleration - own.bend() * rate * rate) / own.slope();
    let mut off = Off::default();
    let size = sketch.size();
    let mut judge = |[x, v, a]: [f64; 3], jet: Jet, scale: f64, is_angle: bool| {
        // A rounding error of the coordinate displaces the parameter, and with it all other quantities.
        let lever = 1.0 + (jet.slope() / own.slope()).abs() / scale * sketch.scale();
        let apart = if is_angle { angle_apart(x, jet.value()) } else { x - jet.value() };
        let (w, b) = (jet.slope() * rate, jet.slope() * second + jet.bend() * rate * rate);
        let fast = (jet.slope() * rate).abs() + scale * rate.abs() * own.slope().abs() / sketch.scale();
        let strong = (jet.slope() * second).abs()
            + (jet.bend() * rate * rate).abs()
            + scale * second.abs()
            + scale * rate * rate;
        let error = Off {
            position: apart.abs() / scale / lever,
            rates: ((v - w).abs() / (fast + 1e-9 * scale) / lever).max((a - b).abs() / (strong + 1e-9 * scale) / lever),
            ..Off::default()
        };
        off.take(error);
    };
    for (k, pose) in place.poses.iter().enumerate() {
        if sketch.turns(k) {
            judge(rates(run, &format!("{}.angle", sketch.bodies[k].name))?, pose.angle, 1.0, true);
        }
        let body = &sketch.bodies[k];
        let local = body.points.last().map_or([0.0; 2], |(_, at)| *at);
        let mark = Sketch::at(pose, local);
        for (axis, jet) in [("x", mark.x), ("y", mark.y)] {
            let mark = format!("{}_mark", body.name);
            let names =
                [format!("{mark}.{axis}"), format!("{mark}.velocity_{axis}"), format!("{mark}.acceleration_{axis}")];
            let [x, v, a] = [get(run, &names[0])?, get(run, &names[1])?, get(run, &names[2])?];
            judge([x, v, a], jet, size, false);
        }
    }
    for k in (0..sketch.slides.len()).filter(|&k| !sketch.follows(k)) {
        let position = format!("{}.position", sketch.slides[k].name);
        judge(rates(run, &position)?, sketch.value(Coordinate::Position(k), &place.places, &place.poses), size, false);
    }
    off.balance = balance(sketch, run, names, (&place, [rate, second]), strongest)?;
    Ok(Some(off))
}

/// Residual force in the Newton-Euler equations of the bodies with the engine's reactions, relative to the largest
/// force so far, which is kept in `strongest`.
fn balance(
    sketch: &Sketch,
    run: &mut Simulation,
    names: &Names,
    (place, [rate, second]): (&Place, [f64; 2]),
    strongest: &mut f64,
) -> Result<f64, String> {
    let (size, [g, up]) = (sketch.size(), sketch.loads.gravity);
    let mut left: Vec<[f64; 3]> = Vec::new();
    let mut largest = 0.0_f64;
    for (body, pose) in sketch.bodies.iter().zip(&place.poses) {
        let center = Sketch::at(pose, body.center);
        let inertial = [(body.mass, center.x), (body.mass, center.y), (body.inertia, pose.angle)]
            .map(|(mass, x)| -mass * (x.slope() * second + x.bend() * rate * rate));
        let weight = [-body.mass * g * up.cos(), -body.mass * g * up.sin(), 0.0];
        largest = largest.max(inertial[0].hypot(inertial[1])).max(body.mass * g).max(inertial[2].abs() / size);
        left.push([0, 1, 2].map(|n| inertial[n] + weight[n]));
    }
    let mut push = |body: Option<usize>, at: [f64; 2], [x, y]: [f64; 2], moment: f64, sign: f64| {
        largest = largest.max(x.hypot(y)).max(moment.abs() / size);
        if let Some(body) = body {
            let center = Sketch::at(&place.poses[body], sketch.bodies[body].center);
            let arm = [at[0] - center.x.value(), at[1] - center.y.value()];
            let add = [x, y, arm[0] * y - arm[1] * x + moment];
            left[body].iter_mut().zip(add).for_each(|(sum, add)| *sum += sign * add);
        }
    };
    for joint in &names.joints {
        let [first, second] = joint.ends;
        let at = place.places[second.1];
        let force = [get(run, &format!("{}.force_x", joint.name))?, get(run, &format!("{}.force_y", joint.name))?];
        let torque = if joint.slide.is_some() { get(run, &format!("{}.torque", joint.name))? } else { 0.0 };
        for (body, sign) in [(first.0, -1.0), (second.0, 1.0)] {
            push(body, [at.x.value(), at.y.value()], force, torque, sign);
        }
    }
    for (body, torque) in &sketch.loads.torques {
        push(Some(*body), [0.0; 2], [0.0; 2], *torque, 1.0);
    }
    for spring in &sketch.loads.springs {
        let end = place.places[spring.end];
        let along = end - Vector::fixed(spring.anchor);
        let part = -place.pull(spring, rate)[0] / along.norm().value();
        let force = [part * along.x.value(), part * along.y.value()];
        push(sketch.owner(spring.end), [end.x.value(), end.y.value()], force, 0.0, 1.0);
    }
    let worst = left.iter().map(|[x, y, m]| x.hypot(*y).max(m.abs() / size)).fold(0.0, f64::max);
    *strongest = strongest.max(largest);
    Ok(worst / *strongest)
}

/// Distance of two motions at one time: of their coordinates and of their speeds relative to the largest speed.
fn between(sketch: &Sketch, one: &Motion<'_>, other: &Motion<'_>, fastest: f64) -> Result<f64, Miss> {
    let [near, moved] = [one, other].map(|motion| {
        let value = Place::of(sketch, motion.state[0])?.value(sketch);
        Ok((value.value(), value.slope() * motion.state[1]))
    });
    let ((x, v), (y, w)) = (near?, moved?);
    Ok(apart(sketch, x, y).abs().max((v - w).abs() / fastest))
}

/// Largest distance from the last state of a motion if the state at one of several times, `h` apart, is displaced by
/// the tolerance.
fn largest_effect(sketch: &Sketch, track: &[Motion<'_>], h: f64, fastest: f64) -> f64 {
    let Some((last, before)) = track.split_last() else { return 0.0 };
    let mut farthest = 0.0_f64;
    for k in 0..PLACES {
        let from = k * before.len() / PLACES;
        let Some(mut moved) = before.get(from).map(|motion| motion.perturbed(sketch.tolerance)) else { continue };
        if (from..before.len()).all(|_| moved.advance(h) == End::Reached) {
            farthest = farthest.max(between(sketch, last, &moved, fastest).unwrap_or(0.0));
        }
    }
    farthest
}

/// A function that makes a step of the engine.
pub type Step<'a> = dyn FnMut(&mut Simulation, f64) -> Result<(), SimulationError> + 'a;

/// Run a sketch over a span in equal steps and compare after each.
pub fn run(sketch: &Sketch, run: &mut Simulation, span: f64, steps: u32, step: &mut Step<'_>) -> Result<Off, String> {
    let names = Names::of(sketch);
    let mut one = Motion::new(sketch);
    let mut other = one.perturbed(sketch.tolerance);
    let mut track = vec![one.clone()];
    let mut off = Off::default();
    let (mut fastest, mut strongest) = (0.0_f64, 0.0_f64);
    let h = span / f64::from(steps);
    for _ in 0..steps {
        if [&mut one, &mut other].into_iter().any(|motion| motion.advance(h) == End::Left) {
            break;
        }
        step(run, h).map_err(|e| format!("a step is refused: {e}"))?;
        track.push(one.clone());
        let Ok(near) = Place::of(sketch, one.state[0]).map(|place| place.value(sketch)) else { break };
        let rate = near.slope() * one.state[1];
        fastest = fastest.max(rate.abs()).max(1e-2 * sketch.scale());
        let Ok(mut doubt) = between(sketch, &one, &other, fastest) else { break };
        if doubt > LOST {
            break;
        }
        let [value, speed, _] = rates(run, &names.value)?;
        let motion = apart(sketch, value, near.value()).abs().max((speed - rate).abs() / fastest);
        let over = |doubt: f64| (motion - OWN).max(0.0) / sketch.tolerance.max(doubt);
        if over(doubt) > SUSPECT {
            doubt = doubt.max(largest_effect(sketch, &track, h, fastest));
        }
        let ratio = over(doubt);
        off.motion = off.motion.max(motion);
        off.plain = off.motion / sketch.tolerance;
        if ratio >= off.ratio {
            (off.ratio, off.moved) = (ratio, doubt);
        }
        off.samples += 1;
        if !one.held
            && let Some(now) = state(sketch, run, &names, one.state[0], &mut strongest)?
        {
            off.take(now);
        }
    }
    Ok(off)
}
