//! Hosts that do everything wrong: every function in every phase with absurd arguments, random sequences of calls,
//! unusable resources, many threads. Each refused call gives the standard's status and one line in the log, and leaves
//! the instance unchanged.

mod calls;
mod every_call;
mod play;
mod resources;
mod sequences;
pub mod standard;
mod threads;
