//! An importer of any FMU of FMI 2.0 for co-simulation. It opens the shared library and finds the functions by name.
//!
//! In: shared library, GUID and resource location of an FMU. Out: instances called through the C functions: statuses,
//! values, derivatives, saved states. Must not know: how a call works, and that this crate exports the same functions.
//! Each method is one call. An FMU is foreign code; each array that is passed to it has the stated length.
use super::host::{Log, callbacks};
use super::types::{
    Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE, FmuState, Integer, LoggerCallback, Real, Status, Text,
    ValueReference,
};
use std::ffi::{CString, OsStr, c_int, c_void};
use std::ptr::null_mut;
use std::sync::Arc;

/// Declares the table of the functions of an FMU: field, exported name, arguments after the component.
macro_rules! functions {
    ($($field:ident = $name:ident($($argument:ty),*);)*) => {
        /// Functions of an FMU that have a component as the first argument and return a status.
        #[derive(Clone, Copy, Debug)]
        struct Functions {
            $($field: unsafe extern "C" fn(Component $(, $argument)*) -> c_int,)*
            instantiate: unsafe extern "C" fn(
                Text, c_int, Text, Text, *const CallbackFunctions, Boolean, Boolean
            ) -> Component,
            free_instance: unsafe extern "C" fn(Component),
        }

        impl Functions {
            /// The functions of an opened library.
            ///
            /// # Errors
            /// The name of a function that the library does not export.
            fn find(library: &shared::Library) -> Result<Self, String> {
                // SAFETY: FMI 2.0.5 defines the type of each name.
                unsafe {
                    Ok(Self {
                        $($field: std::mem::transmute::<
                            *mut c_void, unsafe extern "C" fn(Component $(, $argument)*) -> c_int
                        >(library.symbol(concat!("fmi2", stringify!($name)))?),)*
                        instantiate: std::mem::transmute::<*mut c_void, unsafe extern "C" fn(
                            Text, c_int, Text, Text, *const CallbackFunctions, Boolean, Boolean
                        ) -> Component>(library.symbol("fmi2Instantiate")?),
                        free_instance: std::mem::transmute::<
                            *mut c_void, unsafe extern "C" fn(Component)
                        >(library.symbol("fmi2FreeInstance")?),
                    })
                }
            }
        }
    };
}

functions! {
    setup = SetupExperiment(Boolean, Real, Real, Boolean, Real);
    enter = EnterInitializationMode();
    exit = ExitInitializationMode();
    terminate = Terminate();
    reset = Reset();
    get_real = GetReal(*const ValueReference, usize, *mut Real);
    set_real = SetReal(*const ValueReference, usize, *const Real);
    set_boolean = SetBoolean(*const ValueReference, usize, *const Boolean);
    set_integer = SetInteger(*const ValueReference, usize, *const Integer);
    input_derivatives = SetRealInputDerivatives(*const ValueReference, usize, *const c_int, *const Real);
    output_derivatives = GetRealOutputDerivatives(*const ValueReference, usize, *const c_int, *mut Real);
    directional = GetDirectionalDerivative(
        *const ValueReference, usize, *const ValueReference, usize, *const Real, *mut Real
    );
    step = DoStep(Real, Real, Boolean);
    get_state = GetFMUstate(*mut FmuState);
    set_state = SetFMUstate(FmuState);
    free_state = FreeFMUstate(*mut FmuState);
}

/// Shared libraries of the operating system.
#[cfg(unix)]
mod shared {
    use super::{CString, OsStr, c_void};
    use std::ffi::CStr;
    use std::os::unix::ffi::OsStrExt;

    /// An open shared library. The library is never closed, because its code may run until the process ends.
    #[derive(Debug)]
    pub struct Library(*mut c_void);

    impl Library {
        /// # Errors
        /// Reason why the library cannot be opened.
        pub fn open(path: &OsStr) -> Result<Self, String> {
            let path = CString::new(path.as_bytes()).map_err(|e| e.to_string())?;
            // SAFETY: the path is zero-terminated; `dlerror` returns a text or NULL.
            unsafe {
                let library = libc::dlopen(path.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL);
                if !library.is_null() {
                    return Ok(Self(library));
                }
                let reason = libc::dlerror();
                let reason = if reason.is_null() { c"unknown" } else { CStr::from_ptr(reason) };
                Err(reason.to_string_lossy().into_owned())
            }
        }

        /// # Errors
        /// The library does not export this name.
        pub fn symbol(&self, name: &str) -> Result<*mut c_void, String> {
            let text = CString::new(name).map_err(|e| e.to_string())?;
            // SAFETY: the library is open; the name is zero-terminated.
            let symbol = unsafe { libc::dlsym(self.0, text.as_ptr()) };
            if symbol.is_null() { Err(format!("the library does not export {name}")) } else { Ok(symbol) }
        }
    }
}

/// Shared libraries of the operating system.
#[cfg(windows)]
mod shared {
    use super::{CString, OsStr, c_void};
    use std::os::windows::ffi::OsStrExt;

    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn LoadLibraryW(path: *const u16) -> *mut c_void;
        fn GetProcAddress(library: *mut c_void, name: *const std::ffi::c_char) -> *mut c_void;
    }

    /// An open shared library. The library is never closed, because its code may run until the process ends.
    #[derive(Debug)]
    pub struct Library(*mut c_void);

    impl Library {
        /// # Errors
        /// Reason why the library cannot be opened.
        pub fn open(path: &OsStr) -> Result<Self, String> {
            let path: Vec<u16> = path.encode_wide().chain([0]).collect();
            // SAFETY: the path is zero-terminated.
            let library = unsafe { LoadLibraryW(path.as_ptr()) };
            if library.is_null() { Err(std::io::Error::last_os_error().to_string()) } else { Ok(Self(library)) }
        }

        /// # Errors
        /// The library does not export this name.
        pub fn symbol(&self, name: &str) -> Result<*mut c_void, String> {
            let text = CString::new(name).map_err(|e| e.to_string())?;
            // SAFETY: the library is open; the name is zero-terminated.
            let symbol = unsafe { GetProcAddress(self.0, text.as_ptr()) };
            if symbol.is_null() { Err(format!("the library does not export {name}")) } else { Ok(symbol) }
        }
    }
}

/// The shared library of an FMU, with the data for new instances.
#[derive(Debug)]
pub struct Library {
    functions: Functions,
    guid: CString,
    resources: CString,
}

impl Library {
    /// Opens the shared library at `path` of an FMU with this GUID and resource location (a URI).
    ///
    /// # Errors
    /// The library cannot be opened, or does not export a required function.
    pub fn open(path: &OsStr, guid: &str, resources: &str) -> Result<Arc<Self>, String> {
        let refused = |reason: String| format!("{}: {reason}", path.to_string_lossy());
        let functions = Functions::find(&shared::Library::open(path).map_err(refused)?).map_err(refused)?;
        let text = |text: &str| CString::new(text).map_err(|e| refused(e.to_string()));
        Ok(Arc::new(Self { functions, guid: text(guid)?, resources: text(resources)? }))
    }

    /// New instance for co-simulation. Its messages go to its log.
    ///
    /// # Errors
    /// The FMU returns NULL.
    pub fn instantiate(self: &Arc<Self>, name: &str, logger: Option<LoggerCallback>) -> Result<Instance, String> {
        let log = Box::<Log>::default();
        let name = CString::new(name).map_err(|e| e.to_string())?;
        // An FMU may keep the pointer to the callbacks, and may call the memory functions (FMI 2.0.5, 2.1.5).
        let functions = Box::new(CallbackFunctions {
            allocate_memory: Some(libc::calloc),
            free_memory: Some(libc::free),
            ..callbacks(logger, &log)
        });
        let Functions { instantiate, .. } = self.functions;
        let (guid, resources) = (self.guid.as_ptr(), self.resources.as_ptr());
        // SAFETY: all pointers are valid during the call, the log and the callbacks as long as the instance.
        let c = unsafe { instantiate(name.as_ptr(), CO_SIMULATION, guid, resources, &*functions, FALSE, FALSE) };
        if c.is_null() {
            return Err(format!("fmi2Instantiate: refused: {:?}", log.take()));
        }
        Ok(Instance { c, library: Arc::clone(self), log, _functions: functions })
    }
}

/// A saved state of an [`Instance`]. [`Instance::free`] frees it.
#[derive(Debug)]
pub struct State(FmuState);

impl State {
    /// No state yet: [`Instance::save`] creates one.
    pub const NONE: Self = Self(null_mut());
}

/// An instance of an FMU. Dropping it frees the FMU's instance.
#[derive(Debug)]
pub struct Instance {
    c: Component,
    library: Arc<Library>,
    /// Messages of the instance.
    pub log: Box<Log>,
    _functions: Box<CallbackFunctions>,
}

impl Instance {
    /// Converts a status of the FMU to a result. An error contains the messages since the last call.
    fn answer(&self, function: &str, status: c_int) -> Result<(), String> {
        const OK: c_int = Status::Ok as c_int;
        const WARNING: c_int = Status::Warning as c_int;
        match status {
            OK | WARNING => Ok(()),
            status => Err(format!("{function}: fmi2Status {status}: {:?}", self.log.take())),
        }
    }

    /// `fmi2SetupExperiment`.
    ///
    /// # Errors
    /// In every method: the status of the FMU is neither `fmi2OK` nor `fmi2Warning`.
    pub fn set_up(&self, start: f64, stop: Option<f64>) -> Result<(), String> {
        let setup = self.library.functions.setup;
        // SAFETY: the component is valid.
        let status = unsafe { setup(self.c, FALSE, 0.0, start, Boolean::from(stop.is_some()), stop.unwrap_or(0.0)) };
        self.answer("fmi2SetupExperiment", status)
    }

    /// `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn initialize(&self) -> Result<(), String> {
        let Functions { enter, exit, .. } = self.library.functions;
        // SAFETY: the component is valid.
        self.answer("fmi2EnterInitializationMode", unsafe { enter(self.c) })?;
        // SAFETY: the component is valid.
        self.answer("fmi2ExitInitializationMode", unsafe { exit(self.c) })
    }

    /// `fmi2Terminate`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn terminate(&self) -> Result<(), String> {
        // SAFETY: the component is valid.
        self.answer("fmi2Terminate", unsafe { (self.library.functions.terminate)(self.c) })
    }

    /// `fmi2Reset`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn reset(&self) -> Result<(), String> {
        // SAFETY: the component is valid.
        self.answer("fmi2Reset", unsafe { (self.library.functions.reset)(self.c) })
    }

    /// `fmi2GetReal`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn reals<const N: usize>(&self, references: &[ValueReference; N]) -> Result<[f64; N], String> {
        let mut values = [f64::NAN; N];
        // SAFETY: the component is valid; both arrays have the length that is passed.
        let status = unsafe { (self.library.functions.get_real)(self.c, references.as_ptr(), N, values.as_mut_ptr()) };
        self.answer("fmi2GetReal", status).map(|()| values)
    }

    /// `fmi2SetReal`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn set_reals<const N: usize>(&self, references: &[ValueReference; N], values: &[f64; N]) -> Result<(), String> {
        // SAFETY: the component is valid; both arrays have the length that is passed.
        let status = unsafe { (self.library.functions.set_real)(self.c, references.as_ptr(), N, values.as_ptr()) };
        self.answer("fmi2SetReal", status)
    }

    /// `fmi2SetBoolean` of one variable.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn set_boolean(&self, reference: ValueReference, value: bool) -> Result<(), String> {
        // SAFETY: the component is valid; one reference, one value.
        let status = unsafe { (self.library.functions.set_boolean)(self.c, &reference, 1, &Boolean::from(value)) };
        self.answer("fmi2SetBoolean", status)
    }

    /// `fmi2SetInteger` of one variable.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn set_integer(&self, reference: ValueReference, value: Integer) -> Result<(), String> {
        // SAFETY: the component is valid; one reference, one value.
        let status = unsafe { (self.library.functions.set_integer)(self.c, &reference, 1, &value) };
        self.answer("fmi2SetInteger", status)
    }

    /// `fmi2SetRealInputDerivatives` of one input, with the orders 1, 2 and so on.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn set_derivatives<const N: usize>(&self, input: ValueReference, values: &[f64; N]) -> Result<(), String> {
        let orders: [c_int; N] = std::array::from_fn(|k| k as c_int + 1);
        let references = [input; N];
        let set = self.library.functions.input_derivatives;
        // SAFETY: the component is valid; the arrays have the length that is passed.
        let status = unsafe { set(self.c, references.as_ptr(), N, orders.as_ptr(), values.as_ptr()) };
        self.answer("fmi2SetRealInputDerivatives", status)
    }

    /// `fmi2GetRealOutputDerivatives` of one output, of order 1.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn rate(&self, output: ValueReference) -> Result<f64, String> {
        let mut value = f64::NAN;
        // SAFETY: the component is valid; one reference, one order, one value.
        let status = unsafe { (self.library.functions.output_derivatives)(self.c, &output, 1, &1, &mut value) };
        self.answer("fmi2GetRealOutputDerivatives", status).map(|()| value)
    }

    /// `fmi2GetDirectionalDerivative` of one unknown along one known.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn derivative(&self, unknown: ValueReference, known: ValueReference) -> Result<f64, String> {
        let mut value = f64::NAN;
        let directional = self.library.functions.directional;
        // SAFETY: the component is valid; one unknown, one known, one seed, one value.
        let status = unsafe { directional(self.c, &unknown, 1, &known, 1, &1.0, &mut value) };
        self.answer("fmi2GetDirectionalDerivative", status).map(|()| value)
    }

    /// `fmi2DoStep` of size `h` [s] from the communication point `t` [s].
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn step(&self, t: f64, h: f64) -> Result<(), String> {
        // SAFETY: the component is valid.
        self.answer("fmi2DoStep", unsafe { (self.library.functions.step)(self.c, t, h, FALSE) })
    }

    /// `fmi2GetFMUstate` into an existing state of this instance, or a new one for [`State::NONE`].
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn save(&self, state: &mut State) -> Result<(), String> {
        // SAFETY: the component is valid; the state is NULL or belongs to this instance.
        self.answer("fmi2GetFMUstate", unsafe { (self.library.functions.get_state)(self.c, &mut state.0) })
    }

    /// `fmi2SetFMUstate`.
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn restore(&self, state: &State) -> Result<(), String> {
        // SAFETY: the component is valid; the state is NULL or belongs to this instance.
        self.answer("fmi2SetFMUstate", unsafe { (self.library.functions.set_state)(self.c, state.0) })
    }

    /// `fmi2FreeFMUstate`. The state becomes [`State::NONE`].
    ///
    /// # Errors
    /// As [`Self::set_up`].
    pub fn free(&self, state: &mut State) -> Result<(), String> {
        // SAFETY: the component is valid; the state is NULL or belongs to this instance.
        self.answer("fmi2FreeFMUstate", unsafe { (self.library.functions.free_state)(self.c, &mut state.0) })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the component is not used again.
        unsafe { (self.library.functions.free_instance)(self.c) }
    }
}
