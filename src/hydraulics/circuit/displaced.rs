//! Oil that is shut in while the piston moves.
//!
//! In: the state of a circuit, a way of the piston. Out: the state after it, with the same oil in each chamber. It must
//! not know time.
use super::{CIRCUIT, ENERGY, Equations};

/// Steps of Runge and Kutta's method over the way.
const STEPS: u32 = 8;
/// Indices of the work of the piston and of the energy of compression.
const PISTON: usize = ENERGY + 2;
const COMPRESSION: usize = ENERGY + 4;

impl Equations {
    /// The state after the piston has gone a way [m] that ends at a length of the actuator [m], with valve and leakages
    /// shut: dp_A/ds = -E A_A / V_A, dp_B/ds = E A_B / V_B. The work of the pressures comes out of the compression. The
    /// same state where a chamber would come to absolute zero.
    pub fn displaced(&self, circuit: &[f64; CIRCUIT], length: f64, way: f64) -> [f64; CIRCUIT] {
        let slopes = |s: f64, [a, b, _]: [f64; 3]| {
            let [v_a, v_b] = self.oil_volumes(self.volumes(s));
            let [e_a, e_b] = [self.chamber_modulus(0, a, v_a), self.chamber_modulus(1, b, v_b)];
            let [area_a, area_b] = self.areas();
            [-e_a * area_a / v_a, e_b * area_b / v_b, a * area_a - b * area_b]
        };
        let (step, start) = (way / f64::from(STEPS), length - way);
        let mut y = [circuit[0], circuit[1], 0.0];
        for k in 0..STEPS {
            let s = start + f64::from(k) * step;
            let at = |by: f64, k: [f64; 3]| std::array::from_fn(|i| y[i] + by * k[i]);
            let first = slopes(s, y);
            let second = slopes(s + 0.5 * step, at(0.5 * step, first));
            let third = slopes(s + 0.5 * step, at(0.5 * step, second));
            let last = slopes(s + step, at(step, third));
            y = std::array::from_fn(|i| y[i] + step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + last[i]));
        }
        let mut moved = *circuit;
        (moved[0], moved[1]) = (y[0], y[1]);
        moved[PISTON] += y[2];
        moved[COMPRESSION] -= y[2];
        let vacuum = -self.ambient();
        if y.iter().all(|x| x.is_finite()) && y[0] > vacuum && y[1] > vacuum { moved } else { *circuit }
    }
}
