//! Warnings about a definition that needs no geometry to be suspected: keys that do nothing together, and numbers that
//! look as if they were in another unit.
//!
//! In: a definition as read, before its flags have their defaults. Out: warnings. It must not know how loops are
//! closed.
use super::validate::idle_keys;
use super::{GROUND, Mechanism};
use super::{JointKind, Range, Unclear};
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::hydraulics::plausibility::circuit_warnings;
use crate::inspection::Finding;
use crate::numerics::decimal::Decimal;
use crate::numerics::order::sorted;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Largest direction that is taken for radians: a whole turn, and what rounding adds [rad].
const DIRECTION: f64 = TAU + 0.01;
/// Largest angle of a guess, a start or a stop that is taken for radians: two turns [rad].
const ANGLE: f64 = 2.0 * TAU;
/// Ratio of neighbouring lengths, and of all lengths, from which some are taken for millimetres beside metres.
const APART: [f64; 2] = [100.0, 300.0];
/// Gravity that no planet of the Sun has [m/s2].
const GRAVITY: f64 = 100.0;
/// Size of a body from which on millimetres are suspected [m].
const HUGE: f64 = 150.0;
/// Size of a body from which on millimetres are suspected if it is thin [m].
const LONG: f64 = 10.0;
/// Mass for each metre of a body below which it is thin [kg/m].
const THIN: f64 = 0.05;
/// Moment of inertia over mass and squared size from which on another unit is suspected.
const STOUT: f64 = 100.0;
/// Distance of a centre of mass from the middle of its body's points that is far, in sizes of the body.
const FAR: f64 = 3.0;

impl Mechanism {
    /// Warnings about the definition as it stands in the file. To be asked before [`Self::flags`], which gives flags
    /// that the file leaves out their defaults.
    pub fn warnings(&self) -> Vec<Finding> {
        let mut all = Vec::new();
        self.warn_of_friction(&mut all);
        self.warn_of_stops(&mut all);
        self.warn_of_springs(&mut all);
        self.warn_of_curves(&mut all);
        self.warn_of_tables(&mut all);
        self.warn_of_start_speed(&mut all);
        self.warn_of_masses(&mut all);
        all.extend(self.experiment.coarse().map(|(key, message, remedy)| Finding::warning(key, message, remedy)));
        self.warn_of_bodies(&mut all);
        self.warn_of_angles(&mut all);
        self.warn_of_lengths(&mut all);
        self.warn_of_sizes(&mut all);
        self.warn_of_hydraulics(&mut all);
        self.warn_of_expressions(&mut all);
        all
    }

    /// Expressions, which are in SI units, among numbers in other units.
    fn warn_of_expressions(&self, all: &mut Vec<Finding>) {
        let mut parameters = Vec::new();
        if !self.expressions.is_empty() {
            self.clone().parameters(&mut |parameter, value| parameters.push((parameter.unit, *value)));
        }
        let of_parameters = self.expressions.iter().filter_map(|one| one.unclear(&parameters));
        for Unclear { key, text, value, file_unit: unit } in of_parameters.chain(self.unclear.iter().cloned()) {
            let number = Decimal::rounded(value);
            let (si, remedy) = match unit {
                "mm" => ("m", String::new()),
                _ => ("rad", format!("write \"rad({text})\" if you mean {number} {unit}, or ")),
            };
            let message = format_args!(
                "\"{text}\" is {number} {si}: expressions are in SI units, but numbers of this file are in {unit}"
            );
            let remedy = match text.trim().parse::<f64>() {
                Ok(number) => format!("remove the quotes if you mean {} {unit}", Decimal(number)),
                Err(_) => {
                    format!("{remedy}define the numbers in \"parameters\", in {si} and each with \"unit\": \"{si}\"")
                }
            };
            all.push(Finding::warning(&key, message, remedy));
        }
    }

    fn warn_of_friction(&self, all: &mut Vec<Finding>) {
        let Some(friction) = &self.friction else { return };
        match friction.enabled {
            None => all.push(Finding::warning(
                "friction",
                "the key `enabled` is missing, so the joints have no friction",
                "add \"enabled\": true; or write \"enabled\": false if a simulation tool enables the friction during \
                 the run",
            )),
            Some(false) => {}
            Some(true) => {
                let rubs = |joint: &super::Joint| joint.pin_radius.is_some() || joint.kind != JointKind::Revolute;
                if !self.joints.iter().any(|(_, joint)| rubs(joint)) {
                    let remedy = "give the key `pin_radius` for the joints with friction";
                    let message = "friction is enabled, but no joint has friction: no revolute joint has a \
                                   `pin_radius`, and there is no prismatic joint or slot";
                    all.push(Finding::warning("friction.enabled", message, remedy));
                }
            }
        }
    }

    fn warn_of_stops(&self, all: &mut Vec<Finding>) {
        for (name, stop) in self.stops.iter() {
            let has_curve = stop.points.iter().flatten().any(|[_, push]| *push != 0.0);
            let pushes = stop.stiffness != 0.0 || stop.damping != 0.0 || has_curve;
            match stop.rigid {
                Some(false) if !pushes => all.push(Finding::warning(
                    format_args!("stops.{name}"),
                    "this stop is a bumper without stiffness, damping and points, so the stop never pushes",
                    "add the key `stiffness`, or write \"rigid\": true",
                )),
                Some(true) if pushes => all.push(Finding::warning(
                    format_args!(
                        "stops.{name}.{}",
                        match stop {
                            _ if stop.stiffness != 0.0 => "stiffness",
                            _ if stop.damping != 0.0 => "damping",
                            _ => "points",
                        }
                    ),
                    "this key has no effect while the stop is rigid",
                    "write \"rigid\": false for a bumper",
                )),
                _ => {}
            }
        }
    }

    fn warn_of_springs(&self, all: &mut Vec<Finding>) {
        for (name, spring) in self.springs.iter() {
            let forces = [Some(spring.stiffness), spring.damping, spring.preload];
            let is_linear = spring.points.is_none() && spring.gas.is_none() && spring.damping_points.is_none();
            if is_linear && forces.into_iter().flatten().all(|value| value == 0.0) {
                let message = "this spring has no stiffness, damping or preload, so the spring exerts no force";
                all.push(Finding::warning(
                    format_args!("springs.{name}"),
                    message,
                    "add the key `stiffness`, or remove the spring",
                ));
            }
        }
    }

    fn warn_of_bodies(&self, all: &mut Vec<Finding>) {
        for (name, body) in self.bodies.iter() {
            if body.shape.is_some() && body.mass.is_none() {
                let message = "this key describes the mass distribution, but the body has no mass";
                let remedy = "add the key `mass` to the body";
                all.push(Finding::warning(format_args!("bodies.{name}.shape"), message, remedy));
            }
            let Some([x, y]) = body.center else { continue };
            // The middle of the box round the body's points, and the box's diagonal.
            let ends = body.length.map(|length| [length, 0.0]).into_iter();
            let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
            for point in ends.chain(body.points.iter().map(|(_, point)| *point)) {
                for axis in 0..2 {
                    (low[axis], high[axis]) = (low[axis].min(point[axis]), high[axis].max(point[axis]));
                }
            }
            let size = (high[0] - low[0]).hypot(high[1] - low[1]);
            let away = (x - 0.5 * (low[0] + high[0])).hypot(y - 0.5 * (low[1] + high[1]));
            if size > 0.0 && away > FAR * size {
                let message = format_args!(
                    "the centre of mass is {} m away from the middle of the body, but the points of the body are at \
                     most {} m apart",
                    Decimal::rounded(away),
                    Decimal::rounded(size)
                );
                let unit = if self.file_units.has_millimetres() { "mm" } else { "m" };
                let remedy = format_args!("check the unit: lengths are in {unit}, in the frame of the body");
                all.push(Finding::warning(format_args!("bodies.{name}.center"), message, remedy));
            }
        }
    }

    fn warn_of_angles(&self, all: &mut Vec<Finding>) {
        if self.file_units.has_degrees() {
            // Who states degrees means no radians.
            return;
        }
        let mut warn = |path: &dyn fmt::Display, value: Option<f64>, most: f64| {
            let Some(value) = value.filter(|value| value.abs() > most && Range::Turn.contains(*value)) else { return };
            let message = format_args!(
                "{} rad is {} turns",
                Decimal::rounded(value),
                Decimal((100.0 * value / TAU).round() / 100.0)
            );
            let (degrees, radians) = (Decimal(value), Decimal::rounded(value * PI / 180.0));
            let remedy = format_args!(
                "if you mean {degrees} degrees, write {radians} rad or add \"units\": {{ \"angle\": \"deg\" }}"
            );
            all.push(Finding::warning(path, message, remedy));
        };
        warn(&"gravity.up_angle", self.gravity.as_ref().map(|gravity| gravity.up_angle), DIRECTION);
        warn(&"air.flow_angle", self.air.as_ref().map(|air| air.flow_angle), DIRECTION);
        for (name, body) in self.bodies.iter() {
            warn(&format_args!("bodies.{name}.angle"), body.angle, DIRECTION);
        }
        for (name, joint) in self.joints.iter() {
            warn(&format_args!("joints.{name}.axis_angle"), joint.axis_angle, DIRECTION);
            warn(&format_args!("joints.{name}.angle"), joint.angle, DIRECTION);
        }
        for (name, surface) in self.surfaces.iter() {
            warn(&format_args!("surfaces.{name}.surface_angle"), surface.surface_angle, DIRECTION);
        }
        for (name, stop) in self.stops.iter() {
            warn(&format_args!("stops.{name}.angle"), stop.angle, ANGLE);
        }
        for (name, value) in self.guess.iter().filter(|(name, _)| self.bodies.get(name).is_some()) {
            warn(&format_args!("guess.{name}"), Some(*value), ANGLE);
        }
        warn(&"start.angle", self.start.angle, ANGLE);
    }

    /// Millimetres beside metres: bodies, told by the largest distance of a point from the origin, in two groups far
    /// apart.
    fn warn_of_lengths(&self, all: &mut Vec<Finding>) {
        let mut sizes: Vec<(f64, &str)> = Vec::new();
        for (name, body) in self.bodies.iter() {
            let points = body.points.iter().map(|(_, [x, y])| x.hypot(*y));
            let size = points.chain(body.length).fold(0.0, f64::max);
            if size > 0.0 && size.is_finite() {
                sizes.push((size, name));
            }
        }
        let sizes = sorted(sizes, |(size, _)| *size);
        let (Some(first), Some(last)) = (sizes.first(), sizes.last()) else { return };
        let gap = sizes.windows(2).map(|pair| (pair[1].0 / pair[0].0, pair[1])).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((ratio, above)) = gap.filter(|(ratio, _)| *ratio >= APART[0] && last.0 / first.0 >= APART[1]) {
            let message = format_args!(
                "{} is {} m long, {} times as long as the next smaller body",
                above.1,
                Decimal::rounded(above.0),
                Decimal::rounded(ratio.round())
            );
            let remedy = match self.file_units.has_millimetres() {
                true => "check the units: all lengths of this file are in millimetres",
                false => {
                    "check whether some lengths are in millimetres and others in metres; with \"units\": { \
                     \"length\": \"mm\" } all lengths of the file are in mm"
                }
            };
            all.push(Finding::warning(format_args!("bodies.{}", above.1), message, remedy));
        }
    }

    /// Numbers that look as if they were in another unit, whatever stands beside them: a gravity in mm/s2, a mechanism
    /// as large as a bridge, a moment of inertia that no body of this size has.
    fn warn_of_sizes(&self, all: &mut Vec<Finding>) {
        let acceleration = self.gravity.as_ref().map_or(0.0, |gravity| gravity.acceleration);
        if acceleration.abs() > GRAVITY {
            let message = format_args!(
                "the acceleration is {} m/s2, but the gravity of the Earth is 9.81 m/s2",
                Decimal::rounded(acceleration)
            );
            all.push(Finding::warning(
                "gravity.acceleration",
                message,
                "write the value in m/s2, also in a file with another unit of length",
            ));
        }
        let mut largest = (0.0_f64, "");
        for (name, body) in self.bodies.iter() {
            let points = body.points.iter().map(|(_, [x, y])| x.hypot(*y));
            let size = points.chain(body.length).fold(0.0, f64::max);
            if size > largest.0 && name != GROUND {
                largest = (size, name);
            }
            let (mass, inertia) = (body.mass.unwrap_or(0.0), body.inertia.unwrap_or(0.0));
            if mass > 0.0 && size > 0.0 && inertia > STOUT * mass * size * size {
                let radius = (inertia / mass).sqrt();
                let message = format_args!(
                    "the moment of inertia is {} kg.m2: the radius of gyration is {} m in a body of {} m",
                    Decimal::rounded(inertia),
                    Decimal::rounded(radius),
                    Decimal::rounded(size)
                );
                let remedy = "write the value in kg.m2, about the centre of mass (1e6 kg.mm2 are 1 kg.m2)";
                all.push(Finding::warning(format_args!("bodies.{name}.inertia"), message, remedy));
            }
        }
        let mass = self.bodies.get(largest.1).and_then(|body| body.mass).unwrap_or(0.0);
        let is_thin = largest.0 > LONG && mass > 0.0 && mass < THIN * largest.0;
        if largest.0 > HUGE || is_thin {
            let of_mass = if is_thin { format!(" and has {} kg", Decimal::rounded(mass)) } else { String::new() };
            let message = format_args!("the body is {} m long{of_mass}", Decimal::rounded(largest.0));
            let remedy = match self.file_units.has_millimetres() {
                true => "check the lengths of the body, which are in mm",
                false => "if you mean millimetres, add \"units\": { \"length\": \"mm\" }",
            };
            all.push(Finding::warning(format_args!("bodies.{}", largest.1), message, remedy));
        }
    }

    /// The warning about a pressure lock of a network that operates no lock, where a lock has no pressure lock.
    fn idle_pressure_lock(&self, network: &HydraulicSystem, name: &str) -> Option<Finding> {
        if self.locks.get(name).is_some() {
            return None;
        }
        let mut others = self.locks.names();
        others.retain(|other| network.pressure_locks.get(other).is_none());
        let (first, more) = others.split_first()?;
        let message = format_args!(
            "no lock of the mechanism has this name, so this pressure lock operates no lock; locks without a pressure \
             lock: {first}{}",
            more.iter().map(|other| format!(", {other}")).collect::<String>()
        );
        let remedy = "give the pressure lock the name of the lock that it operates";
        Some(Finding::warning(format_args!("hydraulics.pressure_locks.{name}"), message, remedy))
    }

    pub(super) fn warn_of_circuit(&self, all: &mut Vec<Finding>) {
        if let Some(network) = &self.hydraulics {
            let own = network.warnings().into_iter().filter(|finding| !finding.path.starts_with("experiment"));
            all.extend(own.map(|finding| Finding { path: format!("hydraulics.{}", finding.path), ..finding }));
            all.extend(idle_keys(network).into_iter().map(|path| {
                let message = "this key has no effect in a mechanism, which states the motion of its cylinders and the \
                               settings of the integration";
                Finding::warning(format_args!("hydraulics.{path}"), message, "remove this key")
            }));
            all.extend(
                network.pressure_locks.names().into_iter().filter_map(|name| self.idle_pressure_lock(network, name)),
            );
        }
        let Some((_, drive, circuit)) = self.hydraulic_drive() else { return };
        let mut values = vec![
            ("supply.pressure".to_owned(), circuit.supply.pressure),
            ("tank.pressure".into(), circuit.tank.pressure),
        ];
        circuit.clone().parameters(&mut |parameter, value| values.push((parameter.name.concat(), *value)));
        let value = |name: &str| values.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
        all.extend(circuit_warnings(&format!("actuators.{drive}.hydraulics."), value));
    }
}
