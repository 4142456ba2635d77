//! Stub
use super::probe::Probe;
pub fn attack(_probe: &mut Probe) -> Result<(), String> {
    Ok(())
}
