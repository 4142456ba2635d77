//! Variables of couplings: the force that each transmits, the pressure angle of a cam.
use super::builder::Builder;
use super::needs::{Needs, placed};
use crate::mechanism::linkage::{Freedom, Kind};
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::variables::Unit::{Newton, Radian};

/// Outputs of the coupling with this joint.
pub(super) fn add(b: &mut Builder, joint: usize, needs: Needs) {
    let s = b.source;
    let j = &s.linkage.joints[joint];
    let Freedom::Coupling(coupling) = j.freedom else { return };
    let is_cam = matches!(s.linkage.couplings[coupling].kind, Kind::Cam(_));
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
    if !is_cam {
        let text = "Force along the motion, positive if it drives forward,";
        return add("transmitted_force", text, ReactionPart::Moment);
    }
    add("contact_force", "Force along the normal of the profile, positive if it presses,", ReactionPart::Moment);
    let text = ["Pressure angle of ", n, ", from the lift to the normal of the profile"];
    b.output(n, "pressure_angle", &text, Radian, Output::PressureAngle { coupling }, placed());
}
