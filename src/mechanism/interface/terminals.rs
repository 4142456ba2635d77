//! Terminals: the variables of each drive, as one connection.
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::{Reference, Terminal, Variable, Variables};

/// One terminal for each drive: its force or torque, which goes in; the displacement along which it does work, with the
/// first two derivatives, which come out.
pub fn terminals(variables: &Variables<Quantity>) -> Vec<Terminal> {
    let all = || (0..).zip(variables.list());
    all().filter_map(|(reference, input)| terminal(variables, reference, input, all())).collect()
}

fn terminal<'v>(
    variables: &Variables<Quantity>,
    reference: Reference,
    input: &Variable,
    all: impl Iterator<Item = (Reference, &'v Variable)>,
) -> Option<Terminal> {
    let (name, _) = input.name.rsplit_once('.')?;
    let Some(Quantity::Input(index)) = variables.quantity(reference) else { return None };
    let is_displacement = |(reference, output): &(Reference, &Variable)| {
        let quantity = variables.quantity(*reference);
        // Springs have a length too, but under another name.
        matches!(quantity, Some(Quantity::Output(Output::Displacement { load, .. })) if load == index)
            && output.name.rsplit_once('.').is_some_and(|(owner, _)| owner == name)
    };
    let displacements: Vec<Reference> = all.filter(is_displacement).map(|(reference, _)| reference).collect();
    let description = ["The drive ", name].concat();
    let members = [&[reference], &displacements[..]].concat();
    (!displacements.is_empty()).then(|| Terminal { name: name.to_owned(), description, members })
}
