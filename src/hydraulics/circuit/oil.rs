//! Oil in the chambers: volumes, bulk moduli, stiffness.
//!
//! In: length of the actuator, pressures. Out: volumes, effective bulk moduli of oil, air, hoses and walls, the
//! stiffness of both chambers as one spring. It must not know flows.
use super::Equations;
use foundation::numerics::dual::Number;

impl Equations {
    /// Volumes of the chambers [m3] at a length of the actuator [m].
    #[inline]
    pub fn volumes<T: Number>(&self, length: T) -> [T; 2] {
        let x = length - T::constant(self.closed_length);
        [
            T::constant(self.dead_volumes[0]) + x * self.areas[0],
            T::constant(self.dead_volumes[1]) + (T::constant(self.stroke) - x) * self.areas[1],
        ]
    }

    /// Volumes of the oil that makes the chambers elastic [m3], of their volumes.
    #[inline]
    pub fn oil_volumes<T: Number>(&self, volumes: [T; 2]) -> [T; 2] {
        if self.keeps_volume { self.dead_volumes.map(T::constant) } else { volumes }
    }

    /// Effective bulk modulus of oil with entrained air [Pa] at a gauge pressure: with r = air (p_0/p_abs)^(1/n), E =
    /// bulk (1 + r) / (1 + r bulk/(n p_abs)); NaN at or below absolute zero if there is air.
    #[inline]
    pub fn bulk_modulus<T: Number>(&self, pressure: T) -> T {
        if self.air == 0.0 {
            return T::constant(self.bulk);
        }
        let (n, absolute) = (self.exponent, pressure.value() + self.ambient);
        let r = self.air * (self.ambient / absolute).powf(1.0 / n);
        let ratio = self.bulk / (n * absolute);
        let denominator = 1.0 / (1.0 + r * ratio);
        let value = self.bulk * (1.0 + r) * denominator;
        // r' = -r / (n p_abs), (r ratio)' = -r ratio (1/n + 1) / p_abs.
        let slope = self.bulk * denominator * (-r / (n * absolute))
            + value * denominator * r * ratio * (1.0 / n + 1.0) / absolute;
        pressure.chain(value, slope)
    }

    /// Bulk modulus of chamber `side` [Pa], of oil, hose and walls together: 1/E_eff = 1/E + (V_hose/V)/E_hose +
    /// (V_cyl/V)/E_cyl, V_cyl = V - V_hose.
    #[inline]
    pub fn chamber_modulus<T: Number>(&self, side: usize, pressure: T, volume: T) -> T {
        let oil = self.bulk_modulus(pressure);
        let hose = self.hoses[side];
        if hose == 0.0 && self.wall_compliance == 0.0 {
            return oil;
        }
        let part = T::constant(hose) / volume;
        let walls = (T::constant(1.0) - part) * self.wall_compliance + part * self.hose_compliance;
        oil / (T::constant(1.0) + oil * walls)
    }

    /// Stiffness of the oil [N/m]: k = E(p_A) A_A^2/V_A + E(p_B) A_B^2/V_B.
    #[inline]
    pub fn stiffness<T: Number>(&self, pressures: [T; 2], length: T) -> T {
        let [a, b] = self.oil_volumes(self.volumes(length));
        self.chamber_modulus(0, pressures[0], a) / a * (self.areas[0] * self.areas[0])
            + self.chamber_modulus(1, pressures[1], b) / b * (self.areas[1] * self.areas[1])
    }
}
