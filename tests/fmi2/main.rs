//! Tests through the C interface of FMI 2.0.5.
#![allow(unsafe_code, clippy::unwrap_used)]

mod abi;
mod clock;
mod events;
mod host;
mod hostile;
mod hydraulic_drive;
mod hydraulics;
mod initial;
mod instantiate;
mod interrupted;
mod method;
mod stack;
mod state;
mod undefined;
mod warnings;
