//! The schema, the examples of FORMAT.md and the engine agree on what a mechanism is.
#![allow(clippy::unwrap_used)]

mod examples;
mod keys;
mod support;
mod values;
