//! `cargo fmu <command>`: builds, tests and demonstrates the FMUs. One file per task.
//!
//! In: the command line. Out: files under `target/`.

// First, as its macros stand for those of std in all modules below it.
#[macro_use]
mod output;

pub mod archive;
pub mod bench;
mod binary;
pub mod chain;
pub mod check;
mod command;
mod csv_file;
mod definition_values;
pub mod dist;
pub mod docs;
pub mod documentation;
pub mod drawing;
mod files;
mod fmu;
pub mod gallery;
mod headers;
pub mod import;
pub mod info;
mod library;
mod licenses;
pub mod linearise;
mod names;
mod needs;
pub mod package;
mod parquet_file;
mod platform;
mod prebuilt;
pub mod reference;
pub mod report;
mod schema;
mod shared;
pub mod simulate;
pub mod source;
mod ssp;
mod start_values;
pub mod sweep;
pub mod task;
pub mod test;
pub mod validate;
pub mod version;
pub mod view;
pub mod workspace;
mod xml;
