//! Rotors: masses that move with a stroke of the linkage, such as screws that turn about an axis in the plane.
//!
//! In: positions, rates and accelerations of the bodies. Out: the stroke's derivatives and the force that a rotor
//! takes. It must not know definitions, loads or time.
//!
//! A screw with the moment of inertia J and the lead h turns by 2 pi / h for each metre of its stroke s, so that its
//! kinetic energy is m s_dot^2 / 2 with m = J (2 pi / h)^2.
use super::motion::{Positions, Rates};
use super::structure::{Linkage, Point, Rotor, Stroke};
use crate::numerics::plane::Vec2;

/// What a rotor takes from the linkage.
pub struct Thrust {
    /// Force on the second body of the stroke, its opposite on the first [N].
    pub force: Vec2,
    /// The first body and the second, each with the place of its force in the mechanism frame [m].
    pub on: [(usize, Vec2); 2],
}

impl Linkage {
    /// Points of a stroke, and its direction in the mechanism frame with its length.
    fn stroke(&self, stroke: Stroke, p: &Positions) -> ([Point; 2], Vec2, f64) {
        match stroke {
            Stroke::Between(first, second) => {
                let between = p.point(second) - p.point(first);
                let length = between.norm();
                ([first, second], between / length, length)
            }
            Stroke::Joint(index) => {
                let [axis, between] = self.slid(index, p);
                let joint = &self.joints[index];
                ([joint.first, joint.second], axis, axis.dot(&between))
            }
        }
    }

    /// First derivative of a stroke at these rates.
    pub fn stroke_rate(&self, stroke: Stroke, p: &Positions, r: &Rates) -> f64 {
        let ([first, second], along, _) = self.stroke(stroke, p);
        along.dot(&(p.velocity(r, second) - p.velocity(r, first)))
    }

    /// Second derivative of a stroke at these rates and second rates.
    pub fn stroke_second_rate(&self, stroke: Stroke, p: &Positions, r: &Rates, a: &Rates) -> f64 {
        let ([first, second], along, length) = self.stroke(stroke, p);
        let v = p.velocity(r, second) - p.velocity(r, first);
        let rate = along.dot(&v);
        let turning = match stroke {
            Stroke::Between(..) => (v.norm_squared() - rate * rate) / length,
            // The gap is s e, with e fixed in the first body: e . gap'' = s'' - s omega^2.
            Stroke::Joint(_) => length * r.angle[first.body].powi(2),
        };
        along.dot(&(p.acceleration(r, a, second) - p.acceleration(r, a, first))) + turning
    }

    /// The force that moves a rotor at these rates and second rates.
    pub fn thrust(&self, rotor: &Rotor, p: &Positions, r: &Rates, a: &Rates) -> Thrust {
        let ([first, second], along, _) = self.stroke(rotor.stroke, p);
        let force = rotor.mass * self.stroke_second_rate(rotor.stroke, p, r, a) * along;
        // In a joint both forces act at the second point, where the bodies are in contact.
        let [one, other] = match rotor.stroke {
            Stroke::Between(..) => [first, second].map(|point| p.point(point)),
            Stroke::Joint(_) => [p.point(second); 2],
        };
        Thrust { force, on: [(first.body, one), (second.body, other)] }
    }
}
