//! The rigid finite elements behind the laws of outputs. One-element terms are the reduced model's, at the sigma that
//! fits best. No mesh has a prismatic joint; friction, drag, stops and locks are refused before they act.
use super::{Kept, RigidFemMotion};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::linkage::Point;
use crate::mechanism::outputs::{Kinematics, OutputError, evaluate};
use crate::mechanism::quantity::{OneElement, Output};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem, RigidFemError};
use crate::numerics::plane::Vec2;

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
        self.sync(reduced, inputs);
        evaluate(&mut View { motion: self, reduced, inputs }, reduced.loading(), &output)
    }

    /// The finite elements and their state; for the order 2 with accelerations in balance with the present sizes.
    fn fem(&mut self, order: usize) -> Result<(&RigidFem, &rigid_fem::State), RigidFemError> {
        let Kept { fem, fem_step, state, applied, .. } = &self.kept;
        if order < 2 {
            return Ok((fem, state));
        }
        if !self.balanced {
            self.present.copy_from(state);
            if self.sizes != *applied {
                fem.rebalance(&mut self.present, &mut self.scratch, &self.sizes, *fem_step)?;
            }
            self.balanced = true;
        }
        Ok((fem, &self.present))
    }
}

impl Kinematics<f64> for View<'_> {
    fn angle(&mut self, body: usize, order: usize) -> Result<f64, OutputError> {
        let (fem, state) = self.motion.fem(order)?;
        Ok(fem.angle(state, body, order))
    }

    fn displacement(&mut self, load: usize, order: usize) -> Result<f64, OutputError> {
        let (fem, state) = self.motion.fem(order)?;
        Ok(fem.displacement(state, load, order))
    }

    fn marker(&mut self, marker: usize, axis: usize, order: usize) -> Result<f64, OutputError> {
        let (fem, state) = self.motion.fem(order)?;
        Ok(fem.point(state, self.reduced.markers[marker], order)[axis])
    }

    fn origin(&mut self, body: usize, axis: usize) -> Result<f64, OutputError> {
        let (fem, state) = self.motion.fem(0)?;
        Ok(fem.point(state, Point { body, local: Vec2::zeros() }, 0)[axis])
    }

    fn reaction(&mut self, joint: usize) -> Result<[f64; 3], OutputError> {
        if !self.motion.reactions.0 {
            self.motion.fem(2)?;
            let RigidFemMotion { kept, present, scratch, sizes, reactions, .. } = &mut *self.motion;
            kept.fem.reactions(&kept.state, present, scratch, sizes, kept.fem_step, &mut reactions.1);
            reactions.0 = true;
        }
        let reaction = self.motion.reactions.1[joint];
        Ok([reaction.force.x, reaction.force.y, reaction.moment])
    }

    fn size(&self, load: usize) -> f64 {
        self.motion.sizes[load]
    }

    fn small_motion(&mut self) -> Result<[f64; 2], OutputError> {
        self.motion.rigid.small_motion(self.reduced, self.inputs)
    }

    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<f64, OutputError> {
        self.motion.rigid.output(self.reduced, self.inputs, Output::OneElement { drive, term })
    }

    fn kinetic(&self) -> f64 {
        self.motion.kept.fem.kinetic(&self.motion.kept.state)
    }

    fn drift(&mut self) -> f64 {
        let Kept { fem, state, applied, reference, .. } = &self.motion.kept;
        fem.energy(state, applied) - reference
    }
}
