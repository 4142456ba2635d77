//! Drag of the air on a surface.
//!
//! In: relative velocity of the air, direction and angular velocity of the surface. Out: force and moment. It must not
//! know bodies or the linkage. Source: [HF08] eq. (1), P = 1/2 rho v^2 S c, with S the area that faces the flow.
use crate::numerics::dual::Number;

/// Drag of a strip of some length along a line, or of an area at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Whether drag depends on the direction of the surface; false for an area that is the same from all sides.
    pub directed: bool,
    /// Length of the strip [m]; 0 for an area.
    pub length: f64,
    /// Width of the strip [m], or the area [m2].
    pub breadth: f64,
    /// Drag coefficient c [1].
    pub coefficient: f64,
}

/// Flow relative to a surface, with all vectors in the mechanism frame.
#[derive(Clone, Copy, Debug)]
pub struct RelativeFlow<T> {
    /// Velocity of the air relative to the start of the surface [m/s].
    pub wind: [T; 2],
    /// Angular velocity of the surface [rad/s]; 0 if its motion is neglected.
    pub omega: T,
    /// Unit vector along the surface; unused unless [`Drag::directed`].
    pub line: [T; 2],
}

impl Drag {
    /// Force [N] in the mechanism frame and moment about the surface's start [N.m], in air of this density [kg/m3].
    ///
    /// An element ds of a strip of width w with the normal n has the relative flow u(s) = wind - omega s n and faces it
    /// with the area w ds |n . u| / |u|, so that dF = 1/2 rho c w |n . u| u ds. A flat area is one such element; an
    /// area without direction has F = 1/2 rho c A |u| u.
    pub fn force<T: Number>(&self, density: f64, flow: &RelativeFlow<T>) -> [T; 3] {
        let pressure = T::constant(0.5 * density * self.coefficient * self.breadth);
        let zero = T::constant(0.0);
        let [wx, wy] = flow.wind;
        if !self.directed {
            let square = wx * wx + wy * wy;
            if square.value() == 0.0 {
                return [zero; 3];
            }
            let size = pressure * square.sqrt();
            return [size * wx, size * wy, zero];
        }
        let [ex, ey] = flow.line;
        let along = wx * ex + wy * ey;
        let across = wy * ex - wx * ey;
        let omega = flow.omega;
        // Integrals of |n . u| (1, n . u, s n . u) along the strip.
        let mut sums = [zero; 3];
        let mut add = |from: f64, to: f64, weight: f64| {
            let middle = 0.5 * (from + to);
            for (s, part) in [(from, 1.0), (middle, 4.0), (to, 1.0)] {
                let u = across - omega * T::constant(s);
                let sign = if (across.value() - omega.value() * middle) < 0.0 { -1.0 } else { 1.0 };
                let share = u * T::constant(sign * weight * part / 6.0);
                sums[0] = sums[0] + share;
                sums[1] = sums[1] + share * u;
                sums[2] = sums[2] + share * u * T::constant(s);
            }
        };
        if self.length == 0.0 {
            add(0.0, 0.0, 1.0);
        } else {
            // Zero of n . u. Its derivatives have no effect on the integral, as the integrand vanishes there.
            let root = across.value() / omega.value();
            if root > 0.0 && root < self.length {
                add(0.0, root, root);
                add(root, self.length, self.length - root);
            } else {
                add(0.0, self.length, self.length);
            }
        }
        let force = [pressure * sums[0] * along, pressure * sums[1]];
        [force[0] * ex - force[1] * ey, force[0] * ey + force[1] * ex, pressure * sums[2]]
    }
}

#[cfg(test)]
mod tests;
