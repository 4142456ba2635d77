//! Variables of model exchange: the continuous states, their derivatives and the event indicators.
use super::builder::Builder;
use super::source::Source;
use crate::mechanism::loads::resolved::FrictionKind;
use crate::mechanism::quantity::{Curve, Indicator, Quantity};
use crate::variables::Unit::{Metre, MetrePerSecond, MetrePerSecondSquared, Newton, NewtonMetre, One};
use crate::variables::{Causality, Unit};

/// Owner of the variables that belong to no part of the mechanism.
const OWNER: &str = "along_curve";

pub(super) fn add(b: &mut Builder) {
    let s = b.source;
    if s.mechanism.has_hydraulics() {
        return;
    }
    let states = [
        (
            "position",
            "Position along the motion: distance travelled by an imaginary mass of 1 kg that has the same kinetic \
             energy as the mechanism",
            Metre,
        ),
        (
            "speed",
            "Speed along the motion: speed of an imaginary mass of 1 kg that has the same kinetic energy as the \
             mechanism",
            MetrePerSecond,
        ),
        ("acceleration", "Acceleration along the motion: time derivative of along_curve.speed", MetrePerSecondSquared),
    ];
    for (order, (suffix, text, unit)) in states.into_iter().enumerate() {
        let needs = s.acceleration();
        let inputs = if order == 2 { needs.inputs } else { &[] };
        b.state([OWNER, ".", suffix].concat(), b.text(|| text.to_owned()), unit, Quantity::State(order), inputs);
    }
    for (indicator, unit) in indicators(s) {
        let (name, text) = description(s, indicator);
        let quantity = Quantity::Indicator(indicator);
        b.state(name, b.text(|| text.concat()), unit, quantity, s.acceleration().inputs);
    }
}

/// The event indicators of a mechanism, whatever the values of its parameters.
fn indicators(s: &Source) -> Vec<(Indicator, Unit)> {
    let mut all = Vec::new();
    if !s.loading.stops.is_empty() {
        all.extend([0, 1].map(|side| (Indicator::End(side), One)));
    }
    all.extend((0..s.loading.stops.len()).map(|stop| (Indicator::Bumper(stop), One)));
    all.extend((0..s.loading.locks.len()).map(|lock| (Indicator::Lock(lock), Metre)));
    let joints = s.loading.friction.as_ref().map_or(0, |friction| friction.friction_joints.len());
    if joints > 0 || s.loading.drives.iter().any(|drive| drive.efficiency.is_some()) {
        all.push((Indicator::Reversal, MetrePerSecond));
        if s.mechanism.control_states().next().is_some() {
            all.push((Indicator::Breakaway, MetrePerSecondSquared));
        }
    }
    let turning = s.loading.friction.iter().flat_map(|friction| friction.turning());
    all.extend(turning.map(|joint| (Indicator::Turn(joint), One)));
    let borders = |joint| [false, true].map(|kinetic| (Indicator::Slip { joint, kinetic }, MetrePerSecond));
    let kind = |joint: usize| s.loading.friction.as_ref().map(|friction| friction.friction_joints[joint].kind);
    all.extend((0..joints).filter(|joint| kind(*joint) == Some(FrictionKind::Joint)).flat_map(borders));
    let surface = s.loading.friction.iter().flat_map(|friction| friction.friction_joints.iter().enumerate());
    let surface = surface.filter(|(_, joint)| joint.law.sticks && joint.surface.is_some());
    all.extend(surface.map(|(joint, _)| (Indicator::Surface(joint), One)));
    let drives = s.loading.drives.iter().enumerate();
    let lossy = drives.clone().filter(|(_, drive)| drive.efficiency.is_some());
    all.extend(lossy.map(|(load, _)| (Indicator::DriveSign(load), MetrePerSecondSquared)));
    let friction_joints = s.loading.friction.iter().flat_map(|friction| friction.friction_joints.iter().enumerate());
    let slides = friction_joints.filter(|(_, joint)| joint.has_normal_force(&s.linkage));
    // The loss and the teeth of a coupling have one sign.
    let is_first = |index: usize, own: usize| {
        s.loading.friction.iter().all(|f| f.friction_joints[..index].iter().all(|before| before.joint != own))
    };
    let slides = slides.filter(|(index, joint)| is_first(*index, joint.joint));
    all.extend(slides.map(|(joint, _)| (Indicator::NormalForce(joint), Newton)));
    let springs = || s.loading.springs.iter().enumerate();
    let stops = s.loading.stops.iter().enumerate();
    let cams = s.linkage.couplings.iter().enumerate().filter(|(_, coupling)| coupling.law.has_knots());
    let laws = drives.filter_map(|(load, drive)| Some((load, drive.law.as_ref()?)));
    all.extend(laws.clone().flat_map(|(drive, law)| {
        let limits = law.control().map_or([None; 4], |control| control.limits);
        let stated = (0..).zip(limits).filter(|(_, limit)| limit.is_some());
        let unit = if s.loading.drives[drive].is_rotary { NewtonMetre } else { Newton };
        stated.map(move |(side, _)| (Indicator::Limit { drive, side }, unit))
    }));
    let curves = laws.filter(|(_, law)| law.curve().is_some()).map(|(load, _)| Curve::Drive(load));
    let curves = curves.chain(springs().filter(|(_, s)| s.damper.is_some()).map(|(k, _)| Curve::Damper(k)));
    let curves = curves.chain(springs().filter(|(_, s)| !s.knots().is_empty()).map(|(k, _)| Curve::Spring(k)));
    let curves = curves.chain(stops.filter(|(_, stop)| stop.curve.is_some()).map(|(k, _)| Curve::Bumper(k)));
    let curves = curves.chain(cams.map(|(k, _)| Curve::Cam(k)));
    let slots = s.linkage.slots.iter().enumerate().filter(|(_, slot)| !slot.track.knots().is_empty());
    let curves = curves.chain(slots.map(|(k, _)| Curve::Slot(k)));
    all.extend(curves.map(|curve| (Indicator::Points(curve), One)));
    all
}

/// Name of an event indicator, and the pieces of its description.
fn description<'a>(s: &'a Source, indicator: Indicator) -> (String, [&'a str; 4]) {
    let own = |suffix: &str| [OWNER, ".", suffix].concat();
    let joint_name = |joint: usize| {
        let friction = s.loading.friction.as_ref().map(|friction| &friction.friction_joints[joint]);
        friction.map_or("", |joint| s.loading.friction_name(&s.linkage, joint))
    };
    match indicator {
        Indicator::End(0) => (
            own("low_end"),
            [
                "Event indicator of the rigid stop at the low end of the travel: gap to the stop in free motion, and \
                    contact force while the mechanism rests on the stop",
                "",
                "",
                "",
            ],
        ),
        Indicator::End(_) => (
            own("high_end"),
            [
                "Event indicator of the rigid stop at the high end of the travel: gap to the stop in free motion, and \
                    contact force while the mechanism rests on the stop",
                "",
                "",
                "",
            ],
        ),
        Indicator::Bumper(stop) => {
            let name = s.loading.stops[stop].name.as_str();
            let text = ": gap to the bumper before the contact, and contact force during the contact";
            ([name, ".indicator"].concat(), ["Event indicator of the bumper ", name, text, ""])
        }
        Indicator::Lock(lock) => {
            let name = s.loading.locks[lock].name.as_str();
            let text = ": distance to the position at which the lock holds the mechanism";
            ([name, ".indicator"].concat(), ["Event indicator of the lock ", name, text, ""])
        }
        Indicator::Reversal => (
            own("reversal"),
            ["Event indicator: speed whose sign determines the direction of friction and losses", "", "", ""],
        ),
        Indicator::Breakaway => {
            let text = "Event indicator: while friction or losses hold the mechanism at rest, acceleration without \
                friction and losses";
            (own("breakaway"), [text, "", "", ""])
        }
        Indicator::Turn(joint) => {
            let name = joint_name(joint);
            let text = "Event indicator: slip distance divided by distance along the motion, whose sign determines the \
                direction of friction or losses in the joint or coupling ";
            ([name, ".slip_indicator"].concat(), [text, name, "", ""])
        }
        Indicator::Slip { joint, kinetic } => {
            let name = joint_name(joint);
            let border = if kinetic { "kinetic" } else { "static" };
            let text = ["Event indicator: slip speed minus friction.", border, "_speed in the joint ", name];
            ([name, ".", border, "_indicator"].concat(), text)
        }
        Indicator::Surface(joint) => {
            let name = joint_name(joint);
            let text = "Event indicator: slip speed on the driven surface, and while the surface carries the body \
                along, static friction that is not needed, in the joint ";
            ([name, ".surface_indicator"].concat(), [text, name, "", ""])
        }
        Indicator::DriveSign(load) => {
            let name = s.loading.drives[load].name.as_str();
            (
                [name, ".loss_indicator"].concat(),
                ["Event indicator: value whose sign determines the direction of losses of the drive ", name, "", ""],
            )
        }
        Indicator::NormalForce(joint) => {
            let name = joint_name(joint);
            (
                [name, ".normal_indicator"].concat(),
                [
                    "Event indicator: normal or transmitted force whose sign determines the direction of friction or \
                     losses in the joint or coupling ",
                    name,
                    "",
                    "",
                ],
            )
        }
        Indicator::Limit { drive, side } => {
            let name = s.loading.drives[drive].name.as_str();
            let (limit, text) = [
                ("min_force", "demanded force from control.min_force"),
                ("max_force", "demanded force from control.max_force"),
                ("falling_force", "force from where it falls at the rate control.max_force_rate"),
                ("rising_force", "force from where it rises at the rate control.max_force_rate"),
            ][side];
            let text = ["Event indicator: distance of the ", text, " of the drive ", name];
            ([name, ".", limit, "_indicator"].concat(), text)
        }
        Indicator::Points(curve) => {
            let (name, suffix, what) = match curve {
                Curve::Drive(load) => {
                    (&s.loading.drives[load].name, ".points_indicator", "points of the force-speed curve of the drive ")
                }
                Curve::Damper(k) => (
                    &s.loading.springs[k].name,
                    ".damping_points_indicator",
                    "points of the damping curve of the spring ",
                ),
                Curve::Spring(k) => {
                    (&s.loading.springs[k].name, ".points_indicator", "points of the curve of the spring ")
                }
                Curve::Bumper(k) => {
                    (&s.loading.stops[k].name, ".points_indicator", "points of the curve of the bumper ")
                }
                Curve::Slot(k) => {
                    let joint = s.linkage.slots[k].joint;
                    (&s.linkage.joints[joint].name, ".points_indicator", "points of the slot ")
                }
                Curve::Cam(k) => {
                    let joint = s.linkage.couplings[k].joint;
                    (&s.linkage.joints[joint].name, ".points_indicator", "ends of segments or points of the cam ")
                }
            };
            ([name, suffix].concat(), ["Event indicator: function that changes its sign at the ", what, name, ""])
        }
    }
}

impl Builder<'_> {
    /// Real local variable of model exchange, with the inputs on which it depends.
    fn state(&mut self, name: String, text: String, unit: Unit, quantity: Quantity, inputs: &[usize]) {
        let needs = super::needs::Needs { inputs, ..Default::default() };
        self.add((name, text), Causality::Local, (Some(unit), None), quantity, &needs);
    }
}
