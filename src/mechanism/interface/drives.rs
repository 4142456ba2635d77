//! Variables of drives: inputs, motion, and the terms of the mechanism reduced to one element.
use super::builder::Builder;
use super::hydraulics;
use super::needs::{Needs, placed};
use super::source::Source;
use crate::mechanism::definition::{Between, ControlState};
use crate::mechanism::loads::resolved::{DriveLaw, FrictionJoint, FrictionKind};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{BodyPart, OneElement, Output, Quantity};
use crate::numerics::order;
use crate::variables::Unit::{
    self, Kilogram, KilogramPerMetre, KilogramSquareMetre, KilogramSquareMetrePerRadian, Metre, MetrePerSecond,
    MetrePerSecondSquared, Newton, NewtonMetre, NewtonMetrePerRadian, NewtonMetrePerSecond, NewtonPerMetre,
    NewtonPerSecond, One, Radian, RadianPerSecond, RadianPerSecondSquared,
};
use crate::variables::{Causality, Value};

pub(super) fn add_inputs(b: &mut Builder) {
    let s = b.source;
    if s.mechanism.is_massless() {
        // In the place of the input, which stays 0.
        return (0..s.loading.drives.len()).for_each(|load| add_displacement(b, load, 0));
    }
    for (((name, a), drive), load) in s.mechanism.actuators.iter().zip(&s.loading.drives).zip(0..) {
        if let Some(cylinder) = s.loading.hydraulic_loads().iter().position(|own| *own == load) {
            hydraulics::add_force(b, name, cylinder);
            continue;
        }
        let (what, unit, start) = match drive.is_rotary {
            true => ("Torque of the drive ", NewtonMetre, a.torque),
            false => ("Force of the drive ", Newton, a.force),
        };
        let sense = match (drive.is_rotary, a.between()) {
            (true, _) if a.screw.is_some() => {
                [". A positive torque of the motor increases the stroke of the drive", "", "", ""]
            }
            (true, Some(Between::Bodies([first, second]))) => {
                [". A positive torque turns the body ", second, " anticlockwise, relative to the body ", first]
            }
            (true, _) => {
                let text = ". A positive torque turns the second body of the joint anticlockwise, relative to the \
                            first body";
                [text, "", "", ""]
            }
            (false, Some(Between::Joint(joint))) => {
                [". A positive force moves the second body along the axis of the joint ", joint, "", ""]
            }
            (false, _) => [". A positive force pushes the two ends of the drive apart", "", "", ""],
        };
        let text = [&[what, name][..], &sense].concat();
        b.load_input(&text, unit, start.unwrap_or(0.0));
    }
}

/// Commands of the curves and controllers of drives.
pub(super) fn add_commands(b: &mut Builder) {
    let s = b.source;
    for (load, ((name, a), drive)) in s.mechanism.actuators.iter().zip(&s.loading.drives).enumerate() {
        let Some(law) = &drive.law else { continue };
        let (Some(law), Some(control)) = (law.control(), &a.control) else {
            let what = if drive.is_rotary { "torque" } else { "force" };
            let text = ["Command of the drive ", name, ": factor of the ", what, "-speed curve"];
            b.load_input(&text, One, a.command());
            continue;
        };
        let (what, units) = displacement_of(s, load);
        if law.position_gain.is_some() {
            b.load_input(&["Commanded ", what, " of the drive ", name], units[0], control.command.unwrap_or(0.0));
        }
        if law.speed_gain.is_some() {
            b.load_input(&["Commanded speed of the drive ", name], units[1], control.command_speed.unwrap_or(0.0));
        }
    }
}

pub(super) fn add_demands(b: &mut Builder) {
    if b.source.mechanism.is_massless() {
        return (0..b.source.loading.drives.len()).for_each(|load| add_displacement(b, load, 1));
    }
    for drive in &b.source.loading.drives {
        let (n, unit) = (&drive.name, if drive.is_rotary { RadianPerSecondSquared } else { MetrePerSecondSquared });
        let text = ["Demanded acceleration of the drive ", n, ", for which the output required_force is computed"];
        b.input([n, ".demanded_acceleration"].concat(), &text, unit, 0.0);
    }
}

/// Position, speed and acceleration of a drive that inputs prescribe.
pub(super) fn add_motion_inputs(b: &mut Builder) {
    let s = b.source;
    let Some(drive) = s.loading.motion.as_ref().filter(|drive| drive.first_input.is_some()) else { return };
    let Some((_, name, motion)) = s.mechanism.motion_drive() else { return };
    let units = match s.loading.drives[drive.load].is_rotary {
        true => [Radian, RadianPerSecond, RadianPerSecondSquared],
        false => [Metre, MetrePerSecond, MetrePerSecondSquared],
    };
    let starts = [motion.position.unwrap_or(0.0), 0.0, 0.0];
    for ((word, unit), start) in ["position", "speed", "acceleration"].into_iter().zip(units).zip(starts) {
        let text = ["Prescribed ", word, " of the drive ", name, " at the communication point"];
        b.input([name, ".motion.", word].concat(), &text, unit, start);
    }
}

/// Whether the motion of a drive is prescribed.
pub(super) fn add_motion_switch(b: &mut Builder) {
    let Some((_, name, motion)) = b.source.mechanism.motion_drive() else { return };
    let text = b.text(|| {
        ["true: the motion of the drive ", name, " is prescribed. false: the input force or torque of the drive acts"]
            .concat()
    });
    let start = (None, Value::Boolean(motion.enabled));
    b.known([name, ".motion.enabled"].concat(), text, Causality::Input, start, Quantity::Prescribed);
}

/// Force with which a drive acts that has a curve or a controller, or whose motion can be prescribed.
fn add_acting_force(b: &mut Builder, drive: usize) {
    let s = b.source;
    let (n, is_rotary) = (s.loading.drives[drive].name.as_str(), s.loading.drives[drive].is_rotary);
    let (suffix, what, unit) = match is_rotary {
        true => ("acting_torque", "Acting torque of the drive ", NewtonMetre),
        false => ("acting_force", "Acting force of the drive ", Newton),
    };
    if let Some(law) = &s.loading.drives[drive].law {
        let text = match law.control() {
            None => {
                ": input force or torque, plus the command times the value of the drive's curve at the present speed"
            }
            Some(_) => ": input force or torque, plus the force of the controller, within the limits of the drive",
        };
        let inputs: Vec<usize> = [drive].into_iter().chain(law.commands()).collect();
        let circuit = law.states != [None; 2];
        let needs = Needs { speed: true, inputs: &inputs, loads: &[drive, law.load], circuit, ..s.displacement(drive) };
        let (output, now) = match law.states[ControlState::Force as usize] {
            None => (Output::ActingForce { drive }, needs),
            // A state of its own, which no input changes at once.
            Some(_) => (Output::Controller { drive, state: ControlState::Force, order: 0 }, state()),
        };
        b.output(n, suffix, &[what, n, text], unit, output, &now);
        add_controller_states(b, drive, law, needs);
    } else if s.loading.motion.as_ref().is_some_and(|motion| motion.load == drive) {
        let needs = Needs { masses: true, ..s.acceleration() };
        let text =
            [what, n, ": value for the prescribed motion, or the input of the drive while no motion is prescribed"];
        b.output(n, suffix, &text, unit, Output::ActingForce { drive }, &needs);
    }
}

/// What a state of a controller follows from.
fn state() -> Needs<'static> {
    Needs { circuit: true, ..Needs::default() }
}

/// Integral part of the force of a drive with a controller, and its rate, which follows from these; rate of a force
/// that is a state.
fn add_controller_states(b: &mut Builder, drive: usize, law: &DriveLaw, needs: Needs) {
    let s = b.source;
    let (n, is_rotary) = (s.loading.drives[drive].name.as_str(), s.loading.drives[drive].is_rotary);
    let (what, units) = match is_rotary {
        true => ("torque", [NewtonMetre, NewtonMetrePerSecond]),
        false => ("force", [Newton, NewtonPerSecond]),
    };
    let of = [" ", what, " of the drive ", n].concat();
    let [integral, force] = [ControlState::Integral, ControlState::Force];
    if law.states[integral as usize].is_some() {
        for (order, (end, word, needs)) in
            [("", "Integral part of the", state()), ("_rate", "Time derivative of the integral part of the", needs)]
                .into_iter()
                .enumerate()
        {
            let suffix = ["integral_", what, end].concat();
            let output = Output::Controller { drive, state: integral, order };
            b.output(n, &suffix, &[word, &of], units[order], output, &needs);
        }
    }
    if law.states[force as usize].is_some() {
        let suffix = ["acting_", what, "_rate"].concat();
        let output = Output::Controller { drive, state: force, order: 1 };
        b.output(n, &suffix, &["Time derivative of the acting", &of], units[1], output, &needs);
    }
}

pub(super) fn add(b: &mut Builder) {
    let s = b.source;
    // Without masses the first two stand in the places of inputs.
    let first = if s.mechanism.is_massless() { 2 } else { 0 };
    for load in 0..s.loading.drives.len() {
        (first..3).for_each(|order| add_displacement(b, load, order));
        add_one_element(b, load);
        add_loss(b, load);
        add_acting_force(b, load);
    }
}

/// The displacement of a drive, or its time derivative of this order.
fn add_displacement(b: &mut Builder, load: usize, order: usize) {
    let s = b.source;
    let n = s.loading.drives[load].name.as_str();
    let (what, units) = displacement_of(s, load);
    let position = Needs { loads: &[load], ..s.displacement(load) };
    let (suffix, word, needs) = match order {
        0 => (what, "Present ", position),
        1 => ("speed", "Time derivative of the ", Needs { speed: true, ..position }),
        _ => ("acceleration", "Second time derivative of the ", s.acceleration()),
    };
    let output = Output::Displacement { load, order };
    b.output(n, suffix, &[word, what, " of the drive ", n], units[order], output, &needs);
}

/// The word for the displacement of a drive, and the units of its time derivatives.
fn displacement_of(s: &Source, load: usize) -> (&'static str, [Unit; 3]) {
    match (s.loading.drives[load].is_rotary, &s.loading.loads[load]) {
        (true, _) => ("angle", [Radian, RadianPerSecond, RadianPerSecondSquared]),
        (false, Load::Slide { .. }) => ("position", [Metre, MetrePerSecond, MetrePerSecondSquared]),
        (false, _) => ("length", [Metre, MetrePerSecond, MetrePerSecondSquared]),
    }
}

/// The loss of a screw that locks itself.
fn add_loss(b: &mut Builder, drive: usize) {
    let s = b.source;
    let is_own = |own: &FrictionJoint| matches!(own.kind, FrictionKind::Screw { drive: driven, .. } if driven == drive);
    let mut friction_joints = s.loading.friction.iter().flat_map(|friction| &friction.friction_joints);
    let Some(friction_joint) = friction_joints.position(is_own) else { return };
    let name = s.loading.drives[drive].name.as_str();
    let text = ["Force of the losses on the nut of the screw ", name, ", positive where it increases the stroke"];
    let needs = Needs { masses: true, ..s.acceleration() };
    b.output(name, "loss_force", &text, Newton, Output::Friction { friction_joint }, &needs);
}

/// The terms of the mechanism reduced to a drive.
fn add_one_element(b: &mut Builder, drive: usize) {
    use OneElement::{
        AdditionalForce, BreakawayBackward, BreakawayForward, HoldingForce, HoldingForceDerivative, LowerLimit,
        ReducedMass, ReducedMassDerivative, RequiredForce, StaticLoad, UpperLimit,
    };
    let (s, l) = (b.source, &b.source.loading);
    let (n, loses) = (l.drives[drive].name.as_str(), l.drives[drive].efficiency);
    let (rubs, any_loses) = (s.has_friction(), l.drives.iter().any(|d| d.efficiency.is_some()));
    let damped = s.mechanism.springs.iter().any(|(_, s)| s.damping.is_some() || s.damping_points.is_some());
    let own_commands = l.drives[drive].law.as_ref().map_or(0..0, DriveLaw::commands);
    let any_law = l.drives.iter().enumerate().any(|(other, d)| other != drive && d.law.is_some());
    // No term depends on whether a lock holds.
    let free: Vec<usize> = s.inputs.iter().copied().filter(|i| !s.locks().contains(i)).collect();
    let others: Vec<usize> = free.iter().copied().filter(|i| *i != drive && !own_commands.contains(i)).collect();
    let circuit = s.has_states_at_start();
    let demand = l.inputs.len() + drive;
    let mut demanded = others.clone();
    demanded.insert(demanded.partition_point(|i| *i < demand), demand);
    // With an efficiency the sign of the drive's power counts, so the drive's own force and the speed. Friction depends
    // on all inputs; what a drive with losses delivers depends on the direction in which the mechanism moves or would
    // move.
    let own: Vec<usize> = [drive].into_iter().chain(own_commands).filter(|_| loses.is_some()).collect();
    let present = if any_loses || rubs { &free } else { &others };
    // The loads of friction are the last ones.
    let first = l.friction.iter().flat_map(|f| &f.friction_joints).map(|p| p.load).next();
    let frictionless = &s.loads[..first.unwrap_or(s.loads.len())];
    let additional = Needs { speed: true, inertia: true, inputs: &own, loads: &[drive], ..placed() };
    let mass = Needs { speed: loses.is_some(), ..additional };
    let required = Needs { masses: rubs, inputs: &demanded, ..s.acceleration() };
    let speed = any_loses || rubs || damped || any_law || l.air.is_some();
    let load = Needs { speed, inertia: rubs, inputs: present, ..required };
    let holding = Needs { inputs: &others, loads: frictionless, lossless: true, circuit, ..placed() };
    let breakaway = Needs { statics: true, lossless: false, ..holding };
    let stops = order::distinct(l.stops.iter().map(|stop| stop.load).chain([drive]).collect());
    let locks: Vec<usize> = s.locks().collect();
    let mut add = |linear, rotary, text, units, term, needs: &Needs| {
        add_term(b, drive, [linear, rotary], text, units, term, needs);
    };
    let (inertia, force) = ([Kilogram, KilogramSquareMetre], [Newton, NewtonMetre]);
    let change = [KilogramPerMetre, KilogramSquareMetrePerRadian];
    let text = "Mass (for a rotary drive: moment of inertia) of the whole mechanism, reduced to the drive @";
    add("reduced_mass", "reduced_inertia", text, inertia, ReducedMass, &mass);
    let text = "Derivative of the reduced mass or inertia with respect to the displacement of the drive @";
    add("reduced_mass_derivative", "reduced_inertia_derivative", text, change, ReducedMassDerivative, &mass);
    let text = "Sum of all present loads except the force of the drive, reduced to the drive @";
    add("static_load", "static_load", text, force, StaticLoad, &load);
    let text = "Force or torque at the drive @ due to the changing reduced mass: -1/2 x speed^2 x derivative of the \
        reduced mass";
    add("additional_force", "additional_torque", text, force, AdditionalForce, &additional);
    let text = "Force or torque of the drive @ that causes the demanded acceleration, including friction and losses";
    add("required_force", "required_force", text, force, RequiredForce, &required);
    let text = "Force or torque of the drive @ that holds the mechanism at rest under the present loads, without \
        friction and losses";
    add("holding_force", "holding_torque", text, force, HoldingForce, &holding);
    let text = "Derivative of the holding force or torque with respect to the displacement of the drive @";
    let (linear, rotary) = ("holding_force_derivative", "holding_torque_derivative");
    let (stiffness, term) = ([NewtonPerMetre, NewtonMetrePerRadian], HoldingForceDerivative);
    add(linear, rotary, text, stiffness, term, &holding);
    if !l.stops.is_empty() {
        let limit = Needs { inputs: &locks, loads: &stops, ..placed() };
        let (text, way) = ("Smallest displacement of the drive @ that stops and locks allow", [Metre, Radian]);
        add("lower_limit", "lower_limit", text, way, LowerLimit, &limit);
        let text = "Largest displacement of the drive @ that stops and locks allow";
        add("upper_limit", "upper_limit", text, way, UpperLimit, &limit);
    }
    if rubs {
        let text = "Force or torque of the drive @ above which the mechanism starts to move forward from rest, with \
            friction";
        add("breakaway_force_forward", "breakaway_torque_forward", text, force, BreakawayForward, &breakaway);
        let text = "Force or torque of the drive @ below which the mechanism starts to move backward from rest, with \
            friction";
        add("breakaway_force_backward", "breakaway_torque_backward", text, force, BreakawayBackward, &breakaway);
        let text = b.text(|| {
            let force =
                ": no force of the drive causes the demanded acceleration, or no force of the drive starts a motion ";
            ["True while friction locks the mechanism against the drive ", n, force, "forward or backward"].concat()
        });
        let locking = Needs { statics: true, ..required };
        b.any_output([n, ".self_locking"].concat(), text, None, Quantity::SelfLocking(drive), &locking);
    }
    if s.mechanism.actuators.iter().nth(drive).is_some_and(|(_, a)| a.by_body) {
        add_by_body(b, drive, [mass, load]);
    }
}

/// A term for a linear or a rotary drive, by name and unit. An @ in the text stands for the drive.
// Called, so that the code exists once for all terms.
#[inline(never)]
fn add_term(
    b: &mut Builder,
    drive: usize,
    [linear, rotary]: [&str; 2],
    text: &str,
    units: [Unit; 2],
    term: OneElement,
    needs: &Needs,
) {
    let own = &b.source.loading.drives[drive];
    let (suffix, unit) = if own.is_rotary { (rotary, units[1]) } else { (linear, units[0]) };
    let (before, after) = text.split_once('@').unwrap_or((text, ""));
    b.output(&own.name, suffix, &[before, &own.name, after], unit, Output::OneElement { drive, term }, needs);
}

/// The part of each moving body in the mechanism reduced to a drive; `mass`, `load`: needs of the whole reduced
/// mass and of the whole static load.
fn add_by_body(b: &mut Builder, drive: usize, [mass, load]: [Needs; 2]) {
    use BodyPart::{CenterByDrive, DriveByAngle, DriveByCenter, ReducedMass, StaticLoad};
    let s = b.source;
    let (n, is_rotary) = (s.loading.drives[drive].name.as_str(), s.loading.drives[drive].is_rotary);
    let ratio = Needs { masses: true, loads: &[drive], ..placed() };
    let (mass, load) = (Needs { masses: true, ..mass }, Needs { masses: true, ..load });
    for (index, body) in s.linkage.bodies.iter().enumerate().skip(1) {
        let owner = [n, ".", &body.name].concat();
        let mut add = |suffix, [before, between]: [&str; 2], unit, part, needs: &Needs| {
            let output = Output::OneElement { drive, term: OneElement::OfBody(index, part) };
            b.output(&owner, suffix, &[before, &body.name, between, n], unit, output, needs);
        };
        let (suffix, unit) =
            if is_rotary { ("reduced_inertia", KilogramSquareMetre) } else { ("reduced_mass", Kilogram) };
        let text = ["Mass (for a rotary drive: moment of inertia) of the body ", ", reduced to the drive "];
        add(suffix, text, unit, ReducedMass, &mass);
        let unit = if is_rotary { NewtonMetre } else { Newton };
        let text = ["Sum of all present loads on the body ", ", reduced to the drive "];
        add("static_load", text, unit, StaticLoad, &load);
        let (center, angle) = match is_rotary {
            true => (("effective_radius", Metre, CenterByDrive), ("ratio", One, DriveByAngle)),
            false => (("ratio", One, DriveByCenter), ("effective_radius", Metre, DriveByAngle)),
        };
        let text = match is_rotary {
            true => {
                ["Effective radius: speed of the centre of mass of the body ", ", divided by the speed of the drive "]
            }
            false => [
                "Ratio: speed of the drive, divided by the speed of the centre of mass of the body ",
                ", for the drive ",
            ],
        };
        add(center.0, text, center.1, center.2, &ratio);
        if body.angle_coordinate.is_some() {
            let what = if is_rotary { "Ratio" } else { "Effective radius" };
            let before = [what, ": speed of the drive, divided by the angular speed of the body "].concat();
            add(angle.0, [&before, ", for the drive "], angle.1, angle.2, &ratio);
        }
    }
}
