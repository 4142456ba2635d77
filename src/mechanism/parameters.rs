//! The present parameters of a mechanism, and what of it no parameter can change.
use crate::codec::record::fnv1a;
use crate::mechanism::definition::{Experiment, Mechanism, Method};
use crate::numerics::bits::same_bits;

/// A mechanism with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValues {
    /// With these parameters.
    pub mechanism: Mechanism,
    pub parameters: Vec<f64>,
    pub flags: Vec<bool>,
}

impl ParameterValues {
    pub fn new(mut mechanism: Mechanism) -> Self {
        let (mut parameters, mut flags) = (Vec::new(), Vec::new());
        mechanism.parameters(&mut |_, value| parameters.push(*value));
        mechanism.flags(&mut |_, value| flags.push(*value));
        Self { mechanism, parameters, flags }
    }

    pub fn set_parameter(&mut self, place: usize, value: f64) {
        self.parameters[place] = value;
        self.apply();
    }

    pub fn set_flag(&mut self, place: usize, value: bool) {
        self.flags[place] = value;
        self.apply();
    }

    pub fn method(&self) -> Method {
        self.mechanism.solver.method.unwrap_or_default()
    }

    /// Whether every bit is the same.
    pub fn is(&self, other: &Self) -> bool {
        same_bits(&self.parameters, &other.parameters) && self.flags == other.flags && self.method() == other.method()
    }

    /// Hand the parameters on to the mechanism.
    pub fn apply(&mut self) {
        let (mut parameters, mut flags) = (self.parameters.iter(), self.flags.iter());
        self.mechanism.parameters(&mut |_, value| *value = parameters.next().copied().unwrap_or(*value));
        self.mechanism.flags(&mut |_, value| *value = flags.next().copied().unwrap_or(*value));
    }
}

/// Hash of what neither parameters nor inputs nor texts say: the structure, which assembly the guess means.
pub fn fingerprint(mechanism: &Mechanism) -> u64 {
    let mut bare = mechanism.clone();
    bare.parameters(&mut |_, value| *value = 0.0);
    bare.flags(&mut |_, value| *value = false);
    bare.solver.method = bare.solver.method.map(|_| Method::default());
    (bare.schema, bare.experiment) = (None, Experiment::default());
    bare.description.clear();
    if let Some(gravity) = &mut bare.gravity {
        gravity.load_factor = 0.0;
    }
    if let Some(air) = &mut bare.air {
        air.airspeed = 0.0;
    }
    for (_, actuator) in bare.actuators.iter_mut() {
        (actuator.force, actuator.torque) = (actuator.force.map(|_| 0.0), actuator.torque.map(|_| 0.0));
    }
    bare.forces.iter_mut().for_each(|(_, force)| force.force = [0.0; 2]);
    bare.torques.iter_mut().for_each(|(_, torque)| torque.torque = 0.0);
    bare.locks.iter_mut().for_each(|(_, lock)| lock.engage = false);
    fnv1a(format!("{bare:?}").as_bytes())
}
