//! The model: one mechanism with its present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference. It must not know FMI's life cycle.
mod derivatives;
mod description;
mod events;
mod exchange;
mod formulation;
mod linearisation;
mod occurrences;
mod plan;
mod shared;
mod travel_time;
mod tune;
mod undefined;
mod values;
mod warnings;

use super::designs::Designs;
use super::dynamics::inputs::{InputPolynomial, InputValues, Inputs};
use super::error::ModelError;
use super::interface;
use super::motion::state::{Reached, State};
use super::motion::witness::Pauses;
use super::outputs::{Computed, ReducedMotion};
use super::parameters::ParameterValues;
use super::quantity::{Hydraulic, Output, Quantity};
use super::warnings::warnings;
use super::with_hydraulics::allow_hydraulics;
use crate::codec::sections::Sections;
use crate::hydraulics::network::outputs::Output as Flow;
use crate::inspection::Finding;
use crate::integrator::{SHORTEST, Statistics};
use crate::mechanism::definition::{Mechanism, Method, Range, Role};
use crate::mechanism::reduced::Reduced;
use crate::variables::{Reference, Value, Variables};
pub use derivatives::{INPUT_ORDER, OUTPUT_ORDER};
pub use exchange::{Exchange, NoValue};
pub(super) use formulation::Formulation;
pub use linearisation::{Linearisation, Linearised};
pub use occurrences::Line;
use occurrences::Told;
use std::sync::{Arc, OnceLock};
pub(super) use tune::Untuned;
use warnings::warnings_at_start;
pub(super) use warnings::{Clipped, Watched};

/// Section of the kept tables with the GUID of the interface.
const GUID: &str = "guid";

/// One mechanism with its parameters, inputs and state.
#[derive(Clone, Debug)]
pub struct Model {
    /// As read; [`Self::reset`] returns to it.
    pub(super) original: Arc<Original>,
    /// The present parameters; shared with the snapshots that were taken under them.
    pub(super) parameter_values: Arc<ParameterValues>,
    pub(super) inputs: Inputs,
    /// The reduced model for the present parameters; none after one of them has changed.
    pub(super) reduced: Option<Arc<Reduced>>,
    /// What follows from the parameters that were present last; a next set keeps of it what does not change.
    pub(super) designs: Designs,
    pub(super) state: Option<Formulation>,
    /// The motion before the last [`Self::reset`], with its reduced model: the next start is put in its place.
    spare: Option<(Arc<Reduced>, Box<ReducedMotion>)>,
    /// Whether inputs leave the mechanism where it is: after the initialisation also one that starts at an equilibrium.
    pub(super) is_placed: bool,
    /// Whether [`Self::take_growth`] has told that the curve grows.
    has_told: bool,
    pub(super) clipped: Clipped,
    pub(super) watched: Watched,
    told: Told,
    /// Whether the host knows that `energy.drift` has no value in model exchange.
    lacks_drift: bool,
    /// The laws of the last step, where they are not the present ones.
    pub(super) untuned: Option<Untuned>,
    /// What model exchange keeps, if that is what the model is for.
    pub(super) exchange: Option<Exchange>,
    plan: plan::Plan,
}

/// A definition as read, before any value is set.
#[derive(Debug)]
pub(super) struct Original {
    pub(super) parameter_values: Arc<ParameterValues>,
    pub(super) variables: Variables<Quantity>,
    pub(super) ranges: Vec<(Range, Role)>,
    pub(super) inputs: Inputs,
    /// Identity of the mechanism for snapshots, found when the first one is taken.
    pub(super) identity: OnceLock<[u64; 2]>,
    /// [`Model::initial_dependencies`], once they were asked for.
    dependencies: OnceLock<Option<Vec<Vec<Reference>>>>,
    pub(super) reduced: Arc<Reduced>,
    /// What the definition gives reason to warn of.
    pub(super) warnings: Vec<Finding>,
    /// At the start of a run.
    watched: Watched,
}

impl Model {
    /// Read a mechanism from the text of its `mechanism.json`, assemble it and trace its motion.
    ///
    /// # Errors
    /// The definition is wrong, or gives no mechanism.
    pub fn from_json(text: &str) -> Result<Self, ModelError> {
        Self::with_tables(text, None)
    }

    /// [`Self::from_json`] with kept tables of this text, if there are any: the same model to the bit, but for the
    /// descriptions of its variables, which are empty.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn with_tables(text: &str, tables: Option<Arc<Sections>>) -> Result<Self, ModelError> {
        allow_hydraulics();
        Self::with_mechanism(Mechanism::from_json(text)?, tables)
    }

    /// The model of a mechanism that was read and checked, with kept tables of its text, if there are any.
    pub(super) fn with_mechanism(mut mechanism: Mechanism, tables: Option<Arc<Sections>>) -> Result<Self, ModelError> {
        let mut found = mechanism.warnings();
        let stored = tables.and_then(|tables| Some((Reduced::stored(&mechanism, &tables)?, tables.read(GUID)?)));
        let stored = stored.and_then(|(reduced, guid)| Some((reduced, String::from_utf8(guid).ok()?)));
        let is_stored = stored.is_some();
        let (variables, reduced) = match stored {
            Some((reduced, guid)) => {
                let resolved = (reduced.linkage(), reduced.loading(), &reduced.markers[..]);
                (interface::kept_variables(&mut mechanism, resolved, guid), reduced)
            }
            None => (interface::variables(&mechanism)?, Reduced::new(&mechanism)?),
        };
        let reduced = Arc::new(reduced);
        let mut ranges = Vec::new();
        mechanism.parameters(&mut |p, _| ranges.push((p.range, p.role)));
        let (mut reals, mut locks) = (Vec::new(), Vec::new());
        for (v, reference) in variables.list().iter().zip(0..) {
            match (variables.quantity(reference), &v.start) {
                (Some(Quantity::Input(_)), Some(Value::Real(x))) => reals.push(*x),
                (Some(Quantity::Lock(_) | Quantity::Prescribed), Some(Value::Boolean(x))) => locks.push(*x),
                // The force of a drive with a circuit is in the place of an input, which stays 0.
                (Some(Quantity::Output(Output::Hydraulic(Hydraulic::Force) | Output::Network(Flow::Force(_)))), _) => {
                    reals.push(0.0);
                }
                // So are position and speed of a drive without masses.
                (Some(Quantity::Output(Output::Displacement { load, order: 0 | 1 })), _)
                    if mechanism.is_massless() && load < reduced.loading().drives.len() =>
                {
                    reals.push(0.0);
                }
                _ => {}
            }
        }
        if mechanism.is_massless() {
            // The motion is always prescribed.
            locks.push(true);
        }
        let inputs = Inputs::new(InputValues { signal: InputPolynomial::new(reals.len()), reals, locks });
        found.extend(warnings(&mechanism, &reduced));
        found.extend(warnings_at_start(&mechanism, &reduced, &inputs));
        let watched = Watched::new(&mechanism, &reduced);
        let parameter_values = Arc::new(ParameterValues::new(mechanism));
        let (warnings, identity, dependencies) = (found, OnceLock::new(), OnceLock::new());
        let original = Original {
            parameter_values,
            variables,
            ranges,
            inputs,
            identity,
            dependencies,
            reduced,
            warnings,
            watched,
        };
        let mut model = Self::of(Arc::new(original));
        // Tables are kept of what has a start.
        if !is_stored {
            model.state()?;
            model.state = None;
        }
        Ok(model)
    }

    /// A model of a definition as read.
    pub(super) fn of(original: Arc<Original>) -> Self {
        Self {
            parameter_values: Arc::clone(&original.parameter_values),
            inputs: original.inputs.clone(),
            reduced: Some(Arc::clone(&original.reduced)),
            designs: Designs::new(Arc::clone(&original.parameter_values), Arc::clone(&original.reduced)),
            state: None,
            spare: None,
            is_placed: false,
            has_told: false,
            clipped: Clipped::default(),
            watched: original.watched.clone(),
            told: Told::default(),
            lacks_drift: false,
            untuned: None,
            exchange: None,
            plan: plan::Plan::default(),
            original,
        }
    }

    /// The reduced model for the present parameters.
    ///
    /// # Errors
    /// The present parameters give no mechanism.
    pub fn reduced(&mut self) -> Result<&Arc<Reduced>, ModelError> {
        if self.reduced.is_none() {
            self.designs.settle(&mut self.parameter_values);
            let reduced = self.designs.reduced(&self.parameter_values, &self.original.ranges)?;
            self.designs.keep(&self.parameter_values, &reduced);
            self.reduced = Some(reduced);
        }
        self.reduced.as_ref().ok_or(ModelError::NotInitialised)
    }

    /// Override the relative tolerance of the integration; the same as setting solver.tolerance.
    ///
    /// # Errors
    /// The tolerance is out of range.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), ModelError> {
        match self.original.variables.find("solver.tolerance") {
            Some(reference) => self.set_real(reference, tolerance),
            None => Ok(()),
        }
    }

    /// Put the mechanism at its start under the present parameters and inputs, with all tables if `solver.prepare` asks
    /// for them.
    ///
    /// # Errors
    /// The present parameters give no mechanism, or the start cannot be reached.
    pub fn initialize(&mut self) -> Result<(), ModelError> {
        self.place()?;
        if self.parameter_values.mechanism().solver.prepare {
            self.prepare()?;
        }
        Ok(())
    }

    /// Make what steps and outputs would otherwise make when they first need it.
    #[cold]
    fn prepare(&mut self) -> Result<(), ModelError> {
        let reduced = Arc::clone(self.reduced()?);
        reduced.prepare();
        if let Some(Formulation::Reduced(motion)) = &mut self.state {
            let outputs = self.original.variables.quantities().iter().filter_map(Quantity::output);
            motion.prepare(&reduced, &self.inputs, outputs);
        }
        Ok(())
    }

    fn place(&mut self) -> Result<(), ModelError> {
        self.clipped = Clipped::default();
        self.untuned = None;
        self.watched.restart();
        self.told.restart();
        self.begin_exchange()?;
        let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) else {
            self.state = None;
            self.state()?;
            self.is_placed = true;
            self.plan.reserve(self.original.variables.quantities().iter().filter_map(Quantity::output).count());
            return self.remember();
        };
        // The parameters are those of this state, as one that changes takes the state away.
        let start = self.designs.start(&self.parameter_values, reduced, &self.original.ranges);
        let mechanism = self.parameter_values.mechanism();
        let placed = start.and_then(|start| motion.put_at_start(start, reduced, mechanism, &self.inputs));
        self.is_placed = placed.is_ok();
        if placed.is_err() {
            self.state = None;
        }
        placed?;
        self.remember()
    }

    /// Advance by exactly `h` [s], > 0, under the present inputs with the derivatives of
    /// [`Self::set_input_derivative`]; the inputs keep their values at the end. On an error the state is what it was,
    /// but for [`ModelError::Interrupted`]: the state and the inputs are then those at the time reached.
    ///
    /// # Errors
    /// Not initialised, h out of range, loads that overflow, the integration stopped, the travel ended, or
    /// `solver.max_steps` was met. [`ModelError::ends_step`] tells a refusal from a step that could not be made.
    pub fn step(&mut self, h: f64) -> Result<(), ModelError> {
        self.step_from(None, h)
    }

    /// [`Self::step`] from the time `point` [s] of the host on, which times of impacts count from; without it they
    /// count from the start.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_from(&mut self, point: Option<f64>, h: f64) -> Result<(), ModelError> {
        self.step_to_pause(point, h, Pauses::default()).map(drop)
    }

    /// [`Self::step_from`], but only to where it pauses, if that comes first. At an event the state is that before the
    /// impact, which follows with [`Self::handle_event`] or the next step. With "rigid_fem" a step does not pause.
    ///
    /// # Errors
    /// As [`Self::step`].
    // An FMU has one caller, but LLVM does not see that: the function could be called from another crate.
    #[inline(always)]
    pub fn step_to_pause(&mut self, point: Option<f64>, h: f64, pauses: Pauses) -> Result<Reached, ModelError> {
        // A comparison with infinity would take more instructions.
        if !(h > 0.0 && h <= f64::MAX) {
            return Err(ModelError::StepSize { h });
        }
        if self.inputs.signal.ahead {
            self.check_inputs_at(h)?;
        }
        let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        let solver = &self.parameter_values.mechanism().solver;
        let clipped = self.clipped.look((reduced, state), &self.inputs, h);
        let stepped = match state {
            _ if h < SHORTEST => Ok(Reached::End),
            Formulation::Reduced(motion) => {
                motion.state.is_retuned = self.untuned.is_some();
                motion.state.witness.listens = self.told.listens;
                motion.state.witness.pauses = pauses;
                motion.step_from(point, reduced, &self.inputs, h, solver)
            }
            Formulation::RigidFem(motion) => motion.step(reduced, &self.inputs, h, solver).map(|()| Reached::End),
        };
        let reached = match stepped {
            Ok(reached) => reached,
            Err(error) => {
                if let ModelError::Interrupted { time, .. } = error {
                    self.pass(h, time);
                }
                return Err(error);
            }
        };
        self.pass(h, reached.time(h));
        if let Some(command) = clipped {
            self.clipped.raise(command);
        }
        if self.watched.watches {
            self.watch_contacts(point.map(|point| point + reached.time(h)));
            self.watch_accumulators();
        }
        Ok(reached)
    }

    /// A part of a step of `h` [s] has been made, up to a time [s] of the step.
    #[inline(always)]
    fn pass(&mut self, h: f64, time: f64) {
        if h >= SHORTEST && self.untuned.is_some() {
            self.untuned = None;
        }
        let motion = self.reduced.as_ref().and_then(|reduced| reduced.loading().motion.as_ref());
        if let Some(drive) = motion.filter(|_| self.inputs.prescribes()) {
            self.inputs.move_on(drive, time);
        }
        self.inputs.leave(time);
    }

    /// Back to what [`Self::from_json`] gave.
    pub fn reset(&mut self) {
        if let (Some(Formulation::Reduced(motion)), Some(reduced)) = (self.state.take(), self.reduced.take()) {
            self.spare = Some((reduced, motion));
        }
        self.parameter_values = Arc::clone(&self.original.parameter_values);
        self.inputs.copy_from(&self.original.inputs);
        self.reduced = Some(Arc::clone(&self.original.reduced));
        self.is_placed = false;
        self.untuned = None;
        self.has_told = false;
        self.clipped = Clipped::default();
        self.watched.restart();
        self.told.restart();
        self.exchange = self.exchange.map(|_| Exchange::default());
    }

    /// That the motion has left the part of an open curve that was traced before the first step; told once.
    #[inline]
    pub fn take_growth(&mut self) -> Option<String> {
        let (Some(state), Some(reduced)) = (&self.state, &self.reduced) else { return None };
        let state = state.along_curve();
        if self.has_told || reduced.at(state.sigma).stretch == 0 {
            return None;
        }
        self.has_told = true;
        let position = state.describe(reduced);
        Some(format!(
            "the mechanism is at {position}, outside the part of its travel that was computed before the first step: \
             the FMU computes the next part during the run"
        ))
    }

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        match &self.state {
            Some(Formulation::Reduced(motion)) => motion.state.memory.statistics(),
            Some(Formulation::RigidFem(motion)) => motion.statistics(),
            None => Statistics::default(),
        }
    }

    /// Evaluations made for outputs since initialisation; those of the finite elements are not counted.
    pub fn computed(&self) -> Computed {
        match &self.state {
            Some(Formulation::Reduced(motion)) => motion.computed(),
            _ => Computed::default(),
        }
    }

    /// The state that outputs show, with the reduced model.
    fn shown(&mut self) -> Result<(&State, &Reduced), ModelError> {
        self.state()?;
        let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        let state = match state {
            Formulation::Reduced(motion) => motion.shown(reduced, &self.inputs),
            Formulation::RigidFem(motion) => &motion.rigid.state,
        };
        Ok((state, reduced))
    }

    /// The state, put at the start if there is none yet.
    fn state(&mut self) -> Result<&mut Formulation, ModelError> {
        if self.state.is_none() {
            self.untuned = None;
            let reduced = Arc::clone(self.reduced()?);
            self.designs.settle(&mut self.parameter_values);
            let start = self.designs.start(&self.parameter_values, &reduced, &self.original.ranges)?;
            let (mechanism, inputs) = (self.parameter_values.mechanism(), &self.inputs);
            let spare = self.spare.take().filter(|(of, _)| Arc::ptr_eq(of, &reduced));
            self.state = Some(match (self.parameter_values.method(), spare) {
                (Method::Reduced, Some((_, mut motion))) => {
                    motion.put_at_start(start, &reduced, mechanism, inputs)?;
                    Formulation::Reduced(motion)
                }
                (Method::Reduced, None) => Formulation::reduced(start, &reduced, mechanism, inputs)?,
                (Method::RigidFem, _) => Formulation::rigid_fem(start, &reduced, mechanism, inputs)?,
            });
        }
        self.state.as_mut().ok_or(ModelError::NotInitialised)
    }
}
