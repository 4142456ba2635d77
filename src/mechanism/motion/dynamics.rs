//! What the advance asks of the thing that moves, and the answers of a mechanism.
//!
//! In: states, directions, regimes, contacts. Out: accelerations, and the quantities whose signs change at events. It
//! must not know steps.
use crate::integrator::System;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{BORDERS, DRIVEN, MOTION};
use crate::mechanism::dynamics::network::{Level, NETWORKED};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::enclosure::Enclosure;
use crate::numerics::table::{TablePosition, polynomial};
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

    /// Slip speed of a joint [m/s].
    fn slip(&mut self, _joint: usize, _sigma: f64, _sigma_dot: f64) -> f64 {
        0.0
    }

    /// Bounds of the slip speed of a joint [m/s] along a part of a step with these bounds of sigma and sigma_dot.
    fn slip_bounds(&mut self, _joint: usize, _sigma: Enclosure, _sigma_dot: Enclosure) -> Enclosure {
        Enclosure::constant(0.0)
    }

    /// sigma with its position in the table, for [`Self::slip_rate`], the same for all joints.
    fn slip_position(&self, _sigma: f64) -> (f64, TablePosition) {
        (0.0, TablePosition { panel: 0, x: 0.0 })
    }

    /// Slip speed of a joint [m/s] and its rate [m/s2], at a position and these sigma_dot and sigma_ddot.
    fn slip_rate(&self, _joint: usize, _at: (f64, TablePosition), _rates: [f64; 2]) -> [f64; 2] {
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

impl<'a> EquationOfMotion<'a> {
    /// The loads that the state decides. A state of two components has no energy lost, so that there are none, and
    /// nothing of them is compiled for it.
    #[inline(always)]
    fn deciding<const N: usize>(&self) -> Option<&'a StateLoads> {
        if N < MOTION { None } else { self.state_loads }
    }
}

impl<const N: usize> Dynamics<N> for EquationOfMotion<'_>
where
    Self: System<N>,
{
    #[inline]
    fn set_time(&mut self, t: f64) {
        self.time = t;
    }

    #[inline(always)]
    fn evolves_at_rest(&self) -> bool {
        N > MOTION
    }

    #[inline(always)]
    fn set_state(&mut self, z: &[f64; N]) {
        if N == DRIVEN {
            self.scratch.evaluator.pressures[0] = [z[MOTION], z[MOTION + 1]];
        } else if N == NETWORKED {
            self.set_pressures_of_network(z);
        }
    }

    #[inline(always)]
    fn set_held(&mut self, held: bool) {
        if let (true, Some(ports)) = (N == DRIVEN, &mut self.ports) {
            ports.held = held;
        }
        if let (true, Some(network)) = (N == NETWORKED, &mut self.network) {
            network.held = held;
        }
    }

    #[inline(always)]
    fn next_kink(&self, t: f64) -> f64 {
        match (&self.ports, &self.network) {
            (Some(ports), _) if N == DRIVEN => ports.next_kink(t),
            (_, Some(network)) if N == NETWORKED => network.next_kink(t),
            _ => f64::INFINITY,
        }
    }

    #[inline(always)]
    fn has_knots(&self) -> bool {
        self.whole.has_knots()
    }

    #[inline(always)]
    fn next_knot(&self, sigma: f64, direction: f64) -> Option<f64> {
        if self.whole.has_knots() { self.whole.next_knot(sigma, direction) } else { None }
    }

    #[inline(always)]
    fn borders(&self) -> usize {
        let own = self.deciding::<N>().map_or(0, StateLoads::borders);
        match &self.network {
            Some(network) if N == NETWORKED => own + network.borders(),
            _ if N == DRIVEN => own + BORDERS,
            _ => own,
        }
    }

    #[inline]
    fn distant_borders(&self, states: [(f64, &[f64; N]); 2]) -> Range<usize> {
        match self.deciding::<N>().filter(|state_loads| state_loads.edges > 0) {
            Some(state_loads) if self.faces_alike(states.map(|(t, z)| [t, z[0], z[1]])) => {
                let gaps = state_loads.gap_borders();
                gaps..gaps + state_loads.edges
            }
            _ => 0..0,
        }
    }

    fn is_kink(&self, border: usize) -> bool {
        let gaps = self.deciding::<N>().map_or(0, StateLoads::gap_borders);
        self.deciding::<N>().is_some_and(|state_loads| (gaps..gaps + state_loads.kinks.len()).contains(&border))
    }

    fn beyond_border(&mut self, border: usize, t: f64, z: &[f64; N]) -> f64 {
        let gaps = self.deciding::<N>().map_or(0, StateLoads::gap_borders);
        let Some(border) = border.checked_sub(gaps) else {
            let (reduced, state_loads) = self.stretch_at(z[0]);
            return state_loads.map_or(0.0, |state_loads| state_loads.beyond_gap(border, z[0], reduced.period()));
        };
        let kinks = self.deciding::<N>().map_or(&[][..], |state_loads| &state_loads.kinks);
        if let Some(kink) = kinks.get(border) {
            return self.beyond_kink(kink, [t, z[0], z[1]]);
        }
        let border = border - kinks.len();
        if N == NETWORKED {
            return self.beyond_border_of_network(border, z).unwrap_or(0.0);
        }
        z.first_chunk().and_then(|z| self.beyond_border_of_circuit(border, z)).unwrap_or(0.0)
    }

    #[inline(always)]
    fn levels(&self) -> usize {
        if N == NETWORKED { self.pressure_locks() } else { 0 }
    }

    fn level(&self, index: usize, z: &[f64; N]) -> Option<Level> {
        self.level_of_network(index, z)
    }

    #[inline]
    fn inputs_change(&self) -> bool {
        self.applied.change.is_some()
    }

    fn free_acceleration(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        if sigma_dot == 0.0 && Dynamics::<N>::sticks(self) && self.start_direction(sigma, sigma_dot)? == 0.0 {
            // Even where friction has no solution with the reactions that cause it.
            return Ok(0.0);
        }
        self.settle(sigma, sigma_dot)
    }

    fn length(&self) -> f64 {
        self.reduced.scale()
    }

    fn take_locked(&mut self) -> bool {
        std::mem::take(&mut self.locked)
    }

    #[inline]
    fn set_touching(&mut self, touching: BumperSet) {
        self.mode.touching = touching;
    }

    fn bumper_push(&mut self, bumper: usize, sigma: f64, sigma_dot: f64) -> (f64, f64) {
        let x = self.locate(sigma);
        let Some(state_loads) = self.deciding::<N>() else { return (0.0, 0.0) };
        let (panel_force, loading) = (&self.scratch.panel_force, self.reduced.loading());
        let at = |component: usize| polynomial(panel_force.series(&state_loads.table, component), x);
        let stop = &loading.stops[state_loads.bumpers[bumper]];
        let s = at(state_loads.pressed(bumper)) + panel_force.revolutions * self.reduced.load_growth(stop.load);
        let rate = at(state_loads.bumper(bumper)) * sigma_dot;
        let beyond = stop.beyond(s);
        let outward = if stop.sign() > 0.0 { rate } else { -rate };
        (beyond, stop.push(beyond, outward))
    }

    fn bumper_bounds(&mut self, bumper: usize, sigma: Enclosure, sigma_dot: Enclosure) -> [Enclosure; 2] {
        let Some(state_loads) = self.deciding::<N>() else { return [Enclosure::constant(0.0); 2] };
        let loading = self.reduced.loading();
        let stop = &loading.stops[state_loads.bumpers[bumper]];
        let growth = self.reduced.load_growth(stop.load);
        let of = |component: usize, growth: f64| sigma.chain(self.component_bounds(component, sigma.value, growth));
        let s = of(state_loads.pressed(bumper), growth)
            + Enclosure::constant(self.applied.revolutions * growth - stop.value);
        let rate = of(state_loads.bumper(bumper), 0.0) * sigma_dot;
        let (beyond, outward) = if stop.sign() > 0.0 { (s, rate) } else { (-s, -rate) };
        [beyond, stop.push_bounds(beyond, outward)]
    }

    fn switching_input(&self, index: usize) -> Option<[f64; 3]> {
        let change = self.applied.change.as_ref()?;
        let of = |load: usize| [self.applied.sizes[load], change.first[load], change.second[load]];
        let drives = &self.reduced.loading().drives;
        let at_rest = |state_loads: &StateLoads, drive: usize| {
            let law = state_loads.laws.iter().position(|law| law.drive == drive);
            match (law, &drives[drive].law) {
                (Some(k), Some(law)) => law.at_rest(of(drive), of, self.scratch.evaluator.position_of_law(k)),
                _ => of(drive),
            }
        };
        let (mut efficient, mut limits) = (0, 0);
        if let Some(state_loads) = self.deciding::<N>() {
            (efficient, limits) = (state_loads.efficient, state_loads.limits.len());
            if index < efficient {
                return Some(at_rest(state_loads, state_loads.drives[index]));
            }
            if let Some(&(law, side)) = state_loads.limits.get(index - efficient) {
                let drive = state_loads.laws[law].drive;
                let [force, first, second] = at_rest(state_loads, drive);
                let control = drives[drive].law.as_ref().and_then(DriveLaw::control);
                return Some([control.and_then(|own| own.limits[side]).unwrap_or(0.0) - force, -first, -second]);
            }
        }
        let is_air = index == efficient + limits && self.scratch.air;
        is_air.then(|| [self.applied.airspeed, change.airspeed[0], change.airspeed[1]])
    }

    #[inline]
    fn has_reversals(&self) -> bool {
        self.deciding::<N>().is_some_and(|state_loads| state_loads.reverses)
    }

    #[inline]
    fn sticks(&self) -> bool {
        self.deciding::<N>().is_some_and(|state_loads| state_loads.sticks)
    }

    #[inline]
    fn direction(&self) -> f64 {
        self.mode.direction
    }

    fn find_direction(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        self.mode.direction = self.start_direction(sigma, sigma_dot)?;
        if sigma_dot == 0.0 && Dynamics::<N>::sticks(self) {
            // Of friction the law of the motion that begins.
            Dynamics::<N>::set_regimes(self, sigma, sigma_dot);
        }
        Ok(self.mode.direction)
    }

    fn acceleration_from_rest(&mut self, sigma: f64, direction: f64) -> Result<f64, Locked> {
        self.setting_off(sigma, direction)
    }

    #[inline]
    fn friction_joints(&self) -> usize {
        self.deciding::<N>().map_or(0, |s| s.friction_joints.len())
    }

    fn slip(&mut self, joint: usize, sigma: f64, sigma_dot: f64) -> f64 {
        // Needed at the ends of steps and between them, it leaves the present panel as it is.
        let x = if self.reduced.exact { Some(self.locate(sigma)) } else { None };
        let Some(state_loads) = self.deciding::<N>() else { return 0.0 };
        let component = state_loads.free() + joint;
        let influence = if let Some(x) = x {
            polynomial(self.scratch.panel_force.series(&state_loads.table, component), x)
        } else {
            self.component(component, sigma)
        };
        influence * sigma_dot * state_loads.friction_joints[joint].radius
    }

    fn slip_bounds(&mut self, joint: usize, sigma: Enclosure, sigma_dot: Enclosure) -> Enclosure {
        let Some(state_loads) = self.deciding::<N>() else { return Enclosure::constant(0.0) };
        let influence = sigma.chain(self.component_bounds(state_loads.free() + joint, sigma.value, 0.0));
        influence * sigma_dot * state_loads.friction_joints[joint].radius
    }

    fn slip_position(&self, sigma: f64) -> (f64, TablePosition) {
        let (reduced, state_loads) = self.stretch_at(sigma);
        let table = state_loads.map(|state_loads| (reduced, &*state_loads.table));
        let position = |table| self.scratch.panel_force.position(table, sigma);
        (sigma, table.map_or(TablePosition { panel: 0, x: 0.0 }, position))
    }

    fn slip_rate(&self, joint: usize, at: (f64, TablePosition), [sigma_dot, sigma_ddot]: [f64; 2]) -> [f64; 2] {
        let ((_, Some(state_loads)), at) = (self.stretch_at(at.0), at.1) else { return [0.0; 2] };
        let [influence, slope] = state_loads.table.value_and_slope(at, state_loads.free() + joint);
        let rate = slope * sigma_dot * sigma_dot + influence * sigma_ddot;
        [influence * sigma_dot, rate].map(|v| v * state_loads.friction_joints[joint].radius)
    }

    fn regime(&self, joint: usize) -> Option<Regime> {
        self.scratch.evaluator.regimes[joint]
    }

    #[inline]
    fn slip_range(&self, joint: usize) -> (f64, f64) {
        let regime = self.scratch.evaluator.regimes[joint].unwrap_or(Regime::Viscous);
        self.deciding::<N>().map_or((f64::NEG_INFINITY, f64::INFINITY), |s| s.friction_joints[joint].law.range(regime))
    }

    #[inline]
    fn set_regimes(&mut self, sigma: f64, sigma_dot: f64) {
        let Some(state_loads) = self.deciding::<N>() else { return };
        self.clear_signs();
        for (joint, friction_joint) in state_loads.friction_joints.iter().enumerate() {
            let slip = Dynamics::<N>::slip(self, joint, sigma, sigma_dot);
            let towards = match slip == 0.0 && state_loads.sticks {
                true => Dynamics::<N>::slip(self, joint, sigma, self.mode.direction),
                false => slip,
            };
            self.set_regime(joint, Some(friction_joint.law.regime_towards(slip, towards)));
        }
    }

    #[inline]
    fn switches(&self) -> usize {
        self.deciding::<N>().map_or(0, StateLoads::switches)
    }

    fn find_signs(&mut self, t: f64, z: &[f64; N]) -> Result<(), Locked> {
        self.clear_signs();
        if self.derivative(t, z)[1].is_nan() {
            return Err(Locked);
        }
        self.hold_signs();
        Ok(())
    }

    #[inline]
    fn begin_step(&mut self) {
        self.scratch.evaluator.begin_step();
    }

    fn switch_sample(&self, index: usize, switch: usize) -> Option<[f64; 2]> {
        self.scratch.evaluator.switches.sample(index, switch)
    }

    fn switch_value(&mut self, switch: usize, t: f64, z: &[f64; N]) -> Result<f64, Locked> {
        let is_locked = self.derivative(t, z)[1].is_nan();
        if is_locked { Err(Locked) } else { Ok(self.scratch.evaluator.switches.value(switch)) }
    }

    fn switch_effect(&self, switch: usize) -> f64 {
        let of = |state_loads| self.scratch.evaluator.switch_effect((self.reduced, state_loads), switch);
        self.deciding::<N>().map_or(0.0, of)
    }

    fn flip_sign(&mut self, switch: usize) {
        EquationOfMotion::flip_sign(self, switch);
    }

    fn change_regime(&mut self, joint: usize, sigma: f64, sigma_dot: f64) {
        let Some(state_loads) = self.deciding::<N>() else { return };
        let regime = self.scratch.evaluator.regimes[joint].unwrap_or(Regime::Viscous);
        let slip = Dynamics::<N>::slip(self, joint, sigma, sigma_dot);
        let next = state_loads.friction_joints[joint].law.next(regime, slip);
        self.set_regime(joint, Some(next));
    }
}
