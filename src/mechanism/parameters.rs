//! The present parameters of a mechanism, and a hash of what no parameter changes.
use crate::codec::checksum::fnv1a;
use crate::format::{About, written};
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::mechanism::definition::{Experiment, Expressions, Mechanism, Method};
use crate::numerics::bits::same_bits;
use std::sync::Arc;

/// A mechanism with the values of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValues {
    /// The definition, with the values below if it is not stale; sets that differ in their values alone share it until
    /// they are settled.
    mechanism: Arc<Mechanism>,
    /// Whether values have changed since they were written into the mechanism.
    is_stale: bool,
    /// Which parameters follow from others.
    expressions: Expressions,
    /// Numeric parameters, in the order of [`Mechanism::parameters`].
    pub parameters: Vec<f64>,
    /// Boolean parameters, in the order of [`Mechanism::flags`].
    pub flags: Vec<bool>,
    /// Formulation of the motion, if the definition has it as a parameter.
    method: Option<Method>,
}

impl ParameterValues {
    pub fn new(mut mechanism: Mechanism) -> Self {
        let (mut parameters, mut flags) = (Vec::new(), Vec::new());
        mechanism.parameters(&mut |_, value| parameters.push(*value));
        mechanism.flags(&mut |_, value| flags.push(*value));
        let method = mechanism.solver.method;
        let expressions = mechanism.expressions.clone();
        Self { mechanism: Arc::new(mechanism), is_stale: false, expressions, parameters, flags, method }
    }

    /// The definition with the present values, once they are [settled](Self::settle).
    pub fn mechanism(&self) -> &Mechanism {
        debug_assert!(!self.is_stale, "parameters are settled before the mechanism is read");
        &self.mechanism
    }

    /// A value has changed. Values are written into the mechanism all at once when it is next needed: a host may set
    /// each of many.
    pub fn changed(&mut self) {
        self.is_stale = true;
    }

    /// Which parameters follow from others.
    #[inline]
    pub fn expressions(&self) -> &Expressions {
        &self.expressions
    }

    /// Give a parameter this value, and those that follow from it theirs; `changed` is called with the index of each
    /// that has changed.
    pub fn set(&mut self, index: usize, value: f64, mut changed: impl FnMut(usize)) {
        self.parameters[index] = value;
        changed(index);
        let Self { expressions, parameters, .. } = self;
        for calculated in expressions.iter() {
            let before = parameters[calculated.index];
            calculated.compute(parameters);
            if parameters[calculated.index].to_bits() != before.to_bits() {
                changed(calculated.index);
            }
        }
        self.changed();
    }

    /// Choose the formulation of the motion.
    pub fn set_method(&mut self, method: Method) {
        self.method = Some(method);
        self.changed();
    }

    /// Write the values into the mechanism, if one has changed.
    pub fn settle(this: &mut Arc<Self>) {
        if this.is_stale {
            Arc::make_mut(this).update_mechanism();
        }
    }

    /// Whether inputs decide the start, which no parameter changes: at an equilibrium, where the motion of a drive is
    /// prescribed, or with the force of a controller that a drive follows.
    pub fn starts_by_inputs(&self) -> bool {
        let mechanism = &self.mechanism;
        mechanism.start.equilibrium || mechanism.motion_drive().is_some() || mechanism.has_forces_by_inputs()
    }

    pub fn method(&self) -> Method {
        self.stated_method().unwrap_or_default()
    }

    /// The formulation, if the definition has it as a parameter.
    pub fn stated_method(&self) -> Option<Method> {
        self.method
    }

    /// Whether the mechanism has the present values.
    pub fn is_settled(&self) -> bool {
        !self.is_stale
    }

    /// Whether all parameters are the same to the bit.
    pub fn has_same_bits(&self, other: &Self) -> bool {
        same_bits(&self.parameters, &other.parameters) && self.flags == other.flags && self.method() == other.method()
    }

    /// Write the values into the mechanism.
    fn update_mechanism(&mut self) {
        let (mut parameters, mut flags) = (self.parameters.iter(), self.flags.iter());
        let mechanism = Arc::make_mut(&mut self.mechanism);
        mechanism.parameters(&mut |_, value| *value = parameters.next().copied().unwrap_or(*value));
        mechanism.flags(&mut |_, value| *value = flags.next().copied().unwrap_or(*value));
        mechanism.solver.method = self.method;
        self.is_stale = false;
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
    bare.about = About::default();
    if let Some(shared) = &mut bare.shared {
        shared.file.clear();
        shared.contents.iter_mut().for_each(|contents| {
            (contents.schema, contents.description) = (None, String::new());
        });
    }
    let shared = bare.shared.iter_mut().flat_map(|shared| &mut shared.contents);
    let named = shared.flat_map(|contents| contents.parameters.iter_mut()).chain(bare.parameters.iter_mut());
    named.for_each(|(_, parameter)| parameter.description.clear());
    if let Some(gravity) = &mut bare.gravity {
        gravity.load_factor = 0.0;
    }
    if let Some(air) = &mut bare.air {
        air.airspeed = 0.0;
    }
    for (_, actuator) in bare.actuators.iter_mut() {
        (actuator.force, actuator.torque) = (actuator.force.map(|_| 0.0), actuator.torque.map(|_| 0.0));
        if let Some(motion) = &mut actuator.motion {
            (motion.enabled, motion.position) = (false, motion.position.map(|_| 0.0));
        }
        if let Some(circuit) = &mut actuator.hydraulics {
            (circuit.supply.pressure, circuit.tank.pressure) = (0.0, 0.0);
        }
    }
    bare.hydraulics.iter_mut().for_each(HydraulicSystem::clear_in_mechanism);
    bare.forces.iter_mut().for_each(|(_, force)| force.force = [0.0; 2]);
    bare.torques.iter_mut().for_each(|(_, torque)| torque.torque = 0.0);
    bare.joints.iter_mut().for_each(|(_, joint)| joint.surface_speed = joint.surface_speed.map(|_| 0.0));
    bare.locks.iter_mut().for_each(|(_, lock)| lock.engage = false);
    fnv1a(written(&mut bare).as_bytes())
}
