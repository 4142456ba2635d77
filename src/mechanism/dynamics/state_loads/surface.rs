//! Friction that holds a body on a driven surface: the force that keeps the slip speed 0.
//!
//! In: the speed of the surface, the balance of forces without friction. Out: sigma_ddot, the friction that gives it,
//! the normal force. It must not know which law holds before or after.
use super::{StateLoadEvaluator, balance, solve};
use crate::mechanism::dynamics::panel_force::PanelForce;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::resolved::FrictionKind;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::dual::Number;

/// Slip speed [m/s] that counts as 0, and part of the speed of the surface that does: more than rounding of inputs.
const STILL: f64 = 1e-12;
const ROUNDING: f64 = 1e-10;

/// Whether a slip speed on a surface of this speed counts as 0 [m/s].
pub fn is_still(slip: f64, speed: f64) -> bool {
    slip.abs() <= STILL + ROUNDING * speed.abs()
}

/// A driven surface that can hold its body.
#[derive(Clone, Copy, Debug)]
pub struct Surface<T> {
    /// First two time derivatives of the speed of the surface, at t = 0 [m/s2, m/s3].
    pub rates: [T; 2],
    /// Sign of the slip since the last event of model exchange, 0 while the surface holds its body; none elsewhere.
    pub side: Option<f64>,
    /// Sign of the slip that follows a slip speed of 0, where it is known: 0 for none.
    pub towards: Option<f64>,
    /// Friction of the last evaluation that held the body, and |R| of its joint.
    pub held: [T; 2],
}

impl<T: Number> Default for Surface<T> {
    fn default() -> Self {
        let zero = T::constant(0.0);
        Self { rates: [zero; 2], side: None, towards: None, held: [zero; 2] }
    }
}

impl<T: Number> Surface<T> {
    /// Whether a slip speed v on a surface of the speed V counts as 0 at a time t of the step [s], the slip speed whose
    /// regime counts, and the sign of the slip that follows a slip speed of 0: against the rate of V, or as stated
    /// `otherwise` at a constant V.
    pub(super) fn slip(&self, [t, v, speed]: [f64; 3], otherwise: f64) -> (bool, f64, f64) {
        if let Some(side) = self.side {
            return (side == 0.0, if v * side > 0.0 { v } else { 0.0 }, side);
        }
        let [first, second] = self.rates.map(|rate| rate.value());
        let against = [first + second * t, second].into_iter().find(|rate| *rate != 0.0);
        let towards = self.towards.unwrap_or_else(|| against.map_or(otherwise, |rate| -rate));
        (is_still(v, speed), v, towards)
    }
}

/// sigma_ddot with which the slip speed of a joint on a driven surface stays as it is: with the influence a(sigma) of
/// its friction and the radius r, the slip speed is v = r a sigma_dot - V, so that
/// sigma_ddot = (V_dot / r - a_sigma sigma_dot^2) / a.
pub fn with_surface<T: Number>(
    surface: &Surface<T>,
    state_loads: &StateLoads,
    panel_force: &PanelForce,
    (joint, influence): (usize, T),
    [t, x, sigma_dot]: [T; 3],
) -> T {
    let slope = panel_force.slope(&state_loads.table, state_loads.free() + joint, x);
    let inverse = T::constant(1.0 / state_loads.friction_joints[joint].radius);
    let rate = (surface.rates[0] + surface.rates[1] * t) * inverse;
    (rate - slope * sigma_dot * sigma_dot) / influence
}

impl<T: Number> StateLoadEvaluator<T> {
    /// The normal forces of prismatic joints are switching quantities.
    #[inline(always)]
    pub(super) fn see_normal_forces(&mut self, state_loads: &StateLoads) {
        for (k, &joint) in state_loads.prismatic.iter().enumerate() {
            self.switches.see(state_loads.efficient + k, self.friction.normal_force(joint));
        }
    }

    /// Find the friction of a joint that holds its body on its driven surface. It balances all other forces along the
    /// curve, so the friction in all joints adds a known part to sigma_ddot: the reactions to the friction of this
    /// joint replace the inertial ones, as in [`Self::required`]. Returns sigma_ddot.
    #[cold]
    #[inline(never)]
    pub(super) fn hold(
        &mut self,
        state_loads: &StateLoads,
        panel_force: &PanelForce,
        joint: usize,
        state: [T; 3],
    ) -> Result<T, Locked> {
        let (free, n) = (state_loads.free(), state_loads.friction_joints.len());
        let influence = self.effects.as_flattened()[free + joint];
        let acceleration = with_surface(&self.surface, state_loads, panel_force, (joint, influence), state);
        // The part of sigma_ddot that friction gives.
        let all = acceleration - self.motion;
        let effects = self.effects.as_flattened();
        let inverse = influence.powi(-1);
        let (reactions, inertial) = self.scratch.split_at_mut(2 * n);
        let (to_motion, to_friction) = (&effects[state_loads.inertial()], &effects[state_loads.passed()]);
        let (groups, before) = (state_loads.groups.count(), self.reactions.as_flattened());
        for (i, other) in state_loads.friction_joints.iter().enumerate() {
            let group = state_loads.groups.of[i];
            let [first, second] = [0, groups].map(|axis| to_friction[(axis + group) * n + joint]);
            let [lever, along] = state_loads.groups.seconds[i].map(T::constant);
            for (k, own) in [(i, first + second * lever), (n + i, second * along)] {
                let is_constant = matches!(other.kind, FrictionKind::Constant(_));
                let own = if is_constant { T::constant(0.0) } else { own * inverse };
                inertial[k] = -own;
                reactions[k] = before[k] + (to_motion[k] + own) * all;
            }
        }
        let balance = balance(state_loads, [effects, reactions, inertial]);
        solve(&mut self.friction, state_loads, state[0].value(), &balance)?;
        let mut others = T::constant(0.0);
        for other in (0..n).filter(|other| *other != joint) {
            others = others + effects[free + other] * self.friction.friction(other);
        }
        let force = (all - others) * inverse;
        self.see_normal_forces(state_loads);
        let size = self.friction.size[joint];
        self.surface.held = [force, if size.value() < 0.0 { -size } else { size }];
        // Friction is minus the arm times the size.
        (self.friction.arm[joint], self.friction.size[joint]) = (-force, T::constant(1.0));
        Ok(acceleration)
    }
}
