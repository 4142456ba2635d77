//! Delivered forces of the drives whose force the state decides: drives with an efficiency, a curve, a controller or a
//! cylinder.
//!
//! In: the sizes of the applied loads, effects of the loads at a position, the speed. Out: delivered forces, added to
//! the motion. It must not know friction.
use super::{Mode, StateLoadEvaluator};
use crate::mechanism::dynamics::panel_force::{AppliedLoads, PanelForce};
use crate::mechanism::loads::resolved::Efficiency;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::Number;
use crate::numerics::table::polynomial_at;

impl<T: Number> StateLoadEvaluator<T> {
    /// Displacement of the drive of a law that depends on it [m or rad], at the state of the last evaluation.
    pub fn position_of_law(&self, law: usize) -> f64 {
        self.law_values[law][1]
    }

    /// Delivered forces of the drives, with those of their laws: added to the motion. Returns the power lost in them.
    #[inline(never)]
    pub(super) fn drives(
        &mut self,
        (reduced, state_loads): (&Reduced, &StateLoads),
        applied: &AppliedLoads,
        panel_force: &PanelForce,
        mode: &Mode,
        [t, x, sigma_dot]: [T; 3],
    ) -> T {
        let at = |component: usize| polynomial_at(panel_force.series(&state_loads.table, component), x);
        let mut lost = T::constant(0.0);
        let first_law = state_loads.first_law();
        for (law_load, known) in state_loads.laws.iter().zip(&mut self.law_values) {
            let drive = law_load.drive;
            let Some(law) = &reduced.loading().drives[drive].law else { continue };
            let influence = at(state_loads.given(0, law.load));
            let speed = influence * sigma_dot;
            let position = law_load.position.map_or(T::constant(0.0), |k| {
                let wound = panel_force.revolutions * reduced.load_growth(drive);
                self.effects.as_flattened()[state_loads.driven(k)] + T::constant(wound)
            });
            *known = [influence.value(), position.value()];
            let (switches, mut switch) = (&mut self.switches, state_loads.limit_switch(law_load.limit));
            let margin = |_, margin| {
                switch += 1;
                switches.see(switch - 1, margin)
            };
            let own = applied.size(drive, t);
            let states = self.controllers.as_ref();
            let acting = law.force(own, |input| applied.size(input, t), [position, speed], states, margin);
            self.delivered[law_load.at] = acting.force;
            if states.is_some() {
                for (state, rate) in law.states.into_iter().zip(acting.rates) {
                    state.into_iter().for_each(|state| self.controller_rates[state] = rate);
                }
            }
        }
        for (k, &load) in state_loads.drives[..first_law].iter().enumerate() {
            let influence = at(state_loads.given(0, load));
            if k >= state_loads.efficient {
                let cylinder = k - state_loads.efficient;
                let Some(laws) = reduced.loading().cylinder(cylinder) else { continue };
                self.delivered[k] = laws.force(self.pressures[cylinder], influence * sigma_dot);
                let driven = influence * self.delivered[k];
                self.motion = self.motion + driven;
                lost = lost - driven * sigma_dot;
                continue;
            }
            let size = applied.size(load, t);
            let full = influence * size;
            let efficiency = reduced.loading().drives[load].efficiency;
            let law = state_loads.laws.iter().find(|law| law.drive == load).map(|law| law.at);
            let further = law.map_or(0.0, |law| (influence * self.delivered[law]).value());
            let part = efficient(self.switches.see(k, full.value() + further), mode.direction, efficiency);
            self.delivered[k] = size * T::constant(part);
            if let Some(law) = law {
                self.delivered[law] = self.delivered[law] * T::constant(part);
            }
            self.motion = self.motion + influence * self.delivered[k];
            lost = lost + (full * T::constant(1.0 - part) - influence * applied.excess(load, t)) * sigma_dot;
        }
        for (&load, &delivered) in state_loads.drives[first_law..].iter().zip(&self.delivered[first_law..]) {
            let driven = at(state_loads.given(0, load)) * delivered;
            self.motion = self.motion + driven;
            lost = lost - driven * sigma_dot;
        }
        lost
    }
}

/// Delivered part of a drive's force ([CK16] eqs. (5), (29)), where `full` is the force times its influence: the
/// efficiency where power flows into the mechanism, the inverse of that of the other direction where power flows back;
/// 1 without a direction, as no power flows.
fn efficient(full: f64, direction: f64, efficiency: Option<Efficiency>) -> f64 {
    match efficiency {
        Some(eta) if direction != 0.0 => {
            if full * direction > 0.0 {
                eta.forward
            } else {
                1.0 / eta.backward
            }
        }
        _ => 1.0,
    }
}
