//! Variables of couplings: the force that each transmits, the pressure angle of a cam.
use super::builder::Builder;
use super::needs::{Needs, placed};
use crate::mechanism::linkage::{Freedom, Kind, Second};
use crate::mechanism::loads::resolved::{FrictionJoint, FrictionKind};
use crate::mechanism::quantity::{Output, ReactionPart};
use crate::variables::Unit::{MetrePerSecond, Newton, NewtonMetre, Radian};

/// Outputs of the coupling with this joint.
pub(super) fn add(b: &mut Builder, joint: usize, needs: Needs) {
    let s = b.source;
    let j = &s.linkage.joints[joint];
    let Freedom::Coupling(coupling) = j.freedom else { return };
    let is_cam = matches!(s.linkage.couplings[coupling].kind, Kind::Cam(_));
    let body = |index: usize| s.linkage.bodies[index].name.as_str();
    let n = j.name.as_str();
    let between =
        [" that the body ", body(j.first.body), " exerts on the body ", body(j.second.body), " in the coupling ", n]
            .concat();
    let mut add = |suffix, text, part| {
        let output = Output::Reaction { joint, part };
        b.output(n, suffix, &[text, &between], Newton, output, &needs);
    };
    add("force_x", "x component (in the mechanism frame) of the force", ReactionPart::X);
    add("force_y", "y component (in the mechanism frame) of the force", ReactionPart::Y);
    add("force", "Magnitude of the force", ReactionPart::Magnitude);
    let friction_joints = s.loading.friction.as_ref().map_or(&[][..], |friction| &friction.friction_joints);
    if !is_cam {
        let text = "Transmitted force (a positive force drives the second body of the coupling in the positive \
                    direction)";
        add("transmitted_force", text, ReactionPart::Moment);
        let is_loss = |own: &FrictionJoint| own.joint == joint && own.kind == FrictionKind::Coupling;
        let Some(friction_joint) = friction_joints.iter().position(is_loss) else { return };
        let (output, first) = (Output::Friction { friction_joint }, body(s.linkage.couplings[coupling].carrier));
        let on =
            [first, " exerts on the body ", body(j.second.body), " because of the losses in the coupling ", n].concat();
        return match s.linkage.couplings[coupling].second {
            Second::Angle { .. } => {
                b.output(n, "loss_torque", &["Torque that the body ", &on], NewtonMetre, output, &needs)
            }
            Second::Position { .. } => {
                b.output(n, "loss_force", &["Force that the body ", &on], Newton, output, &needs)
            }
        };
    }
    add(
        "contact_force",
        "Contact force (positive in compression) along the normal of the cam profile",
        ReactionPart::Moment,
    );
    let text =
        ["Pressure angle of the cam ", n, ": angle from the direction of the lift to the normal of the cam profile"];
    b.output(n, "pressure_angle", &text, Radian, Output::PressureAngle { coupling }, &placed());
    let Some(friction_joint) = friction_joints.iter().position(|own| own.joint == joint) else { return };
    let text = ["Friction force along the profile on the follower (clockwise about the cam positive) in the cam ", n];
    b.output(n, "friction_force", &text, Newton, Output::Friction { friction_joint }, &needs);
    let text = ["Slip speed of the follower on the cam (clockwise about the cam positive) in the cam ", n];
    let needs = s.slip_speed(friction_joints[friction_joint].load);
    b.output(n, "slip_speed", &text, MetrePerSecond, Output::SlipSpeed { friction_joint }, &needs);
}
