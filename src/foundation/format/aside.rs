//! Values next to the keys of a definition.
//!
//! In: a value. Out: the value, which no file states and no canonical text contains. Must not know: what the value
//! means.
use super::json::Node;
use super::keys::{Field, Key, Kind, Own, Slot};
use std::ops::{Deref, DerefMut};

/// A value next to the keys of a definition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aside<T>(pub T);

impl<T> Aside<T> {
    /// Row for such a value, which is neither in a file nor in a canonical text.
    pub const KEY: Key = Key { is_written_only: true, ..Key::PLAIN }.brief();
}

impl<T> Deref for Aside<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T> DerefMut for Aside<T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.0
    }
}

impl<T: Default> Field for Aside<T> {
    const KIND: Kind = Kind::Own("nothing");

    fn slot(&mut self) -> Slot<'_> {
        Slot::Own(self)
    }
}

impl<T> Own for Aside<T> {
    fn take(&mut self, _: &Node, _: &str) -> Result<(), String> {
        Ok(())
    }

    fn written(&self) -> String {
        String::new()
    }
}
