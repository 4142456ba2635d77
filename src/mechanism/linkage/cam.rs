//! Disc cams: the profile that gives a follower its motion.
//!
//! In: the follower's motion u2 and its derivatives with respect to the cam's angle u1. Out: pressure angle, radius of
//! curvature and points of the profile. It must not know definitions, loads or time.
//!
//! Vectors are in the frame of the carrier, from the cam's centre. Let X be the roller's centre, or a point of the flat
//! face, V = dX / du2 and W = dV / du2. In the frame of the cam the point X moves with the velocity v = F' V - perp(X)
//! for u1_dot = 1, clockwise about the cam, so that perp(v) points out of it.
use crate::numerics::plane::{Vec2, cross, perp, turned};

/// A disc cam with its follower.
#[derive(Clone, Debug, PartialEq)]
pub struct Cam {
    /// The roller's centre, or a point of the flat face, in the follower's frame [m].
    pub contact: Vec2,
    /// Unit normal of the flat face in the follower's frame, out of the cam; None for a roller.
    pub face: Option<Vec2>,
    /// Radius of the roller [m]; 0 for a flat face.
    pub roller: f64,
    /// Motion of the follower.
    pub guide: Guide,
    /// Sign of a lift in u2.
    pub sign: f64,
}

/// Motion of a follower relative to the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum Guide {
    /// Along a line: X at u2 = 0 [m], the unit vector along which u2 grows, the normal of a flat face.
    Line { start: Vec2, along: Vec2, normal: Vec2 },
    /// About a pivot: its place [m], the vector from it to X at u2 = 0 [m], the normal of a flat face at u2 = 0.
    Pivot { at: Vec2, arm: Vec2, normal: Vec2 },
}

/// The follower at a u2: X, V and W, the normal of a flat face.
struct Placed {
    x: Vec2,
    v: Vec2,
    w: Vec2,
    normal: Vec2,
}

impl Cam {
    fn placed(&self, u2: f64) -> Placed {
        match self.guide {
            Guide::Line { start, along, normal } => {
                Placed { x: start + u2 * along, v: along, w: Vec2::zeros(), normal }
            }
            Guide::Pivot { at, arm, normal } => {
                let arm = turned(arm, u2);
                Placed { x: at + arm, v: perp(arm), w: -arm, normal: turned(normal, u2) }
            }
        }
    }

    /// Pressure angle, from the direction in which a lift moves the follower where it touches to the normal out of the
    /// cam [rad], and its derivative with respect to u1, for u2, F' and F''.
    pub fn pressure_angle(&self, [u2, slope, curvature]: [f64; 3]) -> [f64; 2] {
        let Placed { x, v, w, normal } = self.placed(u2);
        // Multiples of sine and cosine, with derivatives.
        let (sine, cosine) = match (self.face, self.guide) {
            (None, _) => {
                let (v_dot, relative) = (slope * w, slope * v - perp(x));
                let relative_dot = curvature * v + slope * slope * w - slope * perp(v);
                (
                    [v.dot(&relative), v_dot.dot(&relative) + v.dot(&relative_dot)],
                    [-cross(v, relative), -cross(v_dot, relative) - cross(v, relative_dot)],
                )
            }
            (Some(_), Guide::Line { .. }) => ([cross(v, normal), 0.0], [v.dot(&normal), 0.0]),
            (Some(_), Guide::Pivot { at, arm, normal: at_zero }) => {
                // From the pivot to the contact: across the face and along it, to the foot of the relative pole.
                let (off, rest) = (arm.dot(&at_zero), slope - 1.0);
                let along = perp(normal).dot(&at) / rest;
                let along_dot = (-slope * normal.dot(&at) - along * curvature) / rest;
                ([-off, 0.0], [-along, -along_dot])
            }
        };
        let [y, x] = [sine, cosine].map(|part| part.map(|value| self.sign * value));
        [y[0].atan2(x[0]), (x[0] * y[1] - y[0] * x[1]) / (x[0] * x[0] + y[0] * y[0])]
    }

    /// Radius of curvature of the pitch curve, the path of the roller's centre in the cam, or of the profile under a
    /// flat face [m], for u2, F' and F'': positive where it is convex.
    pub fn radius_of_curvature(&self, [u2, slope, curvature]: [f64; 3]) -> f64 {
        let Placed { x, v, w, normal } = self.placed(u2);
        match (self.face, self.guide) {
            (None, _) => {
                let relative = slope * v - perp(x);
                let second = curvature * v + slope * slope * w - 2.0 * slope * perp(v) - x;
                -relative.norm().powi(3) / cross(relative, second)
            }
            // The envelope of a line at the distance h(psi) from the centre, with the normal at psi, has h + h''.
            (Some(_), Guide::Line { .. }) => normal.dot(&x) + curvature * normal.dot(&v),
            (Some(_), Guide::Pivot { at, .. }) => {
                let (rest, first, second) = (slope - 1.0, perp(normal).dot(&at), -normal.dot(&at));
                let h = normal.dot(&x);
                let [h_dot, h_ddot] = [first * slope, second * slope * slope + first * curvature];
                h + (h_ddot * rest - h_dot * curvature) / rest.powi(3)
            }
        }
    }

    /// Point of the profile that touches at u1, in the frame of the cam [m], for u2 and F'.
    pub fn profile(&self, u1: f64, [u2, slope]: [f64; 2]) -> Vec2 {
        let Placed { x, v, normal, .. } = self.placed(u2);
        let at = match (self.face, self.guide) {
            (None, _) => x - self.roller * perp(slope * v - perp(x)).normalize(),
            // The foot of the relative pole on the face.
            (Some(_), guide) => {
                let pole = match guide {
                    Guide::Line { along, .. } => -slope * perp(along),
                    Guide::Pivot { at, .. } => slope / (slope - 1.0) * at,
                };
                let along = perp(normal);
                x + along.dot(&(pole - x)) * along
            }
        };
        turned(at, -u1)
    }
}
