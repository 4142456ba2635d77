//! Forces of drives with a law, and the integral parts of their controllers.
//!
//! In: integral parts of a state, motion of a drive, inputs. Out: the force of a drive, its integral part and the rate
//! of that, in numbers N. It must not know how a step is made.
use crate::mechanism::definition::MOST_INTEGRALS;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError};
use crate::mechanism::outputs::view::{Reading, View};

impl<N: Reading> View<'_, N> {
    /// Force of a drive before its loss, with that of its law at this speed, and the rate of its integral part.
    pub fn acting(&mut self, drive: usize, speed: N) -> Result<[N; 2], OutputError> {
        let own = self.size(drive);
        let Some(law) = &self.reduced.loading().drives[drive].law else { return Ok([own, N::constant(0.0)]) };
        let motion = [self.displacement(drive, 0)?, speed];
        let integrals = self.integrals();
        let [force, rate] = law.force(own, |input| self.size(input), motion, &integrals, |_, margin| margin);
        Ok([own + force, rate])
    }

    /// Integral parts of controllers [N or N.m]; 0 without one.
    pub fn integrals(&self) -> [N; MOST_INTEGRALS] {
        let direction = &self.cache.direction;
        let known = self.state.memory.integrals();
        let of = |k: usize| known.map_or(N::constant(0.0), |all| direction.s.chain(all[k], direction.circuit[k]));
        std::array::from_fn(of)
    }

    /// Integral part of the force of a drive (order 0), or its rate (order 1); 0 without one.
    pub fn integral_of(&mut self, drive: usize, order: usize) -> Result<N, OutputError> {
        let index = self.reduced.loading().drives[drive].law.as_ref().and_then(|law| law.integral);
        let Some(index) = index else { return Ok(N::constant(0.0)) };
        if order == 0 {
            return Ok(self.integrals()[index]);
        }
        let speed = self.displacement(drive, 1)?;
        Ok(self.acting(drive, speed)?[1])
    }
}
