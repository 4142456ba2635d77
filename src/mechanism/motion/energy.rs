//! Energies of the state, from which the energy balance of the steps is made.
use super::state::State;
use crate::mechanism::reduced::Reduced;

impl State {
    /// Kinetic energy T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at the applied sizes: the springs' energy, less the sum of size times displacement [J].
    pub fn load_potential(&self, reduced: &Reduced) -> f64 {
        let springs = reduced.loading().springs.iter();
        let mut sum = springs.fold(0.0, |sum, spring| sum + spring.energy(self.displacement(reduced, spring.load)));
        for (load, size) in self.applied.iter().enumerate() {
            if *size != 0.0 {
                sum -= size * self.displacement(reduced, load);
            }
        }
        sum
    }

    /// Displacement of a load, counted on over whole revolutions.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> f64 {
        let growth = if self.revolutions == 0.0 { 0.0 } else { self.revolutions * reduced.load_growth(load) };
        reduced.displacement_at(load, self.sigma) + growth
    }
}
