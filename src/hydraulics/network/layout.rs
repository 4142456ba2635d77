//! Places of the components of the state and of the inputs of a network.
//!
//! In: the numbers of its elements. Out: indices. It must not know laws.
use super::definition::{HydraulicSystem, Ports, TOTALS};

/// Numbers of the elements of a network, from which all indices follow. The state: pressures of nodes and chambers,
/// position and speed of each spool with dynamics, length and speed of each cylinder; then the integrals: impulse and
/// first moment of the force of each cylinder, the totals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of reservoirs.
    pub reservoirs: usize,
    /// Number of pumps.
    pub pumps: usize,
    /// Number of valves.
    pub valves: usize,
    /// Number of bypasses.
    pub bypasses: usize,
    /// Number of cylinders.
    pub cylinders: usize,
    /// Number of valves with dynamics.
    pub spools: usize,
    /// Whether a mechanism carries the motion of the cylinders: the state then has neither their lengths and speeds nor
    /// the integrals of their forces.
    pub is_carried: bool,
}

/// Inputs of one cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Length [m].
    Length,
    /// Speed [m/s].
    Speed,
    /// Acceleration [m/s2], for derivatives of outputs only.
    Acceleration,
    /// Reduced mass [kg]; 0: unknown.
    Mass,
    /// Its derivative with respect to the length [kg/m].
    MassDerivative,
    /// Force that holds what the cylinder moves at rest [N].
    Load,
    /// Its derivative with respect to the length [N/m]; 0: unknown.
    LoadDerivative,
    /// Least length to which the cylinder can go [m].
    LowerLimit,
    /// Largest length to which it can go [m]; 0 as the least one: unknown.
    UpperLimit,
}

impl Part {
    /// All of them, in the order of their indices.
    pub const ALL: [Self; 9] = [
        Self::Length,
        Self::Speed,
        Self::Acceleration,
        Self::Mass,
        Self::MassDerivative,
        Self::Load,
        Self::LoadDerivative,
        Self::LowerLimit,
        Self::UpperLimit,
    ];
}

/// What an input is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Pressure of a reservoir.
    Reservoir(usize),
    /// Relative speed of a pump.
    Pump(usize),
    /// Command of a valve.
    Command(usize),
    /// Opening of a by-pass.
    Open(usize),
    /// Of a cylinder.
    Cylinder(usize, Part),
    /// The next step of the host.
    Horizon,
}

/// Total volumes and energies, by their indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Total {
    /// Oil from the reservoirs [m3].
    Reservoirs,
    /// Oil lost by external leakage [m3].
    Leaked,
    /// Oil taken by the elasticity of oil, hoses, walls and gas [m3].
    Compressed,
    /// Work of the pumps [J].
    PumpWork,
    /// Energy from the reservoirs [J].
    ReservoirWork,
    /// Work of the cylinders [J].
    PistonWork,
    /// Energy lost in the seals [J].
    SealFriction,
    /// Energy taken by the elasticity [J].
    Compression,
    /// Energy lost in flow paths and leakages [J].
    Throttling,
}

impl Layout {
    /// Of a definition.
    pub fn new(system: &HydraulicSystem) -> Self {
        Self {
            nodes: Ports::new(system).nodes,
            reservoirs: system.reservoirs.len(),
            pumps: system.pumps.len(),
            valves: system.valves.len(),
            bypasses: system.bypasses.len(),
            cylinders: system.cylinders.len(),
            spools: system.valves.iter().filter(|(_, valve)| valve.frequency.is_some()).count(),
            is_carried: false,
        }
    }

    /// Number of pressures that are states.
    pub fn volumes(&self) -> usize {
        self.nodes + 2 * self.cylinders
    }

    /// Index of chamber A of a cylinder; that of chamber B follows.
    pub fn chamber(&self, cylinder: usize) -> usize {
        self.nodes + 2 * cylinder
    }

    /// Index of the position of a spool with dynamics; that of its speed follows.
    pub fn spool(&self, spool: usize) -> usize {
        self.volumes() + 2 * spool
    }

    /// Index of the length of a cylinder; that of its speed follows.
    pub fn motion(&self, cylinder: usize) -> usize {
        self.spool(self.spools) + 2 * cylinder
    }

    /// Number of leading components, on which the rates depend.
    pub fn leading(&self) -> usize {
        self.motion(self.own_motions())
    }

    /// Number of cylinders whose motion is part of the state.
    pub fn own_motions(&self) -> usize {
        if self.is_carried { 0 } else { self.cylinders }
    }

    /// Index of the impulse of the force of a cylinder; that of the first moment follows.
    pub fn impulse(&self, cylinder: usize) -> usize {
        self.leading() + 2 * cylinder
    }

    /// Index of a total.
    pub fn total(&self, total: Total) -> usize {
        self.impulse(self.own_motions()) + total as usize
    }

    /// Number of components of the state.
    pub fn components(&self) -> usize {
        self.impulse(self.own_motions()) + TOTALS
    }

    /// Number of inputs that act on the flows: those before the inputs of the cylinders.
    pub fn flow_inputs(&self) -> usize {
        self.reservoirs + self.pumps + self.valves + self.bypasses
    }

    /// Index of the command of a valve.
    pub fn command(&self, valve: usize) -> usize {
        self.reservoirs + self.pumps + valve
    }

    /// Index of the opening of a by-pass.
    pub fn open(&self, bypass: usize) -> usize {
        self.command(self.valves) + bypass
    }

    /// Index of an input of a cylinder.
    pub fn of_cylinder(&self, cylinder: usize, part: Part) -> usize {
        self.flow_inputs() + Part::ALL.len() * cylinder + part as usize
    }

    /// Index of `preview.horizon`, the last input.
    pub fn horizon(&self) -> usize {
        self.flow_inputs() + Part::ALL.len() * self.cylinders
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.horizon() + 1
    }

    /// What the input of this index is.
    pub fn input(&self, index: usize) -> Input {
        let pumps = self.reservoirs + self.pumps;
        match index {
            _ if index < self.reservoirs => Input::Reservoir(index),
            _ if index < pumps => Input::Pump(index - self.reservoirs),
            _ if index < self.open(0) => Input::Command(index - pumps),
            _ if index < self.flow_inputs() => Input::Open(index - self.open(0)),
            _ if index < self.horizon() => {
                let own = index - self.flow_inputs();
                Input::Cylinder(own / Part::ALL.len(), Part::ALL[own % Part::ALL.len()])
            }
            _ => Input::Horizon,
        }
    }
}
