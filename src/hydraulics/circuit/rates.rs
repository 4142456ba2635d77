//! The state of a circuit and its rates.
//!
//! In: components of the state, motion of the actuator, ports. Out: the point of the laws; rates of all components, the
//! force; the size of each component. It must not know what moves the actuator, nor steps.
use super::{Equations, Flows, Point, Powers};
use crate::definition::Circuit;
use foundation::numerics::dual::Number;

/// Components of the state of a circuit: two pressures, spool position and speed, pressure of the supply, six energies.
pub const CIRCUIT: usize = DYNAMIC + ENERGIES;
/// Number of leading components on which the rates depend; the energies are integrals beside them.
pub const DYNAMIC: usize = SUPPLY + 1;
/// Number of energies: those of [`Powers::in_order`].
pub const ENERGIES: usize = 6;
/// Index of the first energy in the state.
pub const ENERGY: usize = DYNAMIC;
/// Index of the position of the spool.
pub const SPOOL: usize = 2;
/// Index of the pressure of an accumulator; without one the component stays 0.
pub const SUPPLY: usize = 4;

/// Part of the size of the spool position that holds where the spool is at rest; with it, openings near the edges are
/// exact.
const SPOOL_FLOOR: f64 = 0.1;
/// Size of components that are integrals beside the others: their errors follow from those of the others.
pub const FREE: f64 = 1e300;

/// Rates of the state of a circuit at a point.
#[derive(Clone, Copy, Debug)]
pub struct Rates<T> {
    /// Rate of each component of the state.
    pub state: [T; CIRCUIT],
    /// Force of the actuator [N].
    pub force: T,
}

impl<T: Copy> Powers<T> {
    /// The powers in the order of the energies, which are their integrals.
    #[inline]
    pub fn in_order(&self) -> [T; ENERGIES] {
        let Self { supply, returned, piston, seal_friction, compression, throttling, .. } = *self;
        [supply, returned, piston, seal_friction, compression, throttling]
    }
}

impl Equations {
    /// Start of a circuit: pressures of the definition, the spool at rest at 0, the accumulator at the pressure of the
    /// supply port [Pa].
    pub fn start(&self, circuit: &Circuit, supply: f64) -> [f64; CIRCUIT] {
        let mut state = [0.0; CIRCUIT];
        state[..2].copy_from_slice(&[circuit.chamber_a.start_pressure, circuit.chamber_b.start_pressure]);
        state[SUPPLY] = if self.unit.is_some() { supply } else { 0.0 };
        state
    }

    /// The point of the leading components of a state, of length and speed of the actuator, and of supply, tank and
    /// command. With an accumulator its pressure takes the place of that of the supply.
    #[inline]
    pub fn point<T: Number>(&self, state: [T; DYNAMIC], [length, speed]: [T; 2], ports: [T; 3]) -> Point<T> {
        let ([p_a, p_b, spool, spool_speed, own], [supply, tank, command]) = (state, ports);
        let supply = if self.unit.is_some() { own } else { supply };
        Point { pressures: [p_a, p_b], spool, spool_speed, length, speed, supply, tank, command }
    }

    /// Rates of the state at a point.
    #[inline]
    pub fn rates<T: Number>(&self, at: &Point<T>) -> Rates<T> {
        let flows = self.flows(at);
        self.rates_of(at, &flows, &self.powers(at, &flows))
    }

    /// Rates of the state at a point, from the flows and the powers there.
    #[inline]
    pub fn rates_of<T: Number>(&self, at: &Point<T>, flows: &Flows<T>, powers: &Powers<T>) -> Rates<T> {
        let [a, b, y, acceleration, unit] = self.leading(at, flows);
        let [supplied, returned, piston, seal, compression, throttling] = powers.in_order();
        let state = [a, b, y, acceleration, unit, supplied, returned, piston, seal, compression, throttling];
        Rates { state, force: powers.force }
    }

    /// Rates of the leading components at a point.
    #[inline]
    pub fn dynamic_rates<T: Number>(&self, at: &Point<T>) -> [T; DYNAMIC] {
        self.leading(at, &self.flows(at))
    }

    /// Rates of the leading components, from the flows.
    #[inline]
    fn leading<T: Number>(&self, at: &Point<T>, flows: &Flows<T>) -> [T; DYNAMIC] {
        let [a, b] = flows.pressure_rates;
        let unit = self.unit.map_or(T::constant(0.0), |unit| unit.rate(at.supply, flows.supply));
        [a, b, at.spool_speed, flows.spool_acceleration, unit]
    }

    /// Size of each leading component of a state, to which its errors are relative: absolute pressures, at least the
    /// ambient pressure; the spool position, at least a tenth of the stroke of the spool, and its speed at the natural
    /// frequency.
    #[inline]
    pub fn sizes(&self, [p_a, p_b, spool, _, supply]: [f64; DYNAMIC]) -> [f64; DYNAMIC] {
        let ambient = self.ambient();
        let pressure = |p: f64| (p + ambient).max(ambient);
        let spool = SPOOL_FLOOR + spool.abs();
        [pressure(p_a), pressure(p_b), spool, self.spool_frequency() * spool, pressure(supply)]
    }
}
