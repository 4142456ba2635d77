//! Friction of the seals, and the force that it leaves.
//!
//! In: pressures, speed of the actuator. Out: friction with its derivatives by the speed, the force of the actuator. It
//! must not know flows.
use super::Equations;
use super::smooth::soft;
use foundation::numerics::dual::Number;

impl Equations {
    /// Friction of the seals without the part of the pressures [N] at a speed v [m/s]: (coulomb + (static - coulomb)
    /// exp(-(v/stribeck)^2)) tanh(v / transition) + viscous v.
    #[inline]
    pub fn friction<T: Number>(&self, speed: T) -> T {
        let (value, slope, _) = self.friction_at(speed.value());
        speed.chain(value, slope)
    }

    /// Friction of the seals, its derivative and its second derivative with respect to the speed.
    #[inline]
    pub fn friction_at(&self, v: f64) -> (f64, f64, f64) {
        if self.coulomb == 0.0 && self.excess == 0.0 {
            return (self.viscous * v, self.viscous, 0.0);
        }
        let z = v / self.stribeck;
        let bell = self.excess * (-z * z).exp();
        let t = (v / self.transition_speed).tanh();
        let (steepness, level) = ((1.0 - t * t) / self.transition_speed, self.coulomb + bell);
        let bell_slope = -2.0 * z / self.stribeck * bell;
        let bell_curvature = (4.0 * z * z - 2.0) / (self.stribeck * self.stribeck) * bell;
        (
            level * t + self.viscous * v,
            bell_slope * t + level * steepness + self.viscous,
            bell_curvature * t + 2.0 * bell_slope * steepness - 2.0 * level * t * steepness / self.transition_speed,
        )
    }

    /// Growth of the friction level with the pressures [N]: area times the sum of both pressures, each rounded at 0.
    #[inline]
    fn pressed<T: Number>(&self, pressures: [T; 2]) -> T {
        (soft(pressures[0], self.transition) + soft(pressures[1], self.transition)) * self.pressure_area
    }

    /// Friction of the seals [N] under the pressures of the chambers: [`Self::friction`] plus area times the pressures
    /// times tanh(v / transition).
    #[inline]
    pub fn seal_friction<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        let dry = self.friction(speed);
        if self.pressure_area == 0.0 {
            return dry;
        }
        let t = (speed.value() / self.transition_speed).tanh();
        dry + self.pressed(pressures) * speed.chain(t, (1.0 - t * t) / self.transition_speed)
    }

    /// Damping of the seals [N s/m]: derivative of the friction with respect to the speed.
    pub fn damping<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        let (_, slope, curvature) = self.friction_at(speed.value());
        let dry = speed.chain(slope, curvature);
        if self.pressure_area == 0.0 {
            return dry;
        }
        let t = (speed.value() / self.transition_speed).tanh();
        let steepness = (1.0 - t * t) / self.transition_speed;
        dry + self.pressed(pressures) * speed.chain(steepness, -2.0 * t * steepness / self.transition_speed)
    }

    /// Force of the actuator [N], > 0 pushing its ends apart: A_A p_A - A_B p_B - F_f(v).
    #[inline]
    pub fn force<T: Number>(&self, pressures: [T; 2], speed: T) -> T {
        pressures[0] * self.areas[0] - pressures[1] * self.areas[1] - self.seal_friction(pressures, speed)
    }
}
