//! Definitions that several models in this process share: one copy of the variables, the curve and the tables.
//!
//! In: a key that stands for a definition's text, kept tables. Out: a model, of a definition that is read only where no
//! other model has it. A table that one model has made is there for all. It must not know where files are.
use super::{Model, ModelError, Original};
use crate::codec::sections::Sections;
use crate::mechanism::definition::Mechanism;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A definition as read, by the key of its text and whether it has kept tables.
type Entry = ((u128, bool), Weak<Original>);

/// Definitions of which there may be a model. Instantiation alone looks here, no step does.
static SHARED: Mutex<Vec<Entry>> = Mutex::new(Vec::new());

impl Model {
    /// [`Self::with_tables`], sharing what is as read with the other models of a text with this key.
    ///
    /// # Errors
    /// As [`Self::with_tables`].
    pub fn shared(key: u128, text: &str, tables: Option<Arc<Sections>>) -> Result<Self, ModelError> {
        let key = (key, tables.is_some());
        let known = || {
            let mut all = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
            all.retain(|(_, original)| original.strong_count() > 0);
            all.iter().find(|(own, _)| *own == key).and_then(|(_, original)| original.upgrade())
        };
        if let Some(original) = known() {
            return Ok(Self::of(original));
        }
        let model = Self::with_mechanism(Mechanism::from_json(text)?, tables)?;
        let mut all = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        all.push((key, Arc::downgrade(&model.original)));
        Ok(model)
    }
}
