//! Newton and Euler's equations of all bodies in absolute coordinates, with the joints as constraints and multipliers.
//!
//! In: a machine, the places and speeds of the centres of mass and the angles of its bodies, forces. Out:
//! accelerations, quantities with their gradients, how a state is brought back to the constraints. It must not know the
//! engine.
//!
//! M a = Q + J^T lambda, J a = gamma. As M is diagonal here, (J M^-1 J^T) lambda = gamma - J M^-1 Q is solved by
//! Gauss with pivots. Friction makes Q depend on lambda: found by repetition, as each round changes less than the last.
#![expect(clippy::needless_range_loop, reason = "rows and columns are written as in the equations")]
use super::machine::{Freedom, Joint, Machine, Point, Quantity, Vector, turned};

/// Coordinates of three bodies: x, y and angle of each; those of bodies that are not there stay 0.
pub type Coordinates = [f64; 9];
/// Multipliers of four joints, two each.
type Multipliers = [f64; 8];

/// Rounds after which friction counts as having no solution that this method finds.
const ROUNDS: usize = 400;

fn dot(a: &Coordinates, b: &Coordinates) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A point: place, velocity, its arm from the centre of mass, and the body's angular speed.
struct Moving {
    place: Vector,
    velocity: Vector,
    arm: Vector,
    spin: f64,
}

/// What joints are at a state: Jacobian, J a's right-hand side, residuals.
struct Constraints {
    jacobian: [Coordinates; 8],
    gamma: Multipliers,
    residual: Multipliers,
    count: usize,
}

/// A machine's equations.
#[derive(Clone, Debug)]
pub struct Newton {
    pub machine: Machine,
    /// Reciprocal masses and moments of inertia.
    mobility: Coordinates,
    /// The multipliers of the evaluation before: where friction's rounds begin.
    last: Multipliers,
    /// Whether friction had no solution once.
    pub failed: bool,
}

impl Newton {
    pub fn new(machine: &Machine) -> Self {
        let mut mobility = [0.0; 9];
        for (k, body) in machine.bodies.iter().enumerate() {
            mobility[3 * k..3 * k + 3].copy_from_slice(&[1.0 / body.mass, 1.0 / body.mass, 1.0 / body.inertia]);
        }
        Self { machine: machine.clone(), mobility, last: [0.0; 8], failed: false }
    }

    /// The coordinates at the start.
    pub fn start(&self) -> Coordinates {
        let mut q = [0.0; 9];
        for (k, body) in self.machine.bodies.iter().enumerate() {
            let center = turned(body.center, body.angle);
            q[3 * k..3 * k + 3].copy_from_slice(&[body.origin[0] + center[0], body.origin[1] + center[1], body.angle]);
        }
        q
    }

    fn moving(&self, q: &Coordinates, v: &Coordinates, point: &Point) -> Moving {
        let Some(body) = point.body else {
            return Moving { place: point.at, velocity: [0.0; 2], arm: [0.0; 2], spin: 0.0 };
        };
        let center = self.machine.bodies[body].center;
        let arm = turned([point.at[0] - center[0], point.at[1] - center[1]], q[3 * body + 2]);
        let spin = v[3 * body + 2];
        Moving {
            place: [q[3 * body] + arm[0], q[3 * body + 1] + arm[1]],
            velocity: [v[3 * body] - spin * arm[1], v[3 * body + 1] + spin * arm[0]],
            arm,
            spin,
        }
    }

    /// The gradient of a point's place in a direction.
    fn along(point: &Point, arm: Vector, [x, y]: Vector, sign: f64, row: &mut Coordinates) {
        if let Some(body) = point.body {
            row[3 * body] += sign * x;
            row[3 * body + 1] += sign * y;
            row[3 * body + 2] += sign * (y * arm[0] - x * arm[1]);
        }
    }

    fn constraints(&self, q: &Coordinates, v: &Coordinates) -> Constraints {
        let count = 2 * self.machine.joints.len();
        let mut out = Constraints { jacobian: [[0.0; 9]; 8], gamma: [0.0; 8], residual: [0.0; 8], count };
        for (j, joint) in self.machine.joints.iter().enumerate() {
            let [a, b] = [&joint.first, &joint.second].map(|point| self.moving(q, v, point));
            let apart = [b.place[0] - a.place[0], b.place[1] - a.place[1]];
            // The part of the relative acceleration that does not come from accelerations, with its sign turned.
            let inward = [0, 1].map(|n: usize| b.spin * b.spin * b.arm[n] - a.spin * a.spin * a.arm[n]);
            let mut row = |n: usize, unit: Vector| {
                let row = &mut out.jacobian[n];
                Self::along(&joint.second, b.arm, unit, 1.0, row);
                Self::along(&joint.first, a.arm, unit, -1.0, row);
                out.gamma[n] = inward[0] * unit[0] + inward[1] * unit[1];
                out.residual[n] = apart[0] * unit[0] + apart[1] * unit[1];
            };
            match joint.freedom {
                Freedom::Revolute { .. } => {
                    row(2 * j, [1.0, 0.0]);
                    row(2 * j + 1, [0.0, 1.0]);
                }
                Freedom::Prismatic { axis } => {
                    row(2 * j, turned([0.0, 1.0], axis));
                    if let Some(body) = joint.second.body {
                        out.jacobian[2 * j + 1][3 * body + 2] = 1.0;
                        out.residual[2 * j + 1] = q[3 * body + 2] - self.machine.bodies[body].angle;
                    }
                }
            }
        }
        out
    }

    /// Value of a quantity and its gradient.
    pub fn quantity(&self, quantity: Quantity, q: &Coordinates) -> (f64, Coordinates) {
        let mut row = [0.0; 9];
        match quantity {
            Quantity::Angle(body) => {
                row[3 * body + 2] = 1.0;
                (q[3 * body + 2], row)
            }
            Quantity::Slide(joint) => {
                let Joint { first, second, freedom, .. } = &self.machine.joints[joint];
                let Freedom::Prismatic { axis } = freedom else { return (0.0, row) };
                let unit = turned([1.0, 0.0], *axis);
                let [a, b] = [first, second].map(|point| self.moving(q, &[0.0; 9], point));
                Self::along(second, b.arm, unit, 1.0, &mut row);
                ((b.place[0] - a.place[0]) * unit[0] + (b.place[1] - a.place[1]) * unit[1], row)
            }
            Quantity::Distance(place, body, at) => {
                let point = Point { body: Some(body), at, name: "" };
                let end = self.moving(q, &[0.0; 9], &point);
                let [x, y] = [end.place[0] - place[0], end.place[1] - place[1]];
                let length = x.hypot(y);
                Self::along(&point, end.arm, [x / length, y / length], 1.0, &mut row);
                (length, row)
            }
        }
    }

    /// Rate of a quantity.
    pub fn rate(&self, quantity: Quantity, q: &Coordinates, v: &Coordinates) -> f64 {
        dot(&self.quantity(quantity, q).1, v)
    }

    /// Slip speed of a joint with its sign [m/s]; None without friction.
    pub fn slip(&self, joint: &Joint, q: &Coordinates, v: &Coordinates) -> Option<f64> {
        self.machine.friction?;
        match joint.freedom {
            Freedom::Revolute { radius } if radius > 0.0 => {
                let spin = |point: &Point| point.body.map_or(0.0, |body| v[3 * body + 2]);
                Some(radius * (spin(&joint.second) - spin(&joint.first)))
            }
            Freedom::Revolute { .. } => None,
            Freedom::Prismatic { axis } => {
                let (unit, velocity) = (turned([1.0, 0.0], axis), self.moving(q, v, &joint.second).velocity);
                Some(velocity[0] * unit[0] + velocity[1] * unit[1])
            }
        }
    }

    /// Coefficient of friction with the sign of the slip speed.
    fn coefficient(&self, slip: f64) -> f64 {
        let Some([still, moving, slow, fast]) = self.machine.friction else { return 0.0 };
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

    /// Accelerations under generalised forces, gravity and friction.
    pub fn acceleration(&mut self, q: &Coordinates, v: &Coordinates, forces: &Coordinates) -> Coordinates {
        let constraints = self.constraints(q, v);
        let n = constraints.count;
        let mut push = *forces;
        let [g, up] = self.machine.gravity;
        for (k, body) in self.machine.bodies.iter().enumerate() {
            push[3 * k] -= body.mass * g * up.cos();
            push[3 * k + 1] -= body.mass * g * up.sin();
        }
        let mut matrix = [[0.0; 8]; 8];
        for r in 0..n {
            for c in 0..n {
                let pairs = constraints.jacobian[r].iter().zip(&constraints.jacobian[c]).zip(&self.mobility);
                matrix[r][c] = pairs.map(|((a, b), m)| a * b * m).sum();
            }
        }
        let factors = Factors::of(matrix, n);
        let solve = |push: &Coordinates| {
            let mut right = [0.0; 8];
            for (r, value) in right.iter_mut().enumerate().take(n) {
                let free: f64 = (0..9).map(|c| constraints.jacobian[r][c] * self.mobility[c] * push[c]).sum();
                *value = constraints.gamma[r] - free;
            }
            factors.solve(right)
        };
        let joints: Vec<(usize, f64)> = match self.machine.friction {
            None => Vec::new(),
            Some(_) => {
                let slips = self.machine.joints.iter().enumerate();
                slips.filter_map(|(j, joint)| Some((j, self.coefficient(self.slip(joint, q, v)?)))).collect()
            }
        };
        let rubbed = |lambda: &Multipliers| {
            let mut rubbed = push;
            for &(j, mu) in &joints {
                let joint = &self.machine.joints[j];
                match joint.freedom {
                    Freedom::Revolute { radius } => {
                        let torque = -mu * radius * lambda[2 * j].hypot(lambda[2 * j + 1]);
                        for (point, sign) in [(&joint.second, 1.0), (&joint.first, -1.0)] {
                            if let Some(body) = point.body {
                                rubbed[3 * body + 2] += sign * torque;
                            }
                        }
                    }
                    Freedom::Prismatic { axis } => {
                        let force = turned([-mu * lambda[2 * j].abs(), 0.0], axis);
                        if let Some(body) = joint.second.body {
                            rubbed[3 * body] += force[0];
                            rubbed[3 * body + 1] += force[1];
                        }
                    }
                }
            }
            rubbed
        };
        let mut lambda = if joints.is_empty() { solve(&push) } else { self.last };
        let mut found = joints.is_empty();
        for _ in 0..ROUNDS {
            if found {
                break;
            }
            let next = solve(&rubbed(&lambda));
            let size = next.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            let change = next.iter().zip(&lambda).fold(0.0_f64, |change, (a, b)| change.max((a - b).abs()));
            lambda = next;
            found = change <= 3e-15 * size || size == 0.0;
        }
        let finite = lambda.iter().all(|x| x.is_finite());
        self.failed |= !found || !finite;
        self.last = if finite { lambda } else { [0.0; 8] };
        let mut out = rubbed(&lambda);
        for (c, a) in out.iter_mut().enumerate() {
            let held: f64 = (0..n).map(|r| constraints.jacobian[r][c] * lambda[r]).sum();
            *a = self.mobility[c] * (*a + held);
        }
        out
    }

    /// The motion of a unit rate of a quantity that the joints let free; None where it stands still.
    pub fn free_motion(&mut self, quantity: Quantity, q: &Coordinates) -> Option<Coordinates> {
        // The difference that a generalised force makes to the accelerations.
        let constraints = self.constraints(q, &[0.0; 9]);
        let (n, row) = (constraints.count, self.quantity(quantity, q).1);
        let mut matrix = [[0.0; 8]; 8];
        let mut right = [0.0; 8];
        for r in 0..n {
            for c in 0..n {
                matrix[r][c] =
                    (0..9).map(|k| constraints.jacobian[r][k] * constraints.jacobian[c][k] * self.mobility[k]).sum();
            }
            right[r] = -(0..9).map(|k| constraints.jacobian[r][k] * self.mobility[k] * row[k]).sum::<f64>();
        }
        let lambda = Factors::of(matrix, n).solve(right);
        let mut motion = [0.0; 9];
        for (c, x) in motion.iter_mut().enumerate() {
            let held: f64 = (0..n).map(|r| constraints.jacobian[r][c] * lambda[r]).sum();
            *x = self.mobility[c] * (row[c] + held);
        }
        let rate = dot(&row, &motion);
        (rate > 1e-12).then(|| motion.map(|x| x / rate))
    }

    /// Bring places and speeds back to the constraints, by the least change.
    pub fn project(&self, q: &mut Coordinates, v: &mut Coordinates) {
        for round in 0..3 {
            let constraints = self.constraints(q, v);
            let n = constraints.count;
            let mut matrix = [[0.0; 8]; 8];
            for r in 0..n {
                for c in 0..n {
                    matrix[r][c] = dot(&constraints.jacobian[r], &constraints.jacobian[c]);
                }
            }
            let factors = Factors::of(matrix, n);
            let move_by = |vector: &mut Coordinates, right: Multipliers| {
                let lambda = factors.solve(right);
                for (c, x) in vector.iter_mut().enumerate() {
                    *x -= (0..n).map(|r| constraints.jacobian[r][c] * lambda[r]).sum::<f64>();
                }
            };
            if round < 2 {
                move_by(q, constraints.residual);
            } else {
                let mut rates = [0.0; 8];
                (0..n).for_each(|r| rates[r] = dot(&constraints.jacobian[r], v));
                move_by(v, rates);
            }
        }
    }
}

/// A matrix in factors, with the order of its rows.
struct Factors {
    matrix: [[f64; 8]; 8],
    order: [usize; 8],
    count: usize,
}

impl Factors {
    fn of(mut matrix: [[f64; 8]; 8], count: usize) -> Self {
        let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
        for k in 0..count {
            let pivot = (k..count).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap_or(k);
            matrix.swap(k, pivot);
            order.swap(k, pivot);
            for r in k + 1..count {
                let factor = matrix[r][k] / matrix[k][k];
                matrix[r][k] = factor;
                for c in k + 1..count {
                    matrix[r][c] -= factor * matrix[k][c];
                }
            }
        }
        Self { matrix, order, count }
    }

    fn solve(&self, right: Multipliers) -> Multipliers {
        let mut x = [0.0; 8];
        for r in 0..self.count {
            x[r] = right[self.order[r]] - (0..r).map(|c| self.matrix[r][c] * x[c]).sum::<f64>();
        }
        for r in (0..self.count).rev() {
            let known: f64 = (r + 1..self.count).map(|c| self.matrix[r][c] * x[c]).sum();
            x[r] = (x[r] - known) / self.matrix[r][r];
        }
        x
    }
}
