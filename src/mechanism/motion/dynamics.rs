//! What the advance asks of the thing that moves.
//!
//! In: states, directions, regimes, contacts. Out: accelerations, and the quantities whose signs change at events. It
//! must not know steps.
mod of_mechanism;

use crate::integrator::System;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::network::Level;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::numerics::enclosure::Enclosure;
use crate::numerics::table::TablePosition;
use std::ops::Range;

/// A motion along sigma whose right-hand side is smooth between events. The state is (sigma, sigma_dot), or (sigma,
/// sigma_dot, energy lost), or these with more that goes on with them. Bumpers, drives with an efficiency and friction
/// joints are the three kinds of parts that switch their laws; by default there are none.
pub trait Dynamics<const N: usize>: System<N> {
    /// State the time since the start of the span [s] at which inputs are evaluated.
    fn set_time(&mut self, t: f64);

    /// Whether parts of the state go on while the mechanism is held at rest.
    fn evolves_at_rest(&self) -> bool {
        false
    }

    /// State the parts of the state on which the acceleration depends besides sigma and sigma_dot.
    fn set_state(&mut self, _z: &[f64; N]) {}

    /// State whether the mechanism is held at rest, for [`System::derivative`].
    fn set_held(&mut self, _held: bool) {}

    /// The next instant after t [s] at which the right-hand side is less smooth than elsewhere; infinite if there is
    /// none.
    fn next_kink(&self, _t: f64) -> f64 {
        f64::INFINITY
    }

    /// Whether the right-hand side is less smooth at some positions.
    fn has_knots(&self) -> bool {
        false
    }

    /// The next position from a sigma on in a direction, 1 or -1, at which the right-hand side is less smooth; None if
    /// there is none.
    fn next_knot(&self, _sigma: f64, _direction: f64) -> Option<f64> {
        None
    }

    /// Number of borders in the space of states at which the right-hand side is less smooth than elsewhere.
    fn borders(&self) -> usize {
        0
    }

    /// Borders none of which is passed between two states (t, z) of a step, as bounds show. It may be others, too.
    fn distant_borders(&self, _states: [(f64, &[f64; N]); 2]) -> Range<usize> {
        0..0
    }

    /// Whether a border is a kink of the law that sizes a load.
    fn is_kink(&self, _border: usize) -> bool {
        false
    }

    /// How far a state is beyond a border at the time t of the span [s]; 0 where there is none.
    fn beyond_border(&mut self, _border: usize, _t: f64, _z: &[f64; N]) -> f64 {
        0.0
    }

    /// Number of levels of components of the state at which locks change.
    fn levels(&self) -> usize {
        0
    }

    /// A level by its index; none where there is none.
    fn level(&self, _index: usize, _z: &[f64; N]) -> Option<Level> {
        None
    }

    /// Whether inputs change with time within the span.
    fn inputs_change(&self) -> bool {
        false
    }

    /// sigma_ddot at any state, as nothing but the loads determine it: without rigid stops and locks, with the regimes
    /// of friction and the directions of drives that follow from the state itself.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    fn free_acceleration(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked>;

    /// Characteristic length of sigma.
    fn length(&self) -> f64;

    /// Whether the right-hand side had no value somewhere because friction has no solution; clears that mark.
    fn take_locked(&mut self) -> bool {
        false
    }

    /// Inputs whose signs decide a law at rest, by an index from 0 on: value and two time derivatives at the start of
    /// the span. Between the zeros of these, an acceleration at rest is a polynomial of degree 4 in time at most.
    fn switching_input(&self, _index: usize) -> Option<[f64; 3]> {
        None
    }

    /// State the bumpers that push.
    fn set_touching(&mut self, _touching: BumperSet) {}

    /// How far the load of a bumper is beyond its stop, and the push of the bumper if it is in contact.
    fn bumper_push(&mut self, _bumper: usize, _sigma: f64, _sigma_dot: f64) -> (f64, f64) {
        (0.0, 0.0)
    }

    /// Bounds of both numbers of [`Self::bumper_push`] along a part of a step with these bounds of sigma and sigma_dot.
    fn bumper_bounds(&mut self, _bumper: usize, _sigma: Enclosure, _sigma_dot: Enclosure) -> [Enclosure; 2] {
        [Enclosure::constant(0.0); 2]
    }

    /// Whether a drive has an efficiency or friction sticks, so that the right-hand side jumps where sigma_dot changes
    /// its sign.
    fn has_reversals(&self) -> bool {
        false
    }

    /// Whether friction holds at rest, so that the mechanism may stick where sigma_dot becomes 0.
    fn sticks(&self) -> bool {
        false
    }

    /// Direction in which the drives with an efficiency are taken to work: 1, -1, or 0 if they or friction hold.
    fn direction(&self) -> f64 {
        0.0
    }

    /// Find and state that direction: that of sigma_dot, or from rest the one in which the mechanism sets off, 0 if its
    /// drives or friction hold it. Returns it.
    fn find_direction(&mut self, _sigma: f64, _sigma_dot: f64) -> Result<f64, Locked> {
        Ok(0.0)
    }

    /// sigma_ddot from rest, were the drives with an efficiency to work in this direction, against static friction.
    fn acceleration_from_rest(&mut self, sigma: f64, _direction: f64) -> Result<f64, Locked> {
        self.free_acceleration(sigma, 0.0)
    }

    /// Number of joints with friction.
    fn friction_joints(&self) -> usize {
        0
    }

    /// Slip speed of a joint [m/s] at the time of [`Self::set_time`].
    fn slip(&mut self, _joint: usize, _sigma: f64, _sigma_dot: f64) -> f64 {
        0.0
    }

    /// Bounds of the slip speed of a joint [m/s] along a part of a step with these bounds of time, sigma and sigma_dot.
    fn slip_bounds(&mut self, _joint: usize, _motion: [Enclosure; 3]) -> Enclosure {
        Enclosure::constant(0.0)
    }

    /// sigma with its position in the table, for [`Self::slip_rate`], the same for all joints.
    fn slip_position(&self, _sigma: f64) -> (f64, TablePosition) {
        (0.0, TablePosition { panel: 0, x: 0.0 })
    }

    /// Slip speed of a joint [m/s] and its rate [m/s2], at a position and these time, sigma_dot and sigma_ddot.
    fn slip_rate(&self, _joint: usize, _at: (f64, TablePosition), _rates: [f64; 3]) -> [f64; 2] {
        [0.0; 2]
    }

    /// Least and largest slip speed of the regime in which a joint is [m/s].
    fn slip_range(&self, _joint: usize) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Regime in which a joint is.
    fn regime(&self, _joint: usize) -> Option<Regime> {
        None
    }

    /// State the regimes in which all joints are at this state. No sign is held until [`Self::find_signs`].
    fn set_regimes(&mut self, _sigma: f64, _sigma_dot: f64) {}

    /// Number of switching quantities: those whose signs select a law.
    fn switches(&self) -> usize {
        0
    }

    /// Find and hold the signs of the switching quantities at a state and the time t of the span [s].
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    fn find_signs(&mut self, _t: f64, _z: &[f64; N]) -> Result<(), Locked> {
        Ok(())
    }

    /// A step begins: forget the samples of the switching quantities, and what was foreseen.
    fn begin_step(&mut self) {}

    /// A sample of a switching quantity, taken by the evaluations of a step, by its index: time since the start of the
    /// span [s], and the value, positive with the held sign.
    fn switch_sample(&self, _index: usize, _switch: usize) -> Option<[f64; 2]> {
        None
    }

    /// Value of a switching quantity at the time t of the span [s], positive with the held sign.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    fn switch_value(&mut self, _switch: usize, _t: f64, _z: &[f64; N]) -> Result<f64, Locked> {
        Ok(1.0)
    }

    /// Change of sigma_ddot that the other law makes for each unit of a switching quantity.
    fn switch_effect(&self, _switch: usize) -> f64 {
        0.0
    }

    /// Turn the held sign of a switching quantity round.
    fn flip_sign(&mut self, _switch: usize) {}

    /// Take a joint to the neighbour of its regime towards its slip speed at this state.
    fn change_regime(&mut self, _joint: usize, _sigma: f64, _sigma_dot: f64) {}
}
