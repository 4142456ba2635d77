//! The variables of a mechanism, by noun: inputs, outputs with their dependencies, parameters, frames of the
//! bodies.
//!
//! In: a definition. Out: the table of variables with the quantity of each; the dependencies of initial values; the
//! terminals. It must not know how a quantity is computed.
mod bodies;
mod builder;
mod causes;
mod couplings;
mod drives;
mod exchange;
mod hydraulics;
mod loads;
mod needs;
mod parameters;
mod source;
mod terminals;
mod vectors;

use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::quantity::Quantity;
use crate::variables::Causality::{CalculatedParameter, Parameter};
use crate::variables::{Reference, Variables};
use builder::Builder;
use causes::{Cause, causes};
pub use hydraulics::allow_hydraulics;
use parameters::Known;
use source::Source;
pub use terminals::terminals;
pub use vectors::vectors;

/// Most dependencies of outputs on inputs that a table of variables holds, all outputs together: 200 MB. Each
/// acceleration depends on each force, so that n drives have about 4 n^2 dependencies.
pub const MOST_DEPENDENCIES: usize = 50_000_000;

/// Most comparisons that [`initial_dependencies`] makes: some seconds of work.
const MOST_COMPARISONS: usize = 10_000_000;

/// Most bytes of the numbers of variables that [`initial_dependencies`] lists: 1 MB in `modelDescription.xml`.
const MOST_LISTED: usize = 1 << 20;

/// The variables of a mechanism: inputs, outputs, parameters, then local variables.
///
/// # Errors
/// Two variables of one name; a definition that does not resolve; more than [`MOST_DEPENDENCIES`].
pub fn variables(mechanism: &Mechanism) -> Result<Variables<Quantity>, DefinitionError> {
    let source = Source::new(mechanism)?;
    let known = Known::new(&mut mechanism.clone(), true);
    let Builder { list, quantities, dependencies, .. } = build(&source, known, None, true);
    if dependencies > MOST_DEPENDENCIES {
        let message = format!(
            "there are {dependencies} dependencies of outputs on inputs, but at most {MOST_DEPENDENCIES} are allowed: \
             use fewer drives, markers and stops, or make forces and torques constant"
        );
        return Err(DefinitionError::key("mechanism", message));
    }
    Variables::new(&mechanism.name, list, quantities).map_err(|twice| mechanism.named_twice(&twice.0))
}

/// For each output of the mechanism the inputs and parameters on which its initial value depends, ascending; for each
/// other variable none. Each parameter is compared with each element and with each output, so this is not part of
/// [`variables`]. None if the definition is so large that the comparisons would take minutes or the list would have
/// more than 1 MB in `modelDescription.xml`: an output may then depend on every input and every parameter.
///
/// # Errors
/// As [`variables`].
pub fn initial_dependencies(mechanism: &Mechanism) -> Result<Option<Vec<Vec<Reference>>>, DefinitionError> {
    let source = Source::new(mechanism)?;
    let parameters = || Known::new(&mut mechanism.clone(), false);
    let known = build(&source, parameters(), None, false).list;
    let first = known.iter().take_while(|v| !matches!(v.causality, Parameter | CalculatedParameter)).count();
    let elements = mechanism.bodies.len() + mechanism.joints.len() + source.loads.len() + source.markers.len();
    if (known.len() - first).saturating_mul(elements.max(first)) > MOST_COMPARISONS {
        return Ok(None);
    }
    let causes = causes(&source);
    let initial = build(&source, parameters(), Some((first as Reference, causes)), false).initial;
    // Each number and a blank.
    let listed = initial.iter().flatten().map(|reference| 2 + (reference + 1).ilog10() as usize).sum::<usize>();
    Ok(Some(initial).filter(|_| listed <= MOST_LISTED))
}

/// The variables of a mechanism of which this reduced linkage and the GUID of the interface are kept, without their
/// descriptions, which no importer asks an instance for: they stand in the FMU's description.
pub fn kept_variables(
    mechanism: &mut Mechanism,
    resolved: (&Linkage, &Loading, &[Point]),
    guid: String,
) -> Variables<Quantity> {
    let known = Known::new(mechanism, false);
    let source = Source::of(mechanism, resolved);
    let Builder { list, quantities, .. } = build(&source, known, None, false);
    Variables::with_guid(guid, list, quantities)
}

/// All variables in order, with these parameters among them; with `causes` also the dependencies of initial values;
/// `describes`: with descriptions.
fn build<'a>(
    source: &'a Source<'a>,
    known: Known,
    causes: Option<(Reference, Vec<Vec<Cause>>)>,
    describes: bool,
) -> Builder<'a> {
    let mut b = Builder::new(source, causes, describes);
    drives::add_inputs(&mut b);
    drives::add_commands(&mut b);
    loads::add_inputs(&mut b);
    drives::add_demands(&mut b);
    hydraulics::add(&mut b, 0);
    drives::add_motion_inputs(&mut b);
    loads::add_airspeed(&mut b);
    loads::add_engagements(&mut b);
    drives::add_motion_switch(&mut b);
    bodies::add_bodies(&mut b);
    bodies::add_joints(&mut b);
    bodies::add_reactions(&mut b);
    drives::add(&mut b);
    loads::add_springs(&mut b);
    bodies::add_markers(&mut b);
    loads::add_surfaces(&mut b);
    loads::add_stops(&mut b);
    loads::add_locks(&mut b);
    bodies::add_energy(&mut b);
    hydraulics::add(&mut b, 1);
    loads::add_sticking(&mut b);
    bodies::add_small_motion(&mut b);
    known.add(&mut b);
    bodies::add_frames(&mut b);
    loads::add_contact_mode(&mut b);
    exchange::add(&mut b);
    b
}
