//! The equation of motion with the states of the controllers of drives, as one system.
//!
//! In: the equation of motion, whose laws of drives read the states of controllers and give their rates. Out: rates of
//! (sigma, sigma_dot, energy lost, states of controllers), their error weights. It must not know steps.
use crate::hydraulics::circuit::FREE;
use crate::integrator::{System, differences};
use crate::mechanism::definition::MOST_CONTROL_STATES;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{MOTION, SPEED_FLOOR};

/// Components of the state of a motion with states of controllers.
pub const CONTROLLED: usize = MOTION + MOST_CONTROL_STATES;

impl EquationOfMotion<'_> {
    /// Number of states of controllers.
    #[inline]
    fn controllers(&self) -> usize {
        self.state_loads.map_or(0, |state_loads| state_loads.controllers)
    }

    /// State the states of controllers in a state (sigma, sigma_dot, energy lost, states of controllers).
    #[inline]
    pub fn set_controllers(&mut self, z: &[f64]) {
        let states = std::array::from_fn(|k| z[MOTION + k]);
        self.scratch.evaluator.controllers = Some(states);
    }
}

/// (sigma, sigma_dot, energy lost, states of controllers).
impl System<CONTROLLED> for EquationOfMotion<'_> {
    const CAN_BE_STIFF: bool = true;

    fn leading_components(&self) -> usize {
        MOTION + self.controllers()
    }

    fn derivative(&mut self, t: f64, y: &[f64; CONTROLLED]) -> [f64; CONTROLLED] {
        self.time = t;
        self.set_controllers(y);
        let held = self.mode.held;
        let speed = if held { 0.0 } else { y[1] };
        let mut rates = [0.0; CONTROLLED];
        match self.effect(y[0], speed) {
            Ok(found) if !held => rates[..MOTION].copy_from_slice(&[speed, found.acceleration, found.lost]),
            // The laws of drives are evaluated before friction, whose solution nothing needs at rest.
            _ if held => {}
            _ => {
                self.locked = true;
                return [f64::NAN; CONTROLLED];
            }
        }
        self.scratch.evaluator.switches.record(t);
        rates[MOTION..].copy_from_slice(&self.scratch.evaluator.controller_rates);
        rates
    }

    /// A state of a controller is relative to itself, and to what the gains make of the scales of position and speed:
    /// an error of the state moves the drive as the same error of these parts of its force does. The norm of an error
    /// is over the components that there are, whatever the capacity.
    fn scale(&mut self, y: &[f64; CONTROLLED], f: &[f64; CONTROLLED]) -> [f64; CONTROLLED] {
        let mut motion = System::<MOTION>::scale(self, &[y[0], y[1], y[2]], &[f[0], f[1], f[2]]);
        motion[1] = y[1].abs().max(SPEED_FLOOR * motion[1]);
        let share = ((MOTION + self.controllers()) as f64 / CONTROLLED as f64).sqrt();
        let mut scale = [FREE; CONTROLLED];
        scale[..MOTION].copy_from_slice(&motion.map(|own| share * own));
        let Some(state_loads) = self.state_loads else { return scale };
        for law_load in &state_loads.laws {
            let law = self.reduced.loading().drives[law_load.drive].law.as_ref();
            let Some((law, control)) = law.and_then(|law| Some((law, law.control()?))) else { continue };
            let influence = self.component(state_loads.given(0, law_load.drive), y[0]).abs();
            let [stiffness, damping] = [control.position_gain, control.speed_gain].map(|gain| gain.unwrap_or(0.0));
            let force = influence * (stiffness * motion[0] + damping * motion[1]);
            for state in law.states.into_iter().flatten() {
                let own = y[MOTION + state].abs().max(force);
                scale[MOTION + state] = share * if own > 0.0 { own } else { 1.0 };
            }
        }
        scale
    }

    /// By one-sided differences along the components that the right-hand side depends on.
    fn jacobian(&mut self, t: f64, y: &[f64; CONTROLLED]) -> [[f64; CONTROLLED]; CONTROLLED] {
        let leading = MOTION + self.controllers();
        differences(self, t, y, [0, 1].into_iter().chain(MOTION..leading))
    }
}
