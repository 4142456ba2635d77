//! The code that only a library of models with hydraulics contains.
//!
//! In: nothing. Out: hydraulics that are allowed in the modules above. It must not know what they do.
use super::{definition, interface, loads, motion, outputs};

/// State that mechanisms may have hydraulics or integral parts of controllers. A library that never does so is without
/// the code of these.
pub fn allow_hydraulics() {
    definition::allow_hydraulics();
    loads::resolved::allow_hydraulics();
    motion::allow_hydraulics();
    outputs::allow_hydraulics();
    interface::allow_hydraulics();
}
