//! Collects the variables, each with its quantity and dependencies.
use super::MOST_DEPENDENCIES;
use super::causes::Cause;
use super::needs::{Needs, placed};
use super::source::Source;
use crate::mechanism::definition::Method;
use crate::mechanism::quantity::{CONTACT_MODES, ImpactPart, OneElement, Output, Quantity, ReactionPart, SmallMotion};
use crate::numerics::order;
use crate::variables::{Causality, Details, Kind, Reference, Unit, Value, Variability, Variable};

/// Suffixes, descriptions (before the owner's name) and units of a coordinate and its two time derivatives.
pub(super) type Derivatives = [(&'static str, &'static str, Unit); 3];

/// Collects the variables in order: inputs, outputs, parameters, local variables.
pub(super) struct Builder<'a> {
    pub source: &'a Source<'a>,
    pub list: Vec<Variable>,
    pub quantities: Vec<Quantity>,
    /// For the dependencies of initial values: reference of the first parameter, and what each parameter acts on.
    causes: Option<(Reference, Vec<Vec<Cause>>)>,
    /// Inputs and parameters on which the initial value of each variable depends, ascending; empty without `causes`.
    pub initial: Vec<Vec<Reference>>,
    /// Number of dependencies of outputs on inputs, all outputs together. Beyond [`MOST_DEPENDENCIES`] they are counted
    /// and not kept.
    pub dependencies: usize,
    /// Whether variables get their descriptions.
    describes: bool,
}

impl<'a> Builder<'a> {
    pub fn new(source: &'a Source<'a>, causes: Option<(Reference, Vec<Vec<Cause>>)>, describes: bool) -> Self {
        /// Variables of an element, rarely more.
        const EACH: usize = 12;
        let mechanism = source.mechanism;
        let elements = mechanism.bodies.len() + mechanism.joints.len() + source.loads.len() + source.markers.len();
        let most = EACH * elements;
        let (list, quantities, initial) =
            (Vec::with_capacity(most), Vec::with_capacity(most), Vec::with_capacity(most));
        Self { source, list, quantities, causes, initial, dependencies: 0, describes }
    }

    /// A description, made if variables get one.
    pub fn text(&self, description: impl FnOnce() -> String) -> String {
        if self.describes { description() } else { String::new() }
    }

    /// Input that sizes a load, named by the loading.
    pub fn load_input(&mut self, text: &[&str], unit: Unit, start: f64) {
        let name = self.source.loading.inputs[self.list.len()].clone();
        self.input(name, text, unit, start);
    }

    /// Real input; its index is the value reference.
    #[inline(never)]
    pub fn input(&mut self, name: String, text: &[&str], unit: Unit, start: f64) {
        let quantity = Quantity::Input(self.list.len());
        self.known(name, self.text(|| text.concat()), Causality::Input, (Some(unit), Value::Real(start)), quantity);
    }

    /// Input or parameter, which has a start value.
    #[inline(never)]
    pub fn known(
        &mut self,
        name: String,
        description: String,
        causality: Causality,
        (unit, start): (Option<Unit>, Value),
        quantity: Quantity,
    ) {
        self.add((name, description), causality, (unit, Some(start)), quantity, &Needs::default());
    }

    /// Parameter that follows from others, which have these references.
    pub fn calculated(&mut self, name: String, text: String, unit: Unit, quantity: Quantity, bases: Vec<Reference>) {
        self.add((name, text), Causality::CalculatedParameter, (Some(unit), None), quantity, &Needs::default());
        if self.causes.is_some() {
            self.initial.pop();
            self.initial.push(bases.clone());
        }
        if let Some(variable) = self.list.last_mut() {
            variable.dependencies = bases;
        }
    }

    /// Real output `owner.suffix`.
    #[inline(never)]
    pub fn output(&mut self, owner: &str, suffix: &str, text: &[&str], unit: Unit, output: Output, needs: &Needs) {
        let quantity = Quantity::Output(output);
        self.any_output([owner, ".", suffix].concat(), self.text(|| text.concat()), Some(unit), quantity, needs);
    }

    /// Output, Boolean where it has no unit.
    #[inline(never)]
    pub fn any_output(&mut self, name: String, text: String, unit: Option<Unit>, quantity: Quantity, needs: &Needs) {
        self.add((name, text), Causality::Output, (unit, None), quantity, needs);
    }

    /// Real that is computed to be looked at; no dependencies of it are told.
    #[inline(never)]
    pub fn local(&mut self, name: String, text: String, unit: Unit, output: Output) {
        let quantity = Quantity::Output(output);
        self.add((name, text), Causality::Local, (Some(unit), None), quantity, &Needs::default());
    }

    /// A coordinate and its time derivatives; `stated`: whether the start states this coordinate.
    pub fn motion(&mut self, owner: &str, derivatives: Derivatives, stated: bool, output: impl Fn(usize) -> Output) {
        let all = self.source.acceleration();
        let position = Needs { closure: !stated, ..placed() };
        let needs = [position, Needs { position: !stated, speed: true, ..position }, all];
        for (order, (suffix, text, unit)) in derivatives.into_iter().enumerate() {
            self.output(owner, suffix, &[text, " ", owner], unit, output(order), &needs[order]);
            if order > 0 {
                self.is_rate_of(1);
            }
        }
    }

    /// The last variable is the time derivative of the one that stands so many places before it. For a rate that has
    /// been left out this repeats what is known of the last variable.
    pub fn is_rate_of(&mut self, places: usize) {
        let last = self.list.len() - 1;
        self.list[last].details.derivative_of = Some((last - places) as Reference);
    }

    pub(super) fn add(
        &mut self,
        (name, description): (String, String),
        causality: Causality,
        (unit, start): (Option<Unit>, Option<Value>),
        quantity: Quantity,
        needs: &Needs,
    ) {
        if self.source.mechanism.is_massless() && self.source.needs_masses(quantity) {
            return;
        }
        let kind = match start {
            _ if !items(quantity).is_empty() => Kind::Enumeration,
            _ if unit.is_some() => Kind::Real,
            _ => Kind::Boolean,
        };
        let variability = match (causality, kind) {
            (Causality::Parameter | Causality::CalculatedParameter, _) => Variability::Fixed,
            (_, Kind::Real) if !is_discrete(quantity) => Variability::Continuous,
            _ => Variability::Discrete,
        };
        let is_moved = causality == Causality::Output && !is_discrete(quantity) || quantity == Quantity::State(2);
        let moved = self.source.moved((needs.inputs, needs.loads), is_moved);
        let needs = match &moved {
            Some((inputs, loads)) => &Needs { closure: true, position: true, speed: true, inputs, loads, ..*needs },
            None => needs,
        };
        self.dependencies += needs.inputs.len();
        let kept = if self.dependencies > MOST_DEPENDENCIES { &[][..] } else { needs.inputs };
        let dependencies = kept.iter().map(|&i| i as Reference).collect();
        self.initial.push(self.initial_of(quantity, needs));
        let nominal = match &start {
            Some(Value::Real(value)) if causality == Causality::Input && *value != 0.0 => Some(value.abs()),
            _ => None,
        };
        let details = Details { items: items(quantity), bounds: bounds(quantity), nominal, derivative_of: None };
        self.list.push(Variable {
            name,
            description,
            kind,
            causality,
            variability,
            unit,
            start,
            dependencies,
            details,
        });
        self.quantities.push(quantity);
    }

    /// Inputs and parameters on which the initial value of an output depends.
    fn initial_of(&self, quantity: Quantity, needs: &Needs) -> Vec<Reference> {
        let Some((first, causes)) = &self.causes else { return Vec::new() };
        let loading = &self.source.loading;
        // Rods are stretched at the start by all that acts there.
        let stretched = self.source.mechanism.solver.method.is_some() && is_stretched(quantity);
        let loads = if stretched { &self.source.loads[..loading.base()] } else { &[] };
        let rods = Needs { speed: true, inertia: true, masses: true, elasticity: true, loads, ..placed() };
        let inputs = if stretched { loading.inputs.len() } else { 0 };
        // The position of an equilibrium follows from all loads at rest, and from no lock.
        let sought = self.source.mechanism.start.equilibrium && (needs.closure || needs.position);
        let unlocked = self.source.inputs.len() - loading.locks.len();
        let acting = if sought { &self.source.inputs[..unlocked] } else { &[] };
        // A force that follows that of a controller starts from it.
        let followed = if needs.circuit { self.source.followed() } else { Vec::new() };
        let begun = Needs { speed: true, loads: &followed, ..placed() };
        let balance = Needs { loads: &self.source.loads, lossless: true, ..placed() };
        let mut others: Vec<usize> =
            needs.inputs.iter().chain(acting).chain(&followed).copied().filter(|&i| i >= inputs).collect();
        if sought || !followed.is_empty() {
            others = order::distinct(others);
        }
        let meets = |causes: &[Cause]| {
            needs.meet(causes)
                || (stretched && rods.meet(causes))
                || (sought && balance.meet(causes))
                || (!followed.is_empty() && begun.meet(causes))
        };
        let parameters = (*first..).zip(causes).filter(|(_, causes)| meets(causes)).map(|(reference, _)| reference);
        // The force of a drive with a circuit stands in the place of an input, and is an output.
        let sizes = (0..inputs).filter(|load| !self.source.is_hydraulic(*load));
        sizes.chain(others).map(|i| i as Reference).chain(parameters).collect()
    }
}

/// Whether a Real changes at events only.
fn is_discrete(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Output(Output::Impact { .. }))
}

/// Names of the items of an Enumeration; none of any other variable.
fn items(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Method => &Method::WORDS,
        Quantity::Contact => &CONTACT_MODES,
        _ => &[],
    }
}

/// Least and largest value of what is computed, where there are such.
fn bounds(quantity: Quantity) -> [Option<f64>; 2] {
    match quantity {
        Quantity::Output(Output::Reaction { part: ReactionPart::Magnitude, .. } | Output::Kinetic) => [Some(0.0), None],
        Quantity::Output(Output::Impact { part: ImpactPart::Count | ImpactPart::Impulse, .. }) => [Some(0.0), None],
        Quantity::Output(Output::OneElement { term: OneElement::ReducedMass, .. }) => [Some(0.0), None],
        Quantity::Output(Output::SmallMotion(SmallMotion::Eigenfrequency)) => [Some(0.0), None],
        _ => [None, None],
    }
}

/// Whether the stretch of rods changes an output. Terms of the mechanism as one element are those of rigid bodies.
fn is_stretched(quantity: Quantity) -> bool {
    use Output::{Angle, Displacement, JointPosition, Kinetic, Marker, Potential, Reaction, SlipSpeed, SpringForce};
    let Quantity::Output(output) = quantity else { return false };
    matches!(
        output,
        Angle { .. }
            | JointPosition { .. }
            | Reaction { .. }
            | Displacement { .. }
            | SlipSpeed { .. }
            | SpringForce { .. }
            | Marker { .. }
            | Kinetic
            | Potential
    )
}
