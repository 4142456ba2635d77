//! Variables of loads: gravity, forces, torques, springs, drag, stops and locks.
use super::builder::Builder;
use super::needs::Needs;
use crate::mechanism::definition::Between;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{CONTACT_MODES, ImpactPart, Output, Quantity};
use crate::variables::Unit::{
    KilogramSquareMetrePerSecond, Metre, MetrePerSecond, Newton, NewtonMetre, NewtonSecond, One, Radian, Second,
};
use crate::variables::{Causality, Unit, Value};

pub(super) fn add_inputs(b: &mut Builder) {
    let m = b.source.mechanism;
    if let Some(gravity) = &m.gravity {
        b.load_input(
            &["Load factor, by which the gravity acceleration gravity.acceleration is multiplied"],
            One,
            gravity.load_factor,
        );
    }
    for (name, force) in m.forces.iter().filter(|(_, f)| !f.constant) {
        for (value, axis) in force.force.into_iter().zip(["x", "y"]) {
            b.load_input(&[axis, " component of the external force ", name, " in the mechanism frame"], Newton, value);
        }
    }
    for (_, t) in m.torques.iter().filter(|(_, t)| !t.constant) {
        b.load_input(&["External torque on the body ", &t.on, ", anticlockwise positive"], NewtonMetre, t.torque);
    }
    for (name, joint) in m.joints.iter() {
        if let Some(speed) = joint.surface_speed {
            let text = ["Speed of the surface on which the second body slides in the joint ", name];
            b.load_input(&text, MetrePerSecond, speed);
        }
    }
}

pub(super) fn add_airspeed(b: &mut Builder) {
    if let Some(air) = &b.source.mechanism.air {
        let text = "Speed of the air relative to the ground, in the direction of the parameter air.flow_angle";
        b.input("airspeed".into(), &[text], MetrePerSecond, air.airspeed);
    }
}

/// Sense of a spring's force, for its description.
const PULLS: &str = ". A positive force pulls the two ends of the spring together";
/// Sense of the torque of a spring in a revolute joint.
const TURNS: &str = ". A positive torque turns the second body of the joint clockwise, relative to the first body";

pub(super) fn add_springs(b: &mut Builder) {
    let s = b.source;
    for ((i, spring), (_, defined)) in s.loading.springs.iter().enumerate().zip(s.mechanism.springs.iter()) {
        let (n, load) = (spring.name.as_str(), spring.load);
        let (what, unit, force, force_unit, sense) = match s.loading.loads[load] {
            Load::Couple { .. } => ("angle", Radian, "torque", NewtonMetre, TURNS),
            Load::Slide { .. } => ("position", Metre, "force", Newton, PULLS),
            _ => ("length", Metre, "force", Newton, PULLS),
        };
        let position = Needs { loads: &[load], ..s.displacement(load) };
        let needs = Needs { speed: defined.damping.is_some() || defined.damping_points.is_some(), ..position };
        let text = ["Present ", what, " of the spring ", n];
        b.output(n, what, &text, unit, Output::Displacement { load, order: 0 }, &position);
        let text = match defined.between() {
            Some(Between::Bodies([first, second])) => &[
                "Total torque of the spring `",
                n,
                "` (elastic torque, damping and preload). A positive torque turns the body ",
                second,
                " clockwise, relative to the body ",
                first,
            ][..],
            _ => &["Total ", force, " of the spring `", n, "` (elastic ", force, ", damping and preload)", sense],
        };
        b.output(n, force, text, force_unit, Output::SpringForce { spring: i }, &needs);
    }
}

pub(super) fn add_surfaces(b: &mut Builder) {
    let s = b.source;
    let (Some(air), airspeed) = (&s.loading.air, s.airspeed()) else { return };
    for (i, surface) in air.surfaces.iter().enumerate() {
        let (n, loads) = (surface.name.as_str(), [surface.load, surface.load + 1, surface.load + 2]);
        let position = s.position(&[surface.start.body]);
        let needs = Needs { speed: true, inputs: airspeed.as_slice(), loads: &loads, ..position };
        let text = ["Drag of the air on the surface ", n, ": component in the direction of the flow"];
        b.output(n, "drag", &text, Newton, Output::Drag { surface: i }, &needs);
    }
}

pub(super) fn add_engagements(b: &mut Builder) {
    for (i, (name, lock)) in b.source.mechanism.locks.iter().enumerate() {
        let text = b.text(|| match lock.engage_force {
            None => {
                ["true: the lock ", name, " is engaged. An engaged lock holds the mechanism at the stop ", &lock.stop]
                    .concat()
            }
            Some(_) => [
                "true: the lock ",
                name,
                " engages when the force of the stop ",
                &lock.stop,
                " exceeds engage_force; false: the lock releases",
            ]
            .concat(),
        });
        let start = (None, Value::Boolean(lock.engage));
        b.known([name, ".engage"].concat(), text, Causality::Input, start, Quantity::Lock(i));
    }
}

pub(super) fn add_stops(b: &mut Builder) {
    let s = b.source;
    for ((i, stop), (_, defined)) in s.loading.stops.iter().enumerate().zip(s.mechanism.stops.iter()) {
        let n = stop.name.as_str();
        let stated = defined.flag.clone();
        let position = match s.loading.loads[stop.load] {
            Load::Torque { body, .. } => s.position(&[body]),
            _ => s.displacement(stop.load),
        };
        let needs = Needs { loads: &[stop.load], ..position };
        let text = b.text(|| ["True while the mechanism is at the stop ", n, " or beyond this stop"].concat());
        b.any_output(stated.unwrap_or_else(|| [n, ".reached"].concat()), text, None, Quantity::AtStop(i), &needs);
        let (suffix, what, unit) = match stop.quantity == "angle" {
            true => ("torque", "Torque of the stop ", NewtonMetre),
            false => ("force", "Force of the stop ", Newton),
        };
        let text = [what, n, " on the mechanism, negative for an upper stop"];
        b.output(n, suffix, &text, unit, Output::Stop { stop: i }, &s.acceleration());
        add_impacts(b, i, if stop.quantity == "angle" { KilogramSquareMetrePerSecond } else { NewtonSecond });
    }
}

/// What a stop has met.
fn add_impacts(b: &mut Builder, stop: usize, impulse: Unit) {
    let s = b.source;
    let name = &s.loading.stops[stop].name;
    let size = "; for a bumper: reduced mass times the speed at first contact";
    let parts = [
        ("impact_count", ["Number of impacts on the stop ", " since the start of the run"], One, ImpactPart::Count),
        (
            "impact_time",
            ["Time of the last impact on the stop ", "; -1 s before the first impact"],
            Second,
            ImpactPart::Time,
        ),
        ("impact_impulse", ["Impulse of the last impact on the stop ", size], impulse, ImpactPart::Impulse),
    ];
    for (suffix, [before, after], unit, part) in parts {
        b.output(name, suffix, &[before, name, after], unit, Output::Impact { stop, part }, &Needs::default());
    }
}

/// How stops hold the mechanism, to be looked at.
pub(super) fn add_contact_mode(b: &mut Builder) {
    if b.source.loading.stops.is_empty() {
        return;
    }
    let text = b.text(|| {
        let modes = CONTACT_MODES.join(", ");
        format!(
            "Contact of the mechanism with its stops: {modes}. free: no contact; pushed: a bumper pushes the \
             mechanism; resting: the mechanism is at rest on a rigid stop; locked: a lock holds the mechanism; \
             arrived: the mechanism is at a stop, just before the impact"
        )
    });
    let name = "contact.mode".to_owned();
    b.add((name, text), Causality::Local, (None, None), Quantity::Contact, &Needs::default());
}

/// Whether friction holds the mechanism, where its law can.
pub(super) fn add_sticking(b: &mut Builder) {
    let s = b.source;
    if s.mechanism.sticks() && s.has_friction() {
        let text = b.text(|| "True while friction holds the mechanism at rest".to_owned());
        b.any_output("friction.sticking".to_owned(), text, None, Quantity::Sticking, &s.acceleration());
    }
}

pub(super) fn add_locks(b: &mut Builder) {
    let s = b.source;
    for (i, lock) in s.loading.locks.iter().enumerate() {
        let stop = &s.loading.stops[lock.stop].name;
        let text = ["Force of the lock ", &lock.name, " on the mechanism, positive towards the stop ", stop];
        b.output(&lock.name, "force", &text, Newton, Output::Lock { lock: i }, &s.acceleration());
        if lock.engage.is_some() {
            let text = b.text(|| ["True while the lock ", &lock.name, " is engaged"].concat());
            b.any_output([&lock.name, ".engaged"].concat(), text, None, Quantity::Engaged(i), &Needs::default());
        }
    }
}
