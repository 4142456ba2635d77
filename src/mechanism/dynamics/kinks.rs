//! Points of the curves by which the state sizes loads, as borders in the space of states.
//!
//! In: the equation of motion, a state. Out: how far a quantity is beyond a point of its curve. It must not know steps.
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::reduced::{Argument, Kink};

impl EquationOfMotion<'_> {
    /// How far the quantity of a curve is beyond one of its points, 0 where it is at it; sigma may be revolutions away.
    pub fn beyond_kink(&self, kink: &Kink, [sigma, sigma_dot]: [f64; 2]) -> f64 {
        let Some(state_loads) = self.state_loads else { return 0.0 };
        let loading = self.reduced.loading();
        let displacement = |component: usize, load: usize| {
            let growth = self.reduced.load_growth(load);
            let wound = if growth == 0.0 { 0.0 } else { self.applied.revolutions + self.whole.unwound(sigma).1 };
            self.component(component, sigma) + wound * growth
        };
        let value = match kink.of {
            Argument::Drive(drive) => self.component(state_loads.given(0, drive), sigma) * sigma_dot,
            Argument::Rate(k) => self.component(state_loads.spring(k), sigma) * sigma_dot,
            Argument::Angle(k) => displacement(state_loads.stretched(k), loading.springs[state_loads.springs[k]].load),
            Argument::Depth(k) if self.mode.touching.contains(k) => {
                let stop = &loading.stops[state_loads.bumpers[k]];
                stop.beyond(displacement(state_loads.pressed(k), stop.load))
            }
            Argument::Depth(_) => return 0.0,
        };
        let beyond = value - kink.value;
        if beyond.abs() <= kink.near { 0.0 } else { beyond }
    }
}
