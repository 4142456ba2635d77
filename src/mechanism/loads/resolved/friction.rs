//! The joints with friction, each with its law.
//!
//! In: a definition and its linkage. Out: friction joints with their loads. It must not know the state.
use super::{Loading, joint_load};
use crate::mechanism::definition::{DefinitionError, Friction, FrictionLaw, Joint, Mechanism};
use crate::mechanism::linkage::{Freedom, Linkage};
use crate::mechanism::loads::laws::friction::{Cubic, Law, Regime};
use crate::numerics::decimal::Decimal;

/// Friction in the joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFriction {
    /// Whether friction acts.
    pub enabled: bool,
    /// Joints with friction.
    pub friction_joints: Vec<FrictionJoint>,
}

/// A joint with friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJoint {
    /// Index of the joint.
    pub joint: usize,
    /// Index of its load: a couple [N.m] in a revolute joint, a force along the axis [N] in a prismatic one.
    pub load: usize,
    /// Radius of the pin of a revolute joint [m]; 1 for a prismatic joint, where the load is a force.
    pub radius: f64,
    /// Coefficient of friction over slip speed.
    pub law: Law,
}

impl FrictionJoint {
    /// Arm of the friction, mu with its sign times the radius [m, or 1], over the slip speed [m/s] on a regime.
    pub fn arm(&self, regime: Regime) -> Cubic {
        self.law.cubic(regime).times(self.radius)
    }
}

impl Loading {
    pub(super) fn add_friction(&mut self, mechanism: &Mechanism, linkage: &Linkage) -> Result<(), DefinitionError> {
        let Some(f) = &mechanism.friction else { return Ok(()) };
        let Friction { enabled, law, static_coefficient, kinetic_coefficient, static_speed, kinetic_speed } = *f;
        let sticks = law == FrictionLaw::Stick;
        if kinetic_speed <= static_speed && !(sticks && kinetic_speed == 0.0 && static_speed == 0.0) {
            let or = if sticks { ", or 0 with it" } else { "" };
            let allowed = format!("greater than friction.static_speed = {}{or}", Decimal(static_speed));
            return Err(DefinitionError::value("friction.kinetic_speed", Decimal(kinetic_speed), allowed));
        }
        let mut friction_joints = Vec::new();
        for (joint, ((name, defined), resolved)) in mechanism.joints.iter().zip(&linkage.joints).enumerate() {
            let radius = match (resolved.freedom, defined.pin_radius) {
                (Freedom::Prismatic(_), _) => 1.0,
                (Freedom::Revolute, Some(radius)) => radius,
                (Freedom::Revolute, None) | (Freedom::Coupling(_), _) => continue,
            };
            let law = Law {
                sticks,
                static_coefficient: defined.static_coefficient.unwrap_or(static_coefficient),
                kinetic_coefficient: defined.kinetic_coefficient.unwrap_or(kinetic_coefficient),
                static_speed,
                kinetic_speed,
            };
            if sticks && law.static_coefficient < law.kinetic_coefficient {
                return Err(static_below_kinetic(name, defined, &law));
            }
            friction_joints.push(FrictionJoint { joint, load: self.loads.len(), radius, law });
            self.loads.push(joint_load(linkage, joint));
        }
        self.friction = Some(JointFriction { enabled: enabled.unwrap_or(false), friction_joints });
        Ok(())
    }
}

/// The error for a law that sticks with less static than kinetic friction: a mechanism that breaks away would stick at once.
fn static_below_kinetic(joint: &str, defined: &Joint, law: &Law) -> DefinitionError {
    let key = match (defined.static_coefficient, defined.kinetic_coefficient) {
        (None, None) => "friction.static_coefficient".to_owned(),
        (None, Some(_)) => format!("joints.{joint}.kinetic_coefficient"),
        (Some(_), _) => format!("joints.{joint}.static_coefficient"),
    };
    let (rest, slip) = (Decimal(law.static_coefficient), Decimal(law.kinetic_coefficient));
    let message = format!(
        "static friction {rest} is below kinetic friction {slip}, but friction.law is \"stick\": what breaks away would \
         stick at once; make the static coefficient as large as the kinetic one at least"
    );
    DefinitionError::key(key, message)
}
