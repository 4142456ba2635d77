//! Checks of a definition that need no geometry: numbers in range, names that resolve, keys that go together.
//!
//! In: a definition as it was read. Out: all faults that it shows, each under its key. It must not know how loops
//! close.
mod drives;
mod names;
mod network;

use super::between::{Between, PLACES};
use super::bodies::{Body, Joint, JointKind};
use super::characteristics::{check_bumper, check_damper, check_spring};
use super::contact::Stop;
use super::experiment::Solver;
use super::loads::Surface;
use super::refusal::{Check, refused};
use super::{GROUND, Mechanism};
use crate::format::{DefinitionError, Faults, Range};
use crate::variables::Unit;
use names::{alternatives, check_name, entry};
pub use network::allow_hydraulics;
pub(super) use network::idle_keys;

impl Mechanism {
    /// All faults of what was read that show without geometry.
    pub(super) fn find_faults(&mut self, faults: &mut Faults) {
        self.resolve_drawing(faults);
        faults.keep(check_name("name", &self.name));
        if self.description.chars().any(char::is_control) {
            let value = format_args!("\"{}\"", self.description);
            faults.keep::<()>(Err(DefinitionError::value("description", value, "one line of text")));
        }
        self.check_names(faults);
        self.check_couplings(faults);
        faults.keep(self.check_snap());
        faults.keep(self.check_solver());
        self.parameters(&mut |parameter, value| {
            // No product of a few numbers overflows that have the limits of coordinates.
            let ranges = [parameter.range, Range::Coordinate];
            if let Some(range) = ranges.into_iter().find(|range| !range.contains(*value)) {
                faults.keep(range.check_in(parameter.unit, parameter.key.concat(), *value));
            }
        });
        self.check_bodies(faults);
        self.check_joints(faults);
        self.check_drives(faults);
        self.check_hydraulics(faults);
        self.check_loads(faults);
        self.check_surfaces(faults);
        self.check_stops(faults);
        faults.keep(self.check_start());
        faults.keep(self.about.check());
        faults.keep(self.experiment.check());
        self.settle_masses(faults);
    }

    /// A stated method has a step.
    fn check_solver(&mut self) -> Check {
        let Solver { method, fem_step, .. } = &mut self.solver;
        match (method, &fem_step) {
            (Some(_), None) => *fem_step = Some(Solver::FEM_STEP),
            (None, Some(_)) => {
                return refused("solver.fem_step", "this key needs the key `solver.method`: add this key");
            }
            _ => {}
        }
        Ok(())
    }

    /// The body with this name, which stands under this key.
    pub(super) fn named_body(&self, key: &str, name: &str) -> Result<&Body, DefinitionError> {
        entry(key, "bodies", &self.bodies, name)
    }

    /// The joint with this name, which stands under this key.
    pub(super) fn named_joint(&self, key: &str, name: &str) -> Result<&Joint, DefinitionError> {
        entry(key, "joints", &self.joints, name)
    }

    fn check_bodies(&self, faults: &mut Faults) {
        if self.bodies.get(GROUND).is_none() {
            faults.refuse("bodies", "the body `ground`, which does not move, is missing: add this body");
        }
        let before = faults.len();
        for (name, body) in self.bodies.iter() {
            faults.keep(Self::check_body(name, body));
        }
        // A chain is followed through bodies that are sound.
        if faults.len() == before {
            self.check_chains(faults);
        }
    }

    fn check_body(name: &str, body: &Body) -> Check {
        let refused = |key: &str, message: &str| refused(format_args!("bodies.{name}.{key}"), message);
        let given = [
            ("fixed_to", body.fixed_to.is_some()),
            ("mass", body.mass.is_some()),
            ("shape", body.shape.is_some()),
            ("center", body.center.is_some()),
            ("inertia", body.inertia.is_some()),
            ("axial_stiffness", body.axial_stiffness.is_some()),
        ];
        if name == GROUND
            && let Some((key, _)) = given.iter().find(|(_, there)| *there)
        {
            return refused(
                key,
                "the ground does not move and has only the keys `length` and `points`: remove this \
                key",
            );
        }
        if let (Some(_), Some(to)) = (body.axial_stiffness, &body.fixed_to) {
            let other = to.split('.').next().unwrap_or_default();
            let message = format!("{name} is fixed to {other}: give the axial stiffness of {other} instead");
            return refused("axial_stiffness", &message);
        }
        if body.angle.is_some() && body.fixed_to.is_none() {
            let message = "only a body with the key fixed_to has an angle: give the angle of a moving body in guess";
            return refused("angle", message);
        }
        if body.shape.is_some() && body.length.is_none() {
            return refused("shape", "a body with the shape `uniform_rod` needs a length: add the key `length`");
        }
        if body.shape.is_some() && (body.center.is_some() || body.inertia.is_some()) {
            return refused(
                "shape",
                "the shape `uniform_rod` defines the keys `center` and `inertia`: remove these \
                two keys",
            );
        }
        Ok(())
    }

    /// Every chain of fixed_to ends at a body that is not fixed.
    fn check_chains(&self, faults: &mut Faults) {
        let bodies: Vec<(&str, &Body)> = self.bodies.iter().collect();
        // Number of the walk that has come by a body; one walk ends where an earlier one has been.
        let mut walks = vec![0; bodies.len()];
        for first in 0..bodies.len() {
            let (walk, mut body) = (first + 1, first);
            while walks[body] == 0 {
                walks[body] = walk;
                let (name, Body { fixed_to: Some(to), .. }) = bodies[body] else { break };
                let key = format_args!("bodies.{name}.fixed_to");
                let Some((next, _)) = faults.keep(self.point(key, to)) else { break };
                body = next;
                if walks[body] == walk {
                    let key = format_args!("bodies.{}.fixed_to", bodies[first].0);
                    faults.refuse(
                        key,
                        "the bodies are fixed to each other in a circle: fix one of these bodies to another body",
                    );
                }
            }
        }
    }

    fn check_joints(&self, faults: &mut Faults) {
        for (name, joint) in self.joints.iter() {
            let key = |k: &str| format!("joints.{name}.{k}");
            faults.keep(self.point(key("first"), &joint.first));
            faults.keep(self.point(key("second"), &joint.second));
            faults.keep(joint.check_slot(&format!("joints.{name}")));
            let (is_revolute, is_prismatic) = (joint.kind == JointKind::Revolute, joint.kind == JointKind::Prismatic);
            let is_slot = joint.kind == JointKind::Slot;
            let no_slot = "a slot cannot have this key: remove the key";
            let no_slide = "only a prismatic joint has this key: remove the key";
            let no_pin = "only a revolute joint has this key: remove the key";
            let no_friction = "this key has no effect without friction: add the key `friction`, or remove this key";
            let no_radius = "a revolute joint without `pin_radius` has no friction, so the speed of its surface has no \
                             effect: add the key `pin_radius`, or remove this key";
            let without = self.friction.is_none();
            for (k, value, excluded, message) in [
                ("axis_angle", joint.axis_angle, !is_prismatic, no_slide),
                ("angle", joint.angle, !is_prismatic, no_slide),
                ("armature", joint.armature, is_slot, no_slot),
                ("pin_radius", joint.pin_radius, !is_revolute, no_pin),
                ("pin_radius", joint.pin_radius, is_revolute && without, no_friction),
                ("static_coefficient", joint.static_coefficient, without, no_friction),
                ("kinetic_coefficient", joint.kinetic_coefficient, without, no_friction),
                ("surface_speed", joint.surface_speed, without, no_friction),
                ("surface_speed", joint.surface_speed, is_revolute && joint.pin_radius.is_none(), no_radius),
            ] {
                if value.is_some() && excluded {
                    faults.refuse(key(k), message);
                }
            }
        }
    }

    fn check_loads(&self, faults: &mut Faults) {
        for (name, spring) in self.springs.iter() {
            let key = format!("springs.{name}");
            let Some(is_rotary) = faults.keep(self.check_between(&key, spring.between())) else { continue };
            let wrong = if is_rotary { spring.free_length } else { spring.free_angle };
            if wrong.is_some() {
                let message = "a spring in a revolute joint or between two bodies has the key `free_angle`; all \
                               other springs have the key `free_length`";
                faults.refuse(&key, message);
            }
            faults.keep(check_spring(&key, spring, is_rotary));
            faults.keep(check_damper(&key, spring));
        }
        for (name, force) in self.forces.iter() {
            faults.keep(self.point(format_args!("forces.{name}.at"), &force.at));
        }
        for (name, torque) in self.torques.iter() {
            faults.keep(entry(format_args!("torques.{name}.on"), "bodies", &self.bodies, &torque.on));
        }
        for (name, marker) in self.markers.iter() {
            faults.keep(self.point(format_args!("markers.{name}.at"), &marker.at));
        }
        for (name, &value) in self.guess.iter() {
            let key = format_args!("guess.{name}");
            let (is_body, is_joint) = (self.bodies.get(name).is_some(), self.joints.get(name).is_some());
            let (range, unit) = if is_body { (Range::Turn, Unit::Radian) } else { (Range::Coordinate, Unit::Metre) };
            if let Some(carrier) = self.bodies.get(name).and_then(|body| body.fixed_to.as_ref()) {
                let message = format_args!(
                    "the body {name} is fixed to another body (point {carrier}): remove this key, and guess the angle \
                     of the body that carries {name}"
                );
                faults.refuse(key, message);
            } else if is_body || is_joint {
                faults.keep(range.check_in(unit, key, value));
            } else {
                let slides = self.joints.iter().filter(|(_, joint)| joint.slides());
                let moving = self.bodies.names().into_iter().filter(|name| *name != GROUND);
                let names: Vec<&str> = moving.chain(slides.map(|(name, _)| name)).collect();
                let allowed = alternatives("the bodies, prismatic joints and slots", &names, name);
                faults.refuse(key, format!("there is no body, prismatic joint or slot with this name; {allowed}"));
            }
        }
    }

    /// Two different points, one joint or two different bodies; whether a load there is a torque.
    fn check_between(&self, key: &str, place: Option<Between>) -> Result<bool, DefinitionError> {
        let Some(place) = place else { return refused(key, PLACES) };
        let body = |key: &str, name: &str| self.named_body(key, name).map(drop);
        match place {
            Between::Points([first, second]) => {
                let one = self.point(format_args!("{key}.first"), first)?;
                let other = self.point(format_args!("{key}.second"), second)?;
                if one == other {
                    return refused(
                        key,
                        "both ends are the same point, so the length is zero: give two different points",
                    );
                }
            }
            Between::Joint(joint) => self.named_joint(&format!("{key}.joint"), joint).map(drop)?,
            Between::Bodies([first, second]) => {
                body(&format!("{key}.first_body"), first)?;
                body(&format!("{key}.second_body"), second)?;
                if first == second {
                    return refused(key, "both keys name the same body, so the angle is zero: name two bodies");
                }
            }
        }
        Ok(place.is_rotary(&self.joints))
    }

    fn check_surfaces(&self, faults: &mut Faults) {
        if let (None, Some(name)) = (&self.air, self.surfaces.names().first()) {
            let message = "drag needs the density and flow of the air: add the key `air` to the mechanism file";
            faults.refuse(format_args!("surfaces.{name}"), message);
        }
        for (name, s) in self.surfaces.iter() {
            faults.keep(self.check_surface(name, s));
        }
    }

    fn check_surface(&self, name: &str, s: &Surface) -> Check {
        let key = |k: &str| format!("surfaces.{name}.{k}");
        match (&s.from, &s.to, s.width, &s.at, s.area) {
            (Some(from), Some(to), Some(_), None, None) => {
                let (first, a) = self.point(key("from"), from)?;
                let (second, b) = self.point(key("to"), to)?;
                if first != second || a == b {
                    return refused(key("to"), "`to` must be another point on the same body as `from`");
                }
                if s.surface_angle.is_some() {
                    return refused(
                        key("surface_angle"),
                        "only a surface with the keys `at` and `area` has this key: remove this key, because this \
                         surface lies along the line from `from` to `to`",
                    );
                }
                Ok(())
            }
            (None, None, None, Some(at), Some(_)) => self.point(key("at"), at).map(drop),
            _ => refused(
                format_args!("surfaces.{name}"),
                "give the keys `from`, `to` and `width`, or the keys `at` \
                and `area`",
            ),
        }
    }

    fn check_stops(&self, faults: &mut Faults) {
        for (name, s) in self.stops.iter() {
            faults.keep(self.check_stop(name, s));
        }
        for (name, lock) in self.locks.iter() {
            faults.keep(entry(format_args!("locks.{name}.stop"), "stops", &self.stops, &lock.stop));
            faults.keep(self.point(format_args!("locks.{name}.at"), &lock.at));
            if lock.engage_force.is_none() {
                continue;
            }
            let key = format_args!("locks.{name}.engage_force");
            if lock.release_force.is_some() {
                faults.refuse(key, "a lock cannot engage and release by force: remove engage_force or release_force");
            }
            if self.hydraulics.as_ref().is_some_and(|network| network.pressure_locks.get(name).is_some()) {
                faults.refuse(
                    key,
                    "a pressure lock of hydraulics already engages this lock: remove engage_force, or rename the lock",
                );
            }
        }
    }

    fn check_stop(&self, name: &str, s: &Stop) -> Check {
        let key = format!("stops.{name}");
        let has_ends = [&s.joint, &s.first, &s.second, &s.first_body, &s.second_body].iter().any(|end| end.is_some());
        let asked = match (&s.body, s.between()) {
            (Some(body), None) if !has_ends => {
                entry(format_args!("{key}.body"), "bodies", &self.bodies, body)?;
                "angle"
            }
            (None, Some(place)) => match (self.check_between(&key, Some(place))?, &s.joint) {
                (true, _) => "angle",
                (false, Some(_)) => "position",
                (false, None) => "length",
            },
            _ => return refused(key, format!("give the key \"body\", or {}", &PLACES[5..])),
        };
        let given = [("angle", s.angle), ("position", s.position), ("length", s.length)];
        if given.iter().any(|(k, value)| value.is_some() != (*k == asked)) {
            let others: Vec<&str> = given.iter().map(|(k, _)| *k).filter(|k| *k != asked).collect();
            return refused(key, format!("this stop must have the key {asked}, but neither {}", others.join(" nor ")));
        }
        let given = [("stiffness", s.stiffness != 0.0), ("damping", s.damping != 0.0), ("points", s.points.is_some())];
        for (k, is_given) in given {
            if s.rigid.is_none() && is_given {
                let message = "only a bumper has this key: remove this key, or add \"rigid\": false for a bumper (or \
                               \"rigid\": true, if a simulation tool will change the stop to a bumper)";
                return refused(format_args!("{key}.{k}"), message);
            }
        }
        check_bumper(&key, s)?;
        match &s.flag {
            Some(flag) => check_name(format_args!("{key}.flag"), flag),
            None => Ok(()),
        }
    }

    fn check_start(&self) -> Check {
        let s = &self.start;
        if s.equilibrium && self.hydraulics.is_some() {
            let message = "the oil of the hydraulic network holds the mechanism at any position: give a start \
                           position, or remove `hydraulics`";
            return refused("start.equilibrium", message);
        }
        if let (true, Some((_, drive, _))) = (s.equilibrium, self.hydraulic_drive()) {
            let message = format_args!(
                "the oil of actuators.{drive} holds the mechanism at any position: give a start position, and \
                 `start_pressure` of `chamber_a` and `chamber_b` so that the force equals {drive}.holding_force \
                 (`cargo fmu check` prints both forces), or remove `hydraulics`"
            );
            return refused("start.equilibrium", message);
        }
        match (&s.body, s.angle, &s.joint, s.position) {
            (None, None, None, None) if s.equilibrium && s.speed == 0.0 => Ok(()),
            (Some(body), Some(_), None, None) => entry("start.body", "bodies", &self.bodies, body).map(|_| ()),
            (None, None, Some(joint), Some(_)) => match entry("start.joint", "joints", &self.joints, joint)?.kind {
                JointKind::Prismatic | JointKind::Slot => Ok(()),
                JointKind::Revolute => {
                    let message = "the joint must be prismatic; for a revolute joint give the keys `body` and \
                        `angle`";
                    refused("start.joint", message)
                }
            },
            _ => refused(
                "start",
                "give the keys `body` and `angle`, or the keys `joint` and `position` (the key `speed` is optional, \
                 with the default 0), or write \"start\": \"equilibrium\"",
            ),
        }
    }
}
