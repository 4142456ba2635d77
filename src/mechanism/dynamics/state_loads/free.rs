//! Sizes of the loads that the state decides and that no reaction of a joint causes: drag, bumpers, parts of springs.
//!
//! In: effects of the loads at a position, the speed. Out: sizes. It must not know friction.
use super::{Mode, StateLoadEvaluator};
use crate::mechanism::dynamics::panel_force::PanelForce;
use crate::mechanism::loads::laws::drag::RelativeFlow;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::Number;

impl<T: Number> StateLoadEvaluator<T> {
    /// Sizes of the drag loads.
    pub(super) fn drag(&mut self, reduced: &Reduced, state_loads: &StateLoads, airspeed: T, sigma_dot: T) {
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

    /// Sizes of the bumper loads: a spring and a damper for each bumper in contact.
    pub(super) fn bumpers(
        &mut self,
        reduced: &Reduced,
        state_loads: &StateLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        sigma_dot: T,
    ) {
        let effects = self.effects.as_flattened();
        let first = state_loads.bumper(0);
        for (k, &stop) in state_loads.bumpers.iter().enumerate() {
            self.loads[first + k] = T::constant(0.0);
            if mode.touching.contains(k) {
                let stop = &reduced.loading().stops[stop];
                let wound = panel_force.revolutions * reduced.load_growth(stop.load);
                let beyond = effects[state_loads.pressed(k)] + T::constant(wound - stop.value);
                let rate = effects[first + k] * sigma_dot;
                self.loads[first + k] = stop.force(beyond, rate);
            }
        }
    }

    /// Sizes of the loads of springs: dampers with a curve, and curves of torque that wind up. Returns the force along
    /// the curve of what stores energy, with the sign of a force that resists.
    pub(super) fn springs(
        &mut self,
        reduced: &Reduced,
        state_loads: &StateLoads,
        panel_force: &PanelForce,
        sigma_dot: T,
    ) -> T {
        let effects = self.effects.as_flattened();
        let first = state_loads.spring(0);
        let mut stored = T::constant(0.0);
        for (k, &spring) in state_loads.springs.iter().enumerate() {
            let spring = &reduced.loading().springs[spring];
            let influence = effects[first + k];
            let growth = reduced.load_growth(spring.load);
            let mut force = spring.damper_force(influence * sigma_dot);
            if growth != 0.0 {
                let s = effects[state_loads.stretched(k)] + T::constant(panel_force.revolutions * growth);
                let resists = spring.characteristic_force(s);
                stored = stored + influence * resists;
                force = force + resists;
            }
            self.loads[first + k] = -force;
        }
        stored
    }
}
