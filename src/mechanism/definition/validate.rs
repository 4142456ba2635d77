//! Checks of a definition that need no geometry: numbers in range, names that resolve, keys that go together.
use super::{DefinitionError, GROUND, JointKind, Mechanism, Range, Solver};
use crate::numerics::decimal::Decimal;
use std::fmt;

type Check = Result<(), DefinitionError>;

fn key_error(key: impl Into<String>, message: impl Into<String>) -> DefinitionError {
    DefinitionError::Key { key: key.into(), message: message.into() }
}

/// Names become parts of variable names: letters, digits and underscores, a letter first.
fn check_name(key: &str, name: &str) -> Check {
    let mut letters = name.chars();
    let first = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    if first && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(());
    }
    let allowed = "a letter, then letters, digits or underscores".into();
    Err(DefinitionError::Value { key: key.into(), value: format!("\"{name}\""), allowed })
}

fn check_finite(key: String, value: f64) -> Check {
    if value.is_finite() {
        return Ok(());
    }
    Err(DefinitionError::Value { key, value: Decimal(value).to_string(), allowed: "a finite number".into() })
}

impl Mechanism {
    /// Check everything that can be told without geometry.
    pub(super) fn check(&mut self) -> Check {
        check_name("name", &self.name)?;
        if self.description.chars().any(char::is_control) {
            let (key, value) = ("description".into(), format!("\"{}\"", self.description));
            return Err(DefinitionError::Value { key, value, allowed: "one line of text".into() });
        }
        self.check_names()?;
        self.check_solver()?;
        let mut wrong = None;
        self.parameters(&mut |parameter, value| {
            if wrong.is_none() && !parameter.range.contains(*value) {
                wrong = Some(DefinitionError::Value {
                    key: parameter.key(),
                    value: Decimal(*value).to_string(),
                    allowed: parameter.range.text(),
                });
            }
        });
        if let Some(error) = wrong {
            return Err(error);
        }
        self.check_bodies()?;
        self.check_joints()?;
        self.check_loads()?;
        self.check_surfaces()?;
        self.check_stops()?;
        self.check_start()?;
        let e = self.experiment;
        for (key, value) in [("stop_time", e.stop_time), ("step_size", e.step_size)] {
            if !(value.is_finite() && value > 0.0) {
                let key = format!("experiment.{key}");
                return Err(DefinitionError::Value {
                    key,
                    value: Decimal(value).to_string(),
                    allowed: "a finite number > 0".into(),
                });
            }
        }
        Ok(())
    }

    /// A stated method has a step.
    fn check_solver(&mut self) -> Check {
        match self.solver.method {
            Some(_) => {
                self.solver.fem_step.get_or_insert(Solver::FEM_STEP);
                Ok(())
            }
            None if self.solver.fem_step.is_some() => {
                Err(key_error("solver.fem_step", "goes with solver.method only: add that key"))
            }
            None => Ok(()),
        }
    }

    fn check_names(&self) -> Check {
        let groups: [(&str, Vec<&str>); 10] = [
            ("bodies", self.bodies.names()),
            ("joints", self.joints.names()),
            ("actuators", self.actuators.names()),
            ("forces", self.forces.names()),
            ("torques", self.torques.names()),
            ("springs", self.springs.names()),
            ("markers", self.markers.names()),
            ("surfaces", self.surfaces.names()),
            ("stops", self.stops.names()),
            ("locks", self.locks.names()),
        ];
        for (group, names) in groups {
            for name in names {
                check_name(group, name)?;
            }
        }
        for (body, b) in self.bodies.iter() {
            for point in b.points.names() {
                check_name(&format!("bodies.{body}.points"), point)?;
                if point == "origin" || point == "end" {
                    let key = format!("bodies.{body}.points.{point}");
                    return Err(key_error(key, "every body has its own origin and end; choose another name"));
                }
            }
        }
        Ok(())
    }

    /// Body and local coordinates [m] of a point written `body.point`, under this key.
    ///
    /// # Errors
    /// The key with the names that there are.
    pub fn point(&self, key: impl fmt::Display, text: &str) -> Result<(usize, [f64; 2]), DefinitionError> {
        let unknown = |allowed: String| DefinitionError::Unknown { key: key.to_string(), name: text.into(), allowed };
        let Some((body, point)) = text.split_once('.') else {
            return Err(unknown("a point is written body.point, such as crank.end".into()));
        };
        let Some((index, b)) = self.bodies.find(body) else {
            return Err(unknown(format!("the bodies are {}", self.bodies.names().join(", "))));
        };
        match point {
            "origin" => Ok((index, [0.0, 0.0])),
            "end" => match b.length {
                Some(length) => Ok((index, [length, 0.0])),
                None => Err(unknown(format!("{body} has no length, so no end: give bodies.{body}.length"))),
            },
            _ => match b.points.get(point) {
                Some(&local) => Ok((index, local)),
                None => {
                    let mut names = vec!["origin"];
                    names.extend(b.length.map(|_| "end"));
                    names.extend(b.points.names());
                    Err(unknown(format!("the points of {body} are {}", names.join(", "))))
                }
            },
        }
    }

    fn check_bodies(&self) -> Check {
        if self.bodies.get(GROUND).is_none() {
            return Err(key_error("bodies", "there is no body `ground`, the one that does not move: add it"));
        }
        for (name, body) in self.bodies.iter() {
            let key = |k: &str| format!("bodies.{name}.{k}");
            let given = [
                ("fixed_to", body.fixed_to.is_some()),
                ("mass", body.mass.is_some()),
                ("shape", body.shape.is_some()),
                ("center", body.center.is_some()),
                ("inertia", body.inertia.is_some()),
                ("axial_stiffness", body.axial_stiffness.is_some()),
            ];
            if name == GROUND
                && let Some((k, _)) = given.iter().find(|(_, there)| *there)
            {
                return Err(key_error(key(k), "the ground does not move: it has only length and points"));
            }
            if let (Some(_), Some(to)) = (body.axial_stiffness, &body.fixed_to) {
                let other = to.split('.').next().unwrap_or_default();
                let message =
                    format!("{name} is part of {other}: state the axial stiffness of the body that they are fixed to");
                return Err(key_error(key("axial_stiffness"), message));
            }
            if body.angle.is_some() && body.fixed_to.is_none() {
                return Err(key_error(key("angle"), "goes with fixed_to only; a moving body's angle is in guess"));
            }
            if body.shape.is_some() {
                if body.length.is_none() {
                    return Err(key_error(key("shape"), "a uniform_rod needs a length"));
                }
                if body.center.is_some() || body.inertia.is_some() {
                    return Err(key_error(key("shape"), "a uniform_rod has its own center and inertia: remove them"));
                }
            }
            if let Some(to) = &body.fixed_to {
                self.check_chain(name, to)?;
            }
        }
        Ok(())
    }

    /// A chain of fixed_to ends at a body that is not fixed.
    fn check_chain(&self, name: &str, to: &str) -> Check {
        let key = format!("bodies.{name}.fixed_to");
        let mut next = to.to_string();
        for _ in 0..=self.bodies.len() {
            let (index, _) = self.point(&key, &next)?;
            match self.bodies.iter().nth(index).and_then(|(_, b)| b.fixed_to.clone()) {
                Some(further) => next = further,
                None => return Ok(()),
            }
        }
        Err(key_error(key, "the bodies are fixed to one another in a circle"))
    }

    fn check_joints(&self) -> Check {
        for (name, joint) in self.joints.iter() {
            let key = |k: &str| format!("joints.{name}.{k}");
            self.point(key("first"), &joint.first)?;
            self.point(key("second"), &joint.second)?;
            if joint.kind == JointKind::Revolute {
                for (k, value) in [("axis_angle", joint.axis_angle), ("angle", joint.angle)] {
                    if value.is_some() {
                        return Err(key_error(key(k), "goes with a prismatic joint only"));
                    }
                }
            } else if joint.pin_radius.is_some() {
                return Err(key_error(key("pin_radius"), "goes with a revolute joint only"));
            }
            let own =
                [("static_coefficient", joint.static_coefficient), ("kinetic_coefficient", joint.kinetic_coefficient)];
            for (k, value) in own {
                if value.is_some() && self.friction.is_none() {
                    return Err(key_error(key(k), "there is no friction that it could change: add the key friction"));
                }
            }
        }
        Ok(())
    }

    fn check_loads(&self) -> Check {
        if let Some(g) = &self.gravity {
            check_finite("gravity.load_factor".into(), g.load_factor)?;
        }
        for (name, a) in self.actuators.iter() {
            let key = format!("actuators.{name}");
            let is_rotary = self.check_ends(&key, &a.first, &a.second, &a.joint)?;
            let (asked, other) = if is_rotary { ("torque", a.force) } else { ("force", a.torque) };
            if other.is_some() {
                return Err(key_error(
                    key,
                    format!("give {asked}: a drive in a revolute joint has a torque, any other a force"),
                ));
            }
            check_finite(format!("{key}.{asked}"), a.force.or(a.torque).unwrap_or(0.0))?;
        }
        for (name, spring) in self.springs.iter() {
            let key = format!("springs.{name}");
            let is_rotary = self.check_ends(&key, &spring.first, &spring.second, &spring.joint)?;
            let wrong = if is_rotary { spring.free_length } else { spring.free_angle };
            if wrong.is_some() {
                let message = "a spring in a revolute joint has a free_angle, any other a free_length";
                return Err(key_error(key, message));
            }
        }
        for (name, force) in self.forces.iter() {
            self.point(format_args!("forces.{name}.at"), &force.at)?;
            check_finite(format!("forces.{name}.force[0]"), force.force[0])?;
            check_finite(format!("forces.{name}.force[1]"), force.force[1])?;
        }
        for (name, torque) in self.torques.iter() {
            self.check_body(format!("torques.{name}.on"), &torque.on)?;
            check_finite(format!("torques.{name}.torque"), torque.torque)?;
        }
        for (name, marker) in self.markers.iter() {
            self.point(format_args!("markers.{name}.at"), &marker.at)?;
        }
        for (name, &value) in self.guess.iter() {
            let range = if self.bodies.get(name).is_some() { Range::Turn } else { Range::Coordinate };
            if !range.contains(value) {
                let (key, value) = (format!("guess.{name}"), Decimal(value).to_string());
                return Err(DefinitionError::Value { key, value, allowed: range.text() });
            }
        }
        Ok(())
    }

    /// Two different points, or one joint; whether it is a revolute joint.
    fn check_ends(
        &self,
        key: &str,
        first: &Option<String>,
        second: &Option<String>,
        joint: &Option<String>,
    ) -> Result<bool, DefinitionError> {
        match (first, second, joint) {
            (Some(first), Some(second), None) => {
                let one = self.point(format_args!("{key}.first"), first)?;
                let other = self.point(format_args!("{key}.second"), second)?;
                if one == other {
                    return Err(key_error(key, "its two ends are one point, so its length is zero: name two points"));
                }
                Ok(false)
            }
            (None, None, Some(joint)) => match self.joints.get(joint) {
                Some(j) => Ok(j.kind == JointKind::Revolute),
                None => {
                    let allowed = format!("the joints are {}", self.joints.names().join(", "));
                    let key = format!("{key}.joint");
                    Err(DefinitionError::Unknown { key, name: joint.clone(), allowed })
                }
            },
            _ => Err(key_error(key, "give first and second, or joint")),
        }
    }

    fn check_body(&self, key: String, name: &str) -> Check {
        if self.bodies.get(name).is_some() {
            return Ok(());
        }
        let allowed = format!("the bodies are {}", self.bodies.names().join(", "));
        Err(DefinitionError::Unknown { key, name: name.into(), allowed })
    }

    fn check_surfaces(&self) -> Check {
        if let Some(air) = &self.air {
            check_finite("air.airspeed".into(), air.airspeed)?;
        } else if let Some(name) = self.surfaces.names().first() {
            return Err(key_error(
                format!("surfaces.{name}"),
                "there is no air that could drag on it: add the key air",
            ));
        }
        for (name, s) in self.surfaces.iter() {
            let key = |k: &str| format!("surfaces.{name}.{k}");
            match (&s.from, &s.to, s.width, &s.at, s.area) {
                (Some(from), Some(to), Some(_), None, None) => {
                    let (first, a) = self.point(key("from"), from)?;
                    let (second, b) = self.point(key("to"), to)?;
                    if first != second || a == b {
                        return Err(key_error(key("to"), "must be another point of the same body as `from`"));
                    }
                    if s.surface_angle.is_some() {
                        return Err(key_error(key("surface_angle"), "goes with an area; a strip lies along its line"));
                    }
                }
                (None, None, None, Some(at), Some(_)) => {
                    self.point(key("at"), at)?;
                }
                _ => return Err(key_error(format!("surfaces.{name}"), "give from, to and width, or at and area")),
            }
        }
        Ok(())
    }

    fn check_stops(&self) -> Check {
        for (name, s) in self.stops.iter() {
            let key = |k: &str| format!("stops.{name}.{k}");
            let asked = match (&s.body, &s.joint, &s.first, &s.second) {
                (Some(body), None, None, None) => {
                    self.check_body(key("body"), body)?;
                    "angle"
                }
                (None, Some(_), None, None) | (None, None, Some(_), Some(_)) => {
                    let is_rotary = self.check_ends(&format!("stops.{name}"), &s.first, &s.second, &s.joint)?;
                    if is_rotary {
                        "angle"
                    } else if s.joint.is_some() {
                        "position"
                    } else {
                        "length"
                    }
                }
                _ => return Err(key_error(format!("stops.{name}"), "give body, or joint, or first and second")),
            };
            let given = [("angle", s.angle), ("position", s.position), ("length", s.length)];
            if given.iter().any(|(k, value)| value.is_some() != (*k == asked)) {
                return Err(key_error(format!("stops.{name}"), format!("give {asked}, and no other value")));
            }
            if let Some(flag) = &s.flag {
                check_name(&key("flag"), flag)?;
            }
        }
        for (name, lock) in self.locks.iter() {
            if self.stops.get(&lock.stop).is_none() {
                let allowed = match self.stops.names() {
                    names if names.is_empty() => "there are no stops: add the key stops".into(),
                    names => format!("the stops are {}", names.join(", ")),
                };
                return Err(DefinitionError::Unknown {
                    key: format!("locks.{name}.stop"),
                    name: lock.stop.clone(),
                    allowed,
                });
            }
            self.point(format_args!("locks.{name}.at"), &lock.at)?;
        }
        Ok(())
    }

    fn check_start(&self) -> Check {
        let s = &self.start;
        match (&s.body, s.angle, &s.joint, s.position) {
            (Some(body), Some(_), None, None) => self.check_body("start.body".into(), body),
            (None, None, Some(joint), Some(_)) => match self.joints.get(joint) {
                Some(j) if j.kind == JointKind::Prismatic => Ok(()),
                Some(_) => {
                    Err(key_error("start.joint", "must be a prismatic joint; state a revolute one by body and angle"))
                }
                None => {
                    let allowed = format!("the joints are {}", self.joints.names().join(", "));
                    Err(DefinitionError::Unknown { key: "start.joint".into(), name: joint.clone(), allowed })
                }
            },
            _ => Err(key_error("start", "give body and angle, or joint and position (and speed, 0 where absent)")),
        }
    }
}
