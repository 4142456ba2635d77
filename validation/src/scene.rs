//! The landing gear's scenes: parameters, and the host's calls after each step.

use crate::measure;
use linkage_fmu::mechanism::{Model, ModelError, Statistics};

/// Duration of a retraction, scene S1 [s].
pub const SPAN: f64 = 0.13;

/// The input that is set, and the known of directional derivatives.
pub const KNOWN: &str = "actuator.force";

/// A host's calls after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// Three fmi2GetReal: crank.angle, crank.speed, crank.acceleration.
    Motion,
    /// One fmi2GetReal: the magnitudes of the four reactions.
    Reactions,
    /// Four fmi2GetReal: the same, one call each.
    EachReaction,
    /// One fmi2GetDirectionalDerivative: four outputs with respect to one input.
    Derivatives,
    /// One fmi2SetReal: the force, changed by a unit in the last place up and down in turn.
    Force,
    /// fmi2GetFMUstate and fmi2SetFMUstate with the same state.
    State,
    /// One fmi2GetReal: all outputs.
    Outputs,
    /// fmi2GetFMUstate, fmi2SerializedFMUstateSize and fmi2SerializeFMUstate.
    Serialised,
}

/// Force of the actuator after this number of steps with [`After::Force`] [N].
pub fn force(steps: u32) -> f64 {
    if steps.is_multiple_of(2) { 30_000.0 } else { 30_000.0_f64.next_up() }
}

/// Settings that differ from the defaults, and calls.
pub struct Scene {
    /// Name for the command line and for CSV.
    pub name: &'static str,
    /// Folder of the mechanism.
    pub mechanism: &'static str,
    /// Title for a table.
    pub title: &'static str,
    /// Parameters and inputs.
    pub reals: &'static [(&'static str, f64)],
    /// Booleans.
    pub flags: &'static [(&'static str, bool)],
    /// Calls after each step.
    pub after: &'static [After],
}

const AIR: &[(&str, f64)] = &[("airspeed", 70.0)];
const BUMPER: &[(&str, f64)] = &[("upstop.angle", -1.1), ("upstop.stiffness", 1e6), ("upstop.damping", 5e3)];

/// The mechanism with all defaults.
pub const DEFAULT: Scene = Scene {
    name: "default",
    mechanism: "LandingGearRetraction",
    title: "default: rigid stops",
    reals: &[],
    flags: &[],
    after: &[],
};
/// Gravity, load factor and drive; no stops.
pub const BARE: Scene = Scene {
    name: "bare",
    title: "bare: drive and gravity, no stops",
    flags: &[("upstop.enabled", false), ("downstop.enabled", false)],
    ..DEFAULT
};

/// All scenes; the others are compared with the first.
pub const SCENES: [Scene; 9] = [
    BARE,
    DEFAULT,
    Scene {
        name: "bumper",
        title: "bumper, met at -1.1 rad",
        reals: BUMPER,
        flags: &[("upstop.rigid", false)],
        ..DEFAULT
    },
    Scene { name: "drag", title: "drag at 70 m/s", reals: AIR, ..DEFAULT },
    Scene {
        name: "wind",
        title: "drag in relative wind",
        reals: AIR,
        flags: &[("air.relative_wind", true)],
        ..DEFAULT
    },
    Scene { name: "friction", title: "friction", flags: &[("friction.enabled", true)], ..DEFAULT },
    Scene { name: "reactions", title: "four reactions read", after: &[After::Reactions], ..DEFAULT },
    Scene { name: "derivatives", title: "directional derivatives read", after: &[After::Derivatives], ..DEFAULT },
    Scene {
        name: "all",
        title: "all of these",
        reals: &[("airspeed", 70.0), BUMPER[0], BUMPER[1], BUMPER[2]],
        flags: &[("friction.enabled", true), ("air.relative_wind", true), ("upstop.rigid", false)],
        after: &[After::Reactions, After::Derivatives],
        ..DEFAULT
    },
];

/// The gear with a prescribed motion of its actuator.
pub const PRESCRIBED: [Scene; 2] = [
    Scene {
        name: "prescribed",
        mechanism: "SmoothRetraction",
        title: "without friction",
        flags: &[("friction.enabled", false)],
        ..DEFAULT
    },
    Scene { name: "prescribed_friction", mechanism: "SmoothRetraction", title: "with friction", ..DEFAULT },
];

impl Scene {
    /// Work of the integrator in `steps` equal steps of the retraction, with those calls of `after` that affect it.
    pub fn work(&self, text: &str, tolerance: f64, steps: u32, after: &[After]) -> Result<Statistics, ModelError> {
        let mut model = Model::from_json(text)?;
        for &(name, value) in self.reals {
            measure::set(&mut model, name, value)?;
        }
        for &(name, value) in self.flags {
            measure::set(&mut model, name, value)?;
        }
        model.set_tolerance(tolerance)?;
        model.initialize()?;
        for step in 1..=steps {
            model.step(SPAN / f64::from(steps))?;
            if after.contains(&After::Force) {
                measure::set(&mut model, KNOWN, force(step))?;
            }
        }
        Ok(model.statistics())
    }
}
