//! Terminals: the variables of each drive, as one connection.
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::{Reference, Terminal, Variable, Variables};
use std::collections::HashMap;

/// One terminal for each drive: its force or torque, which goes in; the displacement along which it does work, with the
/// first two derivatives, which come out.
pub fn terminals(variables: &Variables<Quantity>) -> Vec<Terminal> {
    let all = || (0..).zip(variables.list());
    let mut displacements: HashMap<usize, Vec<(Reference, &Variable)>> = HashMap::new();
    for (reference, output) in all() {
        if let Some(Quantity::Output(Output::Displacement { load, .. })) = variables.quantity(reference) {
            displacements.entry(load).or_default().push((reference, output));
        }
    }
    all().filter_map(|(reference, input)| terminal(variables, reference, input, &displacements)).collect()
}

/// `displacements`: the outputs of each load's displacement and of its derivatives.
fn terminal(
    variables: &Variables<Quantity>,
    reference: Reference,
    input: &Variable,
    displacements: &HashMap<usize, Vec<(Reference, &Variable)>>,
) -> Option<Terminal> {
    let (name, _) = input.name.rsplit_once('.')?;
    let Some(Quantity::Input(index)) = variables.quantity(reference) else { return None };
    // Springs have a length too, but under another name.
    let is_own = |output: &Variable| output.name.rsplit_once('.').is_some_and(|(owner, _)| owner == name);
    let own = displacements.get(&index)?.iter().filter(|(_, output)| is_own(output));
    let displacements: Vec<Reference> = own.map(|(reference, _)| *reference).collect();
    let description = ["The drive ", name].concat();
    let members = [&[reference], &displacements[..]].concat();
    (!displacements.is_empty()).then(|| Terminal { name: name.to_owned(), description, members })
}
