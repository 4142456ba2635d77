//! A motion with hydraulics behind one trait: its code is reached through the memory of the motion alone, so that a
//! library that makes no such motion is without this code.
//!
//! In: an equation of motion, inputs, a step. Out: the state after the step. It must not know any law.
use crate::codec::record::{Damaged, Record};
use crate::integrator::Statistics;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::motion::advance::Stopped;
use crate::mechanism::motion::contact::{Contact, Ends, EngagedLocks};
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::motion::witness::Witness;
use std::any::Any;
use std::fmt::Debug;

/// What a step of a motion with a circuit or network uses besides its own memory.
pub struct Driven<'a, 'e> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub ends: &'a Ends<'a>,
    pub contact: &'a mut Contact,
    pub witness: &'a mut Witness,
    pub tolerance: f64,
    pub inputs: &'e Inputs,
}

/// What the memory of a motion with a circuit or network answers; as [`Memory`](super::memory::Memory) does.
pub trait HydraulicMotion: Any + Debug + Send + Sync {
    /// Advance (sigma, sigma_dot) and the circuit or network by exactly `h` [s]. Returns the energy lost in impacts
    /// [J]; sigma, sigma_dot and the energy lost in the state reached; the places where a lock is engaged there.
    fn run<'e>(
        &mut self,
        driven: Driven<'_, 'e>,
        motion: [f64; 2],
        h: f64,
        max_steps: u64,
    ) -> (Result<f64, Stopped>, [f64; MOTION], EngagedLocks);
    /// A step has failed: the circuit or network is where it was.
    fn undo(&mut self);
    fn statistics(&self) -> Statistics;
    fn tried(&self) -> [u64; 2];
    fn event_ahead(&self) -> Option<Event>;
    fn drop_outdated(&mut self, outdated: Outdated);
    /// All fields, written or read.
    fn record(&mut self, record: &mut Record) -> Result<(), Damaged>;
    fn duplicate(&self) -> Box<dyn HydraulicMotion>;
    /// Become the same as another one of this type, without allocation. Returns whether it is of this type.
    fn copy_from(&mut self, other: &dyn HydraulicMotion) -> bool;
}

impl Clone for Box<dyn HydraulicMotion> {
    fn clone(&self) -> Self {
        self.as_ref().duplicate()
    }
}
