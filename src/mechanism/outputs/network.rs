//! Outputs of the hydraulic network of a mechanism.
//!
//! In: components of a state, motion of the cylinders, inputs. Out: pressures, flows, forces, volumes, energies, in
//! numbers N. It must not know how a step is made.
use crate::hydraulics::network::definition::{CAPACITY, MOST_CYLINDERS};
use crate::hydraulics::network::laws::Drive;
use crate::hydraulics::network::outputs::{Output, Present};
use crate::mechanism::dynamics::ports::acting;
use crate::mechanism::loads::resolved::NetworkDrives;
use crate::mechanism::motion::CircuitState;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError};
use crate::mechanism::outputs::view::{Reading, View};

impl<'a, N: Reading> View<'a, N> {
    /// Laws and state of the network; none without one.
    pub(super) fn own_network(&self) -> Option<(&'a NetworkDrives, &'a CircuitState<CAPACITY>)> {
        let (reduced, state) = (self.reduced, self.state);
        Some((reduced.loading().network.as_ref()?, state.memory.network()?))
    }

    /// Length and speed of each cylinder.
    fn motions(&mut self, drives: &NetworkDrives) -> Result<[[N; 2]; MOST_CYLINDERS], OutputError> {
        let mut motions = [[N::constant(0.0); 2]; MOST_CYLINDERS];
        for (motion, &load) in motions.iter_mut().zip(&drives.loads) {
            *motion = [self.displacement(load, 0)?, self.displacement(load, 1)?];
        }
        Ok(motions)
    }

    /// An input of the network as it acts, by its index among those.
    fn network_input(&self, drives: &NetworkDrives, index: usize) -> N {
        let input = drives.first_input + index;
        let (stated, value) = (self.inputs.reals[input], acting(&drives.laws, index, self.inputs.reals[input]));
        // Beyond its limits an input changes nothing.
        if stated == value { self.cache.direction.input(input, value) } else { N::constant(value) }
    }

    /// A quantity of the network.
    pub(super) fn of_network(&mut self, output: Output) -> Result<N, OutputError> {
        let Some((drives, state)) = self.own_network() else { return Ok(N::constant(0.0)) };
        let laws = &drives.laws;
        if let Output::EndForce(cylinder) = output {
            let load = drives.loads[cylinder];
            let mut sum = N::constant(0.0);
            for (end, stop) in self.reduced.loading().stops.iter().enumerate() {
                if stop.of_cylinder && stop.load == load {
                    sum = sum + self.stop_force(end)?;
                }
            }
            return Ok(sum);
        }
        let version = self.cache.version;
        if self.cache.network.as_ref().is_none_or(|(_, of)| *of != version) {
            let motions = self.motions(drives)?;
            let direction = &self.cache.direction;
            let of = |k: usize| direction.s.chain(state.values[k], direction.circuit[k]);
            let components = (0..laws.layout.components()).map(of);
            let inputs = (0..laws.layout.flow_inputs()).map(|index| self.network_input(drives, index));
            let present = Present::new(laws, components, inputs, motions);
            if let Some((room, of)) = &mut self.cache.network {
                (**room, *of) = (present, version);
            }
        }
        let start_volume = state.values[laws.layout.components()];
        let present = self.cache.network.as_ref().and_then(|(present, _)| present.output(laws, output, start_volume));
        Ok(present.unwrap_or(N::constant(0.0)))
    }
}

impl View<'_, f64> {
    /// Rates of the state of the network in time.
    pub(super) fn network_rates(
        &mut self,
        drives: &NetworkDrives,
        state: &CircuitState<CAPACITY>,
    ) -> Result<[f64; CAPACITY], OutputError> {
        let motions = self.motions(drives)?.map(Drive::Given);
        let inputs: [f64; CAPACITY] = std::array::from_fn(|index| match index < drives.inputs.len() {
            true => self.network_input(drives, index),
            false => 0.0,
        });
        Ok(drives.laws.rates(&motions[..drives.loads.len()], &inputs, 0.0, &state.values))
    }
}
