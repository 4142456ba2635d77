//! The oracle: Newton-Euler equations of all bodies in absolute coordinates, with the joints as constraints.
//!
//! In: the plain data of a linkage, generated at random or read from a definition, with values and derivatives of its
//! coordinates. Out: poses, closure errors of the joints, accelerations and joint reactions from one dense system, and
//! the imbalance of given reactions. It uses no code of the engine.
pub mod linkage;

use crate::support::{Vec2, turned};
use linkage::{Attachment, Coordinate, Freedom, GROUND, Joint, Linkage, Mass};
use nalgebra::{DMatrix, DVector, Matrix3};

/// Position [m] and angle [rad] of every body's frame, or their rates.
pub type Poses = Vec<(Vec2, f64)>;

fn perp(a: Vec2) -> Vec2 {
    Vec2::new(-a.y, a.x)
}

/// Poses of all bodies with their first and second derivatives.
pub struct Motion<'a> {
    linkage: &'a Linkage,
    pub poses: Poses,
    pub rates: Poses,
    /// Second derivatives, from the accelerations of the coordinates.
    pub accelerations: Poses,
}

/// Accelerations and reactions.
pub struct Solution {
    pub accelerations: Poses,
    /// Force that the first body exerts on the second, and its moment about the second's point.
    pub reactions: Vec<(Vec2, f64)>,
    /// Effect of a relative error in the equations on the unknowns: norm of the inverse times the size of the
    /// equations.
    pub sensitivity: f64,
}

impl<'a> Motion<'a> {
    /// From value, speed and acceleration of the coordinates in their order. All joints that close no loop hold
    /// exactly.
    pub fn of(linkage: &'a Linkage, state: &[[f64; 3]]) -> Self {
        let coordinates = linkage.coordinates();
        let read = |coordinate| {
            let found = coordinates.iter().zip(state).find(|(c, _)| **c == coordinate);
            found.map_or([f64::NAN; 3], |(_, state)| *state)
        };
        let count = linkage.bodies.len();
        let still = || vec![(Vec2::zeros(), 0.0); count];
        let mut motion = Self { linkage, poses: still(), rates: still(), accelerations: still() };
        for b in (0..count).filter(|&b| linkage.rotates(b)) {
            [motion.poses[b].1, motion.rates[b].1, motion.accelerations[b].1] = read(Coordinate::Angle(b));
        }
        // Bodies that prismatic joints connect to the ground, starting at the ground.
        let mut held = vec![false; count];
        held[GROUND] = true;
        for _ in 0..count {
            for joint in &linkage.joints {
                let Freedom::Prismatic { angle, .. } = joint.freedom else { continue };
                let (a, b) = (joint.first.body, joint.second.body);
                if held[a] && !held[b] {
                    motion.poses[b].1 = motion.poses[a].1 + angle;
                    held[b] = true;
                } else if held[b] && !held[a] {
                    motion.poses[a].1 = motion.poses[b].1 - angle;
                    held[a] = true;
                }
            }
        }
        let mut placed = vec![false; count];
        placed[GROUND] = true;
        for _ in 0..count {
            for (j, joint) in linkage.joints.iter().enumerate() {
                let (a, b) = (joint.first, joint.second);
                if placed[a.body] == placed[b.body] {
                    continue;
                }
                let (from, to, sign) = if placed[a.body] { (a, b, 1.0) } else { (b, a, -1.0) };
                let (mut point, mut velocity) = (motion.point(from), motion.velocity(from));
                let mut acceleration = motion.acceleration_of(from);
                if let Freedom::Prismatic { axis, .. } = joint.freedom {
                    let [position, speed, second] = read(Coordinate::Position(j));
                    let unit = turned(Vec2::x(), motion.poses[a.body].1 + axis);
                    let (spin, alpha) = (motion.rates[a.body].1, motion.accelerations[a.body].1);
                    point += sign * position * unit;
                    velocity += sign * (speed * unit + position * spin * perp(unit));
                    acceleration += sign * (second - position * spin * spin) * unit;
                    acceleration += sign * (2.0 * speed * spin + position * alpha) * perp(unit);
                }
                motion.poses[to.body].0 = point - motion.arm(to);
                motion.rates[to.body].0 = velocity - motion.rates[to.body].1 * perp(motion.arm(to));
                let (arm, spin) = (motion.arm(to), motion.rates[to.body].1);
                motion.accelerations[to.body].0 =
                    acceleration - motion.accelerations[to.body].1 * perp(arm) + spin * spin * arm;
                placed[to.body] = true;
            }
        }
        motion
    }

    /// The built start position, at rest.
    pub fn built(linkage: &'a Linkage) -> Self {
        Self {
            linkage,
            poses: linkage.bodies.iter().map(|b| (b.position, b.angle)).collect(),
            rates: vec![(Vec2::zeros(), 0.0); linkage.bodies.len()],
            accelerations: vec![(Vec2::zeros(), 0.0); linkage.bodies.len()],
        }
    }

    fn arm(&self, at: Attachment) -> Vec2 {
        turned(self.linkage.local(at), self.poses[at.body].1)
    }

    pub fn point(&self, at: Attachment) -> Vec2 {
        self.poses[at.body].0 + self.arm(at)
    }

    pub fn velocity(&self, at: Attachment) -> Vec2 {
        self.rates[at.body].0 + self.rates[at.body].1 * perp(self.arm(at))
    }

    /// Acceleration of a point from those of the frames.
    fn acceleration_of(&self, at: Attachment) -> Vec2 {
        let (arm, (base, alpha), spin) = (self.arm(at), self.accelerations[at.body], self.rates[at.body].1);
        base + alpha * perp(arm) - spin * spin * arm
    }

    /// Second point of a joint minus its first point, and the rate.
    fn relative(&self, Joint { first: a, second: b, .. }: &Joint) -> (Vec2, Vec2) {
        (self.point(*b) - self.point(*a), self.velocity(*b) - self.velocity(*a))
    }

    /// Largest violation of a joint [m or rad], and of its rate [m/s or rad/s].
    pub fn gap(&self) -> [f64; 2] {
        let (mut gap, mut rate): (f64, f64) = (0.0, 0.0);
        for joint in &self.linkage.joints {
            let (a, b) = (joint.first, joint.second);
            let (apart, drift) = self.relative(joint);
            match joint.freedom {
                Freedom::Revolute => (gap, rate) = (gap.max(apart.norm()), rate.max(drift.norm())),
                Freedom::Prismatic { axis, angle, .. } => {
                    let across = turned(Vec2::y(), self.poses[a.body].1 + axis);
                    let spin = self.rates[a.body].1;
                    gap = gap.max(apart.dot(&across).abs());
                    gap = gap.max((self.poses[b.body].1 - self.poses[a.body].1 - angle).abs());
                    rate = rate.max((drift.dot(&across) + spin * apart.dot(&perp(across))).abs());
                    rate = rate.max((self.rates[b.body].1 - spin).abs());
                }
            }
        }
        [gap, rate]
    }

    /// Kinetic energy [J].
    pub fn kinetic(&self) -> f64 {
        let mut sum = 0.0;
        for (b, m) in self.masses() {
            let (rate, arm) = (self.rates[b], turned(m.center, self.poses[b].1));
            sum += 0.5 * m.mass * (rate.0 + rate.1 * perp(arm)).norm_squared() + 0.5 * m.inertia * rate.1 * rate.1;
        }
        sum
    }

    /// Potentials of the loads at constant sizes [J].
    pub fn potentials(&self) -> [f64; 4] {
        let loads = &self.linkage.loads;
        let (g, up, factor) = loads.gravity;
        let weights =
            self.masses().into_iter().map(|(b, m)| m.mass * (self.poses[b].0 + turned(m.center, self.poses[b].1)));
        [
            loads.pushes.iter().map(|(a, b, push)| -push * (self.point(*b) - self.point(*a)).norm()).sum(),
            g * factor * weights.sum::<Vec2>().dot(&Vec2::new(up.cos(), up.sin())),
            loads.forces.iter().map(|(at, pull)| -pull.dot(&self.point(*at))).sum(),
            loads.torques.iter().map(|(on, torque)| -torque * self.poses[*on].1).sum(),
        ]
    }

    /// Every mass with the index of the body that carries it. The centres are in the frame of this body.
    fn masses(&self) -> Vec<(usize, Mass)> {
        let bodies = self.linkage.bodies.iter().enumerate().skip(1);
        let riders = self.linkage.riders.iter().map(|rider| {
            let center = self.linkage.local(rider.to) + turned(rider.mass.center, rider.angle);
            (rider.to.body, Mass { center, ..rider.mass })
        });
        bodies.map(|(b, body)| (b, body.mass)).chain(riders.filter(|(body, _)| *body != GROUND)).collect()
    }

    /// Constraint Jacobian (two rows per joint, three columns per body without the ground), and gamma in J a = gamma.
    fn constraints(&self) -> (DMatrix<f64>, DVector<f64>) {
        let (count, joints) = (self.linkage.bodies.len() - 1, &self.linkage.joints);
        let mut jacobian = DMatrix::zeros(2 * joints.len(), 3 * count);
        let mut gamma = DVector::zeros(2 * joints.len());
        for (j, joint) in joints.iter().enumerate() {
            let (a, b) = (joint.first, joint.second);
            let (ra, rb) = (self.arm(a), self.arm(b));
            let (wa, wb) = (self.rates[a.body].1, self.rates[b.body].1);
            let mut add = |row: usize, body: usize, x: f64, y: f64, angle: f64| {
                if body != GROUND {
                    let at = 3 * (body - 1);
                    jacobian[(row, at)] += x;
                    jacobian[(row, at + 1)] += y;
                    jacobian[(row, at + 2)] += angle;
                }
            };
            // Acceleration of the second point relative to the first, without the terms in the accelerations of the
            // frames.
            let centripetal = wa * wa * ra - wb * wb * rb;
            match joint.freedom {
                Freedom::Revolute => {
                    for (row, unit) in [(2 * j, Vec2::x()), (2 * j + 1, Vec2::y())] {
                        add(row, b.body, unit.x, unit.y, unit.dot(&perp(rb)));
                        add(row, a.body, -unit.x, -unit.y, -unit.dot(&perp(ra)));
                        gamma[row] = -unit.dot(&centripetal);
                    }
                }
                Freedom::Prismatic { axis, .. } => {
                    let n = turned(Vec2::y(), self.poses[a.body].1 + axis);
                    let (apart, drift) = self.relative(joint);
                    add(2 * j, b.body, n.x, n.y, n.dot(&perp(rb)));
                    add(2 * j, a.body, -n.x, -n.y, -n.dot(&perp(ra)) + perp(n).dot(&apart));
                    gamma[2 * j] = -n.dot(&centripetal) - 2.0 * wa * perp(n).dot(&drift) + wa * wa * n.dot(&apart);
                    add(2 * j + 1, b.body, 0.0, 0.0, 1.0);
                    add(2 * j + 1, a.body, 0.0, 0.0, -1.0);
                }
            }
        }
        (jacobian, gamma)
    }

    /// Mass matrix, and all forces except joint forces minus the velocity-dependent inertia terms.
    fn dynamics(&self) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.linkage.bodies.len() - 1;
        let (mut mass, mut force) = (DMatrix::zeros(3 * count, 3 * count), DVector::zeros(3 * count));
        let loads = &self.linkage.loads;
        let mut push = |body: usize, f: Vec2, moment: f64| {
            if body != GROUND {
                let at = 3 * (body - 1);
                force[at] += f.x;
                force[at + 1] += f.y;
                force[at + 2] += moment;
            }
        };
        let (g, up, factor) = loads.gravity;
        let fall = -g * factor * Vec2::new(up.cos(), up.sin());
        for (b, m) in self.masses() {
            let (at, r, spin) = (3 * (b - 1), turned(m.center, self.poses[b].1), self.rates[b].1);
            let (x, y) = (m.mass * r.x, m.mass * r.y);
            let own = [[m.mass, 0.0, -y], [0.0, m.mass, x], [-y, x, m.inertia + m.mass * r.norm_squared()]];
            let mut block = mass.fixed_view_mut::<3, 3>(at, at);
            block += Matrix3::from(own);
            push(b, m.mass * (fall + spin * spin * r), r.perp(&(m.mass * fall)));
        }
        for &(a, b, size) in &loads.pushes {
            let along = (self.point(b) - self.point(a)).normalize() * size;
            for (point, f) in [(a, -along), (b, along)] {
                push(point.body, f, self.arm(point).perp(&f));
            }
        }
        loads.forces.iter().for_each(|(at, f)| push(at.body, *f, self.arm(*at).perp(f)));
        loads.torques.iter().for_each(|(on, torque)| push(*on, Vec2::zeros(), *torque));
        (mass, force)
    }

    /// Largest violation of the balance of forces and moments of a body, relative to its largest force or moment, for
    /// these forces and moments in the joints.
    pub fn imbalance(&self, reactions: &[(Vec2, f64)]) -> f64 {
        let ((jacobian, _), (mass, force)) = (self.constraints(), self.dynamics());
        let frames = self.accelerations.iter().skip(1).flat_map(|(base, alpha)| [base.x, base.y, *alpha]);
        let need = mass * DVector::from_iterator(force.len(), frames);
        let multipliers =
            self.linkage.joints.iter().zip(reactions).flat_map(|(joint, (f, moment))| match joint.freedom {
                Freedom::Revolute => [f.x, f.y],
                Freedom::Prismatic { axis, .. } => {
                    [f.dot(&turned(Vec2::y(), self.poses[joint.first.body].1 + axis)), *moment]
                }
            });
        let multipliers = DVector::from_iterator(jacobian.nrows(), multipliers);
        let mut worst = 0.0_f64;
        for body in 0..force.len() / 3 {
            let (mut lack, mut size) = (0.0_f64, 0.0_f64);
            for row in 3 * body..3 * body + 3 {
                let parts = (0..jacobian.nrows()).map(|j| jacobian[(j, row)] * multipliers[j]);
                let parts: Vec<f64> = parts.chain([-need[row], force[row]]).collect();
                lack = lack.max(parts.iter().sum::<f64>().abs());
                size = parts.iter().fold(size, |size, part| size.max(part.abs()));
            }
            worst = worst.max(if lack == 0.0 { 0.0 } else { lack / size });
        }
        worst
    }

    /// Solve [M -J^T; J 0] [accelerations; multipliers] = [forces; gamma].
    pub fn solve(&self) -> Solution {
        let ((jacobian, gamma), (mass, force)) = (self.constraints(), self.dynamics());
        let (n, m) = (force.len(), gamma.len());
        let mut matrix = DMatrix::zeros(n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&mass);
        matrix.view_mut((0, n), (n, m)).copy_from(&-jacobian.transpose());
        matrix.view_mut((n, 0), (m, n)).copy_from(&jacobian);
        let right = DVector::from_iterator(n + m, force.iter().chain(gamma.iter()).copied());
        let (values, largest) = (matrix.singular_values(), matrix.amax());
        let x = matrix.lu().solve(&right).unwrap_or_else(|| DVector::from_element(n + m, f64::NAN));
        let still = [(Vec2::zeros(), 0.0)];
        let moving = (0..n / 3).map(|b| (Vec2::new(x[3 * b], x[3 * b + 1]), x[3 * b + 2]));
        let reactions = self.linkage.joints.iter().enumerate().map(|(j, joint)| {
            let (p, q) = (x[n + 2 * j], x[n + 2 * j + 1]);
            match joint.freedom {
                Freedom::Revolute => (Vec2::new(p, q), 0.0),
                Freedom::Prismatic { axis, .. } => (p * turned(Vec2::y(), self.poses[joint.first.body].1 + axis), q),
            }
        });
        Solution {
            reactions: reactions.collect(),
            accelerations: still.into_iter().chain(moving).collect(),
            sensitivity: (largest * x.amax() + right.amax()) / values.min(),
        }
    }

    /// Time derivative of a coordinate.
    pub fn rate(&self, coordinate: Coordinate) -> f64 {
        match coordinate {
            Coordinate::Angle(body) => self.rates[body].1,
            Coordinate::Position(j) => {
                let joint = &self.linkage.joints[j];
                let Freedom::Prismatic { axis, .. } = joint.freedom else { return 0.0 };
                let unit = turned(Vec2::x(), self.poses[joint.first.body].1 + axis);
                let (apart, drift) = self.relative(joint);
                unit.dot(&drift) + self.rates[joint.first.body].1 * perp(unit).dot(&apart)
            }
        }
    }

    /// Second time derivative of a coordinate.
    pub fn acceleration(&self, solution: &Solution, coordinate: Coordinate) -> f64 {
        let joint = match coordinate {
            Coordinate::Angle(body) => return solution.accelerations[body].1,
            Coordinate::Position(j) => &self.linkage.joints[j],
        };
        let Freedom::Prismatic { axis, .. } = joint.freedom else { return 0.0 };
        let (a, b) = (joint.first, joint.second);
        let of = |p: Attachment| {
            let ((base, alpha), spin, arm) = (solution.accelerations[p.body], self.rates[p.body].1, self.arm(p));
            base + alpha * perp(arm) - spin * spin * arm
        };
        let unit = turned(Vec2::x(), self.poses[a.body].1 + axis);
        let (spin, alpha) = (self.rates[a.body].1, solution.accelerations[a.body].1);
        let (apart, drift) = self.relative(joint);
        unit.dot(&(of(b) - of(a))) + 2.0 * spin * perp(unit).dot(&drift) + alpha * perp(unit).dot(&apart)
            - spin * spin * unit.dot(&apart)
    }
}

/// Rates of the coordinates in the one free motion at the start, and the smallest singular value of the constraint
/// Jacobian.
pub fn free_motion(linkage: &Linkage) -> (Vec<f64>, f64) {
    let built = Motion::built(linkage);
    let (jacobian, _) = built.constraints();
    let n = jacobian.ncols();
    let square = DMatrix::from_fn(n, n, |r, c| if r < n - 1 { jacobian[(r, c)] } else { 0.0 });
    let svd = square.svd(false, true);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| svd.singular_values[*a].total_cmp(&svd.singular_values[*b]));
    let Some(v) = &svd.v_t else { return (Vec::new(), 0.0) };
    let mut moving = built;
    for b in 1..linkage.bodies.len() {
        let at = 3 * (b - 1);
        moving.rates[b] = (Vec2::new(v[(order[0], at)], v[(order[0], at + 1)]), v[(order[0], at + 2)]);
    }
    let rates = linkage.coordinates().into_iter().map(|c| moving.rate(c)).collect();
    (rates, svd.singular_values[order[1]])
}
