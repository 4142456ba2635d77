//! The motion by rigid finite elements: the state, its steps and its refusals.
//!
//! In: the reduced model, inputs, steps. Out: the state of the finite elements, and the sigma and sigma_dot of the
//! reduced model that fit this state best. Friction, air, stops, locks and losses in drives, which the finite elements
//! do not have, are refused when they would begin to act. It must not know the reduced model's integration.
mod outputs;
mod saved;
mod track;

pub use saved::SavedRigidFem;

use crate::integrator::Statistics;
use crate::mechanism::definition::{DefinitionError, Mechanism, Solver};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::resolved::FrictionKind;
use crate::mechanism::motion::contact::Contact;
use crate::mechanism::motion::state::{Start, State};
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem, RigidFemError, Scratch, substeps};
use crate::numerics::plane::Vec2;
use std::sync::Arc;
use track::Track;

/// Rounding of a stop's quantity, relative to 1 and its value [rad or m].
const AT: f64 = 1e-10;

/// The state of motion by rigid finite elements, with the scratch of its steps.
#[derive(Clone, Debug)]
pub struct RigidFemMotion {
    kept: Kept,
    scratch: Scratch,
    /// The state with accelerations in balance with the present sizes.
    present: rigid_fem::State,
    /// Whether `present` is up to date.
    balanced: bool,
    /// Accelerations and applied sizes before the last change of sizes; a step that fails returns to them.
    before: (Vec<Vec2>, Vec<f64>),
    /// Versions of the inputs and of the state to which the present sizes, balance and reactions belong.
    seen: (u64, u64),
    /// Sizes of the loads under the present inputs.
    sizes: Vec<f64>,
    /// Whether the reactions are those of the present sizes, and the reactions of the joints.
    reactions: (bool, Vec<Reaction>),
    /// The reduced model at the sigma and sigma_dot that fit best.
    pub rigid: ReducedMotion,
}

/// The fields of a [`RigidFemMotion`] that a saved state keeps; with those of the reduced model all others follow.
#[derive(Clone, Debug)]
struct Kept {
    fem: Arc<RigidFem>,
    /// Largest step of Newmark's method [s].
    fem_step: f64,
    /// State at the last communication point, in balance with the applied sizes.
    state: rigid_fem::State,
    /// Sizes of the loads in the last step, with which the energy balance is made.
    applied: Vec<f64>,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since [J].
    reference: f64,
    /// Allowed passing of each stop [rad or m]: the stretch at the start, of a mechanism that starts at the stop.
    slack: Vec<f64>,
    /// Steps of Newmark's method so far.
    steps: u64,
}

impl RigidFemMotion {
    /// The state at a start, with the stretch that its own forces give.
    ///
    /// # Errors
    /// The mechanism has friction, air, a lock or an efficiency; the linkage is not of binary links; a body has no
    /// axial stiffness; as [`ReducedMotion::at_start`].
    pub fn at_start(
        start: &Start,
        reduced: &Reduced,
        mechanism: &Mechanism,
        inputs: &Inputs,
    ) -> Result<Self, ModelError> {
        refuse_losses(reduced, inputs)?;
        let mut rigid = ReducedMotion::at_start(start, reduced, mechanism, inputs)?;
        // No stop holds the finite elements.
        rigid.state.contact = Contact::default();
        refuse_locks(reduced, inputs, &rigid.state)?;
        let linkage = reduced.linkage();
        let fem = Arc::new(finite_elements(reduced, mechanism)?);
        let c = reduced.at(rigid.state.sigma).curve().configuration(rigid.state.sigma);
        let q: Vec<f64> =
            c.q.iter().enumerate().map(|(i, q)| q + rigid.state.revolutions * reduced.curve().growth(i)).collect();
        let q_dot: Vec<f64> = c.q_sigma.iter().map(|slope| slope * rigid.state.sigma_dot).collect();
        let sizes = reduced.sizes(&inputs.reals);
        let state = fem.start(linkage, &q, &q_dot, &sizes)?;
        let beyond = |stop: &Stop| stop.beyond(fem.displacement(&state, stop.load, 0)).max(0.0);
        let kept = Kept {
            fem_step: fem_step(mechanism),
            reference: fem.energy(&state, &sizes),
            applied: sizes,
            slack: reduced.loading().stops.iter().map(beyond).collect(),
            steps: 0,
            state,
            fem,
        };
        Ok(Self::new(kept, rigid, reduced, inputs))
    }

    fn new(kept: Kept, rigid: ReducedMotion, reduced: &Reduced, inputs: &Inputs) -> Self {
        Self {
            scratch: kept.fem.scratch(),
            present: kept.state.clone(),
            balanced: false,
            before: (kept.state.accelerations.clone(), kept.applied.clone()),
            reactions: (false, vec![Reaction::default(); reduced.linkage().joints.len()]),
            seen: (0, 0),
            sizes: reduced.sizes(&inputs.reals),
            rigid,
            kept,
        }
    }

    /// Advance by exactly `h` [s] under these inputs. On an error the state is what it was.
    ///
    /// # Errors
    /// No equilibrium or too large a strain; a stop is reached; friction, air or a lock has been switched on; more
    /// substeps than `solver.max_steps`.
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64, solver: &Solver) -> Result<(), ModelError> {
        refuse_losses(reduced, inputs)?;
        refuse_locks(reduced, inputs, &self.rigid.state)?;
        let (count, limit) = (substeps(h, self.kept.fem_step), solver.max_steps);
        if count > limit {
            return Err(RigidFemError::Substeps { count, limit }.into());
        }
        self.sync(reduced, inputs);
        let reference = self.kept.reference;
        let changed = self.apply()?;
        self.advance(reduced, h).inspect_err(|_| {
            if changed {
                self.kept.state.accelerations.copy_from_slice(&self.before.0);
                self.kept.applied.copy_from_slice(&self.before.1);
                self.kept.reference = reference;
            }
        })
    }

    /// [`Self::step`] at the applied sizes.
    fn advance(&mut self, reduced: &Reduced, h: f64) -> Result<(), ModelError> {
        let mut track = Track::new(reduced, &self.rigid.state)?;
        let Kept { fem, fem_step, state, applied, reference, slack, steps } = &mut self.kept;
        let (mut time, mut count) = (0.0, 0);
        let mut watch = |state: &rigid_fem::State, substep| {
            time += substep;
            count += 1;
            refuse_passing(reduced, slack, time, substep, fem, state)?;
            track.follow(reduced, fem, state, substep)
        };
        *reference -= fem.advance_watched(state, &mut self.scratch, applied, [h, *fem_step], &mut watch)?;
        *steps += count;
        self.rigid.move_to(track.sigma, track.sigma_dot, track.revolutions);
        Ok(())
    }

    /// The sizes become those of the inputs; balance and reactions are found again if the inputs or the state are
    /// others.
    fn sync(&mut self, reduced: &Reduced, inputs: &Inputs) {
        let present = (inputs.version(), self.rigid.state.version());
        if self.seen != present {
            (self.seen, self.balanced, self.reactions.0) = (present, false, false);
            reduced.sizes_into(&inputs.reals, &mut self.sizes);
        }
    }

    /// Steps of Newmark's method so far.
    pub fn statistics(&self) -> Statistics {
        Statistics { accepted: self.kept.steps, ..Statistics::default() }
    }

    /// Apply the present sizes: the change of the loads' potential since the last step is work from outside. Returns
    /// whether a size has changed.
    fn apply(&mut self) -> Result<bool, ModelError> {
        let Kept { fem, fem_step, state, applied, reference, .. } = &mut self.kept;
        let mut work = 0.0;
        let mut changed = false;
        for (load, (size, applied)) in self.sizes.iter().zip(&*applied).enumerate() {
            if size.to_bits() != applied.to_bits() {
                work -= (size - applied) * fem.displacement(state, load, 0);
                changed = true;
            }
        }
        if changed {
            self.before.0.copy_from_slice(&state.accelerations);
            self.before.1.copy_from_slice(applied);
            fem.rebalance(state, &mut self.scratch, &self.sizes, *fem_step)?;
            *reference += work;
            applied.copy_from_slice(&self.sizes);
        }
        Ok(changed)
    }
}

/// Largest step of Newmark's method [s].
fn fem_step(mechanism: &Mechanism) -> f64 {
    mechanism.solver.fem_step.unwrap_or(Solver::FEM_STEP)
}

/// The finite elements of a linkage with the bodies' axial stiffness.
fn finite_elements(reduced: &Reduced, mechanism: &Mechanism) -> Result<RigidFem, ModelError> {
    let linkage = reduced.linkage();
    let stated = |body: usize| {
        let defined = mechanism.bodies.get(&linkage.bodies[body].name);
        defined.and_then(|b| b.axial_stiffness).unwrap_or(f64::NAN)
    };
    RigidFem::new(linkage, reduced.loading(), &stated).map_err(|error| match error {
        RigidFemError::AxialStiffness { body, value } if value.is_nan() => {
            let message = "solver.method = \"rigid_fem\" needs this key: write the axial stiffness E A of the body \
                           in N";
            DefinitionError::key(format_args!("bodies.{body}.axial_stiffness"), message).into()
        }
        error => error.into(),
    })
}

/// Refuse friction that is enabled, and air with drag. The mesh refuses losses in drives.
///
/// # Errors
/// [`ModelError::NotInRigidFem`].
fn refuse_losses(reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
    let refuse = |name: &str, value: String, remedy: &str| {
        Err(ModelError::NotInRigidFem { name: name.into(), value, remedy: remedy.into() })
    };
    let loading = reduced.loading();
    if loading.network.is_some() {
        return refuse("hydraulics", String::new(), "use forces instead");
    }
    if let Some(drive) = &loading.hydraulics {
        let name = format!("actuators.{}.hydraulics", loading.drives[drive.load].name);
        return refuse(&name, String::new(), "use a force instead");
    }
    for drive in &loading.drives {
        let Some(law) = &drive.law else { continue };
        let (key, what) =
            if law.curve().is_some() { ("points", "a force-speed curve") } else { ("control", "a controller") };
        let name = format!("actuators.{}.{key}", drive.name);
        return refuse(&name, what.into(), "use a torque or a force instead");
    }
    if let Some(drive) = loading.motion.as_ref().filter(|_| inputs.prescribes()) {
        let name = format!("{}.motion.enabled", loading.drives[drive.load].name);
        return refuse(&name, "true".into(), "set this value to false");
    }
    let mut constant = loading.friction.iter().flat_map(|f| &f.friction_joints);
    if let Some(joint) = constant.find(|own| matches!(own.kind, FrictionKind::Constant(_))) {
        let name = format!("joints.{}.frictionloss", reduced.linkage().joints[joint.joint].name);
        return refuse(&name, "constant friction".into(), "remove this key");
    }
    if let Some(surface) = loading.surfaces.clone().next() {
        return refuse(&format!("joints.{}", loading.inputs[surface]), "a driven surface".into(), "remove this key");
    }
    if loading.friction.as_ref().is_some_and(|f| f.enabled && !f.friction_joints.is_empty()) {
        return refuse("friction.enabled", "true".into(), "set this value to false");
    }
    if let Some(air) = loading.air.as_ref().filter(|air| !air.surfaces.is_empty()) {
        if air.relative_wind {
            return refuse("air.relative_wind", "true".into(), "set this value to false");
        }
        if let Some(speed) = inputs.reals.last().filter(|speed| **speed != 0.0) {
            return refuse("airspeed", format!("{speed}"), "set this value to 0");
        }
    }
    Ok(())
}

/// Refuse a lock that is engaged at its stop.
///
/// # Errors
/// [`ModelError::NotInRigidFem`].
fn refuse_locks(reduced: &Reduced, inputs: &Inputs, rigid: &State) -> Result<(), ModelError> {
    let mut locks = reduced.loading().locks.iter().zip(&inputs.locks);
    match locks.find(|(lock, engaged)| **engaged && rigid.at_stop(reduced, lock.stop)) {
        Some((lock, _)) => Err(ModelError::NotInRigidFem {
            name: format!("{}.engage", lock.name),
            value: "true".into(),
            remedy: "set this input to false before the mechanism reaches the stop of the lock".into(),
        }),
        None => Ok(()),
    }
}

/// Refuse a state beyond a stop, `time` [s] into the step and `substep` [s] after the last one.
///
/// # Errors
/// [`ModelError::StopPassed`].
fn refuse_passing(
    reduced: &Reduced,
    slack: &[f64],
    time: f64,
    substep: f64,
    fem: &RigidFem,
    state: &rigid_fem::State,
) -> Result<(), ModelError> {
    for (stop, slack) in reduced.loading().stops.iter().zip(slack).filter(|(stop, _)| stop.enabled) {
        let [s, s_dot] = [0, 1].map(|order| fem.displacement(state, stop.load, order));
        let beyond = stop.beyond(s) - slack;
        let outward = s_dot * (stop.beyond(1.0) - stop.beyond(0.0));
        if beyond > AT * (1.0 + stop.value.abs()) && outward > 0.0 {
            let name = format!("{}.{}", stop.name, stop.quantity);
            let time = time - (beyond / outward).min(substep);
            return Err(ModelError::StopPassed { name, value: stop.value, time });
        }
    }
    Ok(())
}
