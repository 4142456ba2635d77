//! The laws of a network: flows between ports, elasticity of oil, hoses, walls and gas, forces of the cylinders.
//!
//! In: the numbers of the elements; pressures, spools, motions of the cylinders, inputs. Out: flows, rates of the
//! state, forces, powers. All laws are smooth and generic over [`Number`], so that values and exact derivatives share
//! one law. It must not know time, nor how the laws are integrated.
mod build;
mod events;
mod flows;
mod rates;

use super::definition::HydraulicSystem;
use super::inputs::range;
use super::layout::{Input, Layout};
use crate::circuit::Equations;
use crate::definition::{ABOVE_VACUUM, is_pressure};
pub use events::{Surroundings, empty_words};
pub use flows::Point;
use foundation::numerics::decimal::Decimal;
use foundation::numerics::dual::Number;
pub use rates::{Drive, Element, Rest};

/// Part of the size of the spool position that holds where the spool is at rest.
const SPOOL_FLOOR: f64 = 0.1;
/// Part of the clearance within which a spool is at an edge.
const ON_EDGE: f64 = 1e-3;
/// Absolute pressure, as a part of the ambient pressure, below which oil cavitates.
const CAVITATES: f64 = 0.1;

/// A place at which a law is not smooth, or changes within a hair's breadth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Border {
    /// A cushion starts at a length of a cylinder.
    Length {
        /// Index of the cylinder.
        cylinder: usize,
        /// Length [m].
        level: f64,
    },
    /// An edge of a valve opens at a position of the spool.
    Spool {
        /// Index of the spool's position in the state.
        component: usize,
        /// Position.
        level: f64,
        /// Distance within which the spool counts as being at the position.
        near: f64,
    },
}

/// The laws of one network.
#[derive(Clone, Debug, PartialEq)]
pub struct Laws {
    /// Indices of the state and of the inputs.
    pub layout: Layout,
    /// Names of the pressures that are states.
    pub names: Vec<String>,
    ambient: f64,
    /// The oil, of whose circuit only the law of the bulk modulus is used.
    oil: Equations,
    nodes: Vec<Node>,
    paths: Vec<Path>,
    pumps: Vec<Pump>,
    valves: Vec<Valve>,
    /// Cylinders.
    pub cylinders: Vec<Cylinder>,
    accumulators: Vec<Accumulator>,
    /// Locks that pressure releases.
    pub locks: Vec<Lock>,
}

/// A volume that does not change.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    volume: f64,
    /// Compliance of its hoses [m3/Pa].
    hoses: f64,
}

/// Gas of an accumulator.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Accumulator {
    /// Its port.
    at: usize,
    volume: f64,
    /// Precharge pressure, absolute [Pa].
    precharge: f64,
    exponent: f64,
}

/// A flow path between two ports.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Path {
    from: usize,
    to: usize,
    law: Law,
    /// Pressure drop d_t between laminar and turbulent flow [Pa].
    transition: f64,
    /// Whether the flow switches there.
    switches: bool,
    /// Chambers at its ends whose restrictors and cushions throttle it, by their index among all chambers.
    outlets: [Option<usize>; 2],
}

/// The law of a flow path; K = rated flow / sqrt(rated pressure drop).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    /// The same in both directions; the laminar resistance in series [Pa s/m3].
    Open { k: f64, laminar: f64 },
    /// An edge of a valve, which opens with its spool moved to the positive (0) or the negative side (1).
    Edge { k: f64, valve: usize, side: usize },
    /// Open as far as an input tells.
    Bypass { k: f64, input: usize },
    /// Other square roots of K forward and back, and pilots that open.
    Gated { roots: [f64; 2], cracking: f64, check_width: f64, pilot: Pilot, laminar: f64 },
    /// Linear above a pressure at `from`.
    Relief { conductance: f64, pressure: f64, width: f64 },
    /// Linear above a pressure drop.
    Linear { conductance: f64, cracking: f64, width: f64 },
}

/// What opens a gated path.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pilot {
    /// Nothing: it is open.
    None,
    /// Forward: the pressure at a port is above a limit.
    Above { port: usize, pressure: f64, width: f64 },
    /// Forward: `sign` times the length of a cylinder is above `sign` times a limit [m].
    Position { cylinder: usize, sign: f64, length: f64, width: f64 },
    /// Back: the pressure at a port is above `ratio` times that at `to`.
    Ratio { port: usize, ratio: f64, width: f64 },
    /// Back: the pressure at `to` plus `ratio` times that at a port is above a limit.
    Sum { port: usize, ratio: f64, pressure: f64, width: f64 },
}

/// A pump.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pump {
    from: usize,
    to: usize,
    /// Input of its speed.
    speed: usize,
    max_flow: f64,
    /// Pressures of full and of no flow [Pa], of a compensated pump.
    band: Option<[f64; 2]>,
}

/// The spool of a valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valve {
    clearance: f64,
    overlap: f64,
    /// Natural frequency [rad/s], damping ratio, and the index among the spools with dynamics; none: it is the command.
    pub dynamics: Option<(f64, f64, usize)>,
}

impl Valve {
    /// Positions of the spool at which an edge opens, and the distance from one within which the spool is at it.
    pub fn edges(&self) -> ([f64; 2], f64) {
        ([self.overlap, -self.overlap], ON_EDGE * self.clearance)
    }
}

/// A cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Oil, seals, cushions, walls.
    pub laws: Equations,
    internal: f64,
    external: [f64; 2],
    /// Whether each chamber has a restrictor or a cushion.
    throttles: [bool; 2],
}

/// A lock that pressure releases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lock {
    /// Its port.
    pub at: usize,
    /// Pressure at which the lock releases [Pa].
    pub release: f64,
    /// Pressure below which the lock engages [Pa].
    pub engage: f64,
}

impl Lock {
    /// Whether the lock is engaged under a pressure at its port [Pa], if it was engaged before or not.
    pub fn holds(&self, engaged: bool, pressure: f64) -> bool {
        if engaged { pressure < self.release } else { pressure < self.engage }
    }

    /// The pressure of the next change of a lock [Pa], which takes place on it or beyond, and the sign of the change of
    /// the pressure beyond.
    pub fn next_change(&self, engaged: bool) -> (f64, f64) {
        if engaged { (self.release, 1.0) } else { (self.engage.next_down(), -1.0) }
    }
}

impl Laws {
    /// Write the pressures at the start into a state.
    pub fn fill_start(&self, system: &HydraulicSystem, y: &mut [f64]) {
        for (index, (_, node)) in system.nodes.iter().enumerate() {
            y[index] = node.start_pressure;
        }
        for (index, (_, cylinder)) in system.cylinders.iter().enumerate() {
            let chamber = self.layout.chamber(index);
            (y[chamber], y[chamber + 1]) = (cylinder.chamber_a.start_pressure, cylinder.chamber_b.start_pressure);
        }
    }

    /// What is allowed of an input that acts on flows, in words, if this value is not.
    pub fn refuses(&self, index: usize, value: f64) -> Option<String> {
        let input = self.layout.input(index);
        if let Input::Reservoir(_) = input {
            let ambient = self.ambient;
            let allowed = || format!("{ABOVE_VACUUM}; fluid.ambient_pressure is {ambient} Pa");
            return (!is_pressure(value, ambient)).then(allowed);
        }
        let range = range(input);
        (!range.contains(value)).then(|| range.text())
    }

    /// Ambient pressure p_0 [Pa].
    pub fn ambient(&self) -> f64 {
        self.ambient
    }

    /// The laws of a network whose cylinders a mechanism moves.
    pub fn carried(system: &HydraulicSystem) -> Self {
        let mut laws = Self::new(system);
        laws.layout.is_carried = true;
        laws
    }

    /// Number of places at which a law is not smooth or changes within a hair's breadth: two for each cylinder, where
    /// its cushions begin, and two for each valve, where its edges open.
    pub fn borders(&self) -> usize {
        2 * (self.cylinders.len() + self.valves.len())
    }

    /// What one of [`Self::borders`] is; None where there is no such place.
    pub fn border(&self, index: usize) -> Option<Border> {
        let (element, side) = (index / 2, index % 2);
        if let Some(cylinder) = self.cylinders.get(element) {
            return Some(Border::Length { cylinder: element, level: cylinder.laws.borders()[side]? });
        }
        let valve = self.valves.get(element - self.cylinders.len())?;
        let (edges, near) = valve.edges();
        let component = self.layout.spool(valve.dynamics?.2);
        (side == 0 || edges[1] != edges[0]).then_some(Border::Spool { component, level: edges[side], near })
    }

    /// Sizes of the pressures and spools of a state, to which a relative tolerance applies, each times `share`.
    #[inline]
    pub fn sizes(&self, y: &[f64], share: f64, sizes: &mut [f64]) {
        for index in 0..self.layout.volumes() {
            sizes[index] = share * (y[index] + self.ambient).max(self.ambient);
        }
        for (omega, _, spool) in self.valves.iter().filter_map(|valve| valve.dynamics) {
            let own = self.layout.spool(spool);
            let size = share * (SPOOL_FLOOR + y[own].abs());
            (sizes[own], sizes[own + 1]) = (size, omega * size);
        }
    }

    /// Number of flow paths; pumps follow them.
    pub fn path_count(&self) -> usize {
        self.paths.len()
    }

    /// Valves in the order of the definition.
    pub fn valves(&self) -> &[Valve] {
        &self.valves
    }

    /// Oil in an accumulator [m3] at the pressure of its port.
    pub fn oil_volume<T: Number>(&self, accumulator: usize, y: &[T]) -> T {
        let one = &self.accumulators[accumulator];
        T::constant(one.volume) - one.gas(y[one.at], self.ambient)
    }

    /// The first accumulator that contains no oil, with its pressure and its precharge pressure [Pa].
    pub fn empty_accumulator(&self, y: &[f64]) -> Option<(usize, [f64; 2])> {
        let charges = self.accumulators.iter().map(|one| [y[one.at], one.precharge - self.ambient]);
        charges.enumerate().find(|(_, [pressure, precharge])| pressure < precharge)
    }

    /// Volume of all chambers [m3].
    pub fn chamber_volume<T: Number>(&self, y: &[T]) -> T {
        self.volume_at(|cylinder| y[self.layout.motion(cylinder)])
    }

    /// Volume of all chambers [m3] at these lengths of the cylinders [m].
    pub fn volume_at<T: Number>(&self, length: impl Fn(usize) -> T) -> T {
        let volumes = self.cylinders.iter().enumerate().map(|(index, one)| one.laws.volumes(length(index)));
        volumes.fold(T::constant(0.0), |sum, [a, b]| sum + a + b)
    }

    /// Whether all absolute pressures are above 0.
    pub fn has_pressures(&self, y: &[f64]) -> bool {
        y[..self.layout.volumes()].iter().all(|p| *p > -self.ambient)
    }

    /// The lowest of the pressures, at which an integration came no further, in words.
    #[cold]
    pub fn lowest_pressure(&self, y: &[f64]) -> String {
        let volumes = &y[..self.layout.volumes()];
        let (index, lowest) = volumes
            .iter()
            .enumerate()
            .fold((0, f64::INFINITY), |least, (index, p)| if *p < least.1 { (index, *p) } else { least });
        let remedy = if lowest + self.ambient < CAVITATES * self.ambient {
            ", where the oil cavitates; increase fluid.air_fraction, or connect a check valve through which oil flows \
             in from a reservoir"
        } else {
            ", the lowest pressure of the network"
        };
        format!("{} = {} Pa{remedy}", self.names[index], Decimal::rounded(lowest))
    }

    /// Position of the spool of a valve.
    pub fn spool<T: Number>(&self, valve: usize, y: &[T], u: &[T]) -> T {
        match self.valves[valve].dynamics {
            Some((_, _, spool)) => y[self.layout.spool(spool)],
            None => u[self.layout.command(valve)],
        }
    }
}
