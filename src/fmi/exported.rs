//! How a version of FMI writes its exported functions: in 1 to 4 lines each over an instance.
//!
//! In: names, arguments, phases, work. Out: functions of the C interface, and their table. It must not know any function.

/// Exported functions that take an instance: name, further arguments, phases in which the call is legal, and the work
/// on the instance `i`. The work is done in an unsafe block: a comment states what it relies on beyond a valid
/// instance. The types `Component` and `Status` are those of the version in scope.
macro_rules! exported {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) in $legal:expr => |$i:ident| $work:expr;)*) => {
        $(
            $(#[$doc])*
            #[unsafe(no_mangle)]
            #[allow(missing_docs)]
            pub unsafe extern "C" fn $name(c: Component $(, $argument: $type)*) -> Status {
                const FUNCTION: Function = Function::new(stringify!($name), $legal);
                // SAFETY: the instance is valid (FMI 2.0.5, 2.1.5; FMI 3.0.2, 2.2.1); for the other arguments see the function.
                unsafe { handle::call(c, &FUNCTION, |$i| $work) }.into()
            }
        )*
        /// The functions, for the tests of the phases.
        #[cfg(test)]
        pub(crate) const FUNCTIONS: &[Function] = &[$(Function::new(stringify!($name), $legal)),*];
    };
}

pub(crate) use exported;
