//! Rotors: masses that move with a stroke of the linkage, such as screws that turn about an axis in the plane, and
//! moments of inertia that turn with the angle of a joint, such as those of motors.
//!
//! In: positions, rates and accelerations of the bodies. Out: the stroke's derivatives and the force that a rotor
//! takes. It must not know definitions, loads or time.
//!
//! A screw with the moment of inertia J and the lead h turns by 2 pi / h for each metre of its stroke s, so that its
//! kinetic energy is m s_dot^2 / 2 with m = J (2 pi / h)^2. That of the rotor of a joint is
//! J (omega_2 - omega_1)^2 / 2.
use super::motion::{Positions, Rates};
use super::structure::{Line, Linkage, Point, Rotor, Stroke};
use crate::numerics::plane::Vec2;

/// What a rotor takes from the linkage.
pub struct Thrust {
    /// Force on the second body of the stroke, its opposite on the first [N].
    pub force: Vec2,
    /// Couple on the second body, its opposite on the first [N.m].
    pub couple: f64,
    /// The first body and the second, each with the place of its force in the mechanism frame [m].
    pub on: [(usize, Vec2); 2],
}

impl Rotor {
    /// Mass or moment of inertia that has its kinetic energy in a motion of 1 rad of a linkage of this size [m].
    pub fn inertia(&self, size: f64) -> f64 {
        if let Stroke::Along(_) = self.stroke { self.mass * size.powi(2) } else { self.mass }
    }
}

impl Linkage {
    /// Points of a line, and its direction in the mechanism frame with its length.
    fn line(&self, line: Line, p: &Positions) -> ([Point; 2], Vec2, f64) {
        match line {
            Line::Between(first, second) => {
                let between = p.point(second) - p.point(first);
                let length = between.norm();
                ([first, second], between / length, length)
            }
            Line::Joint(index) => {
                let [axis, between] = self.slid(index, p);
                let joint = &self.joints[index];
                ([joint.first, joint.second], axis, axis.dot(&between))
            }
        }
    }

    /// First derivative of a stroke at these rates.
    pub fn stroke_rate(&self, stroke: Stroke, p: &Positions, r: &Rates) -> f64 {
        match stroke {
            Stroke::Along(line) => {
                let ([first, second], along, _) = self.line(line, p);
                along.dot(&(p.velocity(r, second) - p.velocity(r, first)))
            }
            Stroke::Angle(first, second) => r.angle[second] - r.angle[first],
        }
    }

    /// Second derivative of a stroke at these rates and second rates.
    pub fn stroke_second_rate(&self, stroke: Stroke, p: &Positions, r: &Rates, a: &Rates) -> f64 {
        let line = match stroke {
            Stroke::Along(line) => line,
            Stroke::Angle(first, second) => return a.angle[second] - a.angle[first],
        };
        let ([first, second], along, length) = self.line(line, p);
        let v = p.velocity(r, second) - p.velocity(r, first);
        let rate = along.dot(&v);
        let turning = match line {
            Line::Between(..) => (v.norm_squared() - rate * rate) / length,
            // The gap is s e, with e fixed in the first body: e . gap'' = s'' - s omega^2.
            Line::Joint(_) => length * r.angle[first.body].powi(2),
        };
        along.dot(&(p.acceleration(r, a, second) - p.acceleration(r, a, first))) + turning
    }

    /// The force and the couple that move a rotor at these rates and second rates.
    pub fn thrust(&self, rotor: &Rotor, p: &Positions, r: &Rates, a: &Rates) -> Thrust {
        let size = rotor.mass * self.stroke_second_rate(rotor.stroke, p, r, a);
        let line = match rotor.stroke {
            Stroke::Along(line) => line,
            Stroke::Angle(first, second) => {
                let on = [first, second].map(|body| (body, p.origin[body]));
                return Thrust { force: Vec2::zeros(), couple: size, on };
            }
        };
        let ([first, second], along, _) = self.line(line, p);
        // In a joint both forces act at the second point, where the bodies are in contact.
        let [one, other] = match line {
            Line::Between(..) => [first, second].map(|point| p.point(point)),
            Line::Joint(_) => [p.point(second); 2],
        };
        Thrust { force: size * along, couple: 0.0, on: [(first.body, one), (second.body, other)] }
    }
}
