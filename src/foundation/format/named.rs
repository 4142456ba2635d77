//! A JSON object as an ordered list of named entries, with fast access by name.
use serde::ser::{Serialize, Serializer};
use std::collections::HashMap;
use std::sync::Arc;

/// Number of entries up to which a linear search is faster than a map.
const FEW: usize = 16;

/// Entries in the order of the file; names are unique.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// Copies share the names, which never change.
    names: Arc<Names>,
    values: Vec<T>,
}

/// The names. This code does not depend on the type of the entries.
#[derive(Clone, Debug, Default)]
struct Names {
    list: Vec<String>,
    /// Index of each name, if there are more than [`FEW`] names.
    indices: HashMap<String, usize>,
}

impl PartialEq for Names {
    fn eq(&self, other: &Self) -> bool {
        self.list == other.list
    }
}

impl Names {
    /// Adds a name, unless it exists. Returns whether it was added.
    fn add(&mut self, name: &str) -> bool {
        if self.position(name).is_some() {
            return false;
        }
        self.list.push(name.to_owned());
        if self.list.len() > FEW {
            let from = self.indices.len();
            self.indices.extend(self.list[from..].iter().cloned().zip(from..));
        }
        true
    }

    fn position(&self, name: &str) -> Option<usize> {
        match self.indices.is_empty() {
            true => self.list.iter().position(|own| own == name),
            false => self.indices.get(name).copied(),
        }
    }
}

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self { names: Arc::default(), values: Vec::new() }
    }
}

impl<T> FromIterator<(String, T)> for Named<T> {
    /// Collects entries, whose names must be unique.
    fn from_iter<I: IntoIterator<Item = (String, T)>>(entries: I) -> Self {
        let mut all = Self::default();
        entries.into_iter().for_each(|(name, value)| _ = all.push(&name, value));
        all
    }
}

impl<T> Named<T> {
    /// Entries in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &T)> {
        self.names.list.iter().map(String::as_str).zip(&self.values)
    }

    /// Entries in order, with mutable values.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (&str, &mut T)> {
        self.names.list.iter().map(String::as_str).zip(&mut self.values)
    }

    /// Adds an entry. None, without any change, if the name exists.
    pub fn push(&mut self, name: &str, value: T) -> Option<&mut T> {
        if !Arc::make_mut(&mut self.names).add(name) {
            return None;
        }
        self.values.push(value);
        self.values.last_mut()
    }

    /// Name and value of the entry with this index.
    pub fn at_mut(&mut self, index: usize) -> Option<(&str, &mut T)> {
        Some((self.names.list.get(index)?, self.values.get_mut(index)?))
    }

    /// Index of the entry with this name, and the entry.
    pub fn find(&self, name: &str) -> Option<(usize, &T)> {
        let index = self.position(name)?;
        Some((index, &self.values[index]))
    }

    /// Entry with this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.values.get(self.position(name)?)
    }

    /// Index of the entry with this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.position(name)
    }

    /// All names, in order.
    pub fn names(&self) -> Vec<&str> {
        self.names.list.iter().map(String::as_str).collect()
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there is no entry.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}
