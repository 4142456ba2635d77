//! Loads of unit size: forces and torques, their displacements and their influence on the motion.
//!
//! In: the configuration. Out: the displacement S of each load, work-conjugate to its size, with derivatives along the
//! curve, and the load's wrenches on the bodies. The influence function of [CK16] is S_sigma: the virtual work of the
//! unit load for each d sigma. It must not know the size of a load.
use crate::mechanism::curve::{Configuration, Curve};
use crate::mechanism::linkage::{Freedom, Linkage, Point, Positions};
use crate::numerics::decimal::Decimal;
use crate::numerics::plane::{Vec2, cross};

/// Part of a size below which a position is rounding, and of the speeds of two bodies below which the rate of what is
/// between them is.
const ROUNDING: f64 = 1e-12;

/// A load of unit size.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Gravity for the load factor 1: the acceleration [m/s2] on every mass. S is the sum of m acceleration . r [J].
    Gravity(Vec2),
    /// 1 N at a point, in a fixed direction. S is the point's position in this direction [m].
    Force {
        /// Point at which the force acts.
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
        /// Whether S is one in every position, so that its derivatives are 0 and not rounding.
        is_idle: bool,
    },
    /// 1 N.m on a body. S is its angle plus a constant [rad].
    Torque {
        /// Index of the body.
        body: usize,
        /// Angle of the body that the definition names, in the frame of the one that carries it [rad].
        shift: f64,
    },
    /// 1 N.m on one body and -1 N.m on another. S is the angle between them plus a constant [rad].
    Couple {
        /// Index of the body with -1 N.m.
        first: usize,
        /// Index of the body with 1 N.m.
        second: usize,
        /// S less the angle between the two: from the bodies that the definition names [rad].
        shift: f64,
        /// Whether S is one in every position, so that its derivatives are 0 and not rounding.
        is_idle: bool,
    },
    /// The force that pushes the second body of a coupling away from the first, as the teeth of gears outside one
    /// another do, for a force |F_t| tan(alpha) of 1 N: the force of the coupling that does no work. S is 0.
    Separation {
        /// Index of the coupling.
        coupling: usize,
        /// tan(alpha) with the sign of the transmitted force F_t, which says which flank bears, for gears of variable
        /// ratio; else 0.
        lean: f64,
    },
    /// 1 N along the profile of a cam on its follower, clockwise about the cam, and -1 N on the cam. The rate of S is
    /// the velocity of the follower along the profile, relative to the cam; S itself is not computed, and is 0.
    Rub {
        /// Index of the coupling.
        coupling: usize,
    },
    /// 1 N.m on a screw that pushes along a line. S is the screw's angle [rad], `ratio` times the displacement along
    /// the line.
    Screw {
        /// The load along the line of 1 N.
        along: Box<Self>,
        /// 2 pi over the lead [rad/m].
        ratio: f64,
    },
    /// 1 N along the axis of a prismatic joint or along a slot. S is the joint's position [m], or its opposite.
    Slide {
        /// Index of the joint.
        joint: usize,
        /// 1 for the force on the joint's second body, -1 for the force on its first body.
        sign: f64,
        /// Whether S is one in every position, so that its derivatives are 0 and not rounding.
        is_idle: bool,
    },
}

/// Force [N] on a body and its moment about the origin of the body's frame [N.m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Index of the body.
    pub body: usize,
    /// Force [N].
    pub force: Vec2,
    /// Moment about the body's origin [N.m].
    pub moment: f64,
}

fn center(linkage: &Linkage, body: usize) -> Point {
    Point { body, local: linkage.bodies[body].center }
}

fn couple(body: usize, moment: f64) -> Wrench {
    Wrench { body, force: Vec2::zeros(), moment }
}

/// The two points of a prismatic joint or a slot and its axis in the mechanism frame; axis 0 for a revolute joint.
fn axis(linkage: &Linkage, p: &Positions, joint: usize) -> (Point, Point, Vec2) {
    let j = &linkage.joints[joint];
    let axis = match j.freedom {
        Freedom::Prismatic(e) => p.vector(j.first.body, e),
        Freedom::Slot(index) => p.slots[index].axis,
        Freedom::Revolute | Freedom::Coupling(_) => Vec2::zeros(),
    };
    (j.first, j.second, axis)
}

impl Load {
    /// Whether its S is one in every position.
    pub fn is_idle(&self) -> bool {
        match *self.along() {
            Self::Pair { is_idle, .. } | Self::Couple { is_idle, .. } | Self::Slide { is_idle, .. } => is_idle,
            _ => false,
        }
    }

    /// The words for an idle load with this S [m or rad], and what to name in its place.
    pub fn idle_words(&self, s: f64, size: f64) -> (String, &'static str) {
        let rounding = if matches!(self, Self::Couple { .. }) { ROUNDING } else { ROUNDING * size };
        let s = Decimal::rounded(if s.abs() <= rounding { 0.0 } else { s });
        match self.along() {
            Self::Pair { .. } => {
                (format!("the two ends are {s} m apart in every position"), "give two points whose distance changes")
            }
            Self::Slide { .. } => (format!("the joint is at {s} m in every position"), "give a joint that moves"),
            _ => (
                format!("the angle is {s} rad in every position"),
                "give a joint that moves, or two bodies that turn relative to each other",
            ),
        }
    }

    /// The load along the line of a screw; another load itself.
    pub fn along(&self) -> &Self {
        if let Self::Screw { along, .. } = self { along } else { self }
    }

    /// Mark the load between two points or in a joint as idle, if its S is one in each of these configurations but for
    /// rounding. Whether it is idle.
    pub fn mark_idle(&mut self, linkage: &Linkage, at: &[Configuration]) -> bool {
        let still = |rate: f64, of: f64| rate.abs() <= ROUNDING * of;
        let size = linkage.size;
        match self {
            Self::Screw { along, .. } => along.mark_idle(linkage, at),
            Self::Pair { first, second, is_idle } => {
                *is_idle = at.iter().all(|c| {
                    let [(x1, v1), (x2, v2)] =
                        [*first, *second].map(|end| (c.positions.point(end), c.positions.velocity(&c.rates, end)));
                    still((v2 - v1).dot(&(x2 - x1)), (v1.norm() + v2.norm()) * (x2 - x1).norm())
                });
                *is_idle
            }
            Self::Couple { first, second, is_idle, .. } => {
                *is_idle = at.iter().all(|c| {
                    let [one, other] = [*first, *second].map(|body| c.rates.angle[body]);
                    still(other - one, c.rates.largest(size))
                });
                *is_idle
            }
            Self::Slide { joint, is_idle, .. } => {
                *is_idle = at.iter().all(|c| {
                    if let Freedom::Slot(index) = linkage.joints[*joint].freedom {
                        return still(c.q_sigma[linkage.slots[index].coordinate], c.rates.largest(size) * size);
                    }
                    let (first, second, axis) = axis(linkage, &c.positions, *joint);
                    let [v1, v2] = [first, second].map(|point| c.positions.velocity(&c.rates, point));
                    still(axis.dot(&(v2 - v1)), c.rates.largest(size) * size)
                });
                *is_idle
            }
            _ => false,
        }
    }

    /// Growth of S over one revolution of a closed curve; 0 for another curve.
    pub fn growth(&self, curve: &Curve) -> f64 {
        let body = |b: usize| curve.linkage().bodies[b].angle_coordinate.map_or(0.0, |angle| curve.growth(angle));
        match *self {
            Self::Torque { body: b, .. } => body(b),
            Self::Couple { first, second, .. } => body(second) - body(first),
            _ => 0.0,
        }
    }

    /// Displacement at these positions; 0 for gravity.
    pub fn displacement_at(&self, linkage: &Linkage, p: &Positions) -> f64 {
        match *self {
            Self::Gravity(_) | Self::Separation { .. } | Self::Rub { .. } => 0.0,
            Self::Force { at, direction } => direction.dot(&p.point(at)),
            Self::Pair { first, second, .. } => (p.point(second) - p.point(first)).norm(),
            Self::Torque { body, shift } => p.angle[body] + shift,
            Self::Couple { first, second, shift, .. } => p.angle[second] - p.angle[first] + shift,
            Self::Screw { ref along, ratio } => ratio * along.displacement_at(linkage, p),
            Self::Slide { joint, sign, .. } => match linkage.joints[joint].freedom {
                Freedom::Slot(index) => sign * p.slots[index].position,
                _ => {
                    let (first, second, axis) = axis(linkage, p, joint);
                    sign * axis.dot(&(p.point(second) - p.point(first)))
                }
            },
        }
    }

    /// Displacement with its first and second derivative along sigma.
    pub fn displacement(&self, linkage: &Linkage, c: &Configuration) -> [f64; 3] {
        let p = &c.positions;
        let point = |x: Point| p.motion(&c.rates, &c.second, x);
        match *self {
            Self::Gravity(acceleration) => {
                let mut sum = [0.0; 3];
                for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
                    for (s, d) in sum.iter_mut().zip(point(center(linkage, i))) {
                        *s += body.mass * acceleration.dot(&d);
                    }
                }
                sum
            }
            Self::Separation { .. } => [0.0; 3],
            Self::Rub { coupling } => {
                let [rate, second] = linkage.rubbing_speed(&linkage.couplings[coupling], p, (&c.rates, &c.second));
                [0.0, rate, second]
            }
            Self::Screw { ref along, ratio } => along.displacement(linkage, c).map(|s| ratio * s),
            Self::Force { at, direction } => point(at).map(|d| direction.dot(&d)),
            Self::Pair { is_idle: true, .. }
            | Self::Couple { is_idle: true, .. }
            | Self::Slide { is_idle: true, .. } => [self.displacement_at(linkage, p), 0.0, 0.0],
            Self::Pair { first, second, .. } => {
                let ([x1, v1, a1], [x2, v2, a2]) = (point(first), point(second));
                let (x, v, a) = (x2 - x1, v2 - v1, a2 - a1);
                let length = x.norm();
                let along = x / length;
                let rate = along.dot(&v);
                [length, rate, along.dot(&a) + (v.norm_squared() - rate * rate) / length]
            }
            Self::Torque { body, shift } => [p.angle[body] + shift, c.rates.angle[body], c.second.angle[body]],
            Self::Couple { first, second, shift, .. } => {
                let of = |angle: &[f64]| angle[second] - angle[first];
                [of(&p.angle) + shift, of(&c.rates.angle), of(&c.second.angle)]
            }
            Self::Slide { joint, sign, .. } => {
                if let Freedom::Slot(index) = linkage.joints[joint].freedom {
                    let own = linkage.slots[index].coordinate;
                    return [c.q[own], c.q_sigma[own], c.q_second[own]].map(|s| sign * s);
                }
                // The gap is s e, with e fixed in the first body: gap'' = (s'' - s omega^2) e + (...) e_normal.
                let (first, second, axis) = axis(linkage, p, joint);
                let ([x1, v1, a1], [x2, v2, a2]) = (point(first), point(second));
                let s = axis.dot(&(x2 - x1));
                let omega = c.rates.angle[first.body];
                [s, axis.dot(&(v2 - v1)), axis.dot(&(a2 - a1)) + s * omega * omega].map(|s| sign * s)
            }
        }
    }

    /// Influence S_sigma: the virtual work of the unit load for each d sigma.
    pub fn influence(&self, linkage: &Linkage, c: &Configuration) -> f64 {
        self.displacement(linkage, c)[1]
    }

    /// Call `act` with every wrench of the load.
    pub fn exert(&self, linkage: &Linkage, p: &Positions, act: &mut dyn FnMut(Wrench)) {
        let at = |point: Point, force: Vec2| Wrench {
            body: point.body,
            force,
            moment: cross(p.vector(point.body, point.local), force),
        };
        match *self {
            Self::Gravity(acceleration) => {
                (1..linkage.bodies.len())
                    .for_each(|i| act(at(center(linkage, i), linkage.bodies[i].mass * acceleration)));
            }
            Self::Force { at: point, direction } => act(at(point, direction)),
            Self::Pair { first, second, .. } => {
                let along = (p.point(second) - p.point(first)).normalize();
                act(at(first, -along));
                act(at(second, along));
            }
            Self::Separation { coupling, lean } => {
                let coupling = &linkage.couplings[coupling];
                let (contact, joint) = (linkage.contact(coupling, p), &linkage.joints[coupling.joint]);
                let apart = contact.separation(lean);
                for (body, force) in [(joint.first.body, -apart), (joint.second.body, apart)] {
                    act(Wrench { body, force, moment: cross(contact.at - p.origin[body], force) });
                }
            }
            Self::Rub { coupling } => {
                let coupling = &linkage.couplings[coupling];
                let joint = &linkage.joints[coupling.joint];
                let [on, along] = linkage.rubbing(coupling, p);
                for (body, force) in [(joint.first.body, -along), (joint.second.body, along)] {
                    act(Wrench { body, force, moment: cross(on - p.origin[body], force) });
                }
            }
            Self::Screw { ref along, ratio } => along.exert(linkage, p, &mut |Wrench { body, force, moment }| {
                act(Wrench { body, force: ratio * force, moment: ratio * moment });
            }),
            Self::Torque { body, .. } => act(couple(body, 1.0)),
            Self::Couple { first, second, .. } => {
                act(couple(first, -1.0));
                act(couple(second, 1.0));
            }
            Self::Slide { joint, sign, .. } => {
                let (first, second, axis) = axis(linkage, p, joint);
                let axis = sign * axis;
                // Both forces act at the second point, where the bodies are in contact.
                let moment = cross(p.point(second) - p.origin[first.body], -axis);
                act(at(second, axis));
                act(Wrench { body: first.body, force: -axis, moment });
            }
        }
    }
}
