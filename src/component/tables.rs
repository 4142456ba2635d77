//! Stored tables next to a definition, so that an instance does not have to compute them.
//!
//! In: a component and the text of its definition, or a file of tables. Out: the bytes of the file, or the component. A
//! file belongs to one text and one version. With any other file, the tables are computed again, with a remark.
use super::{Component, ModelKind, Refused};
use crate::codec::checksum::fnv1a_128;
use crate::codec::sections::{self, Sections};
use std::path::Path;
use std::sync::Arc;

/// Name of the file, which is in the folder of the definition.
pub const TABLES: &str = "tables.bin";

/// Version of the contents of the file. It changes with every change of a table.
const LAYOUT: &str = "5";

/// Key of a file of tables: hash of the engine's version, the layout and the definition's text.
fn key(text: &str) -> u128 {
    fnv1a_128([env!("CARGO_PKG_VERSION"), "\0", LAYOUT, "\0", text])
}

impl Component {
    /// The component of a kind that the definition's text describes, with the tables in `folder` if they belong to this
    /// definition. A remark states that other tables were found. Values are identical with and without stored tables.
    ///
    /// # Errors
    /// As [`Component::from_definition`].
    pub fn with_tables(kind: &ModelKind, text: &str, folder: &Path) -> Result<(Self, Option<String>), Refused> {
        match Sections::open(&folder.join(TABLES), key(text)) {
            Ok(sections) => Ok(((kind.construct)(text, sections.map(Arc::new))?, None)),
            Err(why) => {
                let remark = format!(
                    "'{}' {why}: this instance computes the content of the file itself, so it starts more slowly; \
                     package the model again, or remove the file",
                    folder.join(TABLES).display()
                );
                Ok(((kind.construct)(text, None)?, Some(remark)))
            }
        }
    }

    /// As [`Component::with_tables`], from the bytes of a file of tables.
    ///
    /// # Errors
    /// As [`Component::from_definition`], or the bytes are damaged or belong to another definition.
    pub fn with_table_bytes(kind: &ModelKind, text: &str, bytes: Vec<u8>) -> Result<Self, Refused> {
        let sections = Sections::of_bytes(bytes.into(), key(text)).map_err(|why| Refused(format!("{TABLES} {why}")))?;
        (kind.construct)(text, Some(Arc::new(sections)))
    }

    /// The bytes of the file of tables of this component, whose definition has this text. None if it has no tables.
    pub fn tables(&self, text: &str) -> Option<Vec<u8>> {
        let Self::Mechanism(model) = self else { return None };
        let all = model.sections();
        (!all.is_empty()).then(|| sections::encode(key(text), &all))
    }
}
