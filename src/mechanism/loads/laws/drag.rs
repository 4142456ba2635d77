//! Drag of the air on a surface.
//!
//! In: the air's velocity, the surface's place and motion. Out: force and moment on its body. It must not know the linkage.
//! Source: [HF08] eq. (1), P = 1/2 rho v^2 S c, with S the area that faces the flow.
use crate::mechanism::linkage::{Point, Vec2};
use crate::numerics::dual::Number;

/// A surface that moves with a body: a strip of some length along a line, or an area at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Start of the strip, or place of the area.
    pub start: Point,
    /// Unit vector along the strip, or along a flat area, in the body's frame; none for an area that is as large from all
    /// sides.
    pub line: Option<Vec2>,
    /// Length of the strip [m]; 0 for an area.
    pub length: f64,
    /// Width of the strip [m], or the area [m2].
    pub breadth: f64,
    /// Drag coefficient c [1].
    pub coefficient: f64,
    /// Place of its loads: forces along x and y at `start`, a torque on the body.
    pub load: usize,
}

/// What the surface meets: all vectors in the mechanism frame.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<T> {
    /// Velocity of the air at `start` less that of `start` [m/s].
    pub wind: [T; 2],
    /// Angular velocity of the body [rad/s]; 0 if the surface's motion does not count.
    pub omega: T,
    /// Unit vector along the surface; of no meaning where [`Surface::line`] is none.
    pub line: [T; 2],
}

impl Surface {
    /// Force [N] on the body in the mechanism frame and its moment about `start` [N.m], in air of this density [kg/m3].
    ///
    /// An element ds of a strip of width w has the normal n and meets the air with u(s) = wind - omega s n; it presents the
    /// area w ds |n . u| / |u|, so that dF = 1/2 rho c w |n . u| u ds. A flat area is one such element, an area without
    /// direction has F = 1/2 rho c A |u| u.
    pub fn drag<T: Number>(&self, density: f64, meeting: &Meeting<T>) -> [T; 3] {
        let pressure = T::constant(0.5 * density * self.coefficient * self.breadth);
        let zero = T::constant(0.0);
        let [wx, wy] = meeting.wind;
        if self.line.is_none() {
            let square = wx * wx + wy * wy;
            if square.value() == 0.0 {
                return [zero; 3];
            }
            let size = pressure * square.sqrt();
            return [size * wx, size * wy, zero];
        }
        let [ex, ey] = meeting.line;
        let along = wx * ex + wy * ey;
        let across = wy * ex - wx * ey;
        let omega = meeting.omega;
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
            // Where n . u changes its sign; nothing follows from moving this point, as n . u is 0 there.
            let turn = across.value() / omega.value();
            if turn > 0.0 && turn < self.length {
                add(0.0, turn, turn);
                add(turn, self.length, self.length - turn);
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
