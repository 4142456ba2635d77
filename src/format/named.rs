//! A JSON object as an ordered list of named entries, with fast access by name.
use serde::ser::{Serialize, Serializer};
use std::collections::HashMap;
use std::sync::Arc;

/// Number of entries up to which a linear search is faster than a map.
const FEW: usize = 16;

/// Entries in the order of the file; names are unique.
#[derive(Clone, Debug)]
pub struct Named<T> {
    entries: Vec<(String, T)>,
    /// Index of each name, if there are more than [`FEW`] entries. Names never change, so copies share the map.
    indices: Option<Arc<HashMap<String, usize>>>,
}

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), indices: None }
    }
}

impl<T: PartialEq> PartialEq for Named<T> {
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries
    }
}

impl<T> FromIterator<(String, T)> for Named<T> {
    /// Collects entries, whose names must be unique.
    fn from_iter<I: IntoIterator<Item = (String, T)>>(entries: I) -> Self {
        let entries: Vec<(String, T)> = entries.into_iter().collect();
        let mut all = Self { entries, indices: None };
        all.index();
        all
    }
}

impl<T> Named<T> {
    /// Entries in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &T)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value))
    }

    /// Entries in order, with mutable values.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (&str, &mut T)> {
        self.entries.iter_mut().map(|(name, value)| (name.as_str(), value))
    }

    /// Adds an entry. None, without any change, if the name exists.
    pub fn push(&mut self, name: &str, value: T) -> Option<&mut T> {
        if self.position(name).is_some() {
            return None;
        }
        self.entries.push((name.to_owned(), value));
        match &mut self.indices {
            Some(indices) => insert(indices, name, self.entries.len() - 1),
            None => self.index(),
        }
        self.entries.last_mut().map(|(_, value)| value)
    }

    /// Builds the map of the names if there are many.
    fn index(&mut self) {
        if self.entries.len() > FEW {
            self.indices = Some(map(&self.names()));
        }
    }

    /// Name and value of the entry with this index.
    pub fn at_mut(&mut self, index: usize) -> Option<(&str, &mut T)> {
        self.entries.get_mut(index).map(|(name, value)| (name.as_str(), value))
    }

    /// Index of the entry with this name, and the entry.
    pub fn find(&self, name: &str) -> Option<(usize, &T)> {
        let index = position(&self.entries, self.indices.as_deref(), name)?;
        Some((index, &self.entries[index].1))
    }

    /// Entry with this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.find(name).map(|(_, value)| value)
    }

    /// Index of the entry with this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.find(name).map(|(index, _)| index)
    }

    /// All names, in order.
    pub fn names(&self) -> Vec<&str> {
        self.entries.iter().map(|(n, _)| n.as_str()).collect()
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there is no entry.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

/// The map of names to their indices. The code does not depend on the type of the entries.
fn map(names: &[&str]) -> Arc<HashMap<String, usize>> {
    Arc::new(names.iter().enumerate().map(|(index, name)| ((*name).to_owned(), index)).collect())
}

/// Adds a name to the map.
fn insert(indices: &mut Arc<HashMap<String, usize>>, name: &str, index: usize) {
    Arc::make_mut(indices).insert(name.to_owned(), index);
}

/// Index of the entry with this name, from the map if there is one, otherwise by a linear search.
fn position<T>(entries: &[(String, T)], indices: Option<&HashMap<String, usize>>, name: &str) -> Option<usize> {
    match indices {
        Some(indices) => indices.get(name).copied(),
        None => entries.iter().position(|(n, _)| n == name),
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}
