//! Inverse dynamics: the force of one drive with which the mechanism has an acceleration.
//!
//! In: a state, an acceleration along the curve, the loads. Out: the force of the drive along the curve, and what the
//! drive gives for it. It must not know outputs or steps.
use super::equation::EquationOfMotion;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::resolved::Efficiency;
use crate::numerics::dual::{Differentiable, Number};

/// What is asked of a drive.
#[derive(Clone, Copy, Debug)]
pub struct Demand<T> {
    /// Load of the drive, and its influence S_sigma.
    pub drive: (usize, T),
    /// sigma_ddot.
    pub acceleration: T,
    /// Direction of the motion, in which the other drives lose.
    pub direction: f64,
    /// Direction in which every joint has its static friction against the motion; none in a motion.
    pub breakaway: Option<f64>,
}

/// Why inverse dynamics has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoForce {
    /// Without this drive friction and reactions have no common solution.
    Locked,
    /// No force of this drive overcomes the friction that it causes.
    SelfLocking,
}

impl<T: Differentiable> EquationOfMotion<'_, T> {
    /// Derivative along sigma of the delivered force of a drive, as of the last [`Self::slope_at_rest`].
    pub fn slope_of_delivered(&self, drive: usize) -> T {
        let of = |load: usize| {
            let index = self.state_loads.and_then(|s| s.drives.iter().position(|l| *l == load));
            index.map_or(T::constant(0.0), |k| T::slope_of(self.scratch.tangent.delivered[k]))
        };
        let law = self.reduced.loading().drives[drive].law.as_ref();
        law.map_or(of(drive), |law| of(drive) + of(law.load))
    }

    /// Delivered force of a drive, with that of its law, after the loss of the drive if it has one; as last
    /// evaluated.
    pub fn delivered(&self, drive: usize) -> T {
        let of = |load: usize| {
            let index = self.state_loads.and_then(|s| s.drives.iter().position(|l| *l == load));
            index.map_or_else(|| self.applied.size(load, self.time), |k| self.scratch.evaluator.delivered[k])
        };
        match &self.reduced.loading().drives[drive].law {
            Some(law) => of(drive) + of(law.load),
            None => of(drive),
        }
    }

    /// Force along sigma that a drive must give. The other drives lose as in a motion in the demanded direction,
    /// whatever this drive gives at present, even if friction has no solution under that.
    ///
    /// # Errors
    /// [`NoForce`].
    pub fn required(&mut self, sigma: T, sigma_dot: T, demand: &Demand<T>) -> Result<T, NoForce> {
        let Demand { drive: (load, influence), acceleration, direction, breakaway } = *demand;
        let sigma_dot = if breakaway.is_some() { T::constant(0.0) } else { sigma_dot };
        if breakaway.is_none() && self.clinging().is_some() {
            self.slip_by(acceleration, sigma, sigma_dot);
        }
        let free = self.heading(direction, sigma, sigma_dot);
        self.scratch.evaluator.surface.towards = None;
        let size = self.delivered(load);
        let Some(state_loads) = self.state_loads else {
            return Ok(acceleration - (free.map_err(|Locked| NoForce::Locked)? - size * influence));
        };
        let scratch = &mut *self.scratch;
        let (panel_force, load) = (&scratch.panel_force, (load, size));
        let force = scratch.evaluator.required(state_loads, panel_force, sigma, load, acceleration, breakaway);
        force.map_err(|Locked| NoForce::SelfLocking)
    }
}

/// A term of the mechanism at a drive with an efficiency ([CK16] 2.3): divided by it where power flows in, multiplied
/// by that of the other direction where power flows back; at rest divided.
pub fn with_efficiency<T: Number>(efficiency: Option<Efficiency>, power: f64, value: T) -> T {
    match efficiency {
        Some(eta) if power < 0.0 => value * eta.backward,
        Some(eta) => value / T::constant(eta.forward),
        None => value,
    }
}

/// Direction in which the mechanism moves, or sets off from rest: that of sigma_ddot; 0 if it stays at rest.
pub fn toward(sigma_dot: f64, acceleration: f64) -> f64 {
    match if sigma_dot == 0.0 { acceleration } else { sigma_dot } {
        0.0 => 0.0,
        rate => rate.signum(),
    }
}
