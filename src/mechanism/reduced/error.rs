//! Errors of reduction.
use crate::mechanism::closure::AssemblyError;
use crate::mechanism::curve::CurveError;
use crate::mechanism::definition::DefinitionError;
use crate::numerics::decimal::Decimal;
use std::f64::consts::TAU;
use std::fmt;

/// Error of reduction.
#[derive(Clone, Debug, PartialEq)]
pub enum ReductionError {
    /// The definition contradicts itself.
    Definition(DefinitionError),
    /// The linkage cannot be assembled.
    Assembly(AssemblyError),
    /// The curve cannot be traced.
    Curve(CurveError),
    /// The two ends of an actuator or a spring coincide somewhere, so that its force has no direction.
    EndsMeet {
        /// Name of the actuator or spring.
        name: String,
        /// Coordinates by name.
        position: String,
    },
    /// The gas of a gas spring has no volume somewhere, so that its force is infinite.
    NoVolume {
        /// Name of the spring.
        name: String,
        /// Length or position at which the volume is 0 [m].
        least: f64,
        /// Coordinates by name.
        position: String,
    },
    /// A function along the curve is not smooth.
    Table {
        /// Name of the function.
        what: String,
        /// Coordinates by name.
        position: String,
    },
    /// The stated start is not on the curve.
    Start {
        /// Name of the variable that states the start.
        name: String,
        /// Value of the variable.
        value: f64,
        /// Least and largest value within the stops on the curve.
        range: (f64, f64),
        /// Value in this range that differs from the stated one by whole revolutions, if any.
        turned: Option<f64>,
    },
    /// The stated coordinate never moves: its loop is rigid.
    Rigid {
        /// Name of the variable that states the start.
        name: String,
        /// Value of the variable.
        value: f64,
        /// The one value that the coordinate has.
        held: f64,
        /// Names of the coordinates that move.
        moving: Vec<String>,
    },
    /// The stated coordinate does not move at this position, so it cannot have the stated speed.
    StartSpeed {
        /// Name of the variable that states the speed.
        name: String,
        /// Value of the variable.
        value: f64,
    },
}

impl fmt::Display for ReductionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definition(e) => e.fmt(f),
            Self::Assembly(e) => e.fmt(f),
            Self::Curve(e) => e.fmt(f),
            Self::EndsMeet { name, position } => write!(
                f,
                "{name}: both ends are at the same place near {position}, where the force has no direction; move \
                 one of the attachment points, or add a stop before this position"
            ),
            Self::NoVolume { name, least, position } => write!(
                f,
                "{name}: at {position} the length is {} m, at which the gas volume is zero; increase the gas volume, \
                 or add a stop before this position",
                Decimal::rounded(*least)
            ),
            Self::Table { what, position } => write!(
                f,
                "{what} is not a smooth function of the position near {position}, because almost no mass moves there; \
                    add a mass or an inertia to a body that moves at this position"
            ),
            Self::Start { name, value, range: (low, high), turned } => {
                let [value, low, high] = [*value, *low, *high].map(Decimal::rounded);
                let unit = unit_of(name);
                write!(
                    f,
                    "{name} = {value}{unit} cannot be reached: the linkage moves from {low}{unit} to {high}{unit}"
                )?;
                let is_angle = unit == " rad" && (low.0..=high.0).contains(&value.0.to_radians());
                let degrees = if is_angle { if_degrees(value.0) } else { String::new() };
                f.write_str(&degrees)?;
                let Some(same) = turned else { return Ok(()) };
                write!(f, "; {}{unit} is the same position", Decimal::rounded(*same))?;
                f.write_str(if degrees.is_empty() { ": write this value" } else { "" })
            }
            Self::Rigid { name, value, held, moving } => {
                let unit = unit_of(name);
                let (owner, held) = (name.split('.').next().unwrap_or_default(), Decimal::rounded(*held));
                write!(
                    f,
                    "{name} = {}{unit} cannot be reached: the joints or couplings of a rigid loop hold {owner} at \
                     {held}{unit}, while {} move{} freely; remove a joint or a coupling of the rigid loop, or add a \
                     body to this loop; then constrain the bodies and joints that move freely",
                    Decimal(*value),
                    moving.join(", "),
                    if moving.len() == 1 { "s" } else { "" }
                )
            }
            Self::StartSpeed { name, value } => write!(
                f,
                "{name} = {} is not possible: at this position this coordinate does not move (dead centre or rigid \
                 loop); give the start position of another body",
                Decimal(*value)
            ),
        }
    }
}

impl std::error::Error for ReductionError {}

/// Unit of a start value, after a blank, from the name of the variable that states it.
fn unit_of(name: &str) -> &'static str {
    match name.rsplit_once(".start_") {
        Some((_, "angle")) => " rad",
        Some((_, "position")) => " m",
        _ => "",
    }
}

/// The remedy for an angle [rad] of more than two turns, which may be in degrees; empty for others.
pub fn if_degrees(angle: f64) -> String {
    if angle.abs() <= 2.0 * TAU {
        return String::new();
    }
    let [degrees, radians] = [angle, angle.to_radians()].map(Decimal::rounded);
    format!(
        "; if you mean {degrees} degrees, write {degrees}deg after --start-values, or the number {radians} in a \
         definition file whose angles are in rad"
    )
}

impl ReductionError {
    /// The error for a start that is stated by another quantity, which differs from the coordinate by a constant and
    /// has the value `stated` at the start.
    pub fn as_stated(mut self, stated: f64) -> Self {
        if let Self::Rigid { value, held, .. } = &mut self {
            *held += stated - *value;
            *value = stated;
        }
        if let Self::Start { value, range, turned, .. } = &mut self {
            let offset = stated - *value;
            *value = stated;
            *range = (range.0 + offset, range.1 + offset);
            *turned = turned.map(|turned| turned + offset);
        }
        self
    }
}
