//! `cargo fmu sweep` and `cargo fmu optimise`: rows are those of `cargo fmu simulate` to the bit, the same whatever the
//! threads and however often the study was ended; failures are rows; memory does not grow.
#![allow(clippy::unwrap_used)]

mod ended;
mod examples;
mod families;
mod optimise;
mod refusals;
mod rows;
mod support;
