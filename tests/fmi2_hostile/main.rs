//! Hosts that do everything wrong: every function in every phase with absurd arguments, random sequences of calls,
//! resources that are none, many threads. What is asked for is the standard's status, a line in the log, and an instance
//! that is as it was.
#![allow(unsafe_code, clippy::unwrap_used)]

mod calls;
mod every_call;
#[path = "../fmi2_host/mod.rs"]
mod fmi2_host;
mod play;
mod resources;
mod sequences;
mod standard;
mod threads;
