//! `cargo fmu check`: every finding with its place, and facts against closed forms.
#![allow(clippy::unwrap_used)]

mod command;
mod facts;
mod faults;
mod hydraulics;
mod schemas;
mod support;
mod warnings;
