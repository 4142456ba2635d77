//! Macros for the exported functions of a version of FMI: each function is 1 to 4 lines that work on an instance. The
//! functions of model exchange are written here, because FMI 2.0 and 3.0 differ only in some names.
//!
//! In: names, arguments, phases, work. Out: functions of the C interface, and their table. Must not know: functions
//! whose arguments or meaning differ between versions.

/// Exported functions of an instance: name, further arguments, phases in which the call is legal, and the work on the
/// instance `i`. The word `often` marks functions that hosts call in each step. The work runs in an unsafe block. A
/// comment states the conditions beyond a valid instance. The types `Component` and `Status` are those of the version
/// in scope.
macro_rules! exported {
    (@call $c:ident, $work:expr, often) => { handle::call($c, &FUNCTION, $work) };
    (@call $c:ident, $work:expr,) => { handle::call_seldom($c, &FUNCTION, &mut $work) };
    ($(
        $(#[$doc:meta])*
        fn $name:ident($($argument:ident: $type:ty),*) in $legal:expr => $($often:ident)? |$i:ident| $work:expr;
    )*) => {
        $(
            $(#[$doc])*
            #[unsafe(no_mangle)]
            #[allow(missing_docs)]
            pub unsafe extern "C" fn $name(c: Component $(, $argument: $type)*) -> Status {
                const FUNCTION: Function = Function::new(stringify!($name), $legal);
                // SAFETY: the instance is valid (FMI 2.0.5, 2.1.5; FMI 3.0.2, 2.2.1). A comment at the function states
                // the conditions for the other arguments.
                unsafe { $crate::fmi::exported!(@call c, |$i| $work, $($often)?) }.into()
            }
        )*
        /// Table of the functions, for the tests of the phases.
        #[cfg(test)]
        pub(crate) const FUNCTIONS: &[Function] = &[$(Function::new(stringify!($name), $legal)),*];
    };
}

/// Exported functions of model exchange (FMI 2.0.5, 3.2; FMI 3.0.2, 3.2) with the names in a version, then the other
/// functions of this version. The type `Boolean` is that of the version in scope.
macro_rules! exported_exchange {
    (
        $enter:ident, $completed:ident, $time:ident, $set:ident, $derivatives:ident, $indicators:ident, $states:ident,
        $nominals:ident; $($own:tt)*
    ) => {
        $crate::fmi::exported! {
            /// Changes from event mode to continuous-time mode.
            fn $enter() in $crate::fmi::phase::EVENT => |i| i.enter_continuous_time_mode();

            /// Ends a step of the host's solver. `*enter_event_mode`: whether the host must enter event mode.
            // SAFETY: both pointers point to memory for one value (3.2.2).
            fn $completed(
                _no_set_state_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean
            ) in $crate::fmi::phase::CONTINUOUS => often |i| {
                let enter = output("enterEventMode", enter_event_mode, 1)?;
                let terminate = output("terminateSimulation", terminate, 1)?;
                enter[0].write(i.completed_integrator_step()?.into());
                terminate[0].write(false.into());
                i.warning()
            };

            /// Sets the time [s] for derivatives and outputs.
            fn $time(time: f64) in $crate::fmi::phase::EVENT | $crate::fmi::phase::CONTINUOUS => often |i|
                i.set_time(time);

            /// Sets trial states of the solver. The verdict is discard if the mechanism has no such position. The
            /// instance is then unchanged, and a shorter step of the solver avoids the position.
            // SAFETY: the array has `count` elements (3.2.1).
            fn $set(states: *const f64, count: usize) in $crate::fmi::phase::CONTINUOUS => often |i|
                i.set_continuous_states(input("continuousStates", states, count)?);

            /// Time derivatives of the states. The verdict is discard if they do not exist.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $derivatives(derivatives: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.derivatives(output("derivatives", derivatives, count)?);

            /// Event indicators. The verdict is discard if one of them has no value.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $indicators(indicators: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.event_indicators(output("eventIndicators", indicators, count)?);

            /// The continuous states.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $states(states: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.continuous_states(output("continuousStates", states, count)?);

            /// Nominal values of the continuous states.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $nominals(nominals: *mut f64, count: usize)
            in $crate::fmi::phase::INSTANTIATED | $crate::fmi::phase::SOLVABLE => |i|
                i.nominals(output("nominals", nominals, count)?);

            $($own)*
        }
    };
}

/// The host's calls of these functions on the instance `self.instance()`. The calls are safe, because each array has
/// the length that is passed.
macro_rules! exchange_calls {
    (
        $enter:ident, $completed:ident, $time:ident, $set:ident, $derivatives:ident, $indicators:ident, $states:ident,
        $nominals:ident
    ) => {
        /// Changes from event mode to continuous-time mode.
        pub fn enter_continuous_time_mode(&self) -> Status {
            // SAFETY: the instance is valid.
            unsafe { $enter(self.instance()) }
        }

        /// Ends a step of the solver. Returns the status, and whether the host must enter event mode.
        pub fn complete_step(&self) -> (Status, bool) {
            let mut flags: [Boolean; 2] = [FALSE; 2];
            let [enter, terminate] = &mut flags;
            // SAFETY: the instance is valid; each pointer points to one value.
            let status = unsafe { $completed(self.instance(), FALSE, enter, terminate) };
            (status, flags[0] != FALSE)
        }

        /// Sets the time [s].
        pub fn set_time(&self, time: f64) -> Status {
            // SAFETY: the instance is valid.
            unsafe { $time(self.instance(), time) }
        }

        /// Sets the continuous states.
        pub fn set_states(&self, states: &[f64]) -> Status {
            // SAFETY: the instance is valid; the array has the length that is passed.
            unsafe { $set(self.instance(), states.as_ptr(), states.len()) }
        }

        /// Time derivatives of the continuous states.
        pub fn rates(&self, values: &mut [f64]) -> Status {
            // SAFETY: as above.
            unsafe { $derivatives(self.instance(), values.as_mut_ptr(), values.len()) }
        }

        /// Event indicators.
        pub fn indicators(&self, values: &mut [f64]) -> Status {
            // SAFETY: as above.
            unsafe { $indicators(self.instance(), values.as_mut_ptr(), values.len()) }
        }

        /// Continuous states.
        pub fn states(&self, values: &mut [f64]) -> Status {
            // SAFETY: as above.
            unsafe { $states(self.instance(), values.as_mut_ptr(), values.len()) }
        }

        /// Nominal values of the continuous states.
        pub fn nominals(&self, values: &mut [f64]) -> Status {
            // SAFETY: as above.
            unsafe { $nominals(self.instance(), values.as_mut_ptr(), values.len()) }
        }
    };
}

pub(crate) use exchange_calls;
pub(crate) use exported;
pub(crate) use exported_exchange;
