//! A model of a random linkage, whose variables are read by name.
use crate::support::Vec2;
use crate::support::oracle::Motion;
use crate::support::oracle::linkage::{Coordinate, Freedom, Linkage};
use linkage_fmu::simulation::{Simulation, SimulationError};

/// A simulation with the linkage from which it was built.
#[derive(Clone)]
pub struct Run<'a> {
    linkage: &'a Linkage,
    pub simulation: Simulation,
}

/// Value, speed and acceleration of every coordinate.
pub type State = Vec<[f64; 3]>;

impl<'a> Run<'a> {
    pub fn new(linkage: &'a Linkage) -> Result<Self, SimulationError> {
        let mut simulation = Simulation::open(&linkage.json())?;
        simulation.initialize()?;
        Ok(Self { linkage, simulation })
    }

    pub fn state(&mut self) -> Result<State, SimulationError> {
        let mut state = Vec::new();
        for coordinate in self.linkage.coordinates() {
            let name = self.linkage.name(coordinate);
            let value = if matches!(coordinate, Coordinate::Angle(_)) { "angle" } else { "position" };
            let mut get = |quantity| self.simulation.get(&format!("{name}.{quantity}"));
            state.push([get(value)?, get("speed")?, get("acceleration")?]);
        }
        Ok(state)
    }

    /// The state as the oracle represents it.
    pub fn motion(&self, state: &State) -> Motion<'a> {
        Motion::of(self.linkage, state)
    }

    /// Force and moment in every joint.
    pub fn reactions(&mut self) -> Result<Vec<(Vec2, f64)>, SimulationError> {
        let mut reactions = Vec::new();
        for joint in &self.linkage.joints {
            let name = &joint.name;
            let mut get = |quantity| self.simulation.get(&format!("{name}.{quantity}"));
            let force = Vec2::new(get("force_x")?, get("force_y")?);
            let slides = matches!(joint.freedom, Freedom::Prismatic { .. });
            reactions.push((force, if slides { get("torque")? } else { 0.0 }));
        }
        Ok(reactions)
    }

    /// The end of a motion with these steps, whose start differs from the stated start by `off`.
    pub fn end(&self, off: [f64; 2], steps: &[f64]) -> Result<(State, u64), SimulationError> {
        let mut run = self.clone();
        let (_, value, speed) = self.linkage.start;
        run.simulation.set(&self.linkage.start_name(false), value + off[0])?;
        run.simulation.set(&self.linkage.start_name(true), speed + off[1])?;
        run.simulation.initialize()?;
        for h in steps {
            run.simulation.step(*h)?;
        }
        Ok((run.state()?, run.simulation.model().statistics().accepted))
    }
}
