//! Hosts with all kinds of faults: every function in every phase with absurd arguments, random sequences of calls,
//! unusable resources, many threads. Each rejected call returns the standard's status, writes one line into the log,
//! and leaves the instance unchanged.

mod calls;
mod every_call;
mod play;
mod resources;
mod sequences;
pub mod standard;
mod threads;
