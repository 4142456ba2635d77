//! Author, copyright and licence of a model, as stated in the definition and shown by a host.
use super::{DefinitionError, line};

/// Default of `license`: the licence of the library in every FMU.
const LICENSE: &str = "License of the library: MIT OR Apache-2.0, see documentation/licenses. License of the model: \
                       as stated by its author";
/// Default of `copyright`: the copyright of the library in every FMU.
const COPYRIGHT: &str = "Copyright of the library: the authors of linkage-fmu. Copyright of the model: its author";

super::keys! {
    /// Author, copyright and licence of a model, one line of text each. The program writes the texts of `about` into
    /// the file `modelDescription.xml` of the FMU.
    pub struct About {
        /// Name and organisation of the model's author. If the text `author` is empty, the FMU states no author.
        author: String => line();
        /// Copyright of the model. If the text `copyright` is empty, the FMU states the copyright of the library
        /// linkage-fmu.
        copyright: String => line();
        /// Licence of the model. If the text `license` is empty, the FMU states the licence of the library linkage-fmu.
        license: String => line();
    }
}

impl About {
    /// Checks that each text is one line.
    ///
    /// # Errors
    /// A text contains a control character.
    pub fn check(&self) -> Result<(), DefinitionError> {
        for (key, text) in [("author", &self.author), ("copyright", &self.copyright), ("license", &self.license)] {
            if text.chars().any(char::is_control) {
                return Err(DefinitionError::value(format!("about.{key}"), format!("\"{text}\""), "one line of text"));
            }
        }
        Ok(())
    }

    /// Each attribute of the description of an FMU with its text. The author is omitted if it is not stated.
    pub fn attributes(&self) -> Vec<(&'static str, String)> {
        let or = |text: &str, default: &str| if text.is_empty() { default.to_owned() } else { text.to_owned() };
        let author = (!self.author.is_empty()).then(|| ("author", self.author.clone()));
        let rest = [("copyright", or(&self.copyright, COPYRIGHT)), ("license", or(&self.license, LICENSE))];
        author.into_iter().chain(rest).collect()
    }
}
