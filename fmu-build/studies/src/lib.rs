//! Runs and studies of mechanisms, and their pictures: tasks of `cargo fmu` whose crates need a long build. One file
//! per task.
//!
//! In: the command line. Out: tables, pictures, films, definitions. The crate must not know how an FMU is packed.

// The packer's macros replace those of std in all modules below.
#[macro_use]
extern crate fmu_build;

mod definition_values;
pub mod gallery;
pub mod import;
pub mod linearise;
pub mod live;
mod parquet_file;
mod plot;
pub mod progress;
pub mod simulate;
pub mod sweep;
pub mod task;
