//! `cargo fmu sweep` and `cargo fmu optimise`: rows are bit-identical to those of `cargo fmu simulate`, for any number
//! of threads and any interruptions; failures are rows; the memory use does not grow.
#![allow(clippy::unwrap_used)]

mod ended;
mod examples;
mod families;
#[path = "../../../../tests/support/memory.rs"]
mod memory;
mod optimise;
mod refusals;
mod rows;
mod support;
