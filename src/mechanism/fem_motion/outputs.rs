//! The rigid finite elements behind the laws of outputs. One-element terms are the reduced model's, at the sigma that
//! fits best. No mesh has a prismatic joint; friction, drag, stops and locks are refused before they act.
use super::RigidFemMotion;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::outputs::{Kinematics, OutputError, evaluate};
use crate::mechanism::quantity::{OneElement, Output};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFemError};

/// The finite elements in one state under the present inputs.
struct View<'a> {
    motion: &'a mut RigidFemMotion,
    reduced: &'a Reduced,
    inputs: &'a Inputs,
}

impl RigidFemMotion {
    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn output(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        evaluate(&mut View { motion: self, reduced, inputs }, reduced.loading(), output)
    }

    /// With accelerations in balance with the present sizes, which are needed from order 2 on.
    fn balanced_for(&mut self, order: usize) -> Result<&mut Self, RigidFemError> {
        if order > 1 && !self.balanced {
            rigid_fem::State::copy_from(&mut self.present, &self.state);
            if self.sizes != self.applied {
                self.fem.rebalance(&mut self.present, &mut self.scratch, &self.sizes, self.fem_step)?;
            }
            self.balanced = true;
        }
        Ok(self)
    }
}

impl Kinematics<f64> for View<'_> {
    fn angle(&mut self, body: usize, order: usize) -> Result<f64, OutputError> {
        if self.reduced.linkage().bodies[body].angle_coordinate.is_none() {
            return Ok(0.0);
        }
        let RigidFemMotion { fem, state, present, .. } = self.motion.balanced_for(order)?;
        Ok(match order {
            0 => fem.angle(state, body),
            1 => fem.speed(state, body),
            _ => fem.acceleration(present, body),
        })
    }

    fn displacement(&mut self, load: usize, order: usize) -> Result<f64, OutputError> {
        let RigidFemMotion { fem, state, present, .. } = self.motion.balanced_for(order)?;
        Ok(match order {
            0 | 1 => fem.displacement(state, load)[order],
            _ => fem.displacement_acceleration(present, load),
        })
    }

    fn marker(&mut self, marker: usize, axis: usize, order: usize) -> Result<f64, OutputError> {
        let RigidFemMotion { fem, state, present, .. } = self.motion.balanced_for(order)?;
        let state = if order > 1 { present } else { state };
        Ok(fem.point(state, self.reduced.markers[marker])[order][axis])
    }

    fn reaction(&mut self, joint: usize) -> Result<[f64; 3], OutputError> {
        if !self.motion.reactions.0 {
            let RigidFemMotion { fem, state, present, scratch, sizes, fem_step, reactions, .. } =
                self.motion.balanced_for(2)?;
            fem.reactions_after(state, present, scratch, sizes, *fem_step, &mut reactions.1);
            reactions.0 = true;
        }
        let reaction = self.motion.reactions.1[joint];
        Ok([reaction.force.x, reaction.force.y, reaction.moment])
    }

    fn size(&self, load: usize) -> f64 {
        self.motion.sizes[load]
    }

    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<f64, OutputError> {
        self.motion.rigid.output(self.reduced, self.inputs, Output::OneElement { drive, term })
    }

    fn kinetic(&self) -> f64 {
        self.motion.fem.kinetic(&self.motion.state)
    }

    fn drift(&self) -> f64 {
        self.motion.fem.energy(&self.motion.state, &self.motion.applied) - self.motion.reference
    }
}
