//! One model of a random linkage, read by the names of its variables.
use super::linkage::{Coordinate, Freedom, Linkage, Vec2};
use super::oracle::Motion;
use linkage_fmu::mechanism::{Model, ModelError};

/// A model with the linkage that it was made from.
#[derive(Clone)]
pub struct Run<'a> {
    linkage: &'a Linkage,
    pub model: Model,
}

/// Value, speed and acceleration of every coordinate.
pub type State = Vec<[f64; 3]>;

impl<'a> Run<'a> {
    pub fn new(linkage: &'a Linkage) -> Result<Self, ModelError> {
        let mut model = Model::from_json(&linkage.json())?;
        model.initialize()?;
        Ok(Self { linkage, model })
    }

    pub fn get(&mut self, name: &str) -> Result<f64, ModelError> {
        let reference = self.model.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
        self.model.real(reference)
    }

    pub fn set(&mut self, name: &str, value: f64) {
        let reference = self.model.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
        self.model.set_real(reference, value).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    pub fn state(&mut self) -> Result<State, ModelError> {
        let mut state = Vec::new();
        for coordinate in self.linkage.coordinates() {
            let name = self.linkage.name(coordinate);
            let value = if matches!(coordinate, Coordinate::Turn(_)) { "angle" } else { "position" };
            let mut get = |quantity| self.get(&format!("{name}.{quantity}"));
            state.push([get(value)?, get("speed")?, get("acceleration")?]);
        }
        Ok(state)
    }

    /// The oracle's view of a state.
    pub fn motion(&self, state: &State) -> Motion<'a> {
        Motion::of(self.linkage, state)
    }

    /// Force and moment in every joint.
    pub fn reactions(&mut self) -> Result<Vec<(Vec2, f64)>, ModelError> {
        let mut reactions = Vec::new();
        for (j, joint) in self.linkage.joints.iter().enumerate() {
            let name = Linkage::joint_name(j);
            let force = Vec2::new(self.get(&format!("{name}.force_x"))?, self.get(&format!("{name}.force_y"))?);
            let moment = match joint.freedom {
                Freedom::Slide { .. } => self.get(&format!("{name}.torque"))?,
                Freedom::Turn => 0.0,
            };
            reactions.push((force, moment));
        }
        Ok(reactions)
    }

    /// The end of a motion that starts off the stated start by these amounts, in these steps.
    pub fn end(&self, off: [f64; 2], steps: &[f64]) -> Result<(State, u64), ModelError> {
        let mut run = self.clone();
        let (_, value, speed) = self.linkage.start;
        run.set(&self.linkage.start_name(false), value + off[0]);
        run.set(&self.linkage.start_name(true), speed + off[1]);
        run.model.initialize()?;
        for h in steps {
            run.model.step(*h)?;
        }
        Ok((run.state()?, run.model.statistics().accepted))
    }
}
