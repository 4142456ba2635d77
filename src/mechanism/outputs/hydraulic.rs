//! Outputs of the hydraulic circuit of a drive.
//!
//! In: pressures, spool and energies of a state, motion of the actuator, ports. Out: force, flows, powers, energies, in
//! numbers N. It must not know how a step is made.
use crate::hydraulics::circuit::{CIRCUIT, ENERGIES, ENERGY, Equations, Point};
use crate::hydraulics::network::definition::CAPACITY;
use crate::mechanism::dynamics::ports::command;
use crate::mechanism::motion::CircuitState;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError};
use crate::mechanism::outputs::view::{HydraulicOutputs, Reading, View};
use crate::mechanism::quantity::Hydraulic;
use crate::numerics::dual::Dual;
use std::sync::OnceLock;

/// Rates of the state of a circuit, network or states of controllers.
type Rates = fn(&mut View<f64>) -> Result<[f64; CAPACITY], OutputError>;
static RATES: OnceLock<Rates> = OnceLock::new();

/// State that mechanisms may have hydraulics or states of controllers.
pub fn allow_hydraulics() {
    fn of<N: Reading>() {
        N::hydraulics().get_or_init(|| HydraulicOutputs {
            circuit: |view, output| view.circuit(output),
            network: |view, output| view.of_network(output),
        });
    }
    of::<f64>();
    of::<Dual<1>>();
    RATES.get_or_init(|| |view| view.find_rates());
}

impl<'a, N: Reading> View<'a, N> {
    /// Laws and state of the circuit; none without one.
    fn own_circuit(&self) -> Option<(&'a Equations, &'a CircuitState)> {
        let (reduced, state) = (self.reduced, self.state);
        Some((&reduced.loading().hydraulics.as_ref()?.laws, state.memory.circuit()?))
    }

    /// A component of the state of the circuit.
    fn component_of(&self, circuit: &CircuitState, k: usize) -> N {
        self.cache.direction.s.chain(circuit.values[k], self.cache.direction.circuit[k])
    }

    /// The circuit and its surroundings in this state. `with_speed`: with the speed of the actuator, else at rest.
    fn point(&mut self, circuit: &CircuitState, with_speed: bool) -> Result<Point<N>, OutputError> {
        let (reduced, inputs) = (self.reduced, self.inputs);
        let (laws, load, first, signal) = match &reduced.loading().hydraulics {
            Some(drive) => (&drive.laws, drive.load, drive.first_input, command(drive, inputs, circuit.time.now)),
            None => return Err(OutputError::Locked),
        };
        let length = self.displacement(load, 0)?;
        let speed = if with_speed { self.displacement(load, 1)? } else { N::constant(0.0) };
        let port = |input: usize| self.cache.direction.input(input, inputs.reals[input]);
        let state = std::array::from_fn(|k| self.component_of(circuit, k));
        // The command acts on the acceleration of the spool alone, which is no output.
        Ok(laws.point(state, [length, speed], [port(first + 1), port(first + 2), N::constant(signal.at(0.0))]))
    }

    /// A quantity of the circuit.
    fn circuit(&mut self, output: Hydraulic) -> Result<N, OutputError> {
        let Some((laws, circuit)) = self.own_circuit() else { return Ok(N::constant(0.0)) };
        let energy = |view: &Self, k: usize| view.component_of(circuit, ENERGY + k);
        Ok(match output {
            Hydraulic::Pressure(chamber) => self.component_of(circuit, chamber),
            Hydraulic::SpoolPosition => self.component_of(circuit, 2),
            Hydraulic::SpoolSpeed => self.component_of(circuit, 3),
            Hydraulic::Energy(k) => energy(self, k),
            Hydraulic::Balance => (1..ENERGIES).fold(energy(self, 0), |sum, k| sum - energy(self, k)),
            Hydraulic::Volume(chamber) => laws.volumes(self.point(circuit, false)?.length)[chamber],
            Hydraulic::BulkModulus(chamber) => {
                let volume = laws.oil_volumes(laws.volumes(self.point(circuit, false)?.length))[chamber];
                laws.chamber_modulus(chamber, self.component_of(circuit, chamber), volume)
            }
            Hydraulic::StrokePosition => self.point(circuit, false)?.length - N::constant(laws.lengths()[0]),
            Hydraulic::EndForce => {
                let stops = self.reduced.loading().stops.iter().enumerate();
                let mut sum = N::constant(0.0);
                for (end, _) in stops.filter(|(_, stop)| stop.of_cylinder) {
                    sum = sum + self.stop_force(end)?;
                }
                sum
            }
            Hydraulic::Stiffness => {
                let at = self.point(circuit, false)?;
                laws.stiffness(at.pressures, at.length)
            }
            Hydraulic::Flow(chamber) => laws.flows(&self.point(circuit, false)?).chambers[chamber],
            Hydraulic::SupplyPressure => self.point(circuit, false)?.supply,
            Hydraulic::SupplyFlow => laws.flows(&self.point(circuit, false)?).supply,
            Hydraulic::TankFlow => laws.flows(&self.point(circuit, false)?).tank,
            Hydraulic::Force => {
                let at = self.point(circuit, true)?;
                laws.force(at.pressures, at.speed)
            }
            Hydraulic::Damping => {
                let at = self.point(circuit, true)?;
                laws.damping(at.pressures, at.speed)
            }
            Hydraulic::Power(k) => {
                let at = self.point(circuit, true)?;
                laws.powers(&at, &laws.flows(&at)).in_order()[k]
            }
        })
    }
}

impl View<'_, f64> {
    /// Rates of the state of the circuit, network or controllers in time; 0 without one.
    pub fn circuit_rates(&mut self) -> Result<[f64; CAPACITY], OutputError> {
        RATES.get().map_or(Ok([0.0; CAPACITY]), |rates| rates(self))
    }

    fn find_rates(&mut self) -> Result<[f64; CAPACITY], OutputError> {
        let mut rates = [0.0; CAPACITY];
        if let Some((drives, network)) = self.own_network() {
            return self.network_rates(drives, network);
        }
        for (rate, (drive, state)) in rates.iter_mut().zip(self.reduced.loading().control_states()) {
            *rate = self.controller(drive, state, 1)?;
        }
        if let Some((laws, circuit)) = self.own_circuit() {
            let at = self.point(circuit, true)?;
            rates[..CIRCUIT].copy_from_slice(&laws.rates(&at).state);
        }
        Ok(rates)
    }
}
