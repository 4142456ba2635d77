//! Loads that the state decides: dampers, drives with an efficiency or a curve, drag, bumpers, springs that wind up,
//! friction.
//!
//! In: the state loads, the sizes of the applied loads, the state. Out: the acceleration along the curve, the power
//! lost, the sizes of the state loads. Written once for values and for values with derivatives. It must not know steps.
mod drives;
mod free;
mod losses;
mod surface;

use crate::hydraulics::network::definition::MOST_CYLINDERS;
use crate::mechanism::definition::MOST_CONTROL_STATES;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::dynamics::switches::Switches;
use crate::mechanism::loads::friction_loop::{Balance, FrictionLoop, Locked};
use crate::mechanism::loads::laws::friction::{Cubic, Regime};
use crate::mechanism::loads::resolved::FrictionKind;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::bundle::{Bundle, ROW, side_by_side_at};
use crate::numerics::dual::Number;
use crate::numerics::table::polynomial_at;
use losses::solve;
pub use surface::{Surface, is_still, with_surface};

/// What is constant within a step and may change between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Direction in which drives with an efficiency work: the sign of sigma_dot until that passes through 0. 0: no
    /// losses; the full commanded force acts. Friction that holds at rest acts against this direction there.
    pub direction: f64,
    /// Whether friction joints have their static friction against that direction, as where the mechanism is held.
    pub breaks_away: bool,
    /// Bumpers that push.
    pub touching: BumperSet,
    /// Whether a stop, a lock, drives or friction hold the mechanism at rest while other parts of the state change.
    pub held: bool,
    /// Whether driven surfaces are taken to stand still, so that a mechanism at rest has no friction.
    pub still: bool,
}

/// Result of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation<T> {
    /// sigma_ddot.
    pub acceleration: T,
    /// Power that leaves the mechanism beyond the work of the applied loads at t = 0 [W].
    pub lost: T,
}

/// Scratch for an evaluation, with the results of the last one.
#[derive(Clone, Debug)]
pub struct StateLoadEvaluator<T> {
    /// Delivered forces of the drives whose force the state decides.
    pub delivered: Vec<T>,
    /// Pressures of the chambers of each hydraulic cylinder [Pa]; 0 without one.
    pub pressures: [[T; 2]; MOST_CYLINDERS],
    /// States of controllers [N or N.m]; none where controllers are evaluated without them.
    pub controllers: Option<[T; MOST_CONTROL_STATES]>,
    /// Their rates at the last evaluation [N/s or N.m/s].
    pub controller_rates: [T; MOST_CONTROL_STATES],
    pub loads: Vec<T>,
    /// Loop between friction and the reactions that cause it.
    pub friction: FrictionLoop<T>,
    /// Stated regime of each friction joint; where none is stated, it follows from the slip speed.
    pub regimes: Vec<Option<Regime>>,
    /// Arm of each joint's friction in its regime.
    arms: Vec<Cubic>,
    /// Influence of the load of each law of a drive, and the displacement of the drive where the law depends on it.
    law_values: Vec<[f64; 2]>,
    /// Quantities whose signs select a law, with their signs and samples.
    pub switches: Switches,
    /// The driven surface that can hold its body.
    pub surface: Surface<T>,
    /// Values of [`StateLoads::bundle`].
    effects: Vec<[T; ROW]>,
    /// sigma_ddot without friction.
    motion: T,
    /// Components of the friction joints' reactions without friction.
    reactions: Vec<[T; ROW]>,
    /// `delivered`, `motion`, `reactions` and friction of the evaluation before, for [`Self::mix`].
    kept: Vec<T>,
    /// Reactions without friction, then those to sigma_ddot, for [`Self::required`].
    scratch: Vec<T>,
}

impl<T: Number> StateLoadEvaluator<T> {
    #[inline(never)]
    pub fn new(state_loads: Option<&StateLoads>) -> Self {
        let zero = T::constant(0.0);
        let (drives, loads, friction_joints) =
            state_loads.map_or((0, 0, 0), |s| (s.drives.len(), s.loads.len(), s.friction_joints.len()));
        let groups = state_loads.map_or(0, |s| s.groups.count());
        let reactions = Bundle::rows(2 * friction_joints);
        let mut friction = FrictionLoop::new(friction_joints, groups);
        friction.constant = state_loads.map_or(0, |s| s.constant_friction().count());
        friction.has_normal_forces = state_loads.is_some_and(|s| !s.prismatic.is_empty());
        Self {
            delivered: vec![zero; drives],
            pressures: [[zero; 2]; MOST_CYLINDERS],
            controllers: None,
            controller_rates: [zero; MOST_CONTROL_STATES],
            loads: vec![zero; loads],
            friction,
            regimes: vec![None; friction_joints],
            arms: vec![Cubic::default(); friction_joints],
            law_values: vec![[0.0; 2]; state_loads.map_or(0, |s| s.laws.len())],
            switches: Switches::new(state_loads.map_or(0, StateLoads::switches)),
            surface: Surface::default(),
            effects: vec![[zero; ROW]; state_loads.map_or(0, |s| Bundle::rows(s.bundled()))],
            motion: zero,
            reactions: vec![[zero; ROW]; reactions],
            kept: vec![zero; drives + 1 + ROW * reactions + friction_joints],
            scratch: vec![zero; 4 * friction_joints],
        }
    }

    /// State the regime of a friction joint; with none, it follows from the slip speed in each evaluation.
    #[inline]
    pub fn set_regime(&mut self, state_loads: &StateLoads, friction_joint: usize, regime: Option<Regime>) {
        self.regimes[friction_joint] = regime;
        if let Some(regime) = regime {
            self.arms[friction_joint] = state_loads.friction_joints[friction_joint].arm(regime);
        }
    }

    /// Hold the signs that the switching quantities have had in the last evaluation.
    pub fn hold_signs(&mut self, state_loads: &StateLoads) {
        self.switches.hold();
        self.signs_changed(state_loads);
    }

    /// Hold the signs that another evaluator holds.
    pub fn hold_signs_of(&mut self, state_loads: &StateLoads, switches: &Switches) {
        self.switches.hold_as(switches);
        self.signs_changed(state_loads);
    }

    /// Let the laws follow from the signs that the switching quantities have in each evaluation.
    pub fn clear_signs(&mut self, state_loads: &StateLoads) {
        self.switches.clear();
        self.signs_changed(state_loads);
    }

    /// Turn the held sign of a switching quantity round.
    pub fn flip_sign(&mut self, state_loads: &StateLoads, switch: usize) {
        self.switches.flip(switch);
        self.signs_changed(state_loads);
    }

    /// A step begins: what is known of the one before does not count.
    pub fn begin_step(&mut self) {
        self.switches.restart();
        self.friction.begin_step();
    }

    /// No step is being made: evaluations do not depend on those before.
    pub fn end_step(&mut self) {
        self.friction.end_step();
    }

    /// The held signs of the normal forces are those of the switches.
    fn signs_changed(&mut self, state_loads: &StateLoads) {
        for (k, &joint) in state_loads.prismatic.iter().enumerate() {
            self.friction.sign[joint] = self.switches.sign(state_loads.efficient + k);
        }
    }

    /// Largest change of sigma_ddot that the other law of a switch makes for each unit of its quantity, at the state of
    /// the last evaluation.
    pub fn switch_effect(&self, (reduced, state_loads): (&Reduced, &StateLoads), switch: usize) -> f64 {
        if let Some(limit) = switch.checked_sub(state_loads.limit_switch(0)) {
            return self.law_values[state_loads.limits[limit].0][0].abs();
        }
        if let Some(k) = switch.checked_sub(state_loads.efficient) {
            let joint = state_loads.prismatic[k];
            let influence = self.effects.as_flattened()[state_loads.free() + joint];
            let friction_joint = state_loads.friction_joints[joint];
            if friction_joint.kind == FrictionKind::Teeth {
                return self.effect_of_teeth(state_loads, joint);
            }
            return 2.0 * friction_joint.back * (self.friction.arm[joint] * influence).value().abs();
        }
        let efficiency = reduced.loading().drives[state_loads.drives[switch]].efficiency;
        efficiency.map_or(0.0, |eta| (1.0 / eta.backward - eta.forward).abs())
    }

    /// [`Self::switch_effect`] of the force between teeth, which acts by the friction of the joints that it loads.
    fn effect_of_teeth(&self, state_loads: &StateLoads, teeth: usize) -> f64 {
        let (effects, n) = (self.effects.as_flattened(), state_loads.friction_joints.len());
        let passed = &effects[state_loads.passed()];
        let of_joint = |(k, group): (usize, &usize)| {
            let [first, second] = [0, state_loads.groups.count()].map(|axis| passed[(axis + group) * n + teeth]);
            let arm = self.friction.arm[k] * effects[state_loads.free() + k];
            arm.value().abs() * (first.value().abs() + second.value().abs())
        };
        let all: f64 = state_loads.groups.of.iter().enumerate().map(of_joint).sum();
        2.0 * self.friction.arm[teeth].value().abs() * all
    }

    /// Evaluate at a time t of the step and a state; `panel_force` holds at sigma. The energy balance has the potential
    /// of the sizes at t = 0, so the work of the excess over these sizes counts as gained.
    ///
    /// # Errors
    /// [`Locked`]: friction and reactions have no common solution.
    pub fn evaluate(
        &mut self,
        (reduced, state_loads): (&Reduced, &StateLoads),
        applied: &AppliedLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        [t, sigma, sigma_dot]: [T; 3],
    ) -> Result<Evaluation<T>, Locked> {
        let x = panel_force.x(sigma);
        let at = |component: usize| polynomial_at(panel_force.series(&state_loads.table, component), x);
        side_by_side_at(panel_force.bundle(&state_loads.bundle), x, &mut self.effects);
        side_by_side_at(&panel_force.reactions, x, &mut self.reactions);
        self.motion = panel_force.at(x, t);
        let mut lost = T::constant(0.0);
        if !state_loads.drives.is_empty() {
            lost = self.drives((reduced, state_loads), applied, panel_force, mode, [t, x, sigma_dot]);
        }
        self.drag(reduced, state_loads, applied.air(t), sigma_dot);
        self.bumpers(reduced, state_loads, panel_force, mode, sigma_dot);
        if !state_loads.springs.is_empty() {
            lost = lost - self.springs(reduced, state_loads, panel_force, sigma_dot) * sigma_dot;
        }
        for (&effect, &size) in self.effects.as_flattened().iter().zip(&self.loads[..state_loads.free()]) {
            self.motion = self.motion + effect * size;
            lost = lost - effect * size * sigma_dot;
        }
        if let Some(k) = reduced.components().damping {
            let damping = at(state_loads.given(0, k)) * sigma_dot;
            self.motion = self.motion - damping;
            lost = lost + damping * sigma_dot;
        }
        if panel_force.changes() {
            lost = lost - panel_force.excess(0, x, t) * sigma_dot;
        }
        let mut acceleration = self.motion;
        if !state_loads.friction_joints.is_empty() {
            self.reactions_without_friction((reduced, state_loads), panel_force, [t, x, sigma_dot]);
            let held = self.friction(state_loads, applied, panel_force, mode, [t, x, sigma_dot])?;
            let influences = self.effects.as_flattened()[..state_loads.loads.len()].iter();
            for (j, (load, &influence)) in self.loads.iter_mut().zip(influences).skip(state_loads.free()).enumerate() {
                *load = self.friction.friction(j);
                let share = influence * *load;
                acceleration = acceleration + share;
                lost = lost - share * sigma_dot;
            }
            // The sum, without its rounding.
            acceleration = held.unwrap_or(acceleration);
        }
        Ok(Evaluation { acceleration, lost })
    }

    /// Add to the reactions to the applied loads those to the motion, to drag, bumpers, dampers and drives with an
    /// efficiency.
    #[inline]
    fn reactions_without_friction(
        &mut self,
        (reduced, state_loads): (&Reduced, &StateLoads),
        panel_force: &PanelForce,
        [t, x, sigma_dot]: [T; 3],
    ) {
        let at = |component: usize| polynomial_at(panel_force.series(&state_loads.table, component), x);
        let damping = reduced.components().damping;
        let effects = self.effects.as_flattened();
        let reactions = &mut self.reactions.as_flattened_mut()[..2 * state_loads.friction_joints.len()];
        for (k, size) in state_loads.constant_friction() {
            reactions[k] = T::constant(size);
        }
        let square = sigma_dot * sigma_dot;
        for (sum, effect) in reactions.iter_mut().zip(&effects[state_loads.square()]) {
            *sum = *sum + *effect * square;
        }
        for (load, &size) in self.loads[..state_loads.free()].iter().enumerate() {
            for (sum, effect) in reactions.iter_mut().zip(&effects[state_loads.caused(load)]) {
                *sum = *sum + *effect * size;
            }
        }
        if damping.is_some() || !state_loads.drives.is_empty() || panel_force.changes() {
            for (k, sum) in reactions.iter_mut().enumerate() {
                *sum = *sum + panel_force.excess(k + 1, x, t);
                if let Some(damping) = damping {
                    *sum = *sum - at(state_loads.given(k + 1, damping)) * sigma_dot;
                }
                for (&load, &size) in state_loads.drives.iter().zip(&self.delivered) {
                    *sum = *sum + at(state_loads.given(k + 1, load)) * size;
                }
            }
        }
    }

    /// Keep the delivered forces, sigma_ddot, the reactions and the friction of the last evaluation for [`Self::mix`].
    pub fn keep(&mut self, state_loads: &StateLoads) {
        let friction = &self.loads[state_loads.free()..];
        let found = self.delivered.iter().chain([&self.motion]).chain(self.reactions.as_flattened()).chain(friction);
        self.kept.iter_mut().zip(found).for_each(|(kept, found)| *kept = *found);
    }

    /// Replace the delivered forces, sigma_ddot without friction, the reactions and the friction that holds at rest by
    /// share * last + (1 - share) * kept evaluation. At rest reactions are affine in the delivered forces and in the
    /// friction, so the mean of two evaluations, driven forward and backward, is the evaluation for the mean of these.
    /// Of static friction mu |R| forward and -mu |R'| backward, the mean is within mu times the mean of R and R'.
    pub fn mix(&mut self, state_loads: &StateLoads, share: T) {
        let friction = &mut self.loads[state_loads.free()..];
        let found = self.delivered.iter_mut().chain([&mut self.motion]).chain(self.reactions.as_flattened_mut());
        let found = found.chain(friction);
        for (found, kept) in found.zip(&self.kept) {
            *found = share * *found + (T::constant(1.0) - share) * *kept;
        }
    }

    /// Inverse dynamics with friction: the force along the curve of an applied load with which sigma_ddot is `target`
    /// in the state of the last evaluation. `size` is the load's present size. With `breakaway`, every friction joint
    /// has its static friction against a motion in that direction.
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
        // The force along the curve that the load must give without friction.
        let bare = target - (self.motion - influence * size);
        let (free, n) = (state_loads.free(), state_loads.friction_joints.len());
        if n == 0 {
            return Ok(bare);
        }
        match breakaway {
            Some(direction) => self.set_static_arms(state_loads, direction),
            None => losses::turn_forward(&mut self.friction, state_loads),
        }
        let effects = self.effects.as_flattened();
        // This load balances the friction, so sigma_ddot does not depend on friction: the reactions to the load replace
        // the inertial ones.
        let inverse = influence.powi(-1);
        let (reactions, inertial) = self.scratch.split_at_mut(2 * n);
        let pairs = effects[state_loads.inertial()].iter().zip(self.reactions.as_flattened());
        for (k, (effect, reaction)) in pairs.enumerate() {
            let of_load = at(state_loads.given(k + 1, load));
            inertial[k] = *effect - of_load * inverse;
            reactions[k] = *reaction + of_load * (bare * inverse - size);
        }
        let balance = balance(state_loads, [effects, reactions, inertial]);
        solve(&mut self.friction, state_loads, 0.0, &balance)?;
        let mut force = bare;
        for j in 0..n {
            force = force - effects[free + j] * self.friction.friction(j);
        }
        Ok(force)
    }

    /// Every friction joint has its static friction against a motion in this direction; on a surface that moves, that
    /// of the last evaluation, which was one at rest.
    fn set_static_arms(&mut self, state_loads: &StateLoads, direction: f64) {
        let slips = &self.effects.as_flattened()[state_loads.free()..];
        for (j, (friction_joint, slip)) in state_loads.friction_joints.iter().zip(slips).enumerate() {
            if friction_joint.surface.is_some() && self.friction.arm[j].value() != 0.0 {
                continue;
            }
            let arm = friction_joint.law.static_coefficient * friction_joint.radius;
            self.friction.arm[j] = T::constant(if slip.value() * direction < 0.0 { -arm } else { arm });
        }
    }

    /// Whether static friction against a motion in this direction has no solution together with the reactions of the
    /// last evaluation, which was one at rest.
    pub fn locks_slowly(&mut self, state_loads: &StateLoads, direction: f64) -> bool {
        self.set_static_arms(state_loads, direction);
        let effects = self.effects.as_flattened();
        let reactions = self.reactions.as_flattened();
        let balance = balance(state_loads, [effects, reactions, &effects[state_loads.inertial()]]);
        solve(&mut self.friction, state_loads, 0.0, &balance).is_err()
    }

    /// Solve for the friction. Returns sigma_ddot where a driven surface holds its body and so determines it.
    fn friction(
        &mut self,
        state_loads: &StateLoads,
        applied: &AppliedLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        [t, x, sigma_dot]: [T; 3],
    ) -> Result<Option<T>, Locked> {
        let effects = self.effects.as_flattened();
        let slips = &effects[state_loads.free()..state_loads.loads.len()];
        let on_surfaces = state_loads.surfaces > 0 && !mode.still;
        for (j, (friction_joint, slip)) in state_loads.friction_joints.iter().zip(slips).enumerate() {
            let mut v = *slip * sigma_dot * T::constant(friction_joint.radius);
            let (mut towards, mut at) = (slip.value() * mode.direction, v.value());
            let mut rests = mode.breaks_away || is_at_rest(mode, sigma_dot.value());
            if on_surfaces && let Some(surface) = friction_joint.surface {
                let speed = applied.size(surface, t);
                v = v - speed;
                (rests, at, towards) = self.surface.slip([t, v, speed].map(|number| number.value()), towards);
            }
            if self.regimes[j].is_none() {
                self.arms[j] = if friction_joint.law.sticks && rests {
                    friction_joint.law.at_breakaway(towards).times(friction_joint.radius)
                } else {
                    friction_joint.arm(friction_joint.law.regime_towards(at, towards))
                };
            }
            self.friction.arm[j] = self.arms[j].at(v);
        }
        if let Some(joint) = state_loads.clings.filter(|joint| self.regimes[*joint] == Some(Regime::Sticking)) {
            return self.hold(state_loads, panel_force, joint, [t, x, sigma_dot]).map(Some);
        }
        let reactions = self.reactions.as_flattened();
        let balance = balance(state_loads, [effects, reactions, &effects[state_loads.inertial()]]);
        solve(&mut self.friction, state_loads, t.value(), &balance)?;
        self.see_normal_forces(state_loads);
        Ok(None)
    }
}

/// The friction joints' reactions without friction, and the effects of friction and sigma_ddot on them.
#[inline]
fn balance<'a, T>(state_loads: &'a StateLoads, [effects, reactions, inertial]: [&'a [T]; 3]) -> Balance<'a, T> {
    let n = state_loads.friction_joints.len();
    let passed = &effects[state_loads.passed()];
    Balance {
        free: reactions[..2 * n].split_at(n).into(),
        inertial: inertial.split_at(n).into(),
        influence: &effects[state_loads.free()..state_loads.loads.len()],
        passed: passed.split_at(passed.len() / 2).into(),
        groups: &state_loads.groups.of,
        seconds: &state_loads.groups.seconds,
    }
}

/// Whether the mechanism is at rest without a direction in which it would set off.
fn is_at_rest(mode: &Mode, sigma_dot: f64) -> bool {
    sigma_dot == 0.0 && mode.direction == 0.0
}

#[cfg(test)]
mod tests;
