//! `cargo fmu <command>`: builds, tests and demonstrates the FMUs. One file per task.
//!
//! In: the command line. Out: files under `target/`.

mod archive;
pub mod bench;
mod binary;
pub mod chain;
mod command;
mod library;
pub mod package;
mod page;
pub mod report;
mod schema;
mod source;
mod ssp;
pub mod test;
pub mod workspace;
mod xml;
