//! The variables of a mechanism, by noun: inputs, outputs with their dependencies, parameters.
//!
//! In: a definition. Out: the table of variables with the quantity of each; the dependencies of initial values. It must
//! not know how a quantity is computed.
mod bodies;
mod contact;
mod drives;
mod energy;
mod joints;
mod loads;
mod needs;
mod parameters;
mod source;

use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::{Causality, Kind, Reference, Unit, Value, Variability, Variable, Variables};
use needs::{Cause, Needs, PLACED, causes};
use source::Source;

/// Suffixes, descriptions (before the owner's name) and units of a coordinate and its two time derivatives.
type Derivatives = [(&'static str, &'static str, Unit); 3];

/// Collects the variables in order: inputs, outputs, parameters.
struct Builder<'a> {
    source: &'a Source<'a>,
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    /// For the dependencies of initial values: reference of the first parameter, and what each parameter acts on.
    causes: Option<(Reference, Vec<Vec<Cause>>)>,
    /// Inputs and parameters on which the initial value of each variable depends, ascending; empty without `causes`.
    initial: Vec<Vec<Reference>>,
}

/// The variables of a mechanism: inputs, outputs, then parameters.
///
/// # Errors
/// Two variables of one name; a definition that does not resolve.
pub fn variables(mechanism: &Mechanism) -> Result<Variables<Quantity>, DefinitionError> {
    let source = Source::new(mechanism)?;
    let Builder { list, quantities, .. } = Builder::build(&source, None);
    Variables::new(&mechanism.name, list, quantities)
        .map_err(|twice| DefinitionError::key(twice.0, "two elements give a variable of this name: rename one"))
}

/// For each output of the mechanism the inputs and parameters on which its initial value depends, ascending; for each
/// other variable none. It costs a comparison for each parameter, so it is not part of [`variables`].
///
/// # Errors
/// As [`variables`]; a parameter that may not change a little.
pub fn initial_dependencies(mechanism: &Mechanism) -> Result<Vec<Vec<Reference>>, DefinitionError> {
    let source = Source::new(mechanism)?;
    let known = Builder::build(&source, None).list;
    let first = known.iter().take_while(|v| v.causality != Causality::Parameter).count() as Reference;
    Ok(Builder::build(&source, Some((first, causes(&source)?))).initial)
}

impl<'a> Builder<'a> {
    fn build(source: &'a Source<'a>, causes: Option<(Reference, Vec<Vec<Cause>>)>) -> Self {
        let mut b = Self { source, list: Vec::new(), quantities: Vec::new(), causes, initial: Vec::new() };
        drives::add_inputs(&mut b);
        loads::add_inputs(&mut b);
        drives::add_demands(&mut b);
        loads::add_airspeed(&mut b);
        contact::add_inputs(&mut b);
        bodies::add_motion(&mut b);
        joints::add_motion(&mut b);
        joints::add_reactions(&mut b);
        drives::add(&mut b);
        loads::add_springs(&mut b);
        bodies::add_markers(&mut b);
        loads::add_surfaces(&mut b);
        contact::add_stops(&mut b);
        contact::add_locks(&mut b);
        energy::add(&mut b);
        parameters::add(&mut b);
        b
    }

    /// Input that sizes a load, named by the loading.
    fn load_input(&mut self, text: &[&str], unit: Unit, start: f64) {
        let name = self.source.loading.inputs[self.list.len()].clone();
        self.input(name, text, unit, start);
    }

    /// Real input; its index is the value reference.
    fn input(&mut self, name: String, text: &[&str], unit: Unit, start: f64) {
        let quantity = Quantity::Input(self.list.len());
        self.known(name, text.concat(), Causality::Input, (Some(unit), Value::Real(start)), quantity);
    }

    /// Input or parameter.
    fn known(
        &mut self,
        name: String,
        description: String,
        causality: Causality,
        (unit, start): (Option<Unit>, Value),
        quantity: Quantity,
    ) {
        let kind = match start {
            Value::Real(_) => Kind::Real,
            Value::Integer(_) => Kind::Integer,
            Value::Boolean(_) => Kind::Boolean,
            Value::String(_) => Kind::String,
        };
        self.add((name, description), (kind, causality, unit), Some(start), quantity, Vec::new());
        self.initial.push(Vec::new());
    }

    /// Real output `owner.suffix`.
    fn output(&mut self, owner: &str, suffix: &str, text: &[&str], unit: Unit, output: Output, needs: Needs) {
        let quantity = Quantity::Output(output);
        self.any_output([owner, ".", suffix].concat(), text.concat(), Some(unit), quantity, needs);
    }

    /// Output, Boolean where it has no unit.
    fn any_output(&mut self, name: String, text: String, unit: Option<Unit>, quantity: Quantity, needs: Needs) {
        let dependencies = needs.inputs.iter().map(|&i| i as Reference).collect();
        let kind = if unit.is_some() { Kind::Real } else { Kind::Boolean };
        self.add((name, text), (kind, Causality::Output, unit), None, quantity, dependencies);
        let initial = self.initial_of(quantity, &needs);
        self.initial.push(initial);
    }

    /// A coordinate and its time derivatives; `stated`: whether the start states this coordinate.
    fn motion(&mut self, owner: &str, derivatives: Derivatives, stated: bool, output: impl Fn(usize) -> Output) {
        let all = self.source.acceleration();
        let position = Needs { closure: !stated, ..PLACED };
        let needs = [position, Needs { position: !stated, speed: true, ..position }, all];
        for (order, (suffix, text, unit)) in derivatives.into_iter().enumerate() {
            self.output(owner, suffix, &[text, " ", owner], unit, output(order), needs[order]);
        }
    }

    fn add(
        &mut self,
        (name, description): (String, String),
        (kind, causality, unit): (Kind, Causality, Option<Unit>),
        start: Option<Value>,
        quantity: Quantity,
        dependencies: Vec<Reference>,
    ) {
        let variability = match (causality, kind) {
            (Causality::Parameter, _) => Variability::Fixed,
            (_, Kind::Real) => Variability::Continuous,
            _ => Variability::Discrete,
        };
        self.list.push(Variable { name, description, kind, causality, variability, unit, start, dependencies });
        self.quantities.push(quantity);
    }

    /// Inputs and parameters on which the initial value of an output depends.
    fn initial_of(&self, quantity: Quantity, needs: &Needs) -> Vec<Reference> {
        let Some((first, causes)) = &self.causes else { return Vec::new() };
        let loading = &self.source.loading;
        // Rods are stretched at the start by all that acts there.
        let stretched = self.source.mechanism.solver.method.is_some() && is_stretched(quantity);
        let loads = if stretched { &self.source.loads[..loading.base()] } else { &[] };
        let rods = Needs { speed: true, inertia: true, masses: true, elasticity: true, loads, ..PLACED };
        let inputs = if stretched { loading.inputs.len() } else { 0 };
        let others = needs.inputs.iter().copied().filter(|&i| i >= inputs);
        let meets = |causes: &[Cause]| needs.meet(causes) || (stretched && rods.meet(causes));
        let parameters = (*first..).zip(causes).filter(|(_, causes)| meets(causes)).map(|(reference, _)| reference);
        (0..inputs).chain(others).map(|i| i as Reference).chain(parameters).collect()
    }
}

/// Whether the stretch of rods changes an output. Terms of the mechanism as one element are those of rigid bodies.
fn is_stretched(quantity: Quantity) -> bool {
    use Output::{Angle, Displacement, JointPosition, Kinetic, Marker, Potential, Reaction, SpringForce};
    let Quantity::Output(output) = quantity else { return false };
    matches!(
        output,
        Angle { .. }
            | JointPosition { .. }
            | Reaction { .. }
            | Displacement { .. }
            | SpringForce { .. }
            | Marker { .. }
            | Kinetic
            | Potential
    )
}
