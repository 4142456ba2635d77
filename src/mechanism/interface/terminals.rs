//! Terminals: the variables of each drive, as one connection.
use crate::mechanism::quantity::{OneElement, Output, Quantity};
use crate::variables::{Member, Reference, Terminal, Variable, Variables};
use std::collections::HashMap;

/// One terminal for each drive: its force or torque, which goes in; the displacement along which it does work, with the
/// first two derivatives, and the mechanism as one element, which come out.
pub fn terminals(variables: &Variables<Quantity>) -> Vec<Terminal> {
    let all = || (0..).zip(variables.list());
    let mut outputs: HashMap<usize, Vec<(Reference, &Variable)>> = HashMap::new();
    for (reference, output) in all() {
        if let Some(Quantity::Output(Output::Displacement { load: drive, .. })) = variables.quantity(reference) {
            outputs.entry(drive).or_default().push((reference, output));
        }
        if let Some(Quantity::Output(Output::OneElement { drive, term })) = variables.quantity(reference)
            && is_handed_over(term)
        {
            outputs.entry(drive).or_default().push((reference, output));
        }
    }
    all().filter_map(|(reference, input)| terminal(variables, reference, input, &outputs)).collect()
}

/// Whether what moves the drive can make use of a term: what an actuator needs to foresee the motion.
fn is_handed_over(term: OneElement) -> bool {
    use OneElement::{
        HoldingForce, HoldingForceDerivative, LowerLimit, ReducedMass, ReducedMassDerivative, UpperLimit,
    };
    let element = matches!(term, ReducedMass | ReducedMassDerivative | HoldingForce | HoldingForceDerivative);
    element || matches!(term, LowerLimit | UpperLimit)
}

/// `outputs`: those of each drive, its displacement first.
fn terminal(
    variables: &Variables<Quantity>,
    reference: Reference,
    input: &Variable,
    outputs: &HashMap<usize, Vec<(Reference, &Variable)>>,
) -> Option<Terminal> {
    let (name, _) = input.name.rsplit_once('.')?;
    let Some(Quantity::Input(index)) = variables.quantity(reference) else { return None };
    // Springs have a length too, but under another name.
    let is_own = |output: &Variable| output.name.rsplit_once('.').is_some_and(|(owner, _)| owner == name);
    let own: Vec<_> = outputs.get(&index)?.iter().filter(|(_, output)| is_own(output)).collect();
    let (_, displacement) = own.first()?;
    let outputs = own.iter().map(|(reference, output)| Member::of(*reference, output));
    Some(Terminal {
        name: name.to_owned(),
        kind: displacement.quantity().to_owned(),
        description: ["Connection of the drive ", name, ": force, motion, reduced mass and load"].concat(),
        members: std::iter::once(Member::of(reference, input)).chain(outputs).collect(),
    })
}
