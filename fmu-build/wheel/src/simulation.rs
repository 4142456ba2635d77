//! A model with its time, as Python steps it.
//!
//! In: values by names, steps. Out: values, saved states. One thread at a time uses a simulation; the interpreter's
//! lock is released while [`Simulation::run_until`] computes.

use crate::errors::{SimulationError, guarded, input, refused, value};
use crate::names::{Names, array, with_numbers, write};
use crate::run::Run;
use fmu_build::start_values::find;
use linkage_fmu::component::{Component, Snapshot};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Simulation of a mechanism, step by step. `Mechanism.simulation` makes one.
#[pyclass(frozen, weakref, module = "linkage_fmu")]
pub struct Simulation(Mutex<Option<Run>>);

/// All that determines how a simulation continues; `Simulation.save` makes one.
#[pyclass(frozen, module = "linkage_fmu")]
pub struct State {
    snapshot: Mutex<Snapshot>,
    time: f64,
    is_initialized: bool,
    /// Identity of the model: a snapshot of another one cannot be taken.
    identity: [u64; 2],
}

/// A simulation that is held by this call.
struct Held<'a>(MutexGuard<'a, Option<Run>>);

impl Held<'_> {
    #[inline]
    fn run(&mut self) -> PyResult<&mut Run> {
        self.0.as_mut().ok_or_else(|| {
            SimulationError::new_err("this simulation is closed; make a new one with Mechanism.simulation")
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
                "a fault of the engine has left this simulation in an unknown state; make a new one with \
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
    /// Time since the start [s].
    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|run| Ok(run.time))
    }

    /// Look names up once, for fast calls of `get` and `set`.
    ///
    /// Raises InputError if no variable has a name; the text names the nearest ones.
    fn prepare(&self, names: Vec<String>) -> PyResult<Names> {
        self.with(|run| Names::of(&run.model, names))
    }

    /// Present values in SI units. Of one name a number, a truth value or a text. Of several names an array of numbers,
    /// in which a Boolean is 1 or 0; `out` is an array that is filled instead of a new one. An output that does not
    /// exist in the present state is NaN; `undefined` returns the reason.
    ///
    /// Raises InputError if no variable has a name, SimulationError if the parameters give no start.
    #[pyo3(signature = (names, out = None))]
    fn get<'py>(&self, names: &Bound<'py, PyAny>, out: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let py = names.py();
        if let Ok(name) = names.cast::<PyString>() {
            return self.with(|run| run.get(py, &name.to_cow()?));
        }
        let mut values = Vec::new();
        if let Ok(names) = names.cast::<Names>() {
            self.with(|run| run.numbers(names.get(), &mut values))?;
        } else {
            let list = names.extract()?;
            self.with(|run| run.numbers(&Names::of(&run.model, list)?, &mut values))?;
        }
        match out {
            Some(out) => write(&out, &values).map(|()| out),
            None => array(py, &values),
        }
    }

    /// Set inputs and parameters, in SI units: one name and its value, or several names and an array of numbers. A text
    /// may have a unit, such as "45 deg". Within a run, an input or a tunable parameter acts from now on. Any other
    /// parameter ends the run; the next step then needs `initialize`.
    ///
    /// Raises InputError if no variable has a name, if a variable is an output, or if a value is out of range, not
    /// finite, or of another shape. Nothing is set then.
    fn set(&self, names: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        if let Ok(name) = names.cast::<PyString>() {
            return self.with(|run| run.set(&name.to_cow()?, values));
        }
        if let Ok(names) = names.cast::<Names>() {
            let names = names.get();
            return with_numbers(values, names.references.len(), |values| self.with(|run| run.set_all(names, values)));
        }
        let list: Vec<String> = names.extract()?;
        with_numbers(values, list.len(), |values| {
            self.with(|run| {
                let names = Names::of(&run.model, list)?;
                run.set_all(&names, values)
            })
        })
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.with(|run| run.get(py, name))
    }

    fn __setitem__(&self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.with(|run| run.set(name, value))
    }

    /// Reason why an output has no value in the present state; None if it has one.
    fn undefined(&self, name: &str) -> PyResult<Option<String>> {
        self.with(|run| {
            let reference = find(run.model.interface(), name).map_err(input)?;
            Ok(run.model.undefined(reference))
        })
    }

    /// Put the model at its start under the present parameters and inputs, at time 0 s.
    ///
    /// Raises SimulationError if the parameters give no model, or if the start cannot be reached.
    fn initialize(&self) -> PyResult<()> {
        self.with(|run| {
            run.model.initialize().map_err(refused)?;
            (run.time, run.is_initialized) = (0.0, true);
            Ok(())
        })
    }

    /// Back to the values of the definition, not initialised.
    fn reset(&self) -> PyResult<()> {
        self.with(|run| {
            run.model.reset();
            (run.time, run.is_initialized) = (0.0, false);
            Ok(())
        })
    }

    /// Advance by `h` [s] > 0 under the present inputs. The call holds the interpreter's lock.
    ///
    /// Raises InputError if `h` is out of range, SimulationError if the model is not initialised or cannot continue.
    fn step(&self, h: f64) -> PyResult<()> {
        self.with(|run| run.step(h))
    }

    /// Advance to `time` [s] under the present inputs. The interpreter's lock is released. With `at_event`, stop at the
    /// first event, such as the impact on a stop, after it has been handled. Returns what happened there, one line for
    /// each event; an empty list if `time` is reached.
    ///
    /// Raises as `step`.
    #[pyo3(signature = (time, *, at_event = false))]
    fn run_until(&self, py: Python<'_>, time: f64, at_event: bool) -> PyResult<Vec<String>> {
        py.detach(|| self.with(|run| run.run_until(time, at_event)))
    }

    /// Set a time derivative of an input, for the next step only: order 1 [unit/s] or 2 [unit/s2].
    ///
    /// Raises InputError if no continuous input has this name, or if the order or the value is out of range.
    #[pyo3(signature = (name, derivative, order = 1))]
    fn set_derivative(&self, name: &str, derivative: f64, order: i32) -> PyResult<()> {
        self.with(|run| {
            let reference = find(run.model.interface(), name).map_err(input)?;
            run.model.set_input_derivative(reference, order, derivative).map_err(value)
        })
    }

    /// Rate of an output in time [unit/s]; NaN where it has none in the present state.
    ///
    /// Raises InputError if no continuous output has this name.
    fn derivative(&self, name: &str) -> PyResult<f64> {
        self.with(|run| {
            let reference = find(run.model.interface(), name).map_err(input)?;
            run.model.output_derivative(reference, 1).map_err(value)
        })
    }

    /// Derivatives of the outputs in a direction: for each output the sum of its partial derivatives by the inputs,
    /// each times its seed. Before `initialize`, the inputs may be parameters, and the outputs are those at the start.
    ///
    /// Raises InputError if a name is none of an output or an input, or if the seeds are not as many as the inputs.
    fn directional_derivative<'py>(
        &self,
        py: Python<'py>,
        outputs: Vec<String>,
        inputs: Vec<String>,
        seeds: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut found = vec![0.0; outputs.len()];
        with_numbers(seeds, inputs.len(), |seeds| {
            self.with(|run| {
                let unknowns = Names::of(&run.model, outputs)?.references;
                let knowns = Names::of(&run.model, inputs)?.references;
                let mut report = |index: usize, value: f64| found[index] = value;
                let is_initial = !run.is_initialized;
                let done = run.model.directional_derivative(is_initial, &unknowns, &knowns, seeds, &mut report);
                done.map_err(value)
            })
        })?;
        array(py, &found)
    }

    /// Save all that determines how the simulation continues.
    fn save(&self) -> PyResult<State> {
        self.with(|run| {
            let snapshot = Mutex::new(run.model.snapshot());
            let identity = run.model.identity();
            Ok(State { snapshot, time: run.time, is_initialized: run.is_initialized, identity })
        })
    }

    /// Continue from a saved state, of this simulation or another one of the same mechanism.
    ///
    /// Raises InputError if the state belongs to another mechanism.
    fn restore(&self, state: &State) -> PyResult<()> {
        self.with(|run| {
            if state.identity != run.model.identity() {
                return Err(input("this state is of another mechanism; restore a state of a simulation of this one"));
            }
            let snapshot = state.snapshot.lock().map_err(refused)?;
            run.model.restore(&snapshot).map_err(value)?;
            (run.time, run.is_initialized) = (state.time, state.is_initialized);
            Ok(())
        })
    }

    /// Read a state from the bytes that `State.to_bytes` has written.
    ///
    /// Raises InputError if the bytes are no state of this mechanism.
    fn state_from_bytes(&self, bytes: &[u8]) -> PyResult<State> {
        self.with(|run| {
            let no_state =
                || input("these bytes are not a saved state of this mechanism; give those of State.to_bytes");
            let (head, snapshot) = bytes.split_at_checked(24).ok_or_else(no_state)?;
            let word = |at: usize| u64::from_le_bytes(head[8 * at..8 * at + 8].try_into().unwrap_or_default());
            let time = f64::from_bits(word(0));
            if [word(1), word(2)] != run.model.identity() || !time.is_finite() {
                return Err(no_state());
            }
            let snapshot = run.model.read_snapshot(snapshot).map_err(value)?;
            let is_initialized = snapshot.is_initialized();
            let identity = run.model.identity();
            Ok(State { snapshot: Mutex::new(snapshot), time, is_initialized, identity })
        })
    }

    /// A simulation in the same state that continues by itself, for another thread or another variant.
    fn copy(&self) -> PyResult<Self> {
        self.with(|run| Ok(Self(Mutex::new(Some(run.clone())))))
    }

    fn __copy__(&self) -> PyResult<Self> {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copy()
    }

    /// Release the memory of the model. Later calls raise SimulationError.
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

    fn __repr__(&self) -> PyResult<String> {
        self.with(|run| Ok(format!("<Simulation of {} at {:?} s>", run.model.name(), run.time)))
    }
}

#[pymethods]
impl State {
    /// Time of the state [s].
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// The state as bytes, which `Simulation.state_from_bytes` reads, also in another process.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        guarded(|| {
            let head = [self.time.to_bits(), self.identity[0], self.identity[1]];
            let mut bytes: Vec<u8> = head.into_iter().flat_map(u64::to_le_bytes).collect();
            self.snapshot.lock().map_err(refused)?.write(&mut bytes).map_err(value)?;
            Ok(PyBytes::new(py, &bytes))
        })
    }
}
