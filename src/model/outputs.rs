//! Outputs on demand: each from its table, at the present state, under the present inputs.
use super::State;
use crate::reduced::Reduced;
use crate::table::{Table, Unresolved};
use crate::variables::{Output, ReactionPart};

/// What several outputs of one state share.
#[derive(Clone, Debug)]
pub struct Cache {
    acceleration: Option<f64>,
    /// Force x, force y and moment of each joint.
    reactions: Vec<Option<[f64; 3]>>,
    used: bool,
}

impl Cache {
    pub fn new(joints: usize) -> Self {
        Self { acceleration: None, reactions: vec![None; joints], used: false }
    }

    /// The state or the inputs have changed.
    pub fn forget(&mut self) {
        self.acceleration = None;
        if self.used {
            self.reactions.fill(None);
            self.used = false;
        }
    }
}

impl State {
    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`Unresolved`]: its table cannot be built.
    pub fn output(&mut self, reduced: &Reduced, inputs: &[f64], output: Output) -> Result<f64, Unresolved> {
        match output {
            Output::Turn { body, order } => {
                let body = &reduced.linkage().bodies[body];
                let Some(turn) = body.turn else { return Ok(0.0) };
                let value = self.coordinate(reduced, inputs, turn, order)?;
                Ok(if order == 0 { value + body.offset } else { value })
            }
            Output::Slide { coordinate, order } => self.coordinate(reduced, inputs, coordinate, order),
            Output::Reaction { joint, part } => {
                let [x, y, moment] = self.reaction(reduced, inputs, joint)?;
                Ok(match part {
                    ReactionPart::X => x,
                    ReactionPart::Y => y,
                    ReactionPart::Magnitude => x.hypot(y),
                    ReactionPart::Moment => moment,
                })
            }
            Output::Length { load, order } => {
                let table = checked(reduced.displacement(load))?;
                Ok(self.derivative(table, reduced, inputs, order))
            }
            Output::ReducedMass { load } => {
                let influence = self.influence(reduced, load);
                Ok(finite(1.0 / (influence * influence)))
            }
            Output::HoldingForce { load } => {
                let others = (0..inputs.len()).filter(|i| *i != load);
                let sum: f64 = others.map(|i| inputs[i] * self.influence(reduced, i)).sum();
                Ok(if sum == 0.0 { 0.0 } else { finite(-sum / self.influence(reduced, load)) })
            }
            Output::Marker { marker, axis } => {
                let table = checked(reduced.marker(marker))?;
                Ok(table.value(table.spot(self.sigma), axis))
            }
            Output::Kinetic => Ok(self.kinetic()),
            Output::Potential => {
                let mut sum = 0.0;
                for (i, load) in reduced.loads().iter().enumerate() {
                    if matches!(load, crate::loads::Load::Gravity(_)) {
                        sum -= inputs[i] * self.displacement(reduced, i)?;
                    }
                }
                Ok(sum)
            }
            Output::Drift => {
                let applied = std::mem::take(&mut self.applied);
                let potential = self.load_potential(reduced, &applied);
                self.applied = applied;
                Ok(self.kinetic() + potential? - self.reference)
            }
        }
    }

    /// T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at constant sizes: less the sum of size times displacement [J].
    pub fn load_potential(&self, reduced: &Reduced, inputs: &[f64]) -> Result<f64, Unresolved> {
        let mut sum = 0.0;
        for (load, size) in inputs.iter().enumerate() {
            if *size != 0.0 {
                sum -= size * self.displacement(reduced, load)?;
            }
        }
        Ok(sum)
    }

    /// Displacement of a load, counted on over whole turns.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> Result<f64, Unresolved> {
        let table = checked(reduced.displacement(load))?;
        let mut value = table.value(table.spot(self.sigma), 0);
        if let crate::loads::Load::Torque { body } = reduced.loads()[load] {
            let turn = reduced.linkage().bodies[body].turn;
            value += turn.map_or(0.0, |t| self.turns * reduced.growth(t));
        }
        Ok(value)
    }

    fn influence(&self, reduced: &Reduced, load: usize) -> f64 {
        let table = reduced.influence();
        table.value(table.spot(self.sigma), load)
    }

    /// sigma_ddot under these inputs.
    fn acceleration(&mut self, reduced: &Reduced, inputs: &[f64]) -> f64 {
        if let Some(value) = self.cache.acceleration {
            return value;
        }
        let table = reduced.influence();
        let spot = table.spot(self.sigma);
        let value = inputs.iter().enumerate().map(|(i, size)| size * table.value(spot, i)).sum();
        self.cache.acceleration = Some(value);
        value
    }

    /// A coordinate (order 0) or its time derivative.
    fn coordinate(
        &mut self,
        reduced: &Reduced,
        inputs: &[f64],
        coordinate: usize,
        order: usize,
    ) -> Result<f64, Unresolved> {
        let table = checked(reduced.coordinate(coordinate))?;
        let value = self.derivative(table, reduced, inputs, order);
        Ok(if order == 0 { value + self.turns * reduced.growth(coordinate) } else { value })
    }

    /// Time derivative of a table of a function and its two derivatives along sigma.
    fn derivative(&mut self, table: &Table, reduced: &Reduced, inputs: &[f64], order: usize) -> f64 {
        let spot = table.spot(self.sigma);
        match order {
            0 => table.value(spot, 0),
            1 => table.value(spot, 1) * self.sigma_dot,
            _ => {
                let acceleration = self.acceleration(reduced, inputs);
                table.value(spot, 1) * acceleration + table.value(spot, 2) * self.sigma_dot * self.sigma_dot
            }
        }
    }

    fn reaction(&mut self, reduced: &Reduced, inputs: &[f64], joint: usize) -> Result<[f64; 3], Unresolved> {
        if let Some(value) = self.cache.reactions[joint] {
            return Ok(value);
        }
        let table = checked(reduced.reaction(joint))?;
        let spot = table.spot(self.sigma);
        let acceleration = self.acceleration(reduced, inputs);
        let terms = 2 + inputs.len();
        let value = std::array::from_fn(|part| {
            let at = |k: usize| table.value(spot, part * terms + k);
            let loads: f64 = inputs.iter().enumerate().map(|(i, size)| size * at(2 + i)).sum();
            at(0) * acceleration + at(1) * self.sigma_dot * self.sigma_dot + loads
        });
        self.cache.reactions[joint] = Some(value);
        self.cache.used = true;
        Ok(value)
    }
}

fn checked<'a>(table: Result<&'a Table, &Unresolved>) -> Result<&'a Table, Unresolved> {
    table.map_err(Clone::clone)
}

/// Where no finite force or mass has the effect, the largest finite number stands for it.
fn finite(value: f64) -> f64 {
    value.clamp(-f64::MAX, f64::MAX)
}
