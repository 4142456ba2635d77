//! The rigid-link finite element: inertia and axial stiffness of one body between two nodes ([HF08] section 3).
//!
//! In: positions, velocities and accelerations of the two nodes. Out: forces at the nodes, matrices, energies. It must
//! not know joints, loads or time steps. d = x2 - x1 [m] is the vector between the nodes, l its length, e = d / l, n =
//! J e with J the rotation by a right angle; L is the length without force. Vectors of four components are (x1, x2).
use crate::numerics::plane::{Vec2, cross, perp};
use nalgebra::{Matrix4, Vector4};

/// Coordinates of a point of the body relative to its nodes: x = (1 - xi) x1 + xi x2 + eta J (x2 - x1).
///
/// The acceleration of a rigid body is affine, a(r) = a1 + (alpha J - omega^2) r, and alpha J - omega^2 commutes with
/// J: the same weights give positions, velocities and accelerations at any angle of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalCoordinates {
    /// Along the element, 0 at node 1, 1 at node 2 [1].
    pub xi: f64,
    /// Across the element, in lengths of the element [1].
    pub eta: f64,
}

impl LocalCoordinates {
    /// Coordinates of a point at `r` from node 1 if node 2 is at `d` from node 1 [m].
    pub fn new(r: Vec2, d: Vec2) -> Self {
        let square = d.norm_squared();
        Self { xi: d.dot(&r) / square, eta: cross(d, r) / square }
    }

    /// N s: position, velocity or acceleration at this point for the values `s` at the nodes.
    pub fn interpolate(self, s: [Vec2; 2]) -> Vec2 {
        s[0] + self.xi * (s[1] - s[0]) + self.eta * perp(s[1] - s[0])
    }

    /// N^T force: forces at the nodes with the virtual work of a force at this point [N].
    pub fn spread(self, force: Vec2) -> [Vec2; 2] {
        let second = self.xi * force - self.eta * perp(force);
        [force - second, second]
    }
}

/// Motion of the two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Positions [m].
    pub x: [Vec2; 2],
    /// Velocities [m/s].
    pub v: [Vec2; 2],
    /// Accelerations [m/s2].
    pub a: [Vec2; 2],
}

/// Present length and direction of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// l = |x2 - x1| [m].
    pub length: f64,
    /// e, from node 1 to node 2.
    pub along: Vec2,
    /// n = J e.
    pub across: Vec2,
}

impl Span {
    /// Between two positions.
    pub fn new(x: [Vec2; 2]) -> Self {
        let d = x[1] - x[0];
        let length = d.norm();
        let along = d / length;
        Self { length, along, across: perp(along) }
    }

    /// Angular speed n . (v2 - v1) / l [rad/s].
    pub fn speed(&self, v: [Vec2; 2]) -> f64 {
        self.across.dot(&(v[1] - v[0])) / self.length
    }
}

/// (-u, u): the gradient of u . (x2 - x1).
pub fn difference(u: Vec2) -> Vector4<f64> {
    Vector4::new(-u.x, -u.y, u.x, u.y)
}

/// A body as a finite element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Length without force L [m].
    pub length: f64,
    /// E A [N].
    pub axial_stiffness: f64,
    /// Mass m [kg].
    pub mass: f64,
    /// Coordinates of the centre of mass.
    pub center: LocalCoordinates,
    /// Moment of inertia about the centre of mass, I [kg.m2].
    pub inertia: f64,
}

impl Element {
    /// M_e = m N^T N + (I / L^2) (-n, n)(-n, n)^T [kg], N at the centre of mass. For a uniform rod this is [HF08] eq.
    /// (19) turned by eq. (23); for any other body it is the exact inertia.
    pub fn mass_matrix(&self, across: Vec2) -> Matrix4<f64> {
        let LocalCoordinates { xi, eta } = self.center;
        let (one, two, skew) = (1.0 - xi, xi, eta);
        // N = [(1 - xi) - eta J, xi + eta J].
        let n = nalgebra::Matrix2x4::new(one, skew, two, -skew, -skew, one, skew, two);
        let t = difference(across);
        self.mass * n.transpose() * n + (self.inertia / (self.length * self.length)) * t * t.transpose()
    }

    /// Force in the rod N = E A (l - L) / L [N], > 0 in tension: [HF08] eqs. (15)-(18) along the present direction.
    pub fn axial_force(&self, span: &Span) -> f64 {
        self.axial_stiffness * (span.length - self.length) / self.length
    }

    /// K_e = (E A / L) (-e, e)(-e, e)^T [N/m]: [HF08] eq. (18) turned by eq. (24).
    pub fn material_matrix(&self, span: &Span) -> Matrix4<f64> {
        let s = difference(span.along);
        (self.axial_stiffness / self.length) * s * s.transpose()
    }

    /// Derivative of the rod's forces with respect to the nodes' positions [N/m]: K_e + (N / l) (-n, n)(-n, n)^T.
    pub fn stiffness_matrix(&self, span: &Span) -> Matrix4<f64> {
        let t = difference(span.across);
        self.material_matrix(span) + (self.axial_force(span) / span.length) * t * t.transpose()
    }

    /// Forces on the element at its nodes for this motion [N]: M_e a + N (-e, e) + c.
    ///
    /// c = -(I / L^2) l omega^2 (-e, e) is the term of Lagrange's equations for T = v^T M_e v / 2 that is due to the
    /// rotation of M_e with the element. These forces along the rod do no work in a rigid motion, and [HF08] eq. (22)
    /// omits them; with them the energy of a stretching rod is conserved too.
    pub fn demand(&self, ends: &Ends) -> [Vec2; 2] {
        let span = Span::new(ends.x);
        let omega = span.speed(ends.v);
        let [first, second] = self.center.spread(self.mass * self.center.interpolate(ends.a));
        let turning = self.inertia / (self.length * self.length);
        let transverse = turning * span.across.dot(&(ends.a[1] - ends.a[0]));
        let axial = self.axial_force(&span) - turning * span.length * omega * omega;
        let pair = transverse * span.across + axial * span.along;
        [first - pair, second + pair]
    }

    /// T = v^T M_e v / 2 [J].
    pub fn kinetic(&self, ends: &Ends) -> f64 {
        let span = Span::new(ends.x);
        let omega = span.speed(ends.v) * (span.length / self.length);
        0.5 * (self.mass * self.center.interpolate(ends.v).norm_squared() + self.inertia * omega * omega)
    }

    /// U = E A (l - L)^2 / (2 L) [J], [HF08] eq. (14).
    pub fn strain(&self, span: &Span) -> f64 {
        0.5 * self.axial_force(span) * (span.length - self.length)
    }

    /// Angular acceleration [rad/s2]: the derivative of [`Span::speed`].
    pub fn angular_acceleration(&self, ends: &Ends) -> f64 {
        let span = Span::new(ends.x);
        let stretching = span.along.dot(&(ends.v[1] - ends.v[0]));
        (span.across.dot(&(ends.a[1] - ends.a[0])) - 2.0 * stretching * span.speed(ends.v)) / span.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::plane::turned;

    const ROD: Element = Element {
        length: 0.34,
        axial_stiffness: 3.0492e8,
        mass: 3.850704,
        center: LocalCoordinates { xi: 0.5, eta: 0.0 },
        inertia: 3.850704 * 0.34 * 0.34 / 12.0,
    };

    /// A body other than a uniform rod.
    const BODY: Element = Element { center: LocalCoordinates { xi: -0.4, eta: 0.9 }, inertia: 0.3, ..ROD };

    fn ends(angle: f64, stretch: f64) -> Ends {
        let x = Vec2::new(0.1, -0.3);
        Ends {
            x: [x, x + turned(Vec2::new(0.34 + stretch, 0.0), angle)],
            v: [Vec2::new(0.4, -1.0), Vec2::new(-2.0, 0.7)],
            a: [Vec2::new(30.0, 5.0), Vec2::new(-12.0, 60.0)],
        }
    }

    #[test]
    fn a_uniform_rod_has_the_matrices_of_the_paper() {
        // [HF08] eqs. (18), (19), turned by (5), (23), (24).
        let m = Matrix4::new(3., 0., 3., 0., 0., 4., 0., 2., 3., 0., 3., 0., 0., 2., 0., 4.) * (ROD.mass / 12.0);
        let k = Matrix4::new(1., 0., -1., 0., 0., 0., 0., 0., -1., 0., 1., 0., 0., 0., 0., 0.);
        let k = k * (ROD.axial_stiffness / ROD.length);
        for angle in [0.0_f64, 0.7, 2.4, -1.3] {
            let (b, a) = angle.sin_cos();
            let t = Matrix4::new(a, b, 0., 0., -b, a, 0., 0., 0., 0., a, b, 0., 0., -b, a);
            let span = Span::new(ends(angle, 0.0).x);
            assert!((ROD.mass_matrix(span.across) - t.transpose() * m * t).norm() < 1e-14 * m.norm());
            // Rounding of the length leaves a force of 1e-16 E A in the geometric part.
            assert!((ROD.stiffness_matrix(&span) - t.transpose() * k * t).norm() < 1e-14 * k.norm());
        }
    }

    #[test]
    fn the_inertia_is_that_of_newton_and_euler() {
        // A rigid motion: acceleration of node 1, omega, alpha; centre of mass at r from node 1.
        let (omega, alpha, angle) = (-7.0, 31.0, 1.1);
        let at = |r: Vec2| Vec2::new(3.0, -4.0) + alpha * perp(r) - omega * omega * r;
        let d = turned(Vec2::new(BODY.length, 0.0), angle);
        let r = BODY.center.xi * d + BODY.center.eta * perp(d);
        let ends = Ends { x: [Vec2::zeros(), d], v: [Vec2::zeros(), omega * perp(d)], a: [at(Vec2::zeros()), at(d)] };
        let [first, second] = BODY.demand(&ends);
        let force = BODY.mass * at(r);
        assert!((first + second - force).norm() < 1e-12 * force.norm());
        let moment = cross(r, force) + BODY.inertia * alpha;
        assert!((cross(d, second) - moment).abs() < 1e-12 * force.norm());
        assert!((BODY.angular_acceleration(&ends) - alpha).abs() < 1e-12 * alpha);
    }

    #[test]
    fn the_stiffness_is_the_derivative_of_the_force() {
        for stretch in [-2e-3, 0.0, 3e-3] {
            let at = |x: Vector4<f64>| {
                let [v, a] = [[Vec2::zeros(); 2]; 2];
                let x = [Vec2::new(x[0], x[1]), Vec2::new(x[2], x[3])];
                let [f, g] = BODY.demand(&Ends { x, v, a });
                Vector4::new(f.x, f.y, g.x, g.y)
            };
            let [p, q] = ends(0.9, stretch).x;
            let x = Vector4::new(p.x, p.y, q.x, q.y);
            let k = BODY.stiffness_matrix(&Span::new([p, q]));
            for i in 0..4 {
                let mut step = Vector4::zeros();
                step[i] = 1e-6;
                let slope = (at(x + step) - at(x - step)) / 2e-6;
                // h^2 times the third derivative, E A / L^3.
                assert!((slope - k.column(i)).norm() < 1e-9 * k.norm(), "{slope} {k}");
            }
        }
    }

    #[test]
    fn the_angular_acceleration_is_the_rate_of_the_speed_while_the_length_changes() {
        let here = ends(0.9, 2e-3);
        let speed = |t: f64| {
            let x = [0, 1].map(|i| here.x[i] + t * here.v[i] + 0.5 * t * t * here.a[i]);
            Span::new(x).speed([0, 1].map(|i| here.v[i] + t * here.a[i]))
        };
        let rate = (speed(1e-6) - speed(-1e-6)) / 2e-6;
        assert!((BODY.angular_acceleration(&here) - rate).abs() < 1e-8 * rate.abs());
    }

    #[test]
    fn the_power_of_the_demand_is_the_rate_of_the_energy() {
        let here = ends(0.9, 2e-3);
        let [p, q] = BODY.demand(&here);
        let power = p.dot(&here.v[0]) + q.dot(&here.v[1]);
        let energy = |t: f64| {
            let x = [0, 1].map(|i| here.x[i] + t * here.v[i] + 0.5 * t * t * here.a[i]);
            let v = [0, 1].map(|i| here.v[i] + t * here.a[i]);
            let ends = Ends { x, v, a: here.a };
            BODY.kinetic(&ends) + BODY.strain(&Span::new(x))
        };
        let rate = (energy(1e-6) - energy(-1e-6)) / 2e-6;
        assert!((rate - power).abs() < 1e-8 * power.abs(), "{rate} {power}");
        // The term c matters: its power exceeds the tolerance.
        let span = Span::new(here.x);
        let pair = BODY.inertia / BODY.length.powi(2) * span.length * span.speed(here.v).powi(2);
        assert!((pair * span.along.dot(&(here.v[1] - here.v[0]))).abs() > 1e-6 * power.abs());
    }
}
