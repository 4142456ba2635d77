//! Kinks of the laws by which the state sizes loads, as borders in the space of states: points of curves, surfaces that
//! the air flows along.
//!
//! In: the equation of motion, a state. Out: how far a quantity is beyond a point of its curve. It must not know steps.
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::reduced::{Argument, Kink};

/// Speed of the air that is slow for any mechanism [m/s].
const SLOW: f64 = 1.0;

impl EquationOfMotion<'_> {
    /// How far the quantity of a law is beyond one of its kinks, 0 where it is at it; sigma may be revolutions away.
    pub fn beyond_kink(&self, kink: &Kink, [t, sigma, sigma_dot]: [f64; 3]) -> f64 {
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
            Argument::Facing { surface, place } => self.facing((surface, place), [t, sigma, sigma_dot]),
        };
        let beyond = value - kink.value;
        if beyond.abs() <= kink.near { 0.0 } else { beyond }
    }

    /// Whether bounds show that each surface faces the air alike in two states (t, sigma, sigma_dot).
    #[inline]
    pub fn faces_alike(&self, states: [[f64; 3]; 2]) -> bool {
        let facings = states.map(|[t, sigma, sigma_dot]| {
            let (reduced, Some(state_loads)) = self.stretch_at(sigma) else { return None };
            let at = self.scratch.panel_force.position((reduced, &state_loads.table), sigma);
            let (facings, airspeed) = (state_loads.facings(at.panel), self.applied.air(t));
            (sigma_dot.abs() < facings.speed * airspeed.abs()).then_some((facings.backs, airspeed > 0.0))
        });
        facings[0].is_some() && facings[0] == facings[1]
    }

    /// Component across a surface of the flow relative to a place on it, over the speed of that flow and [`SLOW`]:
    /// without a jump where the flow turns round.
    fn facing(&self, (surface, place): (usize, f64), [t, sigma, sigma_dot]: [f64; 3]) -> f64 {
        let (reduced, Some(state_loads)) = self.stretch_at(sigma) else { return 0.0 };
        let Some(air) = &self.reduced.loading().air else { return 0.0 };
        let airspeed = self.applied.air(t);
        let mut wind = [air.flow.x * airspeed, air.flow.y * airspeed];
        let at = self.scratch.panel_force.position((reduced, &state_loads.table), sigma);
        let component = |component: usize| state_loads.table.value(at, component);
        let [line_x, line_y] = [0, 1].map(|k| component(state_loads.line(surface) + k));
        if air.relative_wind {
            let [x, y, omega] = [0, 1, 2].map(|k| component(3 * surface + k) * sigma_dot);
            wind = [wind[0] - x + omega * place * line_y, wind[1] - y - omega * place * line_x];
        }
        (wind[1] * line_x - wind[0] * line_y) / (wind[0].hypot(wind[1]) + SLOW)
    }
}
