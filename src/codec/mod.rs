//! Records in bytes, and check sums. It must not know what the fields mean.
pub mod checksum;
pub mod record;
