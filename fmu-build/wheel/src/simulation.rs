//! A model with its time, for steps from Python.
//!
//! In: values by names, steps. Out: values, saved states. One thread at a time uses a simulation. The interpreter lock
//! is released while [`Simulation::run_until`] computes.

use crate::arguments::{number, numbers, text, truth, whole, wrong};
use crate::errors::{SimulationError, guarded, input, refused, value};
use crate::names::{Names, array, write};
use crate::run::Run;
use fmu_build::start_values::find;
use linkage_fmu::component::{Component, Snapshot};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Step-by-step simulation of a mechanism. The method `Mechanism.simulation` returns a new simulation.
#[pyclass(frozen, weakref, module = "linkage_fmu")]
pub struct Simulation(Mutex<Option<Run>>);

/// Saved state of a simulation. The method `Simulation.save` returns a saved state, and `Simulation.restore` continues
/// from a saved state.
#[pyclass(frozen, module = "linkage_fmu")]
pub struct State {
    snapshot: Mutex<Snapshot>,
    time: f64,
    is_initialized: bool,
}

/// A simulation that this call has locked.
struct Held<'a>(MutexGuard<'a, Option<Run>>);

impl Held<'_> {
    #[inline]
    fn run(&mut self) -> PyResult<&mut Run> {
        self.0.as_mut().ok_or_else(|| {
            SimulationError::new_err("this simulation is closed; create a new simulation with Mechanism.simulation")
        })
    }
}

impl Simulation {
    /// A simulation of this model, not initialised.
    pub fn new(model: Component) -> Self {
        Self(Mutex::new(Some(Run { model, time: 0.0, is_initialized: false })))
    }

    #[inline]
    fn held(&self) -> PyResult<Held<'_>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(Held(guard)),
            Err(TryLockError::WouldBlock) => Err(SimulationError::new_err(
                "another thread uses this simulation; wait until its run ends, or give each thread a copy()",
            )),
            Err(TryLockError::Poisoned(_)) => Err(SimulationError::new_err(
                "an internal error has left this simulation in an unknown state; create a new simulation with \
                    Mechanism.simulation",
            )),
        }
    }

    /// Call `body` with the model.
    #[inline]
    fn with<T>(&self, body: impl FnOnce(&mut Run) -> PyResult<T>) -> PyResult<T> {
        guarded(|| body(self.held()?.run()?))
    }
}

#[pymethods]
impl Simulation {
    /// Time since the start of the simulation [s].
    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|run| Ok(run.time))
    }

    /// Look up the names of variables. With the `Names` object that `prepare` returns, calls of `get` and `set` are
    /// faster than with names.
    ///
    /// The method `prepare` raises InputError if a name is not the name of a variable, or if a name occurs twice. The
    /// text of the exception lists the most similar names.
    fn prepare(&self, names: &Bound<'_, PyAny>) -> PyResult<Names> {
        self.with(|run| Names::of(&run.model, "names", names))
    }

    /// Return the present values of variables in SI units. For one name, `get` returns a number, a truth value or a
    /// text. For several names, `get` returns an array of numbers, in which a Boolean is 1 or 0. If `out` is an array,
    /// `get` writes the values into `out` instead of a new array. If an output has no value in the present state, `get`
    /// returns NaN, and the method `undefined` returns the reason.
    ///
    /// The method `get` raises InputError if a name is not the name of a variable. The method `get` raises
    /// SimulationError if the mechanism cannot start with the present parameters.
    #[pyo3(signature = (names, out = None))]
    fn get<'py>(&self, names: &Bound<'py, PyAny>, out: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let py = names.py();
        if let Ok(name) = names.cast::<PyString>() {
            let name = text("names", name)?;
            return self.with(|run| run.get(py, &name));
        }
        let mut values = Vec::new();
        if let Ok(names) = names.cast::<Names>() {
            self.with(|run| run.numbers(names.get(), &mut values))?;
        } else {
            self.with(|run| run.numbers(&Names::of(&run.model, "names", names)?, &mut values))?;
        }
        match out {
            Some(out) => write(&out, &values).map(|()| out),
            None => array(py, &values),
        }
    }

    /// Set inputs and parameters. The arguments `names` and `values` are one name and its value, or several names and
    /// an array or list of their values. Each value is a number in SI units, a truth value, an enumeration item, or a
    /// text such as "45 deg" or "true". During a simulation, a new value of an input or of a tunable parameter applies
    /// from the present time. After a new value of any other parameter, call `initialize` before the next step.
    ///
    /// The method `set` raises InputError if a name is not the name of a variable, if a name occurs twice, or if a
    /// variable is an output. The method `set` raises InputError if a value is out of range, not finite, or of a wrong
    /// unit, type or shape. If `set` raises InputError, `set` has changed no value.
    fn set(&self, names: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        if let Ok(name) = names.cast::<PyString>() {
            let name = text("names", name)?;
            return self.with(|run| run.set(&name, values));
        }
        if let Ok(names) = names.cast::<Names>() {
            return self.with(|run| run.set_all(names.get(), values));
        }
        self.with(|run| run.set_all(&Names::of(&run.model, "names", names)?, values))
    }

    fn __getitem__<'py>(&self, name: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, name) = (name.py(), text("name", name)?);
        self.with(|run| run.get(py, &name))
    }

    fn __setitem__(&self, name: &Bound<'_, PyAny>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let name = text("name", name)?;
        self.with(|run| run.set(&name, value))
    }

    /// Return the reason why an output has no value in the present state. If the output has a value, `undefined`
    /// returns None.
    fn undefined(&self, name: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
        let name = text("name", name)?;
        self.with(|run| {
            let reference = find(run.model.interface(), &name).map_err(input)?;
            Ok(run.model.undefined(reference))
        })
    }

    /// Move the mechanism to its start position at the time 0 s, with the present parameters and inputs.
    ///
    /// The method `initialize` raises SimulationError if the present parameters are not valid, or if the mechanism
    /// cannot reach the start position.
    fn initialize(&self) -> PyResult<()> {
        self.with(|run| {
            run.model.initialize().map_err(refused)?;
            (run.time, run.is_initialized) = (0.0, true);
            Ok(())
        })
    }

    /// Reset all variables of the simulation to the values in the definition. Call the method `initialize` before the
    /// next step.
    fn reset(&self) -> PyResult<()> {
        self.with(|run| {
            run.model.reset();
            (run.time, run.is_initialized) = (0.0, false);
            Ok(())
        })
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> PyResult<bool> {
        let name = text("name", name)?;
        self.with(|run| Ok(find(run.model.interface(), &name).is_ok()))
    }

    /// Advance the simulation by the time `h` [s], with the present inputs. The time `h` must be > 0. During the call
    /// of `step`, no other Python thread runs, because `step` holds the interpreter lock.
    ///
    /// The method `step` raises InputError if `h` is out of range. The method `step` raises SimulationError if the
    /// simulation is not initialised or cannot continue.
    fn step(&self, h: &Bound<'_, PyAny>) -> PyResult<()> {
        let h = number("h", h)?;
        self.with(|run| run.step(h))
    }

    /// Advance the simulation to the time `time` [s], with the present inputs. During the call of `run_until`, other
    /// Python threads can run, because `run_until` releases the interpreter lock. If `at_event` is true, `run_until`
    /// stops just after the first event, such as the impact on a stop. The method `run_until` returns a list with one
    /// line of text for each event at the end of the call. If the simulation has reached `time` without an event, the
    /// list is empty.
    ///
    /// Ctrl-C takes effect when the call of `run_until` returns, after at most `solver.max_steps` integration steps.
    ///
    /// The method `run_until` raises the same exceptions as `step`.
    #[pyo3(signature = (time, *, at_event = None), text_signature = "($self, time, *, at_event=False)")]
    fn run_until(
        &self,
        py: Python<'_>,
        time: &Bound<'_, PyAny>,
        at_event: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<String>> {
        let time = number("time", time)?;
        let at_event = at_event.map_or(Ok(false), |given| truth("at_event", given))?;
        py.detach(|| self.with(|run| run.run_until(time, at_event)))
    }

    /// Set a time derivative of an input for the next step only. The argument `order` is 1 for the first derivative
    /// [unit/s], or 2 for the second derivative [unit/s2].
    ///
    /// The method `set_derivative` raises InputError if no continuous input has the given name, or if `order` or
    /// `derivative` is out of range.
    #[pyo3(signature = (name, derivative, order = None), text_signature = "($self, name, derivative, order=1)")]
    fn set_derivative(
        &self,
        name: &Bound<'_, PyAny>,
        derivative: &Bound<'_, PyAny>,
        order: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (name, derivative) = (text("name", name)?, number("derivative", derivative)?);
        let order = order.map_or(Ok(1), |order| whole::<1, 2>("order", order))? as i32;
        self.with(|run| {
            let reference = find(run.model.interface(), &name).map_err(input)?;
            run.model.set_input_derivative(reference, order, derivative).map_err(value)
        })
    }

    /// Return the time derivative of an output [unit/s]. The method `derivative` returns NaN if the time derivative
    /// does not exist in the present state.
    ///
    /// The method `derivative` raises InputError if no continuous output has the given name.
    fn derivative(&self, name: &Bound<'_, PyAny>) -> PyResult<f64> {
        let name = text("name", name)?;
        self.with(|run| {
            let reference = find(run.model.interface(), &name).map_err(input)?;
            run.model.output_derivative(reference, 1).map_err(value)
        })
    }

    /// Return the directional derivatives of outputs. The directional derivative of an output is the sum over all
    /// `inputs` of the partial derivative with respect to the input, multiplied by the seed of the input. Before the
    /// call of `initialize`, `inputs` can also contain parameters. Before the call of `initialize`,
    /// `directional_derivative` returns derivatives of the outputs at the start position.
    ///
    /// The method `directional_derivative` raises InputError if a name is not the name of an output or input, or if
    /// the numbers of seeds and inputs differ.
    fn directional_derivative<'py>(
        &self,
        py: Python<'py>,
        outputs: &Bound<'py, PyAny>,
        inputs: &Bound<'py, PyAny>,
        seeds: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let found = self.with(|run| {
            let unknowns = Names::of(&run.model, "outputs", outputs)?.references;
            let knowns = Names::of(&run.model, "inputs", inputs)?.references;
            let seeds = numbers("seeds", seeds, knowns.len())?;
            let mut found = vec![0.0; unknowns.len()];
            let mut report = |index: usize, value: f64| found[index] = value;
            let is_initial = !run.is_initialized;
            let done = run.model.directional_derivative(is_initial, &unknowns, &knowns, &seeds, &mut report);
            done.map(|()| found).map_err(value)
        })?;
        array(py, &found)
    }

    /// Save the present state of the simulation. The method `restore` continues a simulation from the saved state.
    fn save(&self) -> PyResult<State> {
        self.with(|run| {
            let snapshot = Mutex::new(run.model.snapshot());
            Ok(State { snapshot, time: run.time, is_initialized: run.is_initialized })
        })
    }

    /// Return the simulation to a saved state. The saved state can also come from another simulation of the same
    /// mechanism.
    ///
    /// The method `restore` raises InputError if the saved state belongs to another mechanism.
    fn restore(&self, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let Ok(state) = state.cast::<State>() else {
            return Err(wrong("state", state, "a State; Simulation.save makes one"));
        };
        let state = state.get();
        self.with(|run| {
            let snapshot = state.snapshot.lock().map_err(refused)?;
            run.model.restore(&snapshot).map_err(value)?;
            (run.time, run.is_initialized) = (state.time, state.is_initialized);
            Ok(())
        })
    }

    /// Convert bytes from `State.to_bytes` back to a saved state.
    ///
    /// The method `state_from_bytes` raises InputError if the bytes do not contain a state of the mechanism of the
    /// simulation.
    fn state_from_bytes(&self, bytes: &Bound<'_, PyAny>) -> PyResult<State> {
        let Ok(bytes) = bytes.cast::<PyBytes>() else {
            return Err(wrong("bytes", bytes, "bytes of State.to_bytes"));
        };
        let bytes = bytes.as_bytes();
        self.with(|run| {
            let no_state =
                || input("these bytes are not a saved state of this mechanism; give the bytes of State.to_bytes");
            let (head, snapshot) = bytes.split_at_checked(24).ok_or_else(no_state)?;
            let word = |at: usize| u64::from_le_bytes(head[8 * at..8 * at + 8].try_into().unwrap_or_default());
            let time = f64::from_bits(word(0));
            if [word(1), word(2)] != run.model.identity() || !time.is_finite() {
                return Err(no_state());
            }
            let snapshot = run.model.read_snapshot(snapshot).map_err(value)?;
            let is_initialized = snapshot.is_initialized();
            Ok(State { snapshot: Mutex::new(snapshot), time, is_initialized })
        })
    }

    /// Return an independent copy of the simulation in its present state.
    fn copy(&self) -> PyResult<Self> {
        self.with(|run| Ok(Self(Mutex::new(Some(run.clone())))))
    }

    fn __copy__(&self) -> PyResult<Self> {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copy()
    }

    /// Release the memory of the simulation. Calls after `close` raise SimulationError.
    fn close(&self) -> PyResult<()> {
        *self.held()?.0 = None;
        Ok(())
    }

    fn __enter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __exit__(
        &self,
        _class: &Bound<'_, PyAny>,
        _error: &Bound<'_, PyAny>,
        _trace: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        self.close()
    }

    fn __repr__(&self) -> String {
        match self.0.try_lock().as_deref() {
            Ok(Some(run)) => format!("<Simulation of {} at {:?} s>", run.model.name(), run.time),
            Ok(None) => "<Simulation, closed>".to_owned(),
            Err(TryLockError::WouldBlock) => "<Simulation, in use by another thread>".to_owned(),
            Err(TryLockError::Poisoned(_)) => "<Simulation, unusable after a fault of the engine>".to_owned(),
        }
    }
}

#[pymethods]
impl State {
    /// Simulation time of the saved state [s].
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// Return the saved state as bytes. The method `Simulation.state_from_bytes` converts the bytes back to a saved
    /// state, also in another process.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        guarded(|| {
            let mut snapshot = self.snapshot.lock().map_err(refused)?;
            let [guid, structure] = snapshot.identity();
            let head = [self.time.to_bits(), guid, structure];
            let mut bytes: Vec<u8> = head.into_iter().flat_map(u64::to_le_bytes).collect();
            snapshot.write(&mut bytes).map_err(value)?;
            Ok(PyBytes::new(py, &bytes))
        })
    }
}
