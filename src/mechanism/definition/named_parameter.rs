//! Parameters of a mechanism under names of their own, which expressions read: in the definition, or shared by several.
//!
//! In: a number, an expression, or an object with unit and description. Out: a parameter that a host sets, or whose
//! value follows from others. It must not know the expressions that read it.
use crate::format::{
    DefinitionError, Key, Named, Numbers, Parameter, Range, Role, Short, Visit, keys, line, number, read_with,
};
use crate::variables::Unit;

keys! {
    /// A named parameter is a number, an expression, or an object with value and unit. Expressions can contain named
    /// parameters.
    pub struct NamedParameter or (Short::First) {
        /// Value of the parameter in SI units: a number or an expression.
        value: f64 => number(Unit::One, Range::Finite).parameter(Role::Named, "").required();
        /// Unit of the parameter.
        unit: Unit;
        /// Description, one line of text.
        description: String => line();
    }

    /// Several mechanisms can share a file with named parameters. The key `parameters_from` states the path of the
    /// shared file, relative to the folder of the mechanism file. The FMU contains a copy of the shared file.
    pub struct Shared or (Short::First) {
        /// Path of the file of shared parameters.
        file: String => Key::PLAIN.required();
        /// Copy of the file of shared parameters inside an FMU. The command `package` writes the key `contents` into
        /// the FMU. Do not write the key `contents` yourself.
        contents: Option<SharedContents> => Key::PLAIN.required();
    }

    /// The object `contents` has the same keys as the file of shared parameters.
    pub struct SharedContents {
        /// Path of the JSON schema. A text editor uses the JSON schema to complete and check the keys. The FMU does not
        /// use the key `$schema`.
        schema as "$schema": Option<String>;
        /// Description, one line of text.
        description: String;
        /// Shared parameters by name.
        parameters: Named<NamedParameter>;
    }
}

impl SharedContents {
    /// Check that a text is a file of shared parameters; expressions are read with the definition that names the file.
    ///
    /// # Errors
    /// The path of the key at fault, with its value and what is allowed.
    pub fn check(text: &str) -> Result<(), DefinitionError> {
        read_with("file of shared parameters", text, &Numbers::with_expressions(), &mut Self::default()).first()
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
                "the file of shared parameters was not read, because the path of the definition is unknown: pass this \
                 path to `cargo fmu`, which also packs the file of shared parameters into the FMU",
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
