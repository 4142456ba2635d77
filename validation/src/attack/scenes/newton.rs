//! The Newton-Euler equations of all bodies in absolute coordinates, with joints as constraints and multipliers.
//!
//! In: a sketch, positions and speeds of the centres of mass, angles of the bodies, forces. Out: accelerations,
//! quantities with their gradients, projection of a state onto the constraints. Must not depend on the engine.
//!
//! M a = Q + J^T lambda, J a = gamma. As M is diagonal here, (J M^-1 J^T) lambda = gamma - J M^-1 Q is solved by
//! Gaussian elimination with pivoting. With friction Q depends on lambda: a fixed-point iteration, which converges as
//! each round changes less than the last.
use crate::kinds::jet::Jet;
use crate::kinds::sketch::{Coordinate, Sketch};
use crate::linear::Factors;

/// Coordinates of three bodies: x, y and angle of each; 0 for unused bodies.
pub type Coordinates = [f64; 9];
/// Multipliers of four joints, two each.
type Multipliers = [f64; 8];
/// A vector in the plane.
type Vector = [f64; 2];

/// Number of fixed-point iterations after which the friction forces count as unsolvable by this method.
const ROUNDS: usize = 400;

fn dot(a: &Coordinates, b: &Coordinates) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A vector rotated by an angle.
pub fn turned([x, y]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// A point of a body, or of the ground, in its frame [m].
#[derive(Clone, Copy, Debug)]
struct Point {
    body: Option<usize>,
    at: Vector,
}

/// A joint: a pin with a radius [m], or a slide on which a body that does not rotate moves along a line of the ground
/// in a direction [rad].
#[derive(Clone, Debug)]
pub struct Link {
    ends: [Point; 2],
    radius: f64,
    axis: Option<f64>,
}

/// A point: position, velocity, its arm from the centre of mass, and the body's angular speed.
struct Moving {
    place: Vector,
    velocity: Vector,
    arm: Vector,
    spin: f64,
}

/// One constraint in a state: gradient, right-hand side of J a, residual.
#[derive(Clone, Copy, Default)]
struct Row {
    gradient: Coordinates,
    gamma: f64,
    residual: f64,
}

/// All constraints in a state.
struct Constraints {
    rows: [Row; 8],
    count: usize,
}

impl Constraints {
    /// Factors of J W J^T with the weights W.
    fn factors(&self, weights: &Coordinates) -> Factors<8> {
        let mut matrix = [[0.0; 8]; 8];
        for (out, a) in matrix.iter_mut().zip(&self.rows) {
            for (out, b) in out.iter_mut().zip(&self.rows) {
                let terms = a.gradient.iter().zip(&b.gradient).zip(weights);
                *out = terms.map(|((a, b), weight)| a * b * weight).sum();
            }
        }
        Factors::of(matrix, self.count)
    }

    /// J W x.
    fn along(&self, weights: &Coordinates, x: &Coordinates) -> Multipliers {
        self.rows.map(|row| row.gradient.iter().zip(weights).zip(x).map(|((j, w), x)| j * w * x).sum())
    }

    /// J^T lambda.
    fn held(&self, lambda: &Multipliers) -> Coordinates {
        let mut out = [0.0; 9];
        for (row, lambda) in self.rows.iter().zip(lambda) {
            out.iter_mut().zip(row.gradient).for_each(|(sum, j)| *sum += j * lambda);
        }
        out
    }
}

/// Equations of motion of a sketch.
#[derive(Clone)]
pub struct Newton<'a> {
    pub sketch: &'a Sketch,
    pub links: Vec<Link>,
    /// The coordinates at the start.
    pub start: Coordinates,
    /// Reciprocal masses and moments of inertia.
    mobility: Coordinates,
    /// The multipliers of the last evaluation, from which the friction iteration starts.
    last: Multipliers,
    /// Whether a friction iteration has failed.
    pub failed: bool,
}

impl<'a> Newton<'a> {
    /// For a sketch of at most three bodies and four joints, whose slides are on the ground; None for others.
    pub fn new(sketch: &'a Sketch) -> Option<Self> {
        let places = (sketch.places)(Jet::variable(sketch.start[0])).ok()?;
        let (mut mobility, mut start) = ([0.0; 9], [0.0; 9]);
        for (k, (body, pose)) in sketch.bodies.iter().zip(sketch.poses(&places)).enumerate() {
            mobility[3 * k..3 * k + 3].copy_from_slice(&[1.0 / body.mass, 1.0 / body.mass, 1.0 / body.inertia]);
            let [x, y] = Sketch::at(&pose, body.center).place();
            start[3 * k..3 * k + 3].copy_from_slice(&[x, y, pose.angle.value()]);
        }
        let link = |(k, joint): (usize, crate::kinds::sketch::Joint)| {
            let ends =
                joint.ends.map(|(body, point)| Point { body, at: sketch.local(body, point).unwrap_or_default() });
            let radius = sketch.loads.radii.get(k).copied().unwrap_or_default();
            Link { ends, radius, axis: joint.slide.map(|slide| sketch.slides[slide].axis) }
        };
        let links = sketch.joints().into_iter().enumerate().map(link).collect();
        Some(Self { sketch, links, start, mobility, last: [0.0; 8], failed: false })
    }

    fn moving(&self, q: &Coordinates, v: &Coordinates, point: Point) -> Moving {
        let Some(body) = point.body else {
            return Moving { place: point.at, velocity: [0.0; 2], arm: [0.0; 2], spin: 0.0 };
        };
        let center = self.sketch.bodies[body].center;
        let arm = turned([point.at[0] - center[0], point.at[1] - center[1]], q[3 * body + 2]);
        let spin = v[3 * body + 2];
        Moving {
            place: [q[3 * body] + arm[0], q[3 * body + 1] + arm[1]],
            velocity: [v[3 * body] - spin * arm[1], v[3 * body + 1] + spin * arm[0]],
            arm,
            spin,
        }
    }

    /// Add the gradient of a point's position in a direction.
    fn along(point: Point, arm: Vector, [x, y]: Vector, sign: f64, row: &mut Coordinates) {
        if let Some(body) = point.body {
            row[3 * body] += sign * x;
            row[3 * body + 1] += sign * y;
            row[3 * body + 2] += sign * (y * arm[0] - x * arm[1]);
        }
    }

    fn constraints(&self, q: &Coordinates, v: &Coordinates) -> Constraints {
        let mut out = Constraints { rows: [Row::default(); 8], count: 2 * self.links.len() };
        for (link, rows) in self.links.iter().zip(out.rows.chunks_exact_mut(2)) {
            let [first, second] = link.ends;
            let [a, b] = link.ends.map(|point| self.moving(q, v, point));
            let apart = [b.place[0] - a.place[0], b.place[1] - a.place[1]];
            // The part of the relative acceleration independent of the accelerations, with opposite sign.
            let inward = [0, 1].map(|n: usize| b.spin * b.spin * b.arm[n] - a.spin * a.spin * a.arm[n]);
            let row = |[x, y]: Vector| {
                let mut row = Row {
                    gamma: inward[0] * x + inward[1] * y,
                    residual: apart[0] * x + apart[1] * y,
                    ..Row::default()
                };
                Self::along(second, b.arm, [x, y], 1.0, &mut row.gradient);
                Self::along(first, a.arm, [x, y], -1.0, &mut row.gradient);
                row
            };
            rows[0] = row(link.axis.map_or([1.0, 0.0], |axis| turned([0.0, 1.0], axis)));
            match (link.axis, second.body) {
                (None, _) => rows[1] = row([0.0, 1.0]),
                (Some(_), Some(body)) => {
                    rows[1].gradient[3 * body + 2] = 1.0;
                    rows[1].residual = q[3 * body + 2] - self.start[3 * body + 2];
                }
                (Some(_), None) => {}
            }
        }
        out
    }

    /// Value of a quantity and its gradient.
    pub fn quantity(&self, quantity: Coordinate, q: &Coordinates) -> (f64, Coordinates) {
        let mut row = [0.0; 9];
        let still = [0.0; 9];
        let value = match quantity {
            Coordinate::Angle(body) => {
                row[3 * body + 2] = 1.0;
                q[3 * body + 2]
            }
            Coordinate::Position(slide) => {
                let Some(Link { ends: [first, second], axis: Some(axis), .. }) =
                    self.links.iter().filter(|link| link.axis.is_some()).nth(slide)
                else {
                    return (0.0, row);
                };
                let unit = turned([1.0, 0.0], *axis);
                let [a, b] = [first, second].map(|point| self.moving(q, &still, *point));
                Self::along(*second, b.arm, unit, 1.0, &mut row);
                (b.place[0] - a.place[0]) * unit[0] + (b.place[1] - a.place[1]) * unit[1]
            }
            Coordinate::Distance(place, point) => {
                let body = self.sketch.owner(point);
                let point = Point { body, at: self.sketch.local(body, point).unwrap_or_default() };
                let end = self.moving(q, &still, point);
                let [x, y] = [end.place[0] - place[0], end.place[1] - place[1]];
                let length = x.hypot(y);
                Self::along(point, end.arm, [x / length, y / length], 1.0, &mut row);
                length
            }
        };
        (value, row)
    }

    /// Rate of a quantity.
    pub fn rate(&self, quantity: Coordinate, q: &Coordinates, v: &Coordinates) -> f64 {
        dot(&self.quantity(quantity, q).1, v)
    }

    /// Slip speed of a joint with sign [m/s]; None without friction.
    pub fn slip(&self, link: &Link, q: &Coordinates, v: &Coordinates) -> Option<f64> {
        self.sketch.loads.friction?;
        let [first, second] = link.ends;
        match link.axis {
            None if link.radius > 0.0 => {
                let spin = |point: Point| point.body.map_or(0.0, |body| v[3 * body + 2]);
                Some(link.radius * (spin(second) - spin(first)))
            }
            None => None,
            Some(axis) => {
                let (unit, velocity) = (turned([1.0, 0.0], axis), self.moving(q, v, second).velocity);
                Some(velocity[0] * unit[0] + velocity[1] * unit[1])
            }
        }
    }

    /// Coefficient of friction with the sign of the slip speed.
    fn coefficient(&self, slip: f64) -> f64 {
        let Some([still, moving, slow, fast]) = self.sketch.loads.friction else { return 0.0 };
        let v = slip.abs();
        let mu = if v <= slow {
            still * v / slow
        } else if v < fast {
            let s = (v - slow) / (fast - slow);
            still + (moving - still) * s * s * (3.0 - 2.0 * s)
        } else {
            moving
        };
        mu.copysign(slip)
    }

    /// The forces plus the friction forces that follow from the multipliers, for joints with these coefficients.
    fn rubbed(&self, push: &Coordinates, joints: &[(usize, f64)], lambda: &Multipliers) -> Coordinates {
        let mut rubbed = *push;
        for &(j, mu) in joints {
            let Link { ends: [first, second], radius, axis } = &self.links[j];
            match axis {
                None => {
                    let torque = -mu * radius * lambda[2 * j].hypot(lambda[2 * j + 1]);
                    for (point, sign) in [(second, 1.0), (first, -1.0)] {
                        point.body.into_iter().for_each(|body| rubbed[3 * body + 2] += sign * torque);
                    }
                }
                Some(axis) => {
                    let [x, y] = turned([-mu * lambda[2 * j].abs(), 0.0], *axis);
                    if let Some(body) = second.body {
                        (rubbed[3 * body], rubbed[3 * body + 1]) = (rubbed[3 * body] + x, rubbed[3 * body + 1] + y);
                    }
                }
            }
        }
        rubbed
    }

    /// Accelerations with generalised forces, gravity and friction.
    pub fn acceleration(&mut self, q: &Coordinates, v: &Coordinates, forces: &Coordinates) -> Coordinates {
        let constraints = self.constraints(q, v);
        let mut push = *forces;
        let [g, up] = self.sketch.loads.gravity;
        for (k, body) in self.sketch.bodies.iter().enumerate() {
            push[3 * k] -= body.mass * g * up.cos();
            push[3 * k + 1] -= body.mass * g * up.sin();
        }
        let factors = constraints.factors(&self.mobility);
        let solve = |push: &Coordinates| {
            let free = constraints.along(&self.mobility, push);
            factors.solve(&std::array::from_fn(|r| constraints.rows[r].gamma - free[r]))
        };
        let slips = self.links.iter().enumerate();
        let slips = slips.filter_map(|(j, link)| Some((j, self.coefficient(self.slip(link, q, v)?))));
        let joints: Vec<(usize, f64)> = slips.collect();
        let mut lambda = if joints.is_empty() { solve(&push) } else { self.last };
        let mut found = joints.is_empty();
        for _ in 0..ROUNDS {
            if found {
                break;
            }
            let next = solve(&self.rubbed(&push, &joints, &lambda));
            let size = next.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            let change = next.iter().zip(&lambda).fold(0.0_f64, |change, (a, b)| change.max((a - b).abs()));
            lambda = next;
            found = change <= 3e-15 * size || size == 0.0;
        }
        let finite = lambda.iter().all(|x| x.is_finite());
        self.failed |= !found || !finite;
        self.last = if finite { lambda } else { [0.0; 8] };
        let (rubbed, held) = (self.rubbed(&push, &joints, &lambda), constraints.held(&lambda));
        std::array::from_fn(|c| self.mobility[c] * (rubbed[c] + held[c]))
    }

    /// The admissible velocity with unit rate of a quantity, from the change of the accelerations by a generalised
    /// force. None at a dead centre of the quantity.
    pub fn free_motion(&self, quantity: Coordinate, q: &Coordinates) -> Option<Coordinates> {
        let constraints = self.constraints(q, &[0.0; 9]);
        let row = self.quantity(quantity, q).1;
        let right = constraints.along(&self.mobility, &row).map(|x| -x);
        let held = constraints.held(&constraints.factors(&self.mobility).solve(&right));
        let motion: Coordinates = std::array::from_fn(|c| self.mobility[c] * (row[c] + held[c]));
        let rate = dot(&row, &motion);
        (rate > 1e-12).then(|| motion.map(|x| x / rate))
    }

    /// Project positions and speeds onto the constraints, by the least change.
    pub fn project(&self, q: &mut Coordinates, v: &mut Coordinates) {
        let ones = [1.0; 9];
        for round in 0..3 {
            let constraints = self.constraints(q, v);
            let is_place = round < 2;
            let right = if is_place { constraints.rows.map(|row| row.residual) } else { constraints.along(&ones, v) };
            let held = constraints.held(&constraints.factors(&ones).solve(&right));
            let moved = if is_place { &mut *q } else { &mut *v };
            moved.iter_mut().zip(held).for_each(|(x, held)| *x -= held);
        }
    }
}
