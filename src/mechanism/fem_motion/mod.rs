//! The motion by rigid finite elements: the state, its steps and its refusals.
//!
//! In: the reduced model, inputs, steps. Out: the state of the finite elements, and the sigma and sigma_dot of the
//! reduced model that fit this state best. Friction, air, stops, locks and losses in drives, which the finite elements
//! do not have, are refused when they would begin to act. It must not know the reduced model's integration.
mod outputs;
mod refusals;
mod saved;
mod track;

pub use saved::SavedRigidFem;

use crate::integrator::Statistics;
use crate::mechanism::definition::{DefinitionError, Mechanism, Solver};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::motion::contact::Contact;
use crate::mechanism::motion::state::State;
use crate::mechanism::outputs::ReducedMotion;
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem, RigidFemError, Scratch};
use crate::numerics::plane::Vec2;
use refusals::{refuse_locks, refuse_losses, refuse_passing};
use std::sync::Arc;
use track::Track;

/// The state of motion by rigid finite elements, with the scratch of its steps.
#[derive(Clone, Debug)]
pub struct RigidFemMotion {
    fem: Arc<RigidFem>,
    scratch: Scratch,
    /// Largest step of Newmark's method [s].
    fem_step: f64,
    /// State at the last communication point, in balance with the applied sizes.
    state: rigid_fem::State,
    /// The same state with accelerations in balance with the present sizes.
    present: rigid_fem::State,
    /// Whether `present` is up to date.
    balanced: bool,
    /// Sizes of the loads in the last step, with which the energy balance is made.
    applied: Vec<f64>,
    /// Accelerations and applied sizes before the last change of sizes; a step that fails returns to them.
    before: (Vec<Vec2>, Vec<f64>),
    /// Sizes of the loads under the present inputs.
    sizes: Vec<f64>,
    /// Whether the reactions are those of the present sizes, and the reactions of the joints.
    reactions: (bool, Vec<Reaction>),
    /// Energy at the start, plus the work of changing sizes, less the energy lost since [J].
    reference: f64,
    /// Allowed passing of each stop [rad or m]: the stretch at the start, of a mechanism that starts at the stop.
    slack: Vec<f64>,
    /// The reduced model at the sigma and sigma_dot that fit best.
    rigid: ReducedMotion,
    steps: u64,
}

impl RigidFemMotion {
    /// The state that the definition states, with the stretch that its own forces give.
    ///
    /// # Errors
    /// The mechanism has friction, air, a lock or an efficiency; the linkage is not of binary links; a body has no
    /// axial stiffness; as [`ReducedMotion::at_start`].
    pub fn at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Result<Self, ModelError> {
        refuse_losses(reduced, inputs)?;
        let mut rigid = ReducedMotion::at_start(reduced, mechanism, inputs)?;
        // No stop holds the finite elements.
        rigid.state.contact = Contact::default();
        refuse_locks(reduced, inputs, &rigid.state)?;
        let linkage = reduced.linkage();
        let fem = Arc::new(finite_elements(reduced, mechanism)?);
        let c = reduced.curve().configuration(rigid.state.sigma);
        let q: Vec<f64> =
            c.q.iter().enumerate().map(|(i, q)| q + rigid.state.revolutions * reduced.curve().growth(i)).collect();
        let q_dot: Vec<f64> = c.q_sigma.iter().map(|slope| slope * rigid.state.sigma_dot).collect();
        let sizes = reduced.sizes(&inputs.reals);
        let state = fem.start(linkage, &q, &q_dot, &sizes)?;
        let beyond = |stop: &Stop| stop.beyond(fem.displacement(&state, stop.load)[0]).max(0.0);
        Ok(Self {
            scratch: fem.scratch(),
            fem_step: fem_step(mechanism),
            present: state.clone(),
            balanced: true,
            before: (state.accelerations.clone(), sizes.clone()),
            applied: sizes.clone(),
            reactions: (false, vec![Reaction::default(); linkage.joints.len()]),
            reference: fem.energy(&state, &sizes),
            slack: reduced.loading().stops.iter().map(beyond).collect(),
            rigid,
            steps: 0,
            sizes,
            state,
            fem,
        })
    }

    /// Advance by exactly `h` [s] under these inputs. On an error the state is what it was.
    ///
    /// # Errors
    /// No equilibrium or too large a strain; a stop is reached; friction, air or a lock has been switched on.
    pub fn step(&mut self, reduced: &Reduced, inputs: &Inputs, h: f64) -> Result<(), ModelError> {
        refuse_losses(reduced, inputs)?;
        refuse_locks(reduced, inputs, &self.rigid.state)?;
        let reference = self.reference;
        let changed = self.apply(reduced)?;
        self.advance(reduced, h).inspect_err(|_| {
            if changed {
                self.state.accelerations.copy_from_slice(&self.before.0);
                self.applied.copy_from_slice(&self.before.1);
                self.reference = reference;
            }
        })
    }

    /// [`Self::step`] at the applied sizes.
    fn advance(&mut self, reduced: &Reduced, h: f64) -> Result<(), ModelError> {
        let mut track = Track::new(reduced, &self.rigid.state)?;
        let (fem, slack) = (&self.fem, &self.slack);
        let (mut time, mut steps) = (0.0, 0);
        let lost = fem.advance_watched(
            &mut self.state,
            &mut self.scratch,
            &self.applied,
            [h, self.fem_step],
            &mut |state, substep| {
                time += substep;
                steps += 1;
                refuse_passing(reduced, slack, time, substep, &|load| fem.displacement(state, load))?;
                track.follow(reduced, fem, state, substep)
            },
        )?;
        self.reference -= lost;
        self.steps += steps;
        let (sigma, sigma_dot, revolutions) = track.position();
        self.rigid.move_to(sigma, sigma_dot, revolutions);
        self.balanced = false;
        self.reactions.0 = false;
        Ok(())
    }

    /// A Real input has changed. `loads` is the number of inputs that size loads; they come first.
    pub fn set_input(&mut self, input: usize, loads: usize, value: f64) {
        if input < loads {
            self.sizes[input] = value;
            self.balanced = false;
            self.reactions.0 = false;
        }
        self.rigid.set_input(input, loads, value);
    }

    /// A Boolean input has changed.
    pub fn set_lock(&mut self) {
        self.rigid.set_lock();
    }

    /// The reduced model's state that fits best.
    pub fn along_curve(&self) -> &State {
        &self.rigid.state
    }

    /// Steps of Newmark's method so far.
    pub fn statistics(&self) -> Statistics {
        Statistics { accepted: self.steps, ..Statistics::default() }
    }

    /// Apply the present sizes: the change of the loads' potential since the last step is work from outside. Returns
    /// whether a size has changed.
    fn apply(&mut self, reduced: &Reduced) -> Result<bool, ModelError> {
        let mut work = 0.0;
        let mut changed = false;
        for (load, (size, applied)) in self.sizes.iter().zip(&self.applied).enumerate() {
            debug_assert!(load < reduced.loading().sized());
            if size.to_bits() != applied.to_bits() {
                work -= (size - applied) * self.fem.displacement(&self.state, load)[0];
                changed = true;
            }
        }
        if changed {
            self.before.0.copy_from_slice(&self.state.accelerations);
            self.before.1.copy_from_slice(&self.applied);
            self.fem.rebalance(&mut self.state, &mut self.scratch, &self.sizes, self.fem_step)?;
            self.reference += work;
            self.applied.copy_from_slice(&self.sizes);
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
            let message = "solver.method = \"rigid_fem\" asks for it: state E A of the body in N".into();
            ModelError::Definition(DefinitionError::Key { key: format!("bodies.{body}.axial_stiffness"), message })
        }
        error => error.into(),
    })
}
