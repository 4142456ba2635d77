//! Parameters of a mechanism under names of their own, which expressions read: in the definition, or shared by several.
//!
//! In: a number, an expression, or an object with unit and description. Out: a parameter that a host sets, or whose value
//! follows from others. It must not know the expressions that read it.
use super::{Role, Visit};
use crate::format::{DefinitionError, Named, Numbers, Parameter, Range, read_with};
use crate::variables::{Unit, nearest};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize as Derived, Serialize, Serializer};
use std::fmt;

/// A named parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedParameter {
    /// Value, in SI units.
    pub value: f64,
    /// Unit; 1 where absent.
    #[serde(serialize_with = "unit_name")]
    pub unit: Unit,
    /// One line of text.
    pub description: String,
}

fn unit_name<S: Serializer>(unit: &Unit, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(unit.name())
}

/// A named parameter as an object.
#[derive(Derived)]
#[serde(deny_unknown_fields)]
struct Full {
    value: f64,
    #[serde(default)]
    unit: UnitName,
    #[serde(default)]
    description: String,
}

struct UnitName(Unit);

impl Default for UnitName {
    fn default() -> Self {
        Self(Unit::One)
    }
}

impl<'de> Deserialize<'de> for UnitName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Unit::ALL.into_iter().find(|unit| unit.name() == name).map(Self).ok_or_else(|| {
            let names = nearest(Unit::ALL.iter().map(|unit| unit.name()), &name).join(", ");
            D::Error::custom(format!("\"{name}\" is no unit: the nearest are {names}, all of them SI"))
        })
    }
}

impl<'de> Deserialize<'de> for NamedParameter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrObject;
        impl<'de> Visitor<'de> for NumberOrObject {
            type Value = NamedParameter;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number, an expression or an object { \"value\": ... }")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<NamedParameter, E> {
                Ok(NamedParameter { value, unit: Unit::One, description: String::new() })
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<NamedParameter, E> {
                self.visit_f64(value as f64)
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<NamedParameter, E> {
                self.visit_f64(value as f64)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<NamedParameter, A::Error> {
                let Full { value, unit, description } = Full::deserialize(MapAccessDeserializer::new(map))?;
                Ok(NamedParameter { value, unit: unit.0, description })
            }
        }
        deserializer.deserialize_f64(NumberOrObject)
    }
}

/// Named parameters that several definitions share: the file `parameters_from`, with its contents once they were read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shared {
    /// Path of the file from the folder of the definition.
    pub file: String,
    /// What stands in the file; None in a definition as it was written, which only a reader of files completes.
    pub contents: Option<SharedContents>,
}

/// The contents of a file of shared parameters.
#[derive(Clone, Debug, Default, PartialEq, Derived, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SharedContents {
    /// Location of the schema, for editors; not read here.
    #[serde(rename = "$schema", default)]
    pub schema: Option<String>,
    /// One line of text.
    #[serde(default)]
    pub description: String,
    /// The parameters.
    #[serde(default)]
    pub parameters: Named<NamedParameter>,
}

impl<'de> Deserialize<'de> for Shared {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Derived)]
        #[serde(deny_unknown_fields)]
        struct Whole {
            file: String,
            contents: SharedContents,
        }
        struct PathOrObject;
        impl<'de> Visitor<'de> for PathOrObject {
            type Value = Shared;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("the path of a file, or an object { \"file\": ..., \"contents\": ... }")
            }

            fn visit_str<E: Error>(self, file: &str) -> Result<Shared, E> {
                Ok(Shared { file: file.to_owned(), contents: None })
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Shared, A::Error> {
                let Whole { file, contents } = Whole::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Shared { file, contents: Some(contents) })
            }
        }
        deserializer.deserialize_any(PathOrObject)
    }
}

impl SharedContents {
    /// Check that a text is a file of shared parameters; expressions are read with the definition that names the file.
    ///
    /// # Errors
    /// The path of the key at fault, with its value and what is allowed.
    pub fn check(text: &str) -> Result<(), DefinitionError> {
        read_with::<Self>("file of shared parameters", text, &Numbers::with_expressions()).map(drop)
    }
}

impl Shared {
    /// Refuse a file that nobody has read.
    pub(super) fn check(&self) -> Result<(), DefinitionError> {
        match self.contents {
            Some(_) => Ok(()),
            None => Err(DefinitionError::value(
                "parameters_from",
                format_args!("\"{}\"", self.file),
                "read together with the definition: name the definition by its path to `cargo fmu`, which packs the \
                 contents of this file into the FMU",
            )),
        }
    }

    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        for (name, parameter) in self.contents.iter_mut().flat_map(|contents| contents.parameters.iter_mut()) {
            parameter.parameters("parameters_from.contents.parameters.", name, visit);
        }
    }
}

impl NamedParameter {
    pub(super) fn parameters(&mut self, group: &str, name: &str, visit: &mut Visit) {
        let description = if self.description.is_empty() { ["Parameter ", name] } else { [&*self.description, ""] };
        let kind = (self.unit, Range::Finite, Role::Named);
        visit(Parameter::new([name], [group, name], description, kind), &mut self.value);
    }
}
