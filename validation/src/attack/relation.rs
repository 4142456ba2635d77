//! Relation between the outputs of a rewritten mechanism and those of the original.
//!
//! In: name and unit of an output, the outputs of the other mechanism. Out: the expected value. Must not know how the
//! other definition was made.
use linkage_fmu::variables::Unit;
use std::collections::BTreeMap;

/// Least magnitude of the limit of a drive without a stop [m or rad].
const NO_LIMIT: f64 = 1e30;

/// Relation between the outputs of another definition and those of the original.
pub enum Relation {
    /// Identical; not checked for names with one of these prefixes.
    Same(Vec<String>),
    /// Identical except for the reactions of the joint with this name.
    Exchanged { joint: String, is_revolute: bool },
    /// The body with this name is fixed at an angle to another one.
    Chained { body: String, base: String, angle: f64 },
    /// Positions are identical to within ten times this tolerance of the integration.
    Loose(f64),
    /// Elements have other names.
    Renamed(BTreeMap<String, String>),
    /// Mass, length and time have these units [kg, m, s].
    Scaled([f64; 3]),
    /// The Y axis has the opposite direction.
    Mirrored,
    /// Rotated by an angle about the origin, then displaced; these bodies rotate.
    Moved { angle: f64, by: [f64; 2], bodies: Vec<String> },
}

impl Relation {
    /// Value of an output from the outputs of the other definition; None where it is not checked.
    pub fn expected(&self, name: &str, unit: Unit, get: &mut dyn FnMut(&str) -> Option<f64>) -> Option<f64> {
        let (owner, quantity) = name.split_once('.')?;
        // Rounding decides how many of the last bounces on a stop are distinguished.
        if ["impact_count", "impact_impulse"].contains(&quantity) && !matches!(self, Self::Same(_)) {
            return None;
        }
        let is_limit = ["lower_limit", "upper_limit"].contains(&quantity);
        match self {
            Self::Same(without) => {
                if without.iter().any(|start| name.starts_with(start)) {
                    None
                } else {
                    get(name)
                }
            }
            Self::Loose(_) => {
                let is_position = ["angle", "position", "length", "x", "y"].contains(&quantity);
                if is_position { get(name) } else { None }
            }
            Self::Exchanged { joint, is_revolute } if owner == joint => match quantity {
                "force_x" | "force_y" | "friction_torque" => Some(-get(name)?),
                "slip_speed" if *is_revolute => Some(-get(name)?),
                // The torque refers to another point.
                "torque" => None,
                _ => get(name),
            },
            // The axis has the opposite direction, and with it the forward direction of a rack.
            Self::Exchanged { is_revolute: false, .. } if ["transmitted_force", "loss_force"].contains(&quantity) => {
                None
            }
            Self::Exchanged { .. } => get(name),
            Self::Chained { body, base, angle } if owner == body => {
                Some(get(&format!("{base}.{quantity}"))? + if quantity == "angle" { *angle } else { 0.0 })
            }
            Self::Chained { .. } => get(name),
            Self::Renamed(names) => get(&format!("{}.{quantity}", names.get(owner).map_or(owner, String::as_str))),
            // A drive without a stop has infinite limits.
            Self::Scaled(_) if is_limit && get(name)?.abs() >= NO_LIMIT => None,
            Self::Scaled(units) => Some(get(name)? / factor(unit, *units)),
            Self::Mirrored => {
                // Forward and backward are exchanged, as is the forward direction of a wheel.
                if quantity.ends_with("ward") || ["transmitted_force", "loss_torque"].contains(&quantity) {
                    return None;
                }
                let turns = [Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared, Unit::NewtonMetre];
                let odd = [Unit::KilogramSquareMetrePerRadian].contains(&unit) || turns.contains(&unit);
                let is_y = quantity == "y" || quantity.ends_with("_y");
                let of_pin = quantity == "slip_speed";
                Some(if of_pin {
                    get(name)?.abs()
                } else if is_limit && odd {
                    let other = if quantity == "lower_limit" { "upper_limit" } else { "lower_limit" };
                    -get(&format!("{owner}.{other}"))?
                } else if odd || is_y {
                    -get(name)?
                } else {
                    get(name)?
                })
            }
            Self::Moved { angle, by, bodies } => {
                if quantity == "angle" && bodies.iter().any(|body| body == owner) {
                    return Some(get(name)? - angle);
                }
                let (stem, is_y) = match (quantity.strip_suffix('x'), quantity.strip_suffix('y')) {
                    (Some(stem), _) if stem.is_empty() || stem.ends_with('_') => (stem, false),
                    (_, Some(stem)) if stem.is_empty() || stem.ends_with('_') => (stem, true),
                    _ => return get(name),
                };
                let mut part = |axis: &str| get(&format!("{owner}.{stem}{axis}"));
                let (mut x, mut y) = (part("x")?, part("y")?);
                if stem.is_empty() {
                    (x, y) = (x - by[0], y - by[1]);
                }
                let (sin, cos) = angle.sin_cos();
                Some(if is_y { y * cos - x * sin } else { x * cos + y * sin })
            }
        }
    }
}

/// Value in these units [kg, m, s] of 1 in SI units.
pub fn factor(unit: Unit, units: [f64; 3]) -> f64 {
    let base = unit.base();
    units.iter().zip(base).map(|(own, (_, power))| own.powi(power.into())).product()
}
