//! What acts in a scene at one state: dampers, drives with an efficiency, drag, bumpers, friction.
//!
//! In: a scene, the sizes of the given loads, the state. Out: the acceleration along the curve, the power lost, the sizes of
//! the loads that the state decides. Written once for values and for values with derivatives.
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::loads::friction_loop::{Balance, FrictionLoop, Locked};
use crate::mechanism::loads::laws::drag::RelativeFlow;
use crate::mechanism::loads::laws::friction::{Cubic, Regime};
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::bundle::{Bundle, ROW, side_by_side_at};
use crate::numerics::dual::Number;
use crate::numerics::table::polynomial_at;

/// What is decided between steps, not within one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Sign of sigma_dot for the drives with an efficiency; it holds until sigma_dot passes through 0. With 0 all that
    /// they are told arrives.
    pub direction: f64,
    /// Bumper, by its place in the scene, that is in contact at the low and at the high end of the travel.
    pub touching: [Option<usize>; 2],
}

/// Result of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation<T> {
    /// sigma_ddot.
    pub acceleration: T,
    /// Power that leaves the mechanism beyond the work of the given loads [W].
    pub lost: T,
}

/// Room for an evaluation, with what it found last.
#[derive(Clone, Debug)]
pub struct StateLoadEvaluator<T> {
    /// What arrives of the drives with an efficiency, in the scene's order.
    pub delivered: Vec<T>,
    /// Sizes of the scene's loads.
    pub loads: Vec<T>,
    /// Reactions and friction.
    pub friction: FrictionLoop<T>,
    /// Stretch of its law in which each pin is taken to be; where none is stated, that of its slip speed.
    regimes: Vec<Option<Regime>>,
    /// Arm of each pin's friction on its stretch.
    arms: Vec<Cubic>,
    /// The scene's bundle.
    effects: Vec<[T; ROW]>,
    /// Effect of all but friction on the motion.
    motion: T,
    /// The same on the components of the pins' reactions.
    reactions: Vec<[T; ROW]>,
    /// What arrived, then the effects on the motion and on the reactions, of the evaluation that was kept.
    kept: Vec<T>,
    /// Room for the pins' reactions without friction, then those to sigma_ddot.
    room: Vec<T>,
}

impl<T: Number> StateLoadEvaluator<T> {
    /// Room for a scene.
    pub fn new(state_loads: Option<&StateLoads>) -> Self {
        let zero = T::constant(0.0);
        let (drives_with_efficiency, loads, friction_joints) =
            state_loads.map_or((0, 0, 0), |s| (s.drives_with_efficiency.len(), s.loads.len(), s.friction_joints.len()));
        let groups = state_loads.and_then(|s| s.groups.iter().max()).map_or(0, |last| last + 1);
        let reactions = Bundle::rows(2 * friction_joints);
        Self {
            delivered: vec![zero; drives_with_efficiency],
            loads: vec![zero; loads],
            friction: FrictionLoop::new(friction_joints, groups),
            regimes: vec![None; friction_joints],
            arms: vec![Cubic::default(); friction_joints],
            effects: vec![[zero; ROW]; state_loads.map_or(0, |s| Bundle::rows(s.bundled()))],
            motion: zero,
            reactions: vec![[zero; ROW]; reactions],
            kept: vec![zero; drives_with_efficiency + 1 + ROW * reactions],
            room: vec![zero; 4 * friction_joints],
        }
    }

    /// Stretch of its law in which a pin is taken to be, if one is stated.
    pub fn regime(&self, friction_joint: usize) -> Option<Regime> {
        self.regimes[friction_joint]
    }

    /// State the stretch of its law in which a pin is, until told otherwise; with none, its slip speed tells.
    pub fn set_regime(&mut self, state_loads: &StateLoads, friction_joint: usize, regime: Option<Regime>) {
        self.regimes[friction_joint] = regime;
        if let Some(regime) = regime {
            self.arms[friction_joint] = state_loads.friction_joints[friction_joint].arm(regime);
        }
    }

    /// Evaluate at a time t of the step and a state; `panel_force` holds at sigma. Of the work of sizes that change with time, that
    /// of their excess over the sizes at t = 0 counts as gained: the energy balance has the potential of these alone.
    ///
    /// # Errors
    /// [`Locked`]: friction and reactions have no common solution.
    pub fn evaluate(
        &mut self,
        (reduced, state_loads): (&Reduced, &StateLoads),
        given: &AppliedLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        [t, sigma, sigma_dot]: [T; 3],
    ) -> Result<Evaluation<T>, Locked> {
        let x = panel_force.x(sigma);
        let at = |component: usize| polynomial_at(panel_force.series(&state_loads.table, component), x);
        let damping = reduced.components().damping;
        side_by_side_at(panel_force.bundle(&state_loads.bundle), x, &mut self.effects);
        side_by_side_at(&panel_force.reactions, x, &mut self.reactions);
        self.motion = panel_force.at(x, t);
        let (free, n) = (state_loads.free(), state_loads.friction_joints.len());
        let mut lost = T::constant(0.0);
        // What the state decides, but for friction.
        for (k, &load) in state_loads.drives_with_efficiency.iter().enumerate() {
            let influence = at(state_loads.given(0, load));
            let size = given.size(load, t);
            let full = influence * size;
            let efficiency = reduced.loading().drives[load].efficiency.unwrap_or(1.0);
            let part = efficient(full.value(), mode.direction, efficiency);
            self.delivered[k] = size * T::constant(part);
            self.motion = self.motion + influence * self.delivered[k];
            lost = lost + (full * T::constant(1.0 - part) - influence * given.excess(load, t)) * sigma_dot;
        }
        self.blow(reduced, state_loads, given.air(t), sigma_dot);
        self.press(reduced, state_loads, panel_force, mode, sigma_dot);
        for (&effect, &size) in self.effects.as_flattened().iter().zip(&self.loads[..free]) {
            self.motion = self.motion + effect * size;
            lost = lost - effect * size * sigma_dot;
        }
        if let Some(k) = damping {
            let drag = at(state_loads.given(0, k)) * sigma_dot;
            self.motion = self.motion - drag;
            lost = lost + drag * sigma_dot;
        }
        if panel_force.changes() {
            lost = lost - panel_force.excess(0, x, t) * sigma_dot;
        }
        let mut acceleration = self.motion;
        if n > 0 {
            let effects = self.effects.as_flattened();
            let reactions = &mut self.reactions.as_flattened_mut()[..2 * n];
            let square = sigma_dot * sigma_dot;
            for (sum, effect) in reactions.iter_mut().zip(&effects[state_loads.square()]) {
                *sum = *sum + *effect * square;
            }
            for (load, &size) in self.loads[..free].iter().enumerate() {
                for (sum, effect) in reactions.iter_mut().zip(&effects[state_loads.caused(load)]) {
                    *sum = *sum + *effect * size;
                }
            }
            if damping.is_some() || !state_loads.drives_with_efficiency.is_empty() || panel_force.changes() {
                for (k, sum) in reactions.iter_mut().enumerate() {
                    *sum = *sum + panel_force.excess(k + 1, x, t);
                    if let Some(damping) = damping {
                        *sum = *sum - at(state_loads.given(k + 1, damping)) * sigma_dot;
                    }
                    for (&load, &size) in state_loads.drives_with_efficiency.iter().zip(&self.delivered) {
                        *sum = *sum + at(state_loads.given(k + 1, load)) * size;
                    }
                }
            }
            self.rub(state_loads, sigma_dot)?;
            let influences = self.effects.as_flattened()[..state_loads.loads.len()].iter();
            for (j, (load, &influence)) in self.loads.iter_mut().zip(influences).skip(free).enumerate() {
                *load = self.friction.friction(j);
                let share = influence * *load;
                acceleration = acceleration + share;
                lost = lost - share * sigma_dot;
            }
        }
        Ok(Evaluation { acceleration, lost })
    }

    /// Keep what was found last, to be mixed with what is found next.
    pub fn keep(&mut self) {
        let found = self.delivered.iter().chain([&self.motion]).chain(self.reactions.as_flattened());
        self.kept.iter_mut().zip(found).for_each(|(kept, found)| *kept = *found);
    }

    /// This share of what was found last, and the rest of what was kept: for drives that hold the mechanism at rest, where all
    /// is affine in what arrives of them.
    pub fn mix(&mut self, share: T) {
        let found = self.delivered.iter_mut().chain([&mut self.motion]).chain(self.reactions.as_flattened_mut());
        for (found, kept) in found.zip(&self.kept) {
            *found = share * *found + (T::constant(1.0) - share) * *kept;
        }
    }

    /// Force along the curve of a sized load, not subject to friction itself, with which sigma_ddot is `target` in the state
    /// of the last evaluation: inverse dynamics with friction as the loop of its own. `size` is the load's present size.
    /// With `breakaway`, every pin has its static friction against a motion in that direction.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn required(
        &mut self,
        state_loads: &StateLoads,
        panel_force: &PanelForce,
        sigma: T,
        (load, size): (usize, T),
        target: T,
        breakaway: Option<f64>,
    ) -> Result<T, Locked> {
        let x = panel_force.x(sigma);
        let at = |component: usize| polynomial_at(panel_force.series(&state_loads.table, component), x);
        let influence = at(state_loads.given(0, load));
        // What the load must give along the curve without friction, and what this share of it is.
        let bare = target - (self.motion - influence * size);
        let (free, n) = (state_loads.free(), state_loads.friction_joints.len());
        if n == 0 {
            return Ok(bare);
        }
        let effects = self.effects.as_flattened();
        if let Some(direction) = breakaway {
            for (j, friction_joint) in state_loads.friction_joints.iter().enumerate() {
                let slip = effects[free + j].value() * direction;
                let arm = friction_joint.law.static_coefficient * friction_joint.radius;
                self.friction.arm[j] = T::constant(if slip < 0.0 { -arm } else { arm });
            }
        }
        // With this load the motion stays what it is, whatever the friction: reactions to it take the place of inertia.
        let inverse = influence.chain(1.0 / influence.value(), -1.0 / influence.value().powi(2));
        let (reactions, inertial) = self.room.split_at_mut(2 * n);
        for (k, (effect, reaction)) in
            effects[state_loads.inertial()].iter().zip(self.reactions.as_flattened()).enumerate()
        {
            let of_load = at(state_loads.given(k + 1, load));
            inertial[k] = *effect - of_load * inverse;
            reactions[k] = *reaction + of_load * (bare * inverse - size);
        }
        let balance = balance(state_loads, effects, reactions, inertial);
        self.friction.solve(&balance)?;
        let mut force = bare;
        for j in 0..n {
            force = force - effects[free + j] * self.friction.friction(j);
        }
        Ok(force)
    }

    /// Drag of the air.
    fn blow(&mut self, reduced: &Reduced, state_loads: &StateLoads, airspeed: T, sigma_dot: T) {
        let Some(air) = reduced.loading().air.as_ref().filter(|_| state_loads.air) else { return };
        for (i, surface) in air.surfaces.iter().enumerate() {
            let effects = self.effects.as_flattened();
            let rate = |k: usize| effects[3 * i + k] * sigma_dot;
            let mut wind = [air.flow.x, air.flow.y].map(|f| T::constant(f) * airspeed);
            let mut omega = T::constant(0.0);
            if air.relative_wind {
                wind = [wind[0] - rate(0), wind[1] - rate(1)];
                omega = rate(2);
            }
            let line = [effects[state_loads.line(i)], effects[state_loads.line(i) + 1]];
            let drag = surface.drag.force(air.density, &RelativeFlow { wind, omega, line });
            self.loads[3 * i..3 * i + 3].copy_from_slice(&drag);
        }
    }

    /// Bumpers in contact push back.
    fn press(
        &mut self,
        reduced: &Reduced,
        state_loads: &StateLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        sigma_dot: T,
    ) {
        let effects = self.effects.as_flattened();
        let first = state_loads.free() - state_loads.bumpers.len();
        for (k, &stop) in state_loads.bumpers.iter().enumerate() {
            let touches = mode.touching.contains(&Some(k));
            self.loads[first + k] = if touches {
                let stop = &reduced.loading().stops[stop];
                let wound = panel_force.revolutions * reduced.load_growth(stop.load);
                let beyond = effects[state_loads.pressed(k)] + T::constant(wound - stop.value);
                let rate = effects[first + k] * sigma_dot;
                -stop.push(beyond, rate)
            } else {
                T::constant(0.0)
            };
        }
    }

    /// Friction of all pins.
    fn rub(&mut self, state_loads: &StateLoads, sigma_dot: T) -> Result<(), Locked> {
        let effects = self.effects.as_flattened();
        let slips = &effects[state_loads.free()..state_loads.loads.len()];
        for (j, (friction_joint, slip)) in state_loads.friction_joints.iter().zip(slips).enumerate() {
            let v = *slip * sigma_dot * T::constant(friction_joint.radius);
            if self.regimes[j].is_none() {
                self.arms[j] = friction_joint.arm(friction_joint.law.regime(v.value()));
            }
            self.friction.arm[j] = self.arms[j].at(v);
        }
        let reactions = self.reactions.as_flattened();
        self.friction.solve(&balance(state_loads, effects, reactions, &effects[state_loads.inertial()]))
    }
}

/// The pins' reactions without friction, and what friction and sigma_ddot do to them.
#[inline]
fn balance<'a, T>(
    state_loads: &'a StateLoads,
    effects: &'a [T],
    reactions: &'a [T],
    inertial: &'a [T],
) -> Balance<'a, T> {
    let n = state_loads.friction_joints.len();
    let passed = &effects[state_loads.passed()];
    let half = |both: &'a [T], n: usize| {
        let (x, y) = both.split_at(n);
        [x, y]
    };
    Balance {
        free: half(&reactions[..2 * n], n),
        inertial: half(inertial, n),
        influence: &effects[state_loads.free()..state_loads.loads.len()],
        passed: half(passed, passed.len() / 2),
        groups: &state_loads.groups,
    }
}

/// [CK16] eqs. (5), (29): what part of a drive's force `full` (times its influence) arrives when the motion has this
/// direction: eta where power flows in, 1/eta where it flows back; all of it without a direction, as no power flows.
fn efficient(full: f64, direction: f64, efficiency: f64) -> f64 {
    if direction == 0.0 {
        1.0
    } else if full * direction > 0.0 {
        efficiency
    } else {
        1.0 / efficiency
    }
}

#[cfg(test)]
mod tests;
