//! The schema, the examples of the reference and the engine agree on what a mechanism is.
#![allow(clippy::unwrap_used)]

mod examples;
mod keys;
mod support;
mod values;
