//! A body on a driven surface at a slip speed of 0: whether friction holds it there.
//!
//! In: a state, the loads. Out: the regime of the friction on the surface, how far the friction is beyond its limit. It
//! must not know steps.
use super::equation::{EquationOfMotion, Scratch};
use super::state_loads::{is_still, with_surface};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::resolved::FrictionJoint;
use crate::numerics::dual::Differentiable;
use crate::numerics::table::polynomial;

impl<T: Differentiable> Scratch<T> {
    /// State the time derivatives of the speed of a driven surface [m/s2, m/s3].
    pub fn set_surface(&mut self, rates: [T; 2]) {
        self.evaluator.surface.rates = rates;
        self.tangent.surface.rates = rates.map(T::held);
    }

    /// State the sign of the slip on a driven surface since the last event of model exchange.
    pub fn set_side(&mut self, side: Option<f64>) {
        (self.evaluator.surface.side, self.tangent.surface.side) = (side, side);
    }
}

impl<T: Differentiable> EquationOfMotion<'_, T> {
    /// The joint whose driven surface can hold its body, by its index among the friction joints.
    #[inline(always)]
    pub fn clinging(&self) -> Option<(usize, &FrictionJoint)> {
        let state_loads = self.state_loads?;
        state_loads.clings.map(|joint| (joint, &state_loads.friction_joints[joint]))
    }

    /// Whether the driven surface of this friction joint holds its body.
    #[inline]
    pub fn is_held(&self, joint: usize) -> bool {
        self.scratch.evaluator.regimes[joint] == Some(Regime::Sticking)
    }

    /// Slip for each unit of sigma of the joint whose driven surface can hold its body, and the speed of the surface at
    /// the time of the equation [m/s].
    pub fn along_surface(&mut self, sigma: f64) -> Option<[f64; 2]> {
        let x = self.locate(sigma);
        let state_loads = self.state_loads?;
        let joint = state_loads.clings?;
        let FrictionJoint { radius, surface, .. } = state_loads.friction_joints[joint];
        let series = self.scratch.panel_force.series(&state_loads.table, state_loads.free() + joint);
        Some([radius * polynomial(series, x), self.applied.size(surface?, self.time).value()])
    }

    /// Find and state whether a driven surface holds its body: the slip speed is 0, and the friction that keeps it 0 is
    /// within its limit. At a slip speed of 0 without that, the regime of the slip that follows is stated. In model
    /// exchange the last event decided. The mode has the direction of the motion.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn cling(&mut self, sigma: T, sigma_dot: T) -> Result<bool, Locked> {
        let Some([slip, speed]) = self.along_surface(sigma.value()) else { return Ok(false) };
        let Some((joint, &FrictionJoint { law, .. })) = self.clinging() else { return Ok(false) };
        let side = self.scratch.evaluator.surface.side;
        if side.map_or(!is_still(slip * sigma_dot.value() - speed, speed), |side| side != 0.0) {
            return Ok(false);
        }
        let Ok([forward, back]) = self.beyond_hold(joint, [sigma, sigma_dot]) else {
            // No friction on the surface holds the body together with the friction that it causes elsewhere.
            return self.slip_from(joint, slip, [sigma, sigma_dot]);
        };
        let is_held = side.is_some() || forward <= 0.0 && back <= 0.0;
        if !is_held {
            let towards = if forward > 0.0 { -1.0 } else { 1.0 };
            self.set_regime(joint, Some(law.regime_towards(0.0, towards)));
        }
        Ok(is_held)
    }

    /// State the regime of the slip that follows a slip speed of 0 where the surface cannot hold its body: with its
    /// friction, the slip speed changes in its direction. Returns false.
    #[cold]
    fn slip_from(&mut self, joint: usize, slip: f64, [sigma, sigma_dot]: [T; 2]) -> Result<bool, Locked> {
        let Some(own) = self.with_surface(slip, sigma, sigma_dot) else { return Ok(false) };
        let Some((_, &FrictionJoint { law, .. })) = self.clinging() else { return Ok(false) };
        for towards in [1.0, -1.0] {
            self.set_regime(joint, Some(law.regime_towards(0.0, towards)));
            if let Ok(found) = self.effect(sigma, sigma_dot)
                && (found.acceleration - own).value() * slip * towards > 0.0
            {
                return Ok(false);
            }
        }
        Err(Locked)
    }

    /// sigma_ddot with which the slip speed stays as it is, with this slip for each unit of sigma.
    fn with_surface(&mut self, slip: f64, sigma: T, sigma_dot: T) -> Option<T> {
        let state_loads = self.state_loads?;
        let joint = state_loads.clings?;
        let Scratch { panel_force, evaluator, .. } = &mut *self.scratch;
        let influence = T::constant(slip / state_loads.friction_joints[joint].radius);
        let state = [self.time, panel_force.x(sigma), sigma_dot];
        Some(with_surface(&evaluator.surface, state_loads, panel_force, (joint, influence), state))
    }

    /// How far the friction that holds a body on its driven surface is beyond its limit, where it acts forward and
    /// where it acts backward [N or N.m]. The surface is taken to hold from now on.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn beyond_hold(&mut self, joint: usize, [sigma, sigma_dot]: [T; 2]) -> Result<[f64; 2], Locked> {
        self.set_regime(joint, Some(Regime::Sticking));
        self.effect(sigma, sigma_dot)?;
        let [force, normal] = self.scratch.evaluator.surface.held.map(|number| number.value());
        let limit = self.clinging().map_or(0.0, |(_, own)| own.law.static_coefficient * own.radius * normal);
        Ok([force - limit, -force - limit])
    }

    /// State the sign of the slip on a driven surface that follows a slip speed of 0 with this sigma_ddot.
    #[cold]
    pub fn slip_by(&mut self, acceleration: T, sigma: T, sigma_dot: T) {
        /// Part of the accelerations, and of that on a circle of the size of the mechanism, by which equal ones differ.
        const ROUNDING: f64 = 1e-12;
        let on_circle = sigma_dot.value().powi(2) / self.reduced.scale();
        let Some([slip, _]) = self.along_surface(sigma.value()) else { return };
        let Some(own) = self.with_surface(slip, sigma, sigma_dot) else { return };
        let [demanded, own] = [acceleration.value(), own.value()];
        let more = demanded - own;
        let is_equal = more.abs() <= ROUNDING * (demanded.abs() + own.abs() + on_circle);
        self.scratch.evaluator.surface.towards = Some(if is_equal { 0.0 } else { slip * more });
    }

    /// Acceleration at any state in this direction, with the friction on the driven surface that follows from the
    /// state.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    #[cold]
    pub fn find_on_surface(&mut self, direction: f64, sigma: T, sigma_dot: T) -> Result<T, Locked> {
        self.clear_regimes();
        self.mode.direction = direction;
        self.cling(sigma, sigma_dot)?;
        Ok(self.effect(sigma, sigma_dot)?.acceleration)
    }

    /// Acceleration of a state with the regime of the friction on the driven surface that was found for it.
    ///
    /// # Errors
    /// [`Locked`]: friction has no solution.
    pub fn settle_on_surface(&mut self, regime: Regime, direction: f64, state: [T; 2]) -> Result<T, Locked> {
        self.clear_regimes();
        self.mode.direction = direction;
        if let Some((joint, _)) = self.clinging() {
            self.set_regime(joint, Some(regime));
        }
        Ok(self.effect(state[0], state[1])?.acceleration)
    }
}
