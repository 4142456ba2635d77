//! The law of a gas spring: a gas in a cylinder, compressed and expanded by a polytropic change of state.
//!
//! In: change of the length. Out: the force that resists an extension, its slope, energy. It must not know the linkage.

/// A gas spring: p V^n is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// Absolute pressure p0 at the stated volume [Pa], > 0.
    pub pressure: f64,
    /// Area A of the rod, or of the piston if gas is on one side of it only [m2], > 0.
    pub area: f64,
    /// Volume V0 [m3], > 0.
    pub volume: f64,
    /// Polytropic exponent n [1]: 1 for slow changes, the adiabatic exponent for fast ones.
    pub exponent: f64,
    /// Absolute pressure around the spring [Pa], >= 0.
    pub ambient: f64,
}

impl Gas {
    /// Force that resists an extension by x [m], its slope and its curvature: F = (p_a - p0 (V0 / V)^n) A with
    /// V = V0 + A x. They are infinite where the gas has no volume.
    pub fn force(&self, x: f64) -> [f64; 3] {
        let volume = self.volume + self.area * x;
        if volume <= 0.0 {
            return [f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        }
        let pressure = self.pressure * (self.volume / volume).powf(self.exponent);
        let slope = self.exponent * pressure * self.area * self.area / volume;
        [(self.ambient - pressure) * self.area, slope, -(self.exponent + 1.0) * slope * self.area / volume]
    }

    /// Energy stored by an extension by x [m], which is the integral of the force [J]. It is infinite where the gas has
    /// no volume.
    pub fn energy(&self, x: f64) -> f64 {
        let ratio = 1.0 + self.area * x / self.volume;
        if ratio <= 0.0 {
            return f64::INFINITY;
        }
        // The integral of r^-n from 1 to r, without cancellation near n = 1.
        let log = (self.area * x / self.volume).ln_1p();
        let power = (1.0 - self.exponent) * log;
        let integral = if power == 0.0 { log } else { log * power.exp_m1() / power };
        self.ambient * self.area * x - self.pressure * self.volume * integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAS: Gas = Gas { pressure: 2e6, area: 4e-4, volume: 1e-4, exponent: 1.3, ambient: 101_325.0 };

    #[test]
    fn each_is_the_slope_of_the_one_before() {
        for exponent in [0.0, 1.0, 1.0 + 1e-9, 1.3, 1.4] {
            let gas = Gas { exponent, ..GAS };
            for x in [-0.2, -0.05, 0.0, 0.1, 0.3] {
                let h = 1e-5;
                let [force, slope, curvature] = gas.force(x);
                let by_energy = (gas.energy(x + h) - gas.energy(x - h)) / (2.0 * h);
                let by_force = (gas.force(x + h)[0] - gas.force(x - h)[0]) / (2.0 * h);
                assert!((force - by_energy).abs() < 1e-6 * force.abs().max(1.0), "{exponent} {x}: {force} {by_energy}");
                let by_slope = (gas.force(x + h)[1] - gas.force(x - h)[1]) / (2.0 * h);
                assert!((curvature - by_slope).abs() < 1e-5 * curvature.abs().max(1.0), "{curvature} {by_slope}");
                assert!((slope - by_force).abs() < 1e-6 * slope.abs().max(1.0), "{exponent} {x}: {slope} {by_force}");
            }
        }
    }

    #[test]
    fn the_law_of_boyle() {
        let gas = Gas { exponent: 1.0, ambient: 0.0, ..GAS };
        // Half the volume, twice the pressure.
        let [force, ..] = gas.force(-0.5 * gas.volume / gas.area);
        assert!((force + 2.0 * gas.pressure * gas.area).abs() < 1e-9);
        assert!((gas.energy(-0.5 * gas.volume / gas.area) - 200.0 * 2.0_f64.ln()).abs() < 1e-9);
    }

    #[test]
    fn without_volume_the_force_is_infinite() {
        assert_eq!(GAS.force(-0.25)[0], f64::NEG_INFINITY);
        assert_eq!(GAS.energy(-0.3), f64::INFINITY);
    }
}
