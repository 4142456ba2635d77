//! The schema, the examples of the reference and the engine agree about valid mechanisms.
#![allow(clippy::unwrap_used)]

mod examples;
mod keys;
#[path = "../../../tests/support/examples.rs"]
mod reference;
mod support;
mod values;
