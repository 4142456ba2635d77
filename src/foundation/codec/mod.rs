//! Records in bytes, files of named sections, and check sums. Must not know: what the fields mean.
pub mod checksum;
pub mod record;
pub mod sections;
pub mod writer;
