//! Variables of couplings: the force that each transmits.
use super::builder::Builder;
use super::needs::Needs;
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::variables::Unit::Newton;

/// Outputs of the coupling with this joint.
pub(super) fn add(b: &mut Builder, joint: usize, needs: Needs) {
    let s = b.source;
    let j = &s.linkage.joints[joint];
    let body = |index: usize| s.linkage.bodies[index].name.as_str();
    let n = j.name.as_str();
    let between = [" that ", body(j.first.body), " exerts on ", body(j.second.body), " in ", n].concat();
    let mut add = |suffix, text, part| {
        let output = Output::Reaction { joint, part };
        b.output(n, suffix, &[text, &between], Newton, output, needs);
    };
    add("force_x", "Force, x,", ReactionPart::X);
    add("force_y", "Force, y,", ReactionPart::Y);
    add("force", "Magnitude of the force", ReactionPart::Magnitude);
    add("transmitted_force", "Force along the motion, positive if it drives forward,", ReactionPart::Moment);
}
