//! Scene S1 written out by hand: the landing gear's equation of motion in the crank angle, in closed form.
//!
//! I(theta) theta'' = Q(theta) - 1/2 I'(theta) theta'^2 ([HF08] appendix, [CK16] eq. 17), with k_i =
//! d(theta_i)/d(theta2). No angle but theta2 is needed: the rods are vectors, closed by intersecting two circles.

/// A vector in the mechanism's plane [m].
type Vector = [f64; 2];

/// Lengths of the ground, the crank, the coupler and the follower [m].
const GROUND: f64 = 0.5729;
const CRANK: f64 = 0.1755;
const COUPLER: f64 = 0.217;
const FOLLOWER: f64 = 0.34;
/// Masses of crank, coupler and follower, uniform rods [kg].
const CRANK_MASS: f64 = 13.689;
const COUPLER_MASS: f64 = 0.720_370_56;
const FOLLOWER_MASS: f64 = 3.850_704;
/// The leg, a uniform rod from the crank's pivot, and the wheel, a point mass at the end of the leg: length [m], angle
/// from the crank [rad], masses [kg].
const LEG: f64 = 0.759;
const LEG_ANGLE: f64 = -2.4;
const LEG_MASS: f64 = 36.8;
const WHEEL_MASS: f64 = 19.5;
/// Load factor times acceleration of gravity [m/s2], and the angle of the upward direction from Y [rad].
const GRAVITY: f64 = 3.0 * 9.81;
const UP_ANGLE: f64 = 1.13;
/// The actuator's force, positive in extension [N], and its attachments in the crank's and the follower's frame [m].
const FORCE: f64 = 30e3;
const ON_CRANK: Vector = [-0.050, -0.138];
const ON_FOLLOWER: Vector = [0.020, 0.120];

/// theta2 [rad] and its rate [rad/s] at the start.
pub const START: Vector = [0.8, 0.0];
/// End of the run [s].
pub const SPAN: f64 = 0.13;
/// theta2 at the end [rad], from an energy quadrature with 34 digits, and its rate there [rad/s].
pub const THETA2: f64 = -1.237_711_726_689_136_7;
pub const OMEGA: f64 = -30.118_354_649_349_844;

/// Positions and kinetics of the rods at one crank angle.
struct Pose {
    cos: f64,
    sin: f64,
    /// Crank, coupler and follower from joint to joint, with C to the left of the diagonal from B to D [m].
    e2: Vector,
    e3: Vector,
    e4: Vector,
    /// 1 / (e3 x e4), e2 x e3, e2 . e3.
    c34: f64,
    c23: f64,
    d23: f64,
    /// d(theta3)/d(theta2) and d(theta4)/d(theta2).
    k3: f64,
    k4: f64,
    /// Inertia reduced to the crank [kg m2].
    inertia: f64,
}

/// The equation of motion with its constants evaluated once.
pub struct FourBar {
    /// Inertia of crank, leg and wheel about the crank's pivot, and of the coupler's point B [kg m2].
    fixed_inertia: f64,
    coupler_inertia: f64,
    follower_inertia: f64,
    /// Gravity [m/s2].
    gravity: Vector,
    /// Virtual work of gravity on all bodies that turn with the crank: coefficients of cos and sin of theta2 [N m].
    crank_work: Vector,
    /// The actuator's attachment on the follower, along and across it, relative to the follower's length [1].
    on_follower: Vector,
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// `along` times a vector plus `across` times the vector rotated by a right angle.
fn turned(v: Vector, along: f64, across: f64) -> Vector {
    [along * v[0] - across * v[1], along * v[1] + across * v[0]]
}

/// Crank angle at which coupler and follower are in line and the crank reverses [rad].
pub fn toggle() -> f64 {
    const REACH: f64 = COUPLER + FOLLOWER;
    -((GROUND * GROUND + CRANK * CRANK - REACH * REACH) / (2.0 * GROUND * CRANK)).acos()
}

impl FourBar {
    /// Scene S1.
    pub fn new() -> Self {
        let chi = std::f64::consts::FRAC_PI_2 - UP_ANGLE;
        let gravity = [-GRAVITY * chi.sin(), -GRAVITY * chi.cos()];
        let rod = (CRANK_MASS / 2.0 + COUPLER_MASS) * CRANK;
        let leg = (LEG_MASS / 2.0 + WHEEL_MASS) * LEG;
        // Moment of the masses at theta2 = 0. dy/d(theta) is x rotated, so that the virtual work is moment x gravity.
        let moment = [rod + leg * LEG_ANGLE.cos(), leg * LEG_ANGLE.sin()];
        Self {
            fixed_inertia: (CRANK_MASS / 3.0 + COUPLER_MASS) * CRANK * CRANK
                + (LEG_MASS / 3.0 + WHEEL_MASS) * LEG * LEG,
            coupler_inertia: COUPLER_MASS * COUPLER * COUPLER / 3.0,
            follower_inertia: FOLLOWER_MASS * FOLLOWER * FOLLOWER / 3.0,
            gravity,
            crank_work: [cross(moment, gravity), -dot(moment, gravity)],
            on_follower: [ON_FOLLOWER[0] / FOLLOWER, ON_FOLLOWER[1] / FOLLOWER],
        }
    }

    #[inline(always)]
    fn pose(&self, theta2: f64) -> Pose {
        let (sin, cos) = theta2.sin_cos();
        let e2 = [CRANK * cos, CRANK * sin];
        let diagonal = [GROUND - e2[0], -e2[1]];
        let inverse = 1.0 / dot(diagonal, diagonal);
        let along = 0.5 + 0.5 * (COUPLER * COUPLER - FOLLOWER * FOLLOWER) * inverse;
        let across = (COUPLER * COUPLER * inverse - along * along).sqrt();
        let e3 = turned(diagonal, along, across);
        let e4 = [e3[0] - diagonal[0], e3[1] - diagonal[1]];

        let (c34, c23, d23) = (1.0 / cross(e3, e4), cross(e2, e3), dot(e2, e3));
        let k3 = -cross(e2, e4) * c34;
        let k4 = -c23 * c34;
        let inertia = self.fixed_inertia
            + self.follower_inertia * k4 * k4
            + k3 * (self.coupler_inertia * k3 + COUPLER_MASS * d23);
        Pose { cos, sin, e2, e3, e4, c34, c23, d23, k3, k4, inertia }
    }

    /// The actuator's attachment on the crank, that on the follower from D, and the vector from the first to the second
    /// [m].
    #[inline(always)]
    fn actuator(&self, pose: &Pose) -> (Vector, Vector, Vector) {
        let p = turned([pose.cos, pose.sin], ON_CRANK[0], ON_CRANK[1]);
        let q = turned(pose.e4, self.on_follower[0], self.on_follower[1]);
        (p, q, [GROUND + q[0] - p[0], q[1] - p[1]])
    }

    /// theta2'' and its derivative with respect to omega, for the crank angle and its rate omega.
    #[inline]
    pub fn acceleration(&self, theta2: f64, omega: f64) -> (f64, f64) {
        let pose = self.pose(theta2);
        let Pose { cos, sin, e2, e3, e4, c34, c23, d23, k3, k4, inertia } = pose;
        let d34 = dot(e3, e4);
        let k3_slope = (dot(e2, e4) + k3 * k3 * d34 - k4 * k4 * (FOLLOWER * FOLLOWER)) * c34;
        let k4_slope = (d23 + k3 * k3 * (COUPLER * COUPLER) - k4 * k4 * d34) * c34;
        let half_slope = self.follower_inertia * k4 * k4_slope
            + self.coupler_inertia * k3 * k3_slope
            + 0.5 * COUPLER_MASS * (k3_slope * d23 + k3 * (1.0 - k3) * c23);

        let (p, q, stroke) = self.actuator(&pose);
        let push = FORCE * (k4 * cross(q, stroke) - cross(p, stroke)) / dot(stroke, stroke).sqrt();
        let weight = self.crank_work[0] * cos
            + self.crank_work[1] * sin
            + 0.5 * (COUPLER_MASS * k3 * cross(e3, self.gravity) + FOLLOWER_MASS * k4 * cross(e4, self.gravity));

        let per_inertia = 1.0 / inertia;
        ((push + weight - half_slope * omega * omega) * per_inertia, -2.0 * half_slope * omega * per_inertia)
    }

    /// Work of actuator and gravity up to this crank angle, up to a constant [J], and the reduced inertia.
    #[inline]
    pub fn work_and_inertia(&self, theta2: f64) -> (f64, f64) {
        let pose = self.pose(theta2);
        let (_, _, stroke) = self.actuator(&pose);
        let work = FORCE * dot(stroke, stroke).sqrt() + self.crank_work[0] * pose.sin - self.crank_work[1] * pose.cos
            + 0.5 * (COUPLER_MASS * dot(pose.e3, self.gravity) + FOLLOWER_MASS * dot(pose.e4, self.gravity));
        (work, pose.inertia)
    }
}
