//! Forces of drives with a law, and the states of their controllers.
//!
//! In: states of controllers, motion of a drive, inputs. Out: the force of a drive, the states of its controller and
//! their rates, in numbers N. It must not know how a step is made.
use crate::mechanism::definition::{ControlState, MOST_CONTROL_STATES};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::control::Acting;
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::reduced::Reduced;

impl<N: Reading> View<'_, N> {
    /// Force of a drive before its loss, with that of its law at this speed, and the rates of the states of its
    /// controller.
    pub fn acting(&mut self, drive: usize, speed: N) -> Result<Acting<N>, OutputError> {
        let own = self.size(drive);
        let Some(law) = &self.reduced.loading().drives[drive].law else {
            return Ok(Acting { force: own, rates: [N::constant(0.0); 2] });
        };
        let motion = [self.displacement(drive, 0)?, speed];
        let states = self.controllers();
        let found = law.force(own, |input| self.size(input), motion, states.as_ref(), |_, margin| margin);
        Ok(Acting { force: own + found.force, ..found })
    }

    /// States of controllers [N or N.m]; none without one.
    #[inline]
    pub fn controllers(&self) -> Option<[N; MOST_CONTROL_STATES]> {
        let direction = &self.cache.direction;
        let known = self.state.memory.controllers()?;
        Some(std::array::from_fn(|k| direction.s.chain(known[k], direction.circuit[k])))
    }

    /// A state of the controller of a drive (order 0), or its rate (order 1); 0 without one.
    pub fn controller_of(&mut self, drive: usize, state: ControlState, order: usize) -> Result<N, OutputError> {
        if order > 0 {
            let speed = self.displacement(drive, 1)?;
            return Ok(self.acting(drive, speed)?.rates[state as usize]);
        }
        let index = self.reduced.loading().drives[drive].law.as_ref().and_then(|law| law.states[state as usize]);
        Ok(index.zip(self.controllers()).map_or(N::constant(0.0), |(index, all)| all[index]))
    }
}

impl ReducedMotion {
    /// Give forces of drives that follow those of their controllers the values that these have in this state: those of
    /// the states with an index that `starts`.
    ///
    /// # Errors
    /// [`ModelError::Table`]: the displacement of a drive is not smooth along the motion.
    pub fn follow(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        starts: impl Fn(usize) -> bool,
    ) -> Result<(), ModelError> {
        let Some(mut states) = self.state.memory.controllers().copied() else { return Ok(()) };
        let loading = reduced.loading();
        let all = loading.control_states().enumerate();
        for (index, (drive, _)) in all.filter(|(k, (_, state))| *state == ControlState::Force && starts(*k)) {
            let mut view = self.view(reduced, inputs);
            let (Ok(x), Ok(speed)) = (view.displacement(drive, 0), view.displacement(drive, 1)) else {
                let name = format!("{}.acting_force", loading.drives[drive].name);
                return Err(ModelError::Table { name, position: "its start".into() });
            };
            let law = loading.drives[drive].law.as_ref();
            let force = law.and_then(|law| law.followed(view.size(drive), |k| view.size(k), [x, speed], &states));
            states[index] = force.unwrap_or(0.0);
        }
        self.state.memory.set_controllers(&states);
        Ok(())
    }
}
