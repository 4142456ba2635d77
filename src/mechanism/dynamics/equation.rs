//! The equation of motion along the curve, under inputs that are constant or change with time.
//!
//! sigma_ddot = sum of sizes times influences, because the reduced inertia is 1 and its derivative 0. On one panel this
//! sum is one polynomial, computed when the panel is entered. Loads that the state decides - friction, drag, bumpers,
//! dampers, drives with an efficiency - are the state loads; a mechanism without them does not pay for them.
//!
//! In: a reduced model, its state loads, sizes of loads, a state. Out: acceleration and power lost. It must not know
//! steps.
use crate::integrator::System;
use crate::mechanism::definition::MOST_CONTROL_STATES;
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::dynamics::ports::{NetworkPorts, Ports};
use crate::mechanism::dynamics::state_loads::{Evaluation, Mode, StateLoadEvaluator};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::{Differentiable, Dual, Number};
use crate::numerics::enclosure::Interval;
use crate::numerics::table::{polynomial, polynomial_at};

/// Scratch of the equation of motion in numbers T, with the results of its last evaluation.
#[derive(Clone, Debug)]
pub struct Scratch<T: Differentiable = f64> {
    /// Applied loads on the panel used last.
    pub panel_force: PanelForce,
    pub evaluator: StateLoadEvaluator<T>,
    /// State loads with derivatives along sigma.
    pub(super) tangent: StateLoadEvaluator<T::Along>,
    /// Whether the state loads include those of moving air.
    pub air: bool,
}

impl<T: Differentiable> Scratch<T> {
    pub fn new(state_loads: Option<&StateLoads>) -> Self {
        Self {
            panel_force: PanelForce::new(state_loads),
            evaluator: StateLoadEvaluator::new(state_loads),
            tangent: StateLoadEvaluator::new(state_loads),
            air: state_loads.is_some_and(|s| s.air),
        }
    }

    /// State the pressures of the chambers of a hydraulic cylinder [Pa].
    pub fn set_pressures(&mut self, cylinder: usize, pressures: [T; 2]) {
        self.evaluator.pressures[cylinder] = pressures;
        self.tangent.pressures[cylinder] = pressures.map(T::held);
    }

    /// State the states of controllers [N or N.m].
    pub fn set_controllers(&mut self, states: Option<[T; MOST_CONTROL_STATES]>) {
        self.evaluator.controllers = states;
        self.tangent.controllers = states.map(|all| all.map(T::held));
    }
}

/// The equation of motion over one communication step, in numbers T.
pub struct EquationOfMotion<'a, T: Differentiable = f64> {
    /// The reduced model on the stretch of the curve with the guess.
    pub whole: &'a Reduced,
    /// The reduced model on the stretch of the present panel.
    pub reduced: &'a Reduced,
    /// The loads that the state decides, on that stretch.
    pub state_loads: Option<&'a StateLoads>,
    /// Sizes of the other loads.
    pub applied: AppliedLoads<'a>,
    /// Time since the start of the span [s].
    pub time: T,
    /// Constant within a step.
    pub mode: Mode,
    pub scratch: &'a mut Scratch<T>,
    /// Whether friction had no solution somewhere.
    pub locked: bool,
    /// The hydraulic circuit of a drive, in a step with one.
    pub ports: Option<Ports<'a>>,
    /// The hydraulic network of the mechanism, in a step with one.
    pub network: Option<NetworkPorts<'a>>,
}

/// A reduced model with the loads that the state decides on its stretch of the curve.
type Stretch<'a> = (&'a Reduced, Option<&'a StateLoads>);

/// The stretch of the curve that holds sigma, mostly the present one.
#[inline(always)]
fn stretch_at<'a>(whole: &'a Reduced, present: Stretch<'a>, air: bool, sigma: f64) -> Stretch<'a> {
    if !whole.is_open() || present.0.holds(sigma) {
        return present;
    }
    whole.with_state_loads(sigma, air)
}

/// Enter the panel at sigma, on its stretch of the curve, which is returned; `varies`: for values with derivatives. Not
/// a method: as no reference to the
/// equation of motion escapes, its other fields stay in registers between evaluations.
#[cold]
fn enter<'a, T: Differentiable>(
    whole: &'a Reduced,
    present: Stretch<'a>,
    applied: &AppliedLoads,
    scratch: &mut Scratch<T>,
    sigma: f64,
    varies: bool,
) -> Stretch<'a> {
    let stretch = stretch_at(whole, present, scratch.air, sigma);
    scratch.panel_force.enter(stretch, applied, sigma, varies);
    stretch
}

impl<'a, T: Differentiable> EquationOfMotion<'a, T> {
    /// The equation at the start of a span, from a position on this stretch of the curve on. The scratch keeps its
    /// panel if that is of these loads.
    #[inline(always)]
    pub fn new(
        whole: &'a Reduced,
        (reduced, state_loads): Stretch<'a>,
        applied: AppliedLoads<'a>,
        scratch: &'a mut Scratch<T>,
    ) -> Self {
        scratch.panel_force.belong_to(&applied, reduced.stretch);
        let (time, mode, locked, ports, network) = (T::constant(0.0), Mode::default(), false, None, None);
        Self { whole, reduced, state_loads, applied, time, mode, scratch, locked, ports, network }
    }

    /// x at sigma on its panel, which is entered if it is not the present one.
    #[inline(always)]
    pub fn locate(&mut self, sigma: f64) -> f64 {
        if !self.scratch.panel_force.holds(sigma) {
            let present = (self.reduced, self.state_loads);
            (self.reduced, self.state_loads) =
                enter(self.whole, present, &self.applied, self.scratch, sigma, T::CARRIES);
        }
        self.scratch.panel_force.x(sigma)
    }

    /// The reduced model and the loads that the state decides on the stretch that holds sigma.
    #[inline(always)]
    pub fn stretch_at(&self, sigma: f64) -> Stretch<'a> {
        stretch_at(self.whole, (self.reduced, self.state_loads), self.scratch.air, sigma)
    }

    /// One component of the table of the loads that the state decides, at any sigma, without leaving the present panel.
    #[inline]
    pub fn component(&self, component: usize, sigma: f64) -> f64 {
        let (reduced, Some(state_loads)) = self.stretch_at(sigma) else { return 0.0 };
        self.scratch.panel_force.value((reduced, &state_loads.table), component, sigma)
    }

    /// Bounds of one component of that table, and of its derivative along sigma, on an interval of sigma. `growth`: how
    /// much the component grows over a revolution.
    pub fn component_bounds(&self, component: usize, sigma: Interval, growth: f64) -> [Interval; 2] {
        let (mut reduced, mut state_loads) = self.stretch_at(sigma.low);
        let mut all: Option<[Interval; 2]> = None;
        while let Some(present) = state_loads {
            let here = self.scratch.panel_force.bounds((reduced, &present.table), component, sigma, growth);
            let hull = all.map_or(here, |all| [all[0].hull(here[0]), all[1].hull(here[1])]);
            let last = reduced.curve().range.1;
            if !self.whole.is_open() || sigma.high < last {
                return hull;
            }
            let (next, loads) = self.whole.with_state_loads(last, self.scratch.air);
            if std::ptr::eq(next, reduced) {
                return hull;
            }
            (reduced, state_loads, all) = (next, loads, Some(hull));
        }
        all.unwrap_or([Interval::around(0.0, f64::MAX); 2])
    }

    /// Acceleration and power lost, for a motion in the mode's direction.
    #[inline]
    pub fn effect(&mut self, sigma: T, sigma_dot: T) -> Result<Evaluation<T>, Locked> {
        self.locate(sigma.value());
        let y = [self.time, sigma, sigma_dot];
        let Scratch { panel_force, evaluator, .. } = &mut *self.scratch;
        let Some(state_loads) = self.state_loads else { return Ok(of_applied_loads(panel_force, y)) };
        evaluator.evaluate((self.reduced, state_loads), &self.applied, panel_force, &self.mode, y)
    }

    /// Whether the right-hand side jumps where sigma_dot changes its sign: a drive has an efficiency, or friction
    /// sticks.
    pub fn reverses(&self) -> bool {
        self.state_loads.is_some_and(|s| s.reverses)
    }

    /// Whether friction holds at rest.
    pub fn sticks(&self) -> bool {
        self.state_loads.is_some_and(|s| s.sticks)
    }

    /// Acceleration from rest at a sigma, were the drives with an efficiency to work in this direction, against static
    /// friction. Where friction that sticks has no solution together with the reactions that cause it, no load
    /// overcomes it: the acceleration without it then stands for how far the mechanism is from setting off, against the
    /// direction.
    pub fn setting_off(&mut self, sigma: T, direction: f64) -> Result<T, Locked> {
        self.mode.direction = direction;
        if !self.sticks() {
            if self.clinging().is_some() {
                self.clear_regimes();
            }
            return Ok(self.effect(sigma, T::constant(0.0))?.acceleration);
        }
        self.clear_regimes();
        self.mode.breaks_away = true;
        let found = self.effect(sigma, T::constant(0.0));
        self.mode.breaks_away = false;
        if let Ok(found) = found {
            return Ok(found.acceleration);
        }
        self.mode.direction = 0.0;
        let size = self.effect(sigma, T::constant(0.0))?.acceleration;
        self.mode.direction = direction;
        Ok(if size.value() * direction > 0.0 { -size } else { size })
    }

    /// Direction of the motion; at rest the direction in which the mechanism sets off, 0 if its drives hold it ([CK16]
    /// 2.3: driven forward they give less, driven back they hold more) or friction does.
    pub fn start_direction(&mut self, sigma: T, sigma_dot: T) -> Result<f64, Locked> {
        if sigma_dot.value() != 0.0 {
            return Ok(sigma_dot.value().signum());
        }
        for direction in [1.0, -1.0] {
            if self.setting_off(sigma, direction)?.value() * direction > 0.0 {
                return Ok(direction);
            }
        }
        Ok(0.0)
    }

    /// Acceleration at any state, with the delivered force of every drive. The mode's direction becomes that of the
    /// drives, 0 where they hold the mechanism at rest.
    #[inline]
    pub fn settle(&mut self, sigma: T, sigma_dot: T) -> Result<T, Locked> {
        self.clear_regimes();
        let direction = if self.reverses() { self.start_direction(sigma, sigma_dot)? } else { self.mode.direction };
        if self.clinging().is_some() && !(self.reverses() && direction == 0.0) {
            return self.find_on_surface(direction, sigma, sigma_dot);
        }
        self.settle_in(direction, sigma, sigma_dot)
    }

    /// [`Self::settle`] in a known direction. Where drives or friction hold the mechanism at rest, each delivers a
    /// force between its forward and its backward value: the common share at which all is in balance.
    pub fn settle_in(&mut self, direction: f64, sigma: T, sigma_dot: T) -> Result<T, Locked> {
        let Some(state_loads) = self.state_loads.filter(|s| direction == 0.0 && s.reverses) else {
            return self.heading(direction, sigma, sigma_dot);
        };
        self.mode.breaks_away = state_loads.sticks;
        let both = self.forward_and_back(state_loads, sigma, sigma_dot);
        (self.mode.breaks_away, self.mode.direction) = (false, 0.0);
        let (forward, back) = both?;
        let share = if back.value() > forward.value() { back / (back - forward) } else { T::constant(1.0) };
        self.scratch.evaluator.mix(state_loads, share);
        Ok(T::constant(0.0))
    }

    /// Accelerations in both directions; the evaluation backward is kept, the one forward is the last one.
    fn forward_and_back(&mut self, state_loads: &StateLoads, sigma: T, sigma_dot: T) -> Result<(T, T), Locked> {
        let back = self.heading(-1.0, sigma, sigma_dot)?;
        self.scratch.evaluator.keep(state_loads);
        Ok((self.heading(1.0, sigma, sigma_dot)?, back))
    }

    /// Acceleration at any state, were the drives with an efficiency to work in this direction; 0: without their
    /// losses.
    pub fn heading(&mut self, direction: f64, sigma: T, sigma_dot: T) -> Result<T, Locked> {
        self.clear_regimes();
        self.mode.direction = direction;
        Ok(self.effect(sigma, sigma_dot)?.acceleration)
    }

    /// Whether friction locks a motion so slow that every joint has its static friction against this direction.
    pub fn locks_slowly(&mut self, sigma: T, direction: f64) -> bool {
        self.clear_regimes();
        self.mode.direction = direction;
        let at_rest = self.effect(sigma, T::constant(0.0));
        let Some(state_loads) = self.state_loads else { return false };
        at_rest.is_err() || self.scratch.evaluator.locks_slowly(state_loads, direction)
    }

    /// Derivative along sigma of the acceleration at rest, without losses of drives.
    pub fn slope_at_rest(&mut self, sigma: T) -> Result<T, Locked> {
        self.clear_regimes();
        self.mode.direction = 0.0;
        let evaluation = self.along([self.time.held(), sigma.varied(), T::Along::constant(0.0)])?;
        Ok(T::slope_of(evaluation.acceleration))
    }

    /// Acceleration in a direction of the drives, with its derivatives along sigma and sigma_dot.
    pub fn gradient(&mut self, direction: f64, sigma: T, sigma_dot: T) -> Result<[T; 3], Locked> {
        self.clear_regimes();
        self.mode.direction = direction;
        let slopes = self.tangent(sigma, sigma_dot)?.map(|evaluation| T::slope_of(evaluation.acceleration));
        Ok([self.heading(direction, sigma, sigma_dot)?, slopes[0], slopes[1]])
    }

    /// [`Self::effect`] with its derivatives along sigma, and with those along sigma_dot. No number carries both with
    /// the derivatives of its own.
    pub fn tangent(&mut self, sigma: T, sigma_dot: T) -> Result<[Evaluation<T::Along>; 2], Locked> {
        let time = self.time.held();
        let by_sigma = self.along([time, sigma.varied(), sigma_dot.held()])?;
        Ok([by_sigma, self.along([time, sigma.held(), sigma_dot.varied()])?])
    }

    /// Evaluation at (t, sigma, sigma_dot) in numbers with derivatives along sigma.
    fn along(&mut self, y: [T::Along; 3]) -> Result<Evaluation<T::Along>, Locked> {
        let sigma = y[1].value();
        if !self.scratch.panel_force.has_slopes(sigma) {
            let present = (self.reduced, self.state_loads);
            (self.reduced, self.state_loads) = enter(self.whole, present, &self.applied, self.scratch, sigma, true);
        }
        let Scratch { panel_force, tangent, .. } = &mut *self.scratch;
        let Some(state_loads) = self.state_loads else { return Ok(of_applied_loads(panel_force, y)) };
        tangent.evaluate((self.reduced, state_loads), &self.applied, panel_force, &self.mode, y)
    }

    /// State the regime of a friction joint; with none, it follows from the slip speed in each evaluation.
    #[inline]
    pub fn set_regime(&mut self, friction_joint: usize, regime: Option<Regime>) {
        if let Some(state_loads) = self.state_loads {
            self.scratch.evaluator.set_regime(state_loads, friction_joint, regime);
            self.scratch.tangent.set_regime(state_loads, friction_joint, regime);
        }
    }

    /// Hold the signs that the switching quantities have had in the last evaluation.
    pub fn hold_signs(&mut self) {
        if let Some(state_loads) = self.state_loads {
            self.scratch.evaluator.hold_signs(state_loads);
            self.copy_signs(state_loads);
        }
    }

    /// Turn the held sign of a switching quantity round.
    pub fn flip_sign(&mut self, switch: usize) {
        if let Some(state_loads) = self.state_loads {
            self.scratch.evaluator.flip_sign(state_loads, switch);
            self.copy_signs(state_loads);
        }
    }

    /// Let the laws follow from the present signs of the switching quantities.
    #[inline]
    pub fn clear_signs(&mut self) {
        if let Some(state_loads) = self.state_loads.filter(|s| s.switches() > 0) {
            self.scratch.evaluator.clear_signs(state_loads);
            self.copy_signs(state_loads);
        }
    }

    fn copy_signs(&mut self, state_loads: &StateLoads) {
        let Scratch { evaluator, tangent, .. } = &mut *self.scratch;
        tangent.hold_signs_of(state_loads, &evaluator.switches);
    }

    /// Let the regimes and signs follow from the state in each evaluation.
    #[inline(always)]
    pub fn clear_regimes(&mut self) {
        self.clear_signs();
        for friction_joint in 0..self.state_loads.map_or(0, |s| s.friction_joints.len()) {
            self.set_regime(friction_joint, None);
        }
    }
}

impl EquationOfMotion<'_> {
    /// Scales of sigma and sigma_dot: the length of a motion of the size of one radian; sigma_dot itself, or the part
    /// `floor` of the speed that the present force gives over that length.
    fn scales(&self, sigma_dot: f64, acceleration: f64, floor: f64) -> [f64; 2] {
        let length = self.reduced.scale();
        let fallen = floor * (acceleration.abs() * length).sqrt();
        [length, sigma_dot.abs().max(fallen).max(1e-12 * length)]
    }
}

/// Evaluation of the applied loads alone, at (t, sigma, sigma_dot).
#[inline(always)]
fn of_applied_loads<T: Number>(panel_force: &PanelForce, [t, sigma, sigma_dot]: [T; 3]) -> Evaluation<T> {
    let x = panel_force.x(sigma);
    let (acceleration, zero) = (polynomial_at(&panel_force.force, x), T::constant(0.0));
    if !panel_force.changes() {
        return Evaluation { acceleration, lost: zero };
    }
    let gained = panel_force.excess(0, x, t);
    Evaluation { acceleration: acceleration + gained, lost: -(gained * sigma_dot) }
}

/// No loss of power and constant inputs: (sigma, sigma_dot).
impl System<2> for EquationOfMotion<'_> {
    const SECOND_ORDER: bool = true;

    #[inline(always)]
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let x = self.locate(y[0]);
        [y[1], polynomial(&self.scratch.panel_force.force, x)]
    }

    /// x is computed from y before `way` is added, so that the processor need not wait for `way`.
    #[inline(always)]
    fn acceleration(&mut self, _t: f64, y: &[f64; 2], way: f64) -> f64 {
        self.locate(y[0] + way);
        let x = self.scratch.panel_force.x(Dual::<1>::variable(y[0], 0));
        polynomial(&self.scratch.panel_force.force, x.value + way * x.slope[0])
    }

    fn scale(&mut self, y: &[f64; 2], f: &[f64; 2]) -> [f64; 2] {
        self.scales(y[1], f[1], self.reduced.speed_floor)
    }
}

/// With state loads, or inputs that change with time: (sigma, sigma_dot, energy lost).
impl System<3> for EquationOfMotion<'_> {
    const CAN_BE_STIFF: bool = true;

    fn jacobian(&mut self, t: f64, y: &[f64; 3]) -> [[f64; 3]; 3] {
        self.time = t;
        let Ok([by_sigma, by_speed]) = self.tangent(y[0], y[1]) else {
            self.locked = true;
            return [[f64::NAN; 3]; 3];
        };
        let row = |of: fn(&Evaluation<Dual<1>>) -> Dual<1>| [of(&by_sigma).slope[0], of(&by_speed).slope[0], 0.0];
        [[0.0, 1.0, 0.0], row(|found| found.acceleration), row(|found| found.lost)]
    }

    fn derivative(&mut self, t: f64, y: &[f64; 3]) -> [f64; 3] {
        self.time = t;
        let Ok(Evaluation { acceleration, lost }) = self.effect(y[0], y[1]) else {
            // The step is rejected and tried again, shorter. If none is short enough, this is reported as the reason.
            self.locked = true;
            return [f64::NAN; 3];
        };
        self.scratch.evaluator.switches.record(t);
        [y[1], acceleration, lost]
    }

    fn scale(&mut self, y: &[f64; 3], f: &[f64; 3]) -> [f64; 3] {
        // Where the loads balance each other, the acceleration does not show how large the forces are, but applied
        // loads do.
        let x = self.locate(y[0]);
        let panel_force = &self.scratch.panel_force;
        let force = f[1].abs().max(panel_force.at(x, 0.0).abs()).max(panel_force.excess(0, x, self.time).abs());
        let floor = self.reduced.speed_floor;
        let [length, speed] = self.scales(y[1], force, floor);
        // Energies are relative to the whole speed, as their rounding is.
        let whole = if floor < 1.0 { self.scales(y[1], force, 1.0)[1] } else { speed };
        // Where friction balances the rest, the power lost shows how large the forces are.
        let resisting = if f[2] == 0.0 { 0.0 } else { (f[2] / y[1]).abs() };
        [length, speed, (whole * whole).max(resisting * length)]
    }
}
