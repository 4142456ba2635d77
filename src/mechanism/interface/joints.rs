//! Variables of joints: motion along prismatic joints, reactions, friction.
use super::builder::Builder;
use super::needs::Needs;
use crate::mechanism::linkage::Freedom;
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::variables::Unit::{Metre, MetrePerSecond, MetrePerSecondSquared, Newton, NewtonMetre};

pub(super) fn add_motion(b: &mut Builder) {
    let linkage = &b.source.linkage;
    for (coordinate, name) in linkage.coordinates.iter().enumerate().skip(linkage.angles) {
        let derivatives = [
            ("position", "Position along the axis of", Metre),
            ("speed", "Speed along the axis of", MetrePerSecond),
            ("acceleration", "Acceleration along the axis of", MetrePerSecondSquared),
        ];
        let stated = b.source.mechanism.start.joint.as_ref() == Some(name);
        b.motion(name, derivatives, stated, |order| Output::JointPosition { coordinate, order });
    }
}

pub(super) fn add_reactions(b: &mut Builder) {
    let s = b.source;
    let needs = Needs { masses: true, ..s.acceleration() };
    let friction_joints = s.loading.friction.as_ref().map_or(&[][..], |f| &f.friction_joints);
    for (joint, j) in s.linkage.joints.iter().enumerate() {
        let body = |index: usize| s.linkage.bodies[index].name.as_str();
        let (n, is_revolute) = (j.name.as_str(), j.freedom == Freedom::Revolute);
        let between = [" that ", body(j.first.body), " exerts on ", body(j.second.body), " in ", n].concat();
        let mut add = |suffix, text, unit, output| b.output(n, suffix, &[text, &between], unit, output, needs);
        let reaction = |part| Output::Reaction { joint, part };
        add("force_x", "Force, x,", Newton, reaction(ReactionPart::X));
        add("force_y", "Force, y,", Newton, reaction(ReactionPart::Y));
        add("force", "Magnitude of the force", Newton, reaction(ReactionPart::Magnitude));
        if !is_revolute {
            add("torque", "Moment about the second point", NewtonMetre, reaction(ReactionPart::Moment));
        }
        let Some(friction_joint) = friction_joints.iter().position(|p| p.joint == joint) else { continue };
        let friction = Output::Friction { friction_joint };
        match is_revolute {
            true => add("friction_torque", "Friction torque", NewtonMetre, friction),
            false => add("friction_force", "Friction force along the axis", Newton, friction),
        }
        let text = ["Slip speed of ", body(j.second.body), " on ", body(j.first.body), " in ", n];
        let needs = s.slip_speed(friction_joints[friction_joint].load);
        b.output(n, "slip_speed", &text, MetrePerSecond, Output::SlipSpeed { friction_joint }, needs);
    }
}
