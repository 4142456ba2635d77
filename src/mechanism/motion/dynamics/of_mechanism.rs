//! The answers of a mechanism to the advance.
//!
//! In: an equation of motion, a state. Out: accelerations, and the quantities whose signs change at events. It must not
//! know steps.
use super::Dynamics;
use crate::integrator::System;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::controlled::CONTROLLED;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{BORDERS, DRIVEN, MOTION};
use crate::mechanism::dynamics::network::{Level, NETWORKED};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::{Law, Regime};
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::enclosure::Enclosure;
use crate::numerics::table::{TablePosition, polynomial};
use std::ops::Range;

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
        } else if N == CONTROLLED {
            self.set_controllers(z);
        }
    }

    #[inline(always)]
    fn set_held(&mut self, held: bool) {
        if N > MOTION {
            self.mode.held = held;
        }
        if N == CONTROLLED {
            // At rest, limits of the force of a controller are no events.
            self.clear_signs();
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
        let of = |load: usize| self.applied.rates(load);
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
        let index = index - efficient - limits;
        if index == 0 && self.scratch.air {
            return Some([self.applied.airspeed, change.airspeed[0], change.airspeed[1]]);
        }
        let index = index - usize::from(self.scratch.air);
        let mut joints = self.deciding::<N>()?.friction_joints.iter().filter_map(|own| Some((own.law, own.surface?)));
        let (Law { static_speed, kinetic_speed, .. }, surface) = joints.nth(index / 4)?;
        let border = [-kinetic_speed, -static_speed, static_speed, kinetic_speed][index % 4];
        let [speed, first, second] = of(surface);
        Some([speed - border, first, second])
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
        let friction_joint = &state_loads.friction_joints[joint];
        let surface = friction_joint.surface.map_or(0.0, |surface| self.applied.size(surface, self.time));
        influence * sigma_dot * friction_joint.radius - surface
    }

    fn slip_bounds(&mut self, joint: usize, [time, sigma, sigma_dot]: [Enclosure; 3]) -> Enclosure {
        let Some(state_loads) = self.deciding::<N>() else { return Enclosure::constant(0.0) };
        let influence = sigma.chain(self.component_bounds(state_loads.free() + joint, sigma.value, 0.0));
        let friction_joint = &state_loads.friction_joints[joint];
        let slip = influence * sigma_dot * friction_joint.radius;
        friction_joint.surface.map_or(slip, |surface| {
            let [speed, first, second] = self.applied.rates(surface).map(Enclosure::constant);
            slip + -(speed + time * (first + time * second * 0.5))
        })
    }

    fn slip_position(&self, sigma: f64) -> (f64, TablePosition) {
        let (reduced, state_loads) = self.stretch_at(sigma);
        let table = state_loads.map(|state_loads| (reduced, &*state_loads.table));
        let position = |table| self.scratch.panel_force.position(table, sigma);
        (sigma, table.map_or(TablePosition { panel: 0, x: 0.0 }, position))
    }

    fn slip_rate(&self, joint: usize, at: (f64, TablePosition), [t, sigma_dot, sigma_ddot]: [f64; 3]) -> [f64; 2] {
        let ((_, Some(state_loads)), at) = (self.stretch_at(at.0), at.1) else { return [0.0; 2] };
        let [influence, slope] = state_loads.table.value_and_slope(at, state_loads.free() + joint);
        let rate = slope * sigma_dot * sigma_dot + influence * sigma_ddot;
        let friction_joint = &state_loads.friction_joints[joint];
        let slip = [influence * sigma_dot, rate].map(|v| v * friction_joint.radius);
        friction_joint.surface.map_or(slip, |surface| {
            let [speed, first, second] = self.applied.rates(surface);
            [slip[0] - (speed + t * (first + 0.5 * t * second)), slip[1] - (first + t * second)]
        })
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
