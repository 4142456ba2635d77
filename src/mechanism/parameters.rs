//! The present parameters of a mechanism, and a hash of what no parameter changes.
use crate::codec::checksum::fnv1a;
use crate::mechanism::definition::{Experiment, Mechanism, Method};
use crate::numerics::bits::same_bits;

/// A mechanism with the values of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValues {
    /// The definition with the values below.
    pub mechanism: Mechanism,
    /// Numeric parameters, in the order of [`Mechanism::parameters`].
    pub parameters: Vec<f64>,
    /// Boolean parameters, in the order of [`Mechanism::flags`].
    pub flags: Vec<bool>,
}

impl ParameterValues {
    pub fn new(mut mechanism: Mechanism) -> Self {
        let (mut parameters, mut flags) = (Vec::new(), Vec::new());
        mechanism.parameters(&mut |_, value| parameters.push(*value));
        mechanism.flags(&mut |_, value| flags.push(*value));
        Self { mechanism, parameters, flags }
    }

    pub fn method(&self) -> Method {
        self.mechanism.solver.method.unwrap_or_default()
    }

    /// Whether all parameters are the same to the bit.
    pub fn has_same_bits(&self, other: &Self) -> bool {
        same_bits(&self.parameters, &other.parameters) && self.flags == other.flags && self.method() == other.method()
    }

    /// Write the values into the mechanism.
    pub fn update_mechanism(&mut self) {
        let (mut parameters, mut flags) = (self.parameters.iter(), self.flags.iter());
        self.mechanism.parameters(&mut |_, value| *value = parameters.next().copied().unwrap_or(*value));
        self.mechanism.flags(&mut |_, value| *value = flags.next().copied().unwrap_or(*value));
    }
}

/// Hash of the mechanism apart from its parameters, inputs and texts: of its structure and of the assembly that the
/// guess names.
///
/// The hashed text is the definition as compact JSON, with keys in the order of the types and names in the order of the
/// file, which decides the value references. Parameters and start values of inputs are 0 in it, texts are empty.
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
        if let Some(circuit) = &mut actuator.hydraulics {
            (circuit.supply.pressure, circuit.tank.pressure) = (0.0, 0.0);
        }
    }
    bare.forces.iter_mut().for_each(|(_, force)| force.force = [0.0; 2]);
    bare.torques.iter_mut().for_each(|(_, torque)| torque.torque = 0.0);
    bare.locks.iter_mut().for_each(|(_, lock)| lock.engage = false);
    let json = serde_json::to_string(&bare).unwrap_or_else(|error| unreachable!("a definition is JSON: {error}"));
    fnv1a(json.as_bytes())
}
