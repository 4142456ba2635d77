//! Outputs of the finite elements. One-element terms are the reduced model's, at the sigma that fits best.
use super::RigidFemMotion;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::outputs::OutputError;
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFemError};

impl RigidFemMotion {
    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn output(&mut self, reduced: &Reduced, inputs: &Inputs, output: Output) -> Result<f64, OutputError> {
        let loading = reduced.loading();
        Ok(match output {
            Output::Angle { body, .. } if reduced.linkage().bodies[body].angle_coordinate.is_none() => 0.0,
            Output::Angle { body, order: 0 } => self.fem.angle(&self.state, body),
            Output::Angle { body, order: 1 } => self.fem.speed(&self.state, body),
            Output::Angle { body, .. } => {
                self.balance()?;
                self.fem.acceleration(&self.present, body)
            }
            Output::Displacement { load, order: 0 } => self.fem.displacement(&self.state, load)[0],
            Output::Displacement { load, order: 1 } => self.fem.displacement(&self.state, load)[1],
            Output::Displacement { load, .. } => {
                self.balance()?;
                self.fem.displacement_acceleration(&self.present, load)
            }
            Output::Marker { marker, axis, order } => {
                if order > 1 {
                    self.balance()?;
                }
                let state = if order > 1 { &self.present } else { &self.state };
                self.fem.point(state, reduced.marker_point(marker))[order][axis]
            }
            Output::Reaction { joint, part } => {
                self.react()?;
                let reaction = self.reactions.1[joint];
                match part {
                    ReactionPart::X => reaction.force.x,
                    ReactionPart::Y => reaction.force.y,
                    ReactionPart::Magnitude => reaction.force.norm(),
                    ReactionPart::Moment => reaction.moment,
                }
            }
            Output::SpringForce { spring } => {
                let spring = &loading.springs[spring];
                let [s, s_dot] = self.fem.displacement(&self.state, spring.load);
                spring.force(s) + spring.damping * s_dot
            }
            Output::OneElement { .. } => self.rigid.output(reduced, inputs, output)?,
            Output::Kinetic => self.fem.kinetic(&self.state),
            Output::Potential => {
                let at = |load: usize| self.fem.displacement(&self.state, load)[0];
                let gravity = loading.gravity.map_or(0.0, |load| -inputs.reals[load] * at(load));
                gravity + loading.springs.iter().map(|spring| spring.energy(at(spring.load))).sum::<f64>()
            }
            Output::Drift => self.fem.energy(&self.state, &self.applied) - self.reference,
            // No mesh has a prismatic joint; what would give the others is refused before it acts.
            Output::JointPosition { .. }
            | Output::Friction { .. }
            | Output::Drag { .. }
            | Output::Stop { .. }
            | Output::Lock { .. } => 0.0,
        })
    }

    /// Bring the accelerations into balance with the present sizes, if they are not.
    fn balance(&mut self) -> Result<(), RigidFemError> {
        if self.balanced {
            return Ok(());
        }
        rigid_fem::State::copy_from(&mut self.present, &self.state);
        if self.sizes != self.applied {
            self.fem.rebalance(&mut self.present, &mut self.room, &self.sizes, self.fem_step)?;
        }
        self.balanced = true;
        Ok(())
    }

    fn react(&mut self) -> Result<(), RigidFemError> {
        if self.reactions.0 {
            return Ok(());
        }
        self.balance()?;
        let (state, present, h) = (&self.state, &self.present, self.fem_step);
        self.fem.reactions_after(state, present, &mut self.room, &self.sizes, h, &mut self.reactions.1);
        self.reactions.0 = true;
        Ok(())
    }
}
