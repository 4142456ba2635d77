//! Variables of bodies, joints and markers: motion, reactions, friction, energy.
use super::builder::Builder;
use super::couplings;
use super::needs::{Needs, placed};
use crate::mechanism::linkage::Freedom;
use crate::mechanism::loads::resolved::{FrictionJoint, FrictionKind};
use crate::mechanism::quantity::{FramePart, Output, ReactionPart, SmallMotion};
use crate::variables::Unit::{
    Hertz, Joule, Metre, MetrePerSecond, MetrePerSecondSquared, Newton, NewtonMetre, One, Radian, RadianPerSecond,
    RadianPerSecondSquared, Watt,
};

pub(super) fn add_bodies(b: &mut Builder) {
    let bodies = b.source.linkage.bodies.iter().enumerate();
    for (body, name) in bodies.filter(|(_, b)| b.angle_coordinate.is_some()).map(|(i, b)| (i, &b.name)) {
        let derivatives = [
            (
                "angle",
                "Angle (anticlockwise positive) from the X axis of the mechanism frame to the x axis of the body",
                Radian,
            ),
            ("speed", "Angular speed (anticlockwise positive) of the body", RadianPerSecond),
            ("acceleration", "Angular acceleration (anticlockwise positive) of the body", RadianPerSecondSquared),
        ];
        let stated = b.source.mechanism.start.body.as_ref() == Some(name);
        b.motion(name, derivatives, stated, |order| Output::Angle { body, order });
    }
}

pub(super) fn add_joints(b: &mut Builder) {
    let linkage = &b.source.linkage;
    for (coordinate, name) in linkage.coordinates.iter().enumerate().skip(linkage.angles) {
        let is_slot = linkage.slots.iter().any(|slot| slot.coordinate == coordinate);
        let texts = match is_slot {
            true => [
                "Distance of the pin, along the slot, from the start of the slot",
                "Speed of the pin along the slot",
                "Rate of change of the speed of the pin along the slot",
            ],
            false => [
                "Position of the second body along the axis of the joint",
                "Speed of the second body relative to the first body, along the axis of the joint",
                "Acceleration of the second body relative to the first body, along the axis of the joint",
            ],
        };
        let derivatives = [
            ("position", texts[0], Metre),
            ("speed", texts[1], MetrePerSecond),
            ("acceleration", texts[2], MetrePerSecondSquared),
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
        if let Freedom::Coupling(_) = j.freedom {
            couplings::add(b, joint, needs);
            continue;
        }
        let body = |index: usize| s.linkage.bodies[index].name.as_str();
        let (n, is_revolute) = (j.name.as_str(), j.freedom == Freedom::Revolute);
        let between =
            [" that the body ", body(j.first.body), " exerts on the body ", body(j.second.body), " in the joint ", n]
                .concat();
        let mut add = |suffix, text, unit, output| b.output(n, suffix, &[text, &between], unit, output, &needs);
        let reaction = |part| Output::Reaction { joint, part };
        add("force_x", "x component (in the mechanism frame) of the force", Newton, reaction(ReactionPart::X));
        add("force_y", "y component (in the mechanism frame) of the force", Newton, reaction(ReactionPart::Y));
        add("force", "Magnitude of the force", Newton, reaction(ReactionPart::Magnitude));
        if !j.freedom.turns() {
            add(
                "torque",
                "Moment (anticlockwise positive, about the second point of the joint)",
                NewtonMetre,
                reaction(ReactionPart::Moment),
            );
        }
        let Some(friction_joint) = friction_joints.iter().position(|p| p.joint == joint) else { continue };
        let friction = Output::Friction { friction_joint };
        match is_revolute {
            true => add("friction_torque", "Friction torque", NewtonMetre, friction),
            false => add("friction_force", "Friction force along the axis", Newton, friction),
        }
        if friction_joints[friction_joint].kind != FrictionKind::Joint {
            continue;
        }
        let text =
            ["Slip speed of the body ", body(j.second.body), " on the body ", body(j.first.body), " in the joint ", n];
        let FrictionJoint { load, surface, .. } = friction_joints[friction_joint];
        let slip = Needs { inputs: surface.as_slice(), ..s.slip_speed(load) };
        b.output(n, "slip_speed", &text, MetrePerSecond, Output::SlipSpeed { friction_joint }, &slip);
        if surface.is_some() {
            let text = [
                "Power that moves the surface of the body ",
                body(j.first.body),
                " against the friction in the joint ",
                n,
            ];
            b.output(n, "surface_power", &text, Watt, Output::SurfacePower { friction_joint }, &needs);
        }
    }
}

pub(super) fn add_markers(b: &mut Builder) {
    let s = b.source;
    for (marker, n) in s.mechanism.markers.names().into_iter().enumerate() {
        let position = Needs { marker: Some(marker), ..s.position(&[s.markers[marker].body]) };
        let velocity = Needs { speed: true, ..position };
        let acceleration = Needs { marker: Some(marker), ..s.acceleration() };
        for (order, suffixes, word, unit, needs) in [
            (0, ["x", "y"], " coordinate of the marker ", Metre, position),
            (1, ["velocity_x", "velocity_y"], " component of the velocity of the marker ", MetrePerSecond, velocity),
            (
                2,
                ["acceleration_x", "acceleration_y"],
                " component of the acceleration of the marker ",
                MetrePerSecondSquared,
                acceleration,
            ),
        ] {
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let (text, output) =
                    ([letter, word, n, " in the mechanism frame"], Output::Marker { marker, axis, order });
                b.output(n, suffixes[axis], &text, unit, output, &needs);
                if order > 0 {
                    b.is_rate_of(2);
                }
            }
        }
    }
}

pub(super) fn add_energy(b: &mut Builder) {
    let loading = &b.source.loading;
    let gravity = loading.gravity.as_slice();
    let stored: Vec<usize> = gravity.iter().copied().chain(loading.sized()..loading.base()).collect();
    let kinetic = Needs { speed: true, inertia: true, ..placed() };
    let potential = Needs { inputs: gravity, loads: &stored, ..placed() };
    b.output("energy", "kinetic", &["Kinetic energy of the mechanism"], Joule, Output::Kinetic, &kinetic);
    let text = "Potential energy of the mechanism: energy of gravity (at the present load factor) and of the springs";
    b.output("energy", "potential", &[text], Joule, Output::Potential, &potential);
    let text = "Error of the time integration, expressed as an energy: present energy minus the energy at the start, \
                minus the work of all loads since the start of the run";
    b.output("energy", "drift", &[text], Joule, Output::Drift, &Needs::default());
}

/// Eigenfrequency and damping ratio, where the definition asks for them.
pub(super) fn add_small_motion(b: &mut Builder) {
    if !b.source.mechanism.linearisation {
        return;
    }
    let needs = b.source.acceleration();
    let mut add = |suffix, text, unit, output| {
        b.output("linearisation", suffix, &[text], unit, Output::SmallMotion(output), &needs);
    };
    let text = "Eigenfrequency of undamped small motions of the mechanism about the present state";
    add("eigenfrequency", text, Hertz, SmallMotion::Eigenfrequency);
    let text = "Damping ratio of small motions of the mechanism about the present state; 1 is critical damping";
    add("damping_ratio", text, One, SmallMotion::DampingRatio);
}

/// Where each body is, for whoever draws it: its origin, and the matrix of rotation by its angle.
pub(super) fn add_frames(b: &mut Builder) {
    for (body, carried) in b.source.linkage.bodies.iter().enumerate().skip(1) {
        let parts = [
            ("x", "x coordinate (in the mechanism frame) of the origin of the body ", Metre, FramePart::Origin(0)),
            ("y", "y coordinate (in the mechanism frame) of the origin of the body ", Metre, FramePart::Origin(1)),
            ("cos", "Cosine of the angle of the body ", One, FramePart::Cos),
            ("sin", "Sine of the angle of the body ", One, FramePart::Sin),
            ("minus_sin", "Negative sine of the angle of the body ", One, FramePart::MinusSin),
        ];
        for (suffix, text, unit, part) in parts {
            let name = [&carried.name, ".frame.", suffix].concat();
            b.local(name, b.text(|| [text, &carried.name].concat()), unit, Output::Frame { body, part });
        }
    }
}
