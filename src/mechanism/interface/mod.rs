//! The variables of a mechanism, by noun: inputs, outputs with their dependencies, parameters.
//!
//! In: a definition. Out: the table of variables with the quantity of each; the dependencies of initial values. It must
//! not know how a quantity is computed.
mod bodies;
mod builder;
mod causes;
mod contact;
mod drives;
mod energy;
mod joints;
mod loads;
mod needs;
mod parameters;
mod source;

use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::quantity::Quantity;
use crate::variables::{Causality, Reference, Variables};
use builder::Builder;
use causes::causes;
use needs::Cause;
use source::Source;

/// The variables of a mechanism: inputs, outputs, then parameters.
///
/// # Errors
/// Two variables of one name; a definition that does not resolve.
pub fn variables(mechanism: &Mechanism) -> Result<Variables<Quantity>, DefinitionError> {
    let source = Source::new(mechanism)?;
    let Builder { list, quantities, .. } = build(&source, None);
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
    let known = build(&source, None).list;
    let first = known.iter().take_while(|v| v.causality != Causality::Parameter).count() as Reference;
    Ok(build(&source, Some((first, causes(&source)?))).initial)
}

/// All variables in order; with `causes` also the dependencies of initial values.
fn build<'a>(source: &'a Source<'a>, causes: Option<(Reference, Vec<Vec<Cause>>)>) -> Builder<'a> {
    let mut b = Builder::new(source, causes);
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
