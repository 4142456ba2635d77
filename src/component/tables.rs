//! Tables next to a definition, so that an instance does not have to compute them.
//!
//! In: a component and the text of its definition; or a file of tables. Out: the bytes of the file; or the component. A
//! file belongs to one text and one version. Tables of any other file are computed again, with a remark.
use super::{Component, ModelKind, Refused};
use crate::codec::checksum::fnv1a_128;
use crate::codec::sections::{self, Sections};
use std::path::Path;
use std::sync::Arc;

/// Name of the file, beside the definition.
pub const TABLES: &str = "tables.bin";

/// Version of what is kept in the file. It changes with anything that changes a table.
const LAYOUT: &str = "5";

/// Key of a file of tables: of the engine's version, the layout and the definition's text.
fn key(text: &str) -> u128 {
    fnv1a_128([env!("CARGO_PKG_VERSION"), "\0", LAYOUT, "\0", text])
}

impl Component {
    /// The component of a kind that the definition's text describes, with the tables in `folder`, if there are any of
    /// this definition; and a remark if there are others. What it answers is the same with tables and without.
    ///
    /// # Errors
    /// As [`Component::from_definition`].
    pub fn with_tables(kind: &ModelKind, text: &str, folder: &Path) -> Result<(Self, Option<String>), Refused> {
        match Sections::open(&folder.join(TABLES), key(text)) {
            Ok(sections) => Ok(((kind.construct)(text, sections.map(Arc::new))?, None)),
            Err(why) => {
                let remark = format!(
                    "'{}' {why}: the tables are computed again, so this instance starts more slowly; package the \
                     model again, or remove the file",
                    folder.join(TABLES).display()
                );
                Ok(((kind.construct)(text, None)?, Some(remark)))
            }
        }
    }

    /// [`Component::with_tables`] with the bytes of a file of tables.
    ///
    /// # Errors
    /// As [`Component::from_definition`]; the bytes are of another definition or damaged.
    pub fn with_table_bytes(kind: &ModelKind, text: &str, bytes: Vec<u8>) -> Result<Self, Refused> {
        let sections = Sections::of_bytes(bytes.into(), key(text)).map_err(|why| Refused(format!("{TABLES} {why}")))?;
        (kind.construct)(text, Some(Arc::new(sections)))
    }

    /// The bytes of the file of tables of this component, whose definition has this text; None if it has no tables.
    pub fn tables(&self, text: &str) -> Option<Vec<u8>> {
        let Self::Mechanism(model) = self else { return None };
        let all = model.sections();
        (!all.is_empty()).then(|| sections::encode(key(text), &all))
    }
}
