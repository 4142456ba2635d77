//! The mode of the equation of motion between two events: direction of the drives, regimes of friction, held signs, and
//! the components of the state besides those of the motion.
//!
//! In: an equation of motion, a state. Out: the mode that follows from the state. It must not know steps.
use crate::integrator::System;
use crate::mechanism::dynamics::controlled::CONTROLLED;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{DRIVEN, MOTION};
use crate::mechanism::dynamics::network::NETWORKED;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::reduced::StateLoads;

impl<'a> EquationOfMotion<'a> {
    /// The loads that the state decides. A state of two components has no energy lost, so that there are none, and
    /// nothing of them is compiled for it.
    #[inline(always)]
    pub fn deciding<const N: usize>(&self) -> Option<&'a StateLoads> {
        if N < MOTION { None } else { self.state_loads }
    }

    /// State the parts of the state on which the acceleration depends besides sigma and sigma_dot.
    #[inline(always)]
    pub fn set_state<const N: usize>(&mut self, z: &[f64; N]) {
        if N == DRIVEN {
            self.scratch.evaluator.pressures[0] = [z[MOTION], z[MOTION + 1]];
        } else if N == NETWORKED {
            self.set_pressures_of_network(z);
        } else if N == CONTROLLED {
            self.set_controllers(z);
        }
    }

    /// State whether the mechanism is held at rest, for [`System::derivative`].
    #[inline(always)]
    pub fn set_held<const N: usize>(&mut self, held: bool) {
        if N > MOTION {
            self.mode.held = held;
        }
        if N == CONTROLLED {
            // At rest, limits of the force of a controller are no events.
            self.clear_signs();
        }
    }

    /// The next instant after t [s] at which the right-hand side is less smooth than elsewhere; infinite if there is
    /// none.
    #[inline(always)]
    pub fn next_kink<const N: usize>(&self, t: f64) -> f64 {
        match (&self.ports, &self.network) {
            (Some(ports), _) if N == DRIVEN => ports.next_kink(t),
            (_, Some(network)) if N == NETWORKED => network.next_kink(t),
            _ => f64::INFINITY,
        }
    }

    /// sigma_ddot at any state, as nothing but the loads determine it: without rigid stops and locks, with the regimes
    /// of friction and the directions of drives that follow from the state itself.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn free_acceleration(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        if sigma_dot == 0.0 && self.sticks() && self.start_direction(sigma, sigma_dot)? == 0.0 {
            // Even where friction has no solution with the reactions that cause it.
            return Ok(0.0);
        }
        self.settle(sigma, sigma_dot)
    }

    /// Find and state the direction in which the drives with an efficiency are taken to work: that of sigma_dot, or
    /// from rest the one in which the mechanism sets off, 0 if its drives or friction hold it. Returns it.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn find_direction(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        self.mode.direction = self.start_direction(sigma, sigma_dot)?;
        if sigma_dot == 0.0 && (self.sticks() || self.clinging().is_some()) {
            // The law of friction is that of the motion that starts.
            self.set_regimes(sigma, sigma_dot);
            self.cling(sigma, sigma_dot)?;
        }
        Ok(self.mode.direction)
    }

    /// State the regimes in which all joints are at this state. No sign is held until [`Self::find_signs`].
    #[inline]
    pub fn set_regimes(&mut self, sigma: f64, sigma_dot: f64) {
        let Some(state_loads) = self.state_loads else { return };
        self.clear_signs();
        for (joint, friction_joint) in state_loads.friction_joints.iter().enumerate() {
            let slip = self.slip(joint, sigma, sigma_dot);
            let towards = match slip == 0.0 && state_loads.sticks {
                true => self.slip(joint, sigma, self.mode.direction),
                false => slip,
            };
            self.set_regime(joint, Some(friction_joint.law.regime_towards(slip, towards)));
        }
    }

    /// Take a joint to the neighbour of its regime towards its slip speed at this state.
    pub fn change_regime(&mut self, joint: usize, sigma: f64, sigma_dot: f64) {
        let Some(state_loads) = self.state_loads else { return };
        let regime = self.regime(joint);
        let slip = self.slip(joint, sigma, sigma_dot);
        let next = state_loads.friction_joints[joint].law.next(regime, slip);
        self.set_regime(joint, Some(next));
    }

    /// Regime in which a joint is.
    #[inline]
    pub fn regime(&self, joint: usize) -> Regime {
        self.scratch.evaluator.regimes[joint].unwrap_or(Regime::Viscous)
    }

    /// Find and hold the signs of the switching quantities at a state and the time t of the span [s].
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn find_signs<const N: usize>(&mut self, t: f64, z: &[f64; N]) -> Result<(), Locked>
    where
        Self: System<N>,
    {
        self.clear_signs();
        if self.derivative(t, z)[1].is_nan() {
            return Err(Locked);
        }
        self.hold_signs();
        Ok(())
    }
}
