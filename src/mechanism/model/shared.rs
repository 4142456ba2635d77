//! Definitions that several models in this process share: one copy of the variables, the curve and the tables.
//!
//! In: a definition's text, kept tables. Out: a model, of a definition that is read only where no other model has it. A
//! table that one model has made is there for all. It must not know where files are.
use super::{Model, ModelError, Original};
use crate::codec::sections::Sections;
use crate::mechanism::definition::Mechanism;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A definition as read, with its text and whether it has kept tables.
struct Entry {
    text: Box<str>,
    has_tables: bool,
    original: Weak<Original>,
}

/// Definitions of which there may be a model. Instantiation alone looks here, no step does.
static SHARED: Mutex<Vec<Entry>> = Mutex::new(Vec::new());

impl Model {
    /// [`Self::with_tables`], sharing what is as read with the other models of this text. The mechanism has no
    /// hydraulics, unless [`allow_hydraulics`](crate::mechanism::allow_hydraulics) was called.
    ///
    /// # Errors
    /// As [`Self::with_tables`].
    pub fn shared(text: &str, tables: Option<Arc<Sections>>) -> Result<Self, ModelError> {
        let has_tables = tables.is_some();
        let known = || {
            let mut all = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
            all.retain(|entry| entry.original.strong_count() > 0);
            let own = all.iter().find(|entry| entry.has_tables == has_tables && *entry.text == *text);
            own.and_then(|entry| entry.original.upgrade())
        };
        if let Some(original) = known() {
            return Ok(Self::of(original));
        }
        let model = Self::with_mechanism(Mechanism::checked(text)?, tables)?;
        let mut all = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(Entry { text: text.into(), has_tables, original: Arc::downgrade(&model.original) });
        Ok(model)
    }
}

#[cfg(test)]
mod tests {
    use super::Model;
    use crate::mechanism::GEAR;
    use std::sync::Arc;

    /// A text of the same length that differs in one digit is another definition.
    #[test]
    fn models_of_one_text_alone_share_its_definition() {
        let other = GEAR.replace("\"load_factor\": 3", "\"load_factor\": 2");
        assert!(other != GEAR && other.len() == GEAR.len());
        let [first, second, third] = [GEAR, GEAR, &other].map(|text| Model::shared(text, None).unwrap());
        assert!(Arc::ptr_eq(&first.original, &second.original));
        assert!(!Arc::ptr_eq(&first.original, &third.original));
    }
}
