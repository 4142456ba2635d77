//! Vectors: the reaction in each joint; position, velocity and acceleration of each marker.
use crate::mechanism::quantity::{Output, Quantity, ReactionPart};
use crate::variables::{Reference, Variables, Vector};
use std::collections::HashSet;

/// The vectors whose elements are outputs of their own, in the order of these. One whose name a scalar has, such as the
/// position of a marker that is called as a prismatic joint, is left out.
pub fn vectors(variables: &Variables<Quantity>) -> Vec<Vector> {
    let names: HashSet<&str> = variables.list().iter().map(|variable| variable.name.as_str()).collect();
    let along_x = (0..).zip(variables.list()).filter_map(|(reference, variable)| {
        let (suffix, what, other) = vector(variables.quantity(reference)?)?;
        let (owner, _) = variable.name.rsplit_once('.')?;
        let name = [owner, ".", suffix].concat();
        let y = Some(reference + 1).filter(|&y| variables.quantity(y) == Some(Quantity::Output(other)))?;
        (!names.contains(name.as_str())).then(|| named(variables, name, [what, owner].concat(), [reference, y]))
    });
    along_x.collect()
}

/// Of the element along x: last part of the vector's name, beginning of its description, and the element along y.
fn vector(quantity: Quantity) -> Option<(&'static str, &'static str, Output)> {
    match quantity {
        Quantity::Output(Output::Reaction { joint, part: ReactionPart::X }) => {
            let other = Output::Reaction { joint, part: ReactionPart::Y };
            Some(("reaction", "Reaction force in the joint or coupling ", other))
        }
        Quantity::Output(Output::Marker { marker, axis: 0, order }) => {
            let names = [
                ("position", "Position of the marker "),
                ("velocity", "Velocity of the marker "),
                ("acceleration", "Acceleration of the marker "),
            ];
            let (suffix, what) = *names.get(order)?;
            Some((suffix, what, Output::Marker { marker, axis: 1, order }))
        }
        _ => None,
    }
}

fn named(variables: &Variables<Quantity>, name: String, what: String, elements: [Reference; 2]) -> Vector {
    let [x, y] = elements.map(|element| variables.get(element).map_or("", |variable| &variable.name));
    Vector { description: [&what, " as a vector: ", x, ", ", y].concat(), name, elements }
}
