//! How a version of FMI writes its exported functions: in 1 to 4 lines each over an instance. Those of model exchange,
//! which FMI 2.0 and 3.0 have alike but for some names, are written here.
//!
//! In: names, arguments, phases, work. Out: functions of the C interface, and their table. It must not know any
//! function whose arguments or meaning differ between versions.

/// Exported functions that take an instance: name, further arguments, phases in which the call is legal, and the work
/// on the instance `i`, with `often` before it where hosts call the function in each step. The work is done in an
/// unsafe block: a comment states what it relies on beyond a valid instance. The types `Component` and `Status` are
/// those of the version in scope.
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
                // SAFETY: the instance is valid (FMI 2.0.5, 2.1.5; FMI 3.0.2, 2.2.1); for the other arguments see the
                // function.
                unsafe { $crate::fmi::exported!(@call c, |$i| $work, $($often)?) }.into()
            }
        )*
        /// The functions, for the tests of the phases.
        #[cfg(test)]
        pub(crate) const FUNCTIONS: &[Function] = &[$(Function::new(stringify!($name), $legal)),*];
    };
}

/// Exported functions of model exchange (FMI 2.0.5, 3.2; FMI 3.0.2, 3.2) under the names that a version gives them, and
/// the version's own functions after these. The type `Boolean` too is that of the version in scope.
macro_rules! exported_exchange {
    (
        $enter:ident, $completed:ident, $time:ident, $set:ident, $derivatives:ident, $indicators:ident, $states:ident,
        $nominals:ident; $($own:tt)*
    ) => {
        $crate::fmi::exported! {
            /// From event mode to continuous-time mode.
            fn $enter() in $crate::fmi::phase::EVENT => |i| i.enter_continuous_time_mode();

            /// A step of the host's solver is complete. `*enter_event_mode`: whether a transition is due.
            // SAFETY: both pointers lead to memory for one value (3.2.2).
            fn $completed(
                _no_set_state_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean
            ) in $crate::fmi::phase::CONTINUOUS => often |i| {
                let enter = output("enterEventMode", enter_event_mode, 1)?;
                let terminate = output("terminateSimulation", terminate, 1)?;
                enter[0].write(i.completed_integrator_step()?.into());
                terminate[0].write(false.into());
                i.warning()
            };

            /// The time at which values are asked for [s].
            fn $time(time: f64) in $crate::fmi::phase::EVENT | $crate::fmi::phase::CONTINUOUS => often |i|
                i.set_time(time);

            /// Take the states that the solver tries. Discarded where the mechanism has no such position: a shorter
            /// step avoids it; nothing has changed.
            // SAFETY: the array has `count` elements (3.2.1).
            fn $set(states: *const f64, count: usize) in $crate::fmi::phase::CONTINUOUS => often |i|
                i.set_continuous_states(input("continuousStates", states, count)?);

            /// Time derivatives of the states. Discarded where there are none.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $derivatives(derivatives: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.derivatives(output("derivatives", derivatives, count)?);

            /// Event indicators. Discarded where one has no value.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $indicators(indicators: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.event_indicators(output("eventIndicators", indicators, count)?);

            /// The continuous states.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $states(states: *mut f64, count: usize) in $crate::fmi::phase::SOLVABLE => often |i|
                i.continuous_states(output("continuousStates", states, count)?);

            /// Scales of the continuous states.
            // SAFETY: the array has `count` elements (3.2.2).
            fn $nominals(nominals: *mut f64, count: usize)
            in $crate::fmi::phase::INSTANTIATED | $crate::fmi::phase::SOLVABLE => |i|
                i.nominals(output("nominals", nominals, count)?);

            $($own)*
        }
    };
}

/// The calls of a host for these functions, on an instance that `self.instance()` gives: safe, as arrays have the
/// lengths that are passed.
macro_rules! exchange_calls {
    (
        $enter:ident, $completed:ident, $time:ident, $set:ident, $derivatives:ident, $indicators:ident, $states:ident,
        $nominals:ident
    ) => {
        /// From event mode to continuous-time mode.
        pub fn enter_continuous_time_mode(&self) -> Status {
            // SAFETY: the instance is valid.
            unsafe { $enter(self.instance()) }
        }

        /// A step of the solver is complete, and whether event mode is to be entered.
        pub fn complete_step(&self) -> (Status, bool) {
            let mut told: [Boolean; 2] = [FALSE; 2];
            let [enter, terminate] = &mut told;
            // SAFETY: the instance is valid; each pointer leads to one value.
            let status = unsafe { $completed(self.instance(), FALSE, enter, terminate) };
            (status, told[0] != FALSE)
        }

        /// Set the time [s].
        pub fn set_time(&self, time: f64) -> Status {
            // SAFETY: the instance is valid.
            unsafe { $time(self.instance(), time) }
        }

        /// Set the continuous states.
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

        /// Scales of the continuous states.
        pub fn nominals(&self, values: &mut [f64]) -> Status {
            // SAFETY: as above.
            unsafe { $nominals(self.instance(), values.as_mut_ptr(), values.len()) }
        }
    };
}

pub(crate) use exchange_calls;
pub(crate) use exported;
pub(crate) use exported_exchange;
