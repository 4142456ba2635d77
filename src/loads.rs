//! Loads: forces and torques of unit size, their displacements and their influence on the motion.
//!
//! In: the configuration. Out: for each load its displacement S (what its size does work on) with derivatives along the
//! curve, and its wrenches on the bodies. The influence function of [CK16] is S_sigma: the virtual work of the unit load
//! for each d sigma. It must not know the present size of a load.
use crate::curve::Configuration;
use crate::linkage::{Linkage, Point, Positions, Vec2, cross};

/// A load of unit size.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Gravity for the load factor 1: the acceleration [m/s2] on every mass. S = -sum m acceleration . (-r) [J].
    Gravity(Vec2),
    /// 1 N at a point, in a fixed direction. S is the point's position in this direction [m].
    Force {
        /// Where it acts.
        at: Point,
        /// Unit vector in the mechanism frame.
        direction: Vec2,
    },
    /// 1 N that pushes two points apart. S is their distance [m].
    Pair {
        /// One end.
        first: Point,
        /// The other end.
        second: Point,
    },
    /// 1 N.m on a body. S is its angle [rad].
    Torque {
        /// Place of the body.
        body: usize,
    },
}

/// Force [N] on a body and its moment about the origin of the body's frame [N.m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Place of the body.
    pub body: usize,
    /// Force [N].
    pub force: Vec2,
    /// Moment about the body's origin [N.m].
    pub moment: f64,
}

fn center(linkage: &Linkage, body: usize) -> Point {
    Point { body, local: linkage.bodies[body].center }
}

impl Load {
    /// Displacement and its first and second derivative along sigma.
    pub fn displacement(&self, linkage: &Linkage, c: &Configuration) -> [f64; 3] {
        let p = &c.positions;
        let point = |x: Point| (p.point(x), p.velocity(&c.rates, x), p.acceleration(&c.rates, &c.second, x));
        match *self {
            Self::Gravity(acceleration) => {
                let mut sum = [0.0; 3];
                for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
                    let (x, v, a) = point(center(linkage, i));
                    for (s, d) in sum.iter_mut().zip([x, v, a]) {
                        *s += body.mass * acceleration.dot(&d);
                    }
                }
                sum
            }
            Self::Force { at, direction } => {
                let (x, v, a) = point(at);
                [x, v, a].map(|d| direction.dot(&d))
            }
            Self::Pair { first, second } => {
                let ((x1, v1, a1), (x2, v2, a2)) = (point(first), point(second));
                let (x, v, a) = (x2 - x1, v2 - v1, a2 - a1);
                let length = x.norm();
                let along = x / length;
                let rate = along.dot(&v);
                [length, rate, along.dot(&a) + (v.norm_squared() - rate * rate) / length]
            }
            Self::Torque { body } => [p.angle[body], c.rates.angle[body], c.second.angle[body]],
        }
    }

    /// Influence S_sigma: the virtual work of the unit load for each d sigma.
    pub fn influence(&self, linkage: &Linkage, c: &Configuration) -> f64 {
        self.displacement(linkage, c)[1]
    }

    /// What it does to the bodies.
    pub fn wrenches(&self, linkage: &Linkage, p: &Positions) -> Vec<Wrench> {
        let at = |point: Point, force: Vec2| Wrench {
            body: point.body,
            force,
            moment: cross(p.vector(point.body, point.local), force),
        };
        match *self {
            Self::Gravity(acceleration) => (1..linkage.bodies.len())
                .map(|i| at(center(linkage, i), linkage.bodies[i].mass * acceleration))
                .collect(),
            Self::Force { at: point, direction } => vec![at(point, direction)],
            Self::Pair { first, second } => {
                let along = (p.point(second) - p.point(first)).normalize();
                vec![at(first, -along), at(second, along)]
            }
            Self::Torque { body } => vec![Wrench { body, force: Vec2::zeros(), moment: 1.0 }],
        }
    }
}
