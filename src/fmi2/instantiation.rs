//! The function of FMI 2.0 that creates an instance, for the kinds of models in a library. A library with fewer kinds
//! is smaller, because only this function refers to the code of the kinds.
//!
//! In: the kinds, the host's arguments. Out: an instance. Must not know: any kind.
use crate::component::KINDS;

/// Defines the function of FMI 2.0 that creates an instance of one of the kinds, with this attribute. The contract of
/// the pointers is that of the module [`fmi2`](crate::fmi2).
#[macro_export]
macro_rules! fmi2_instantiation {
    ($kinds:expr $(, $attribute:meta)?) => {
        /// FMI 2.0.5, 2.1.5: creates an instance. `visible` has no effect.
        $(#[$attribute])?
        pub unsafe extern "C" fn fmi2Instantiate(
            name: $crate::fmi2::types::Text,
            fmu_type: std::ffi::c_int,
            guid: $crate::fmi2::types::Text,
            location: $crate::fmi2::types::Text,
            functions: *const $crate::fmi2::types::CallbackFunctions,
            _visible: $crate::fmi2::types::Boolean,
            logging_on: $crate::fmi2::types::Boolean,
        ) -> $crate::fmi2::types::Component {
            let kinds: &[$crate::component::ModelKind] = $kinds;
            // SAFETY: the caller is the host, which guarantees the contract of the pointers.
            unsafe { $crate::fmi2::instantiate(kinds, name, fmu_type, guid, location, functions, logging_on) }
        }
    };
}

pub use fmi2_instantiation as instantiation;

fmi2_instantiation!(&KINDS);
