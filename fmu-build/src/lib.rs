//! `cargo fmu <command>`: builds, tests and demonstrates the FMUs. One file per task.
//!
//! In: the command line. Out: files under `target/`.

// This module is the first one, because its macros replace those of std in all later modules.
#[macro_use]
pub mod output;

pub mod archive;
pub mod bench;
mod binary;
pub mod chain;
pub mod check;
pub mod command;
pub mod csv_file;
pub mod dist;
pub mod docs;
pub mod documentation;
pub mod drawing;
pub mod files;
pub mod fmu;
mod headers;
pub mod info;
mod library;
mod licenses;
mod names;
mod needs;
pub mod package;
mod platform;
pub mod prebuilt;
pub mod reference;
pub mod report;
pub mod run;
pub mod schema;
pub mod setting;
pub mod shared;
pub mod source;
pub mod ssp;
pub mod start_values;
mod static_library;
pub mod task;
pub mod test;
pub mod validate;
pub mod version;
pub mod view;
pub mod workspace;
pub mod xml;
