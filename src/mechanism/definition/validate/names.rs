//! Names of a definition: their letters, no two alike where variables would be, and what a name stands for.
//!
//! In: a name, the group that should have it. Out: its entry, or a message with the names that there are. It must not
//! know what an entry means.
use super::{Check, refused};
use crate::format::{DefinitionError, Faults, Named, is_reserved};
use crate::mechanism::definition::Mechanism;
use crate::numerics::order;
use crate::variables::nearest;
use std::fmt;

/// Most letters of a name: file systems take 255 with what packing adds.
const LONGEST: usize = 200;

/// Names become parts of variable names: letters, digits and underscores, a letter first.
pub(super) fn check_name(key: impl fmt::Display, name: &str) -> Check {
    let mut letters = name.chars();
    let first = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    if name.len() > LONGEST {
        let (start, count) = (name.chars().take(20).collect::<String>(), name.chars().count());
        let message = format_args!(
            "the name \"{start}...\" has {count} letters, but at most {LONGEST} are allowed, because the program \
             writes files with this name: shorten the name"
        );
        return refused(key, message);
    }
    if first && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(());
    }
    let allowed = format_args!("a letter, then letters, digits or underscores, at most {LONGEST} characters");
    Err(DefinitionError::value(key, format_args!("\"{name}\""), allowed))
}

/// The entry of a group with this name, which stands under this key.
pub(super) fn entry<'m, T>(
    key: impl fmt::Display,
    group: &str,
    entries: &'m Named<T>,
    name: &str,
) -> Result<&'m T, DefinitionError> {
    entries.get(name).ok_or_else(|| {
        let allowed = match entries.names() {
            names if names.is_empty() => format!("the definition has no {group}: add the key `{group}`"),
            names => alternatives(&format!("the {group}"), &names, name),
        };
        DefinitionError::unknown(key, name, allowed)
    })
}

/// Most names that are all told.
const FEW: usize = 20;
/// Most names that are compared letter by letter with a name that there is not.
const COMPARED: usize = 1000;

/// These names in words: all, or those nearest to a name that is none of them.
pub(super) fn alternatives(what: &str, names: &[&str], name: &str) -> String {
    if names.len() <= FEW {
        return format!("{what} are {}", names.join(", "));
    }
    // Names that begin alike first, so that any number of names is searched in time.
    let alike = |other: &&str| other.bytes().zip(name.bytes()).take_while(|(a, b)| a == b).count();
    let mut sorted = names.to_vec();
    if sorted.len() > COMPARED {
        sorted = order::sorted(sorted, |other| -(alike(other) as f64));
        sorted.truncate(COMPARED);
    }
    let nearest = nearest(sorted.into_iter(), name).join(", ");
    format!("this is none of the {} names of {what}; similar names are {nearest}", names.len())
}

impl Mechanism {
    pub(super) fn check_names(&self, faults: &mut Faults) {
        let groups: [(&str, Vec<&str>); 11] = [
            ("bodies", self.bodies.names()),
            ("joints", self.joints.names()),
            ("couplings", self.couplings.names()),
            ("actuators", self.actuators.names()),
            ("forces", self.forces.names()),
            ("torques", self.torques.names()),
            ("springs", self.springs.names()),
            ("markers", self.markers.names()),
            ("surfaces", self.surfaces.names()),
            ("stops", self.stops.names()),
            ("locks", self.locks.names()),
        ];
        for (group, names) in groups {
            for name in names {
                faults.keep(check_name(group, name));
            }
        }
        let shared = self.shared.iter().flat_map(|shared| &shared.contents);
        for (key, named) in [("parameters", Some(&self.parameters))]
            .into_iter()
            .chain([("parameters_from.contents.parameters", shared.map(|contents| &contents.parameters).next())])
        {
            for (name, parameter) in named.into_iter().flat_map(Named::iter) {
                let key = format!("{key}.{name}");
                faults.keep(check_name(&key, name));
                if is_reserved(name) {
                    faults.refuse(&key, "this name is a function or a constant of expressions: choose another name");
                }
                if parameter.description.chars().any(char::is_control) {
                    faults.refuse(
                        &key,
                        "the description contains a control character: write the description on one line",
                    );
                }
            }
        }
        // Both would have one name in the guess, and one variable for two speeds.
        for (name, _) in self.joints.iter().filter(|(_, joint)| joint.slides()) {
            if self.bodies.get(name).is_some() {
                let message = format_args!("`{name}` is the name of a body and of a joint: rename one of the two");
                faults.refuse(format_args!("joints.{name}"), message);
            }
        }
        for (body, b) in self.bodies.iter() {
            for point in b.points.names() {
                faults.keep(check_name(format_args!("bodies.{body}.points"), point));
                if point == "origin" || point == "end" {
                    let message = "every body has the points origin and end: choose another name";
                    faults.refuse(format_args!("bodies.{body}.points.{point}"), message);
                }
            }
        }
    }

    /// Body and local coordinates [m] of a point written `body.point`, under this key.
    ///
    /// # Errors
    /// No such point; the message lists the names that there are.
    pub fn point(&self, key: impl fmt::Display, text: &str) -> Result<(usize, [f64; 2]), DefinitionError> {
        let unknown = |allowed: String| Err(DefinitionError::unknown(&key, text, allowed));
        let Some((body, point)) = text.split_once('.') else {
            return unknown("write a point as body.point, such as crank.end".into());
        };
        let Some((index, b)) = self.bodies.find(body) else {
            return unknown(alternatives("the bodies", &self.bodies.names(), body));
        };
        match (point, b.length, b.points.get(point)) {
            ("origin", ..) => Ok((index, [0.0, 0.0])),
            ("end", Some(length), _) => Ok((index, [length, 0.0])),
            ("end", None, _) => {
                unknown(format!("{body} has no length and therefore no point `end`: add bodies.{body}.length"))
            }
            (.., Some(&local)) => Ok((index, local)),
            (_, length, None) => {
                let mut names = vec!["origin"];
                names.extend(length.map(|_| "end"));
                names.extend(b.points.names());
                unknown(alternatives(&format!("the points of {body}"), &names, point))
            }
        }
    }
}
