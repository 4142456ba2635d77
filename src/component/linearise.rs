//! Linearisation of a component along its travel.
//!
//! In: a component, a coordinate, inputs, outputs. Out: matrices, eigenfrequencies, equilibria. Must not know: how they
//! are computed.
use super::{Component, Refused};
pub use crate::mechanism::{Linearisation, Linearised};

impl Component {
    /// Linearises at rest at the start position.
    ///
    /// # Errors
    /// The component has no travel, the present parameters allow no model, or a variable has the wrong kind.
    pub fn linearise_here(&mut self, what: &Linearisation) -> Result<Linearised, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model.linearise_here(what)?),
            Self::Hydraulic(_) => Err(no_travel()),
        }
    }

    /// Linearises at rest at `count` + 1 positions of the travel.
    ///
    /// # Errors
    /// As [`Self::linearise_here`].
    pub fn linearise(&mut self, what: &Linearisation, count: usize) -> Result<Vec<Linearised>, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model.linearise(what, count)?),
            Self::Hydraulic(_) => Err(no_travel()),
        }
    }

    /// Natural coordinate of a linearisation: the output whose value and rate form the state. This is the coordinate
    /// that states the start, or else the first coordinate. None for a component without travel.
    pub fn natural_coordinate(&self) -> Option<crate::variables::Reference> {
        let variables = match self {
            Self::Mechanism(model) => model.variables(),
            Self::Hydraulic(_) => return None,
        };
        let of = |suffix: &'static str| {
            let stated = variables.list().iter().filter_map(move |v| v.name.strip_suffix(suffix));
            stated.filter_map(|name| variables.find(&format!("{name}{}", suffix.replace("start_", "")))).next()
        };
        let first = |suffix: &str| {
            let mut names = variables.list().iter().map(|v| &v.name).filter(|name| name.ends_with(suffix));
            names.find(|name| variables.find(&format!("{}.acceleration", name.trim_end_matches(suffix))).is_some())
        };
        let of_name = |name: &String| variables.find(name);
        of(".start_angle")
            .or_else(|| of(".start_position"))
            .or_else(|| first(".angle").and_then(of_name).or_else(|| first(".position").and_then(of_name)))
    }
}

fn no_travel() -> Refused {
    Refused(
        "a hydraulic actuator without a mechanism has no travel; linearise the mechanism that the actuator moves"
            .to_owned(),
    )
}
