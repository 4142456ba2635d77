//! Geometry as drawn: bodies by the coordinates of their points in the mechanism frame at one drawn position, and other
//! units of angle and length for the file.
//!
//! In: a mechanism as read. Out: the same mechanism in lengths, points in the bodies' frames and a guess, in SI units.
//! It must not know how loops are closed.
use super::between::Between;
use super::bodies::{Body, Drawn, JointKind};
use super::contact::Lock;
use super::loads::Actuator;
use super::{GROUND, Mechanism};
use crate::format::{Aside, DefinitionError, Faults, Key, Named, Number, Role, keys, numbers, words};
use crate::numerics::decimal::Decimal;
use crate::numerics::plane::{Vec2, cross, turned};
use crate::variables::Unit;
use std::f64::consts::{PI, TAU};

/// Largest difference of a stated value from the drawn one, relative to the size of the drawing, and in rad: the
/// rounding of coordinates to six digits.
const ROUNDING: f64 = 1e-6;
/// Gap of a joint at the drawn position that is an error of the drawing, relative to its size.
const OPEN: f64 = 1e-3;
/// Angle that is 0 but for rounding [rad].
const ZERO: f64 = 1e-12;

keys! {
    /// Units of the angles and lengths in the mechanism file. All numbers of the mechanism file other than angles and
    /// lengths are in SI units. The variables of the FMU are always in SI units.
    pub struct Units: Copy {
        /// Unit of all angles in the mechanism file.
        angle: Option<AngleUnit> => Key::PLAIN.absent("\"rad\"");
        /// Unit of all lengths in the mechanism file.
        length: Option<LengthUnit> => Key::PLAIN.absent("\"m\"");
    }
}

words! {
    /// Unit of angles.
    pub enum AngleUnit {
        /// Radians.
        Rad = "rad",
        /// Degrees.
        Deg = "deg",
    }

    /// Unit of lengths.
    pub enum LengthUnit {
        /// Metres.
        M = "m",
        /// Millimetres.
        Mm = "mm",
    }
}

impl Units {
    /// Whether angles are in degrees.
    pub fn has_degrees(self) -> bool {
        self.angle == Some(AngleUnit::Deg)
    }

    /// Whether lengths are in millimetres.
    pub fn has_millimetres(self) -> bool {
        self.length == Some(LengthUnit::Mm)
    }

    /// The file's unit of a parameter with this unit and role, where it is none of SI.
    pub(super) fn of_parameter(self, unit: Unit, role: Role) -> Option<&'static str> {
        match (unit, role) {
            // A circuit has defaults in SI units, so all its numbers are.
            (_, Role::Circuit | Role::CircuitStart) => None,
            // A named parameter has the unit that it states.
            (_, Role::Named) => None,
            _ => self.of_number(unit),
        }
    }

    /// The file's unit of a number in this unit, where it is none of SI.
    pub(super) fn of_number(self, unit: Unit) -> Option<&'static str> {
        match unit {
            Unit::Radian => self.has_degrees().then_some("deg"),
            Unit::Metre => self.has_millimetres().then_some("mm"),
            _ => None,
        }
    }

    /// The file's unit of the number at this path of the file, in this unit, where it is none of SI.
    pub(super) fn of_path(self, path: &str, unit: Unit) -> Option<&'static str> {
        // A circuit has defaults in SI units, so all its numbers are.
        let is_of_circuit = path.contains(".hydraulics.") || path.starts_with("hydraulics.");
        self.of_number(unit).filter(|_| !is_of_circuit)
    }

    /// The number that states a value in this unit [SI] in the file.
    pub(super) fn stated(self, unit: Unit, value: f64) -> f64 {
        in_file(self.of_number(unit), value)
    }
}

/// The number that states a value [SI] in this unit of a file, if it is none of SI.
pub(super) fn in_file(unit: Option<&'static str>, value: f64) -> f64 {
    match unit {
        Some("deg") => value.to_degrees(),
        Some(_) => 1000.0 * value,
        None => value,
    }
}

impl Mechanism {
    /// Whether the motion of a drive is an angle.
    pub(crate) fn turns(&self, drive: &Actuator) -> bool {
        self.is_rotary(drive.between()) || drive.screw.is_some()
    }

    /// Whether a drive acts along a slot, which no cylinder and no screw follows.
    pub(super) fn is_in_slot(&self, drive: &Actuator) -> bool {
        let joint = drive.joint.as_ref().and_then(|joint| self.joints.get(joint));
        joint.is_some_and(|joint| joint.kind == JointKind::Slot)
    }

    /// Whether a load there is a torque.
    fn is_rotary(&self, place: Option<Between>) -> bool {
        place.is_some_and(|place| place.is_rotary(&self.joints))
    }

    /// Take the file's units and drawn coordinates into SI units, lengths, points and a guess.
    pub(super) fn resolve_drawing(&mut self, faults: &mut Faults) {
        self.convert_units();
        let frames = self.drawn_frames(faults);
        if frames.is_empty() {
            return;
        }
        let size = frames.iter().fold(0.0, |size: f64, (_, (origin, _))| size.max(origin.norm()));
        let bodies = self.bodies.iter().map(|(_, body)| body.length.unwrap_or(0.0));
        let size = bodies.fold(size, f64::max);
        self.resolve_fixed(&frames, size, faults);
        self.resolve_joints(&frames, faults);
        self.resolve_guess(&frames, size, faults);
    }

    /// Every angle and length of the file in SI units, if it has others.
    pub(super) fn convert_units(&mut self) {
        if let Some(units) = self.units.take() {
            self.file_units = Aside(units);
            self.convert(units);
        }
    }

    /// Every angle and length of the file in SI units.
    fn convert(&mut self, units: Units) {
        let rotary = self.rotary();
        numbers(self, &mut |number: Number| match units.of_path(number.path, number.unit(&rotary)) {
            Some("deg") => *number.value = number.value.to_radians(),
            Some(_) => *number.value /= 1000.0,
            None => {}
        });
    }

    /// Paths of the elements whose numbers have the second one of two units: those of a joint that turns.
    pub(super) fn rotary(&self) -> Named<()> {
        let drives = self.actuators.iter().filter(|(_, drive)| self.turns(drive));
        let springs = self.springs.iter().filter(|(_, spring)| self.is_rotary(spring.between()));
        let stops = self.stops.iter().filter(|(_, stop)| stop.angle.is_some());
        let turning = |lock: &Lock| self.stops.get(&lock.stop).is_some_and(|stop| stop.angle.is_some());
        let locks = self.locks.iter().filter(|(_, lock)| turning(lock));
        let couplings = self.couplings.iter().filter(|(_, coupling)| coupling.joint.is_none());
        let paths = drives.map(|(name, _)| format!("actuators.{name}"));
        let paths = paths.chain(springs.map(|(name, _)| format!("springs.{name}")));
        let paths = paths.chain(stops.map(|(name, _)| format!("stops.{name}")));
        let paths = paths.chain(locks.map(|(name, _)| format!("locks.{name}")));
        let paths = paths.chain(couplings.map(|(name, _)| format!("couplings.{name}")));
        paths
            .chain(self.bodies.names().into_iter().map(|name| format!("guess.{name}")))
            .map(|path| (path, ()))
            .collect()
    }

    /// Origin and angle of every drawn body, with the ground's; empty if nothing is drawn. Each body then has its
    /// length and its points.
    fn drawn_frames(&mut self, faults: &mut Faults) -> Named<(Vec2, f64)> {
        const OF_GROUND: (Vec2, f64) = (Vec2::new(0.0, 0.0), 0.0);
        let mut frames = Named::default();
        for (name, body) in self.bodies.iter_mut() {
            let Some(drawn) = body.drawn.take() else { continue };
            if let Some(frame) = faults.keep(resolve_body(name, body, drawn)) {
                frames.push(name, if name == GROUND { OF_GROUND } else { frame });
            }
        }
        if !frames.is_empty() {
            frames.push(GROUND, OF_GROUND);
        }
        frames
    }

    /// Angles of fixed bodies, and whether they are drawn where they are fixed.
    fn resolve_fixed(&mut self, frames: &Named<(Vec2, f64)>, size: f64, faults: &mut Faults) {
        let mut angles = Named::default();
        for (name, body) in self.bodies.iter() {
            let (Some(to), Some(&(origin, angle))) = (&body.fixed_to, frames.get(name)) else { continue };
            let carrier = to.split('.').next().unwrap_or_default();
            let key = format!("bodies.{name}.fixed_to");
            // A name that there is not is reported by the checks.
            let Ok((_, local)) = self.point(&key, to) else { continue };
            let Some(&(of, own)) = frames.get(carrier) else {
                let message = format_args!(
                    "{name} has the key `drawn`, so the body {carrier}, which carries {name}, needs this key too: \
                     add bodies.{carrier}.drawn"
                );
                faults.refuse(key, message);
                continue;
            };
            let off = (of + turned(Vec2::from(local), own) - origin).norm();
            if off > ROUNDING * size {
                let message = format_args!(
                    "the drawn origin of {name} is {} m away from the point {to}, but must be at this point: correct \
                     one of the two positions",
                    Decimal::rounded(off)
                );
                faults.refuse(format_args!("bodies.{name}.drawn.origin"), message);
            }
            let relative = wrapped(angle - own);
            match body.angle {
                Some(stated) if wrapped(stated - relative).abs() > ROUNDING => {
                    let message = format_args!(
                        "the drawing gives {} rad: remove this angle, or correct this angle or the drawing",
                        Decimal::rounded(relative)
                    );
                    let key = format!("bodies.{name}.angle");
                    faults.refuse(key, message);
                }
                Some(_) => {}
                None if relative.abs() > ZERO => drop(angles.push(name, relative)),
                None => {}
            }
        }
        for (name, body) in self.bodies.iter_mut() {
            if let Some(angle) = angles.get(name) {
                body.angle = Some(*angle);
            }
        }
    }

    /// Angles between the bodies of prismatic joints.
    fn resolve_joints(&mut self, frames: &Named<(Vec2, f64)>, faults: &mut Faults) {
        let angle_of = |point: &str| frames.get(point.split('.').next().unwrap_or_default()).map(|(_, angle)| *angle);
        for (name, joint) in self.joints.iter_mut().filter(|(_, joint)| joint.kind == JointKind::Prismatic) {
            let (Some(first), Some(second)) = (angle_of(&joint.first), angle_of(&joint.second)) else { continue };
            let relative = wrapped(second - first);
            match joint.angle {
                Some(stated) if wrapped(stated - relative).abs() > ROUNDING => {
                    let message = format_args!(
                        "the drawing gives {} rad: remove this angle, or correct this angle or the drawing",
                        Decimal::rounded(relative)
                    );
                    faults.refuse(format_args!("joints.{name}.angle"), message);
                }
                Some(_) => {}
                None if relative.abs() > ZERO => joint.angle = Some(relative),
                None => {}
            }
        }
    }

    /// A guess of every coordinate that is drawn and that the file does not state; joints that are drawn open.
    fn resolve_guess(&mut self, frames: &Named<(Vec2, f64)>, size: f64, faults: &mut Faults) {
        let place = |text: &str| {
            let (origin, angle) = frames.get(text.split('.').next().unwrap_or_default())?;
            let (_, local) = self.point("guess", text).ok()?;
            Some((origin + turned(Vec2::from(local), *angle), *angle))
        };
        let mut groups = Groups::new(self);
        let mut guesses: Vec<(String, f64)> = Vec::new();
        for (name, joint) in self.joints.iter() {
            let is_prismatic = joint.kind == JointKind::Prismatic;
            // A prismatic joint between bodies that others hold already has no coordinate of its own.
            let is_own = is_prismatic && groups.join(&joint.first, &joint.second);
            let (Some((from, angle)), Some((to, _))) = (place(&joint.first), place(&joint.second)) else { continue };
            let axis = turned(Vec2::x(), angle + joint.axis_angle.unwrap_or(0.0));
            let gap = to - from;
            let (off, what, position) = match joint.kind {
                JointKind::Revolute => (gap.norm(), "away from the first point", None),
                JointKind::Prismatic => {
                    let off = cross(axis, gap).abs();
                    (off, "off the line through the first point", is_own.then(|| axis.dot(&gap)))
                }
                JointKind::Slot => {
                    let Some([s, off]) = joint.track().map(|track| track.nearest(turned(gap, -angle))) else {
                        continue;
                    };
                    (off, "away from the slot", Some(s))
                }
            };
            if off > OPEN * size {
                let message = format_args!(
                    "the second point of the joint is drawn {} m {what}: correct one of the two points",
                    Decimal::rounded(off)
                );
                faults.refuse(format_args!("joints.{name}"), message);
            }
            if let Some(position) = position.filter(|_| self.guess.get(name).is_none()) {
                guesses.push((name.to_owned(), position));
            }
        }
        // One body of each group that turns together, unless the file states one.
        let mut known: Vec<usize> = vec![groups.of(GROUND)];
        known.extend(self.guess.names().into_iter().map(|name| groups.of(name)));
        for (name, _) in self.bodies.iter().filter(|(_, body)| body.fixed_to.is_none()) {
            let (group, Some((_, angle))) = (groups.of(name), frames.get(name)) else { continue };
            if !known.contains(&group) {
                known.push(group);
                guesses.push((name.to_owned(), *angle));
            }
        }
        let stated = self.guess.iter().map(|(name, value)| (name.to_owned(), *value));
        self.guess = stated.chain(guesses).collect();
    }
}

/// Bodies that turn together: joined by fixings and by prismatic joints.
struct Groups<'m> {
    bodies: &'m Named<Body>,
    /// Of each body another one of its group, or itself.
    parts: Vec<usize>,
}

impl<'m> Groups<'m> {
    /// The groups that fixings make.
    fn new(mechanism: &'m Mechanism) -> Self {
        let bodies = &mechanism.bodies;
        let mut groups = Self { bodies, parts: (0..bodies.len()).collect() };
        for (name, body) in bodies.iter() {
            if let Some(to) = &body.fixed_to {
                groups.join(name, to);
            }
        }
        groups
    }

    /// The group of a body, or of a point's body; that of the ground for a name that there is not.
    fn of(&mut self, point: &str) -> usize {
        let mut at = self.bodies.position(point.split('.').next().unwrap_or_default()).unwrap_or(0);
        while self.parts[at] != at {
            self.parts[at] = self.parts[self.parts[at]];
            at = self.parts[at];
        }
        at
    }

    /// Make one group of the groups of two points; whether they were two.
    fn join(&mut self, one: &str, other: &str) -> bool {
        let (one, other) = (self.of(one), self.of(other));
        self.parts[other] = one;
        one != other
    }
}

/// Length, points and centre of a drawn body in its own frame; its origin and angle.
fn resolve_body(name: &str, body: &mut Body, drawn: Drawn) -> Result<(Vec2, f64), DefinitionError> {
    let key = |k: &str| format!("bodies.{name}.drawn{k}");
    if name == GROUND {
        let message = "the frame of the ground is the mechanism frame: give the keys `points` and `length` instead \
            of the key `drawn`";
        return Err(DefinitionError::key(key(""), message));
    }
    let finite = |p: &[f64; 2]| p.iter().all(|x| x.abs() <= 1e100);
    let all = [Some(&drawn.origin), drawn.end.as_ref(), drawn.center.as_ref()];
    if !all.into_iter().flatten().chain(drawn.points.iter().map(|(_, p)| p)).all(finite) {
        return Err(DefinitionError::key(key(""), "the coordinates must be numbers from -1e100 to 1e100"));
    }
    let origin = Vec2::from(drawn.origin);
    let angle = match (drawn.end, drawn.angle) {
        (Some(_), Some(_)) => {
            let message = "the points `origin` and `end` already define the angle of the body: remove the key \
                           `angle` or the key `end`";
            return Err(DefinitionError::key(key(".angle"), message));
        }
        (Some(end), None) => {
            let along = Vec2::from(end) - origin;
            let length = along.norm();
            if length == 0.0 {
                let message = "the points end and origin coincide, so the body has no length: correct one of the two \
                    points";
                return Err(DefinitionError::key(key(".end"), message));
            }
            match body.length {
                Some(stated) if (stated - length).abs() > ROUNDING * length => {
                    let message = format_args!("origin and end are drawn {} m apart", Decimal::rounded(length));
                    let allowed = format_args!(
                        "the length in the drawing, because {message}: remove this length, or correct the length or \
                         the drawn points"
                    );
                    let (key, stated) = (format!("bodies.{name}.length"), Decimal::rounded(stated));
                    return Err(DefinitionError::value(key, format_args!("{stated} m"), allowed));
                }
                Some(_) => {}
                None => body.length = Some(length),
            }
            along.y.atan2(along.x)
        }
        (None, angle) => angle.unwrap_or(0.0),
    };
    let local = |point: [f64; 2]| {
        let local = turned(Vec2::from(point) - origin, -angle);
        [local.x, local.y]
    };
    if let Some(center) = drawn.center {
        if body.center.is_some() {
            return Err(DefinitionError::key(
                key(".center"),
                "the centre of mass is given twice: by `drawn.center`, and by `center` of the body. Remove one of \
                 the two keys",
            ));
        }
        body.center = Some(local(center));
    }
    let mut points: Vec<(String, [f64; 2])> = body.points.iter().map(|(n, p)| (n.to_owned(), *p)).collect();
    for (point, place) in drawn.points.iter() {
        if body.points.get(point).is_some() {
            let message = "this point is given twice: by `drawn.points`, and by `points` of the body. Remove one of \
                           the two points";
            return Err(DefinitionError::key(key(&format!(".points.{point}")), message));
        }
        points.push((point.to_owned(), local(*place)));
    }
    body.points = points.into_iter().collect();
    Ok((origin, angle))
}

/// An angle from -pi to pi.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}
