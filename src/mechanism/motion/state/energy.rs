//! Energies of a state, and the displacements of loads that they follow from.
//!
//! In: a state, the reduced model. Out: kinetic energy, potential of the applied loads, displacements. It must not know
//! steps.
use super::State;
use crate::mechanism::reduced::Reduced;

impl State {
    /// Kinetic energy T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at the applied sizes [J]: the springs' energy, less the sum of size times `displacement`.
    pub fn load_potential(&self, reduced: &Reduced, mut displacement: impl FnMut(usize) -> f64) -> f64 {
        let springs = reduced.loading().springs.iter();
        let mut sum = springs.fold(0.0, |sum, spring| sum + spring.energy(displacement(spring.load)));
        for (load, size) in self.applied.sizes.iter().enumerate().filter(|(_, size)| **size != 0.0) {
            if !reduced.loading().is_command(load) {
                sum -= size * displacement(load);
            }
        }
        sum
    }

    /// Displacement of a load, counted on over whole revolutions.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> f64 {
        self.displacement_near(reduced, load, &mut self.scratch.panel_force.panel())
    }

    /// [`Self::displacement`], with a search that starts at a panel, which becomes the one in the load's table.
    #[inline]
    pub fn displacement_near(&self, reduced: &Reduced, load: usize, panel: &mut usize) -> f64 {
        let growth = if self.revolutions == 0.0 { 0.0 } else { self.revolutions * reduced.load_growth(load) };
        reduced.displacement_from(load, self.sigma, panel) + growth
    }
}
