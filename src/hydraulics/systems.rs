//! The circuit as systems of differential equations: under a prescribed motion, and with one element that it moves.
//!
//! In: the laws of a circuit, inputs as functions of time, a point-mass model of what the actuator moves. Out:
//! right-hand sides, Jacobians and error weights for the integration. It must not know how steps are made, nor events.
use super::circuit::{Equations, Point, SupplyUnit};
use super::inputs::{CommandSignal, Polynomial};
use crate::integrator::System;
use crate::numerics::dual::{Dual, Number};

/// Components of the state of a circuit: two pressures, spool position and speed, six energies, pressure of the supply.
pub const CIRCUIT: usize = 11;
/// Components of the state of a circuit with one element: the former, length and speed, impulse and first moment of the
/// force.
pub const ELEMENT: usize = CIRCUIT + 4;
/// Number of energies.
pub const ENERGIES: usize = 6;
/// Components that the right-hand side depends on; the last two with an element only.
const DRIVING: [usize; 7] = [0, 1, 2, 3, SUPPLY, LENGTH, SPEED];

/// Index of the spool's position in the state.
pub const SPOOL: usize = 2;
/// Index of the first energy in the state.
pub const ENERGY: usize = 4;
/// Index of the pressure of an accumulator; without one the component stays 0.
pub const SUPPLY: usize = ENERGY + ENERGIES;
/// Index of the length in the state of a circuit with an element.
pub const LENGTH: usize = CIRCUIT;
/// Index of the speed.
pub const SPEED: usize = CIRCUIT + 1;
/// Index of the impulse of the force, int F dt [N s].
pub const IMPULSE: usize = CIRCUIT + 2;
/// Index of the first moment of the force, int F t dt [N s2].
pub const MOMENT: usize = CIRCUIT + 3;

/// Part of the error weight of the spool that holds where it is at rest; with it, openings near the edges are exact.
const SPOOL_FLOOR: f64 = 0.1;
/// Weight of components whose errors follow from those of the others.
const FREE: f64 = 1e300;
/// Speed of the element below which errors are absolute [m/s].
const SPEED_FLOOR: f64 = 0.01;

/// Pressures of the ports and the command during a step.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Accumulator and pump; none where the pressure of the supply is an input.
    pub unit: Option<SupplyUnit>,
    pub supply: Polynomial,
    pub tank: Polynomial,
    pub command: CommandSignal,
}

impl Surroundings {
    /// Pressure of the supply, whose component of the state is `own`.
    #[inline]
    fn supply<T: Number>(&self, t: f64, own: T) -> T {
        if self.unit.is_some() { own } else { T::constant(self.supply.at(t)) }
    }
}

/// Error weights of the components of a circuit.
#[inline]
fn circuit_scale(laws: &Equations, y: &[f64]) -> [f64; CIRCUIT] {
    let ambient = laws.ambient();
    let pressure = |p: f64| (p + ambient).max(ambient);
    let spool = SPOOL_FLOOR + y[2].abs();
    let mut scale = [FREE; CIRCUIT];
    (scale[0], scale[1]) = (pressure(y[0]), pressure(y[1]));
    (scale[2], scale[3]) = (spool, laws.spool_frequency() * spool);
    scale[SUPPLY] = pressure(y[SUPPLY]);
    scale
}

/// Rates of the components of a circuit, and the force.
#[inline]
fn circuit_rates<T: Number>(laws: &Equations, unit: Option<&SupplyUnit>, at: &Point<T>) -> ([T; CIRCUIT], T) {
    let flows = laws.flows(at);
    let powers = laws.powers(at, &flows);
    let [a, b] = flows.pressure_rates;
    let rates = [
        a,
        b,
        at.spool_speed,
        flows.spool_acceleration,
        powers.supply,
        powers.returned,
        powers.piston,
        powers.seal_friction,
        powers.compression,
        powers.throttling,
        unit.map_or(T::constant(0.0), |unit| unit.rate(at.supply, flows.supply)),
    ];
    (rates, powers.force)
}

/// A circuit under a prescribed motion.
#[derive(Clone, Copy, Debug)]
pub struct Driven<'a> {
    pub laws: &'a Equations,
    pub surroundings: Surroundings,
    pub length: Polynomial,
    pub speed: Polynomial,
}

impl Driven<'_> {
    fn point<T: Number>(&self, t: f64, [p_a, p_b, spool, spool_speed, supply]: [T; 5]) -> Point<T> {
        let Surroundings { tank, command, .. } = &self.surroundings;
        Point {
            pressures: [p_a, p_b],
            spool,
            spool_speed,
            length: T::constant(self.length.at(t)),
            speed: T::constant(self.speed.at(t)),
            supply: self.surroundings.supply(t, supply),
            tank: T::constant(tank.at(t)),
            command: T::constant(command.at(t)),
        }
    }
}

impl System<CIRCUIT> for Driven<'_> {
    const CAN_BE_STIFF: bool = true;

    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64; CIRCUIT]) -> [f64; CIRCUIT] {
        let at = self.point(t, [y[0], y[1], y[2], y[3], y[SUPPLY]]);
        circuit_rates(self.laws, self.surroundings.unit.as_ref(), &at).0
    }

    #[inline]
    fn scale(&mut self, y: &[f64; CIRCUIT], _f: &[f64; CIRCUIT]) -> [f64; CIRCUIT] {
        circuit_scale(self.laws, y)
    }

    fn jacobian(&mut self, t: f64, y: &[f64; CIRCUIT]) -> [[f64; CIRCUIT]; CIRCUIT] {
        let duals: [Dual<5>; 5] = std::array::from_fn(|k| Dual::variable(y[DRIVING[k]], k));
        let (rates, _) = circuit_rates(self.laws, self.surroundings.unit.as_ref(), &self.point(t, duals));
        rates.map(|rate| row(rate.slope))
    }
}

/// Row of a Jacobian, from the derivatives by the components of [`DRIVING`].
fn row<const K: usize, const N: usize>(slope: [f64; K]) -> [f64; N] {
    let mut row = [0.0; N];
    for (slope, component) in slope.into_iter().zip(DRIVING) {
        row[component] = slope;
    }
    row
}

/// What an actuator moves, as one element along it: (m + m' (s - s_0)) v' = F - W_0 - W_1 (s - s_0) - W_t t - m' v^2/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<T> {
    /// Mass m [kg] at the length s_0.
    pub mass: T,
    /// Its derivative m' with respect to the length [kg/m].
    pub mass_derivative: T,
    /// Load W_0 [N].
    pub load: T,
    /// Derivative W_1 of the load with respect to the length [N/m].
    pub load_derivative: T,
    /// Rate W_t of the load [N/s].
    pub load_rate: T,
    /// Length s_0 [m].
    pub length: T,
}

impl<T: Number> Element<T> {
    /// Acceleration [m/s2] under a force, t [s] after the beginning; NaN where the element has no mass.
    #[inline]
    pub fn acceleration(&self, force: T, length: T, speed: T, t: T) -> T {
        let way = length - self.length;
        let mass = self.mass + self.mass_derivative * way;
        let load =
            self.load + self.load_derivative * way + self.load_rate * t + self.mass_derivative * speed * speed * 0.5;
        let mass = if mass.value() > 0.0 { mass } else { T::constant(f64::NAN) };
        (force - load) / mass
    }
}

/// Rates of a circuit with an element, at the time t [s] after the beginning. `ports`: pressures of supply and tank,
/// and the command.
#[inline]
pub fn element_rates<T: Number>(
    laws: &Equations,
    unit: Option<&SupplyUnit>,
    element: &Element<T>,
    ports: [T; 3],
    t: T,
    y: &[T; ELEMENT],
) -> [T; ELEMENT] {
    let [supply, tank, command] = ports;
    let (pressures, spool, spool_speed, length, speed) = ([y[0], y[1]], y[2], y[3], y[LENGTH], y[SPEED]);
    let at = Point { pressures, spool, spool_speed, length, speed, supply, tank, command };
    let (rates, force) = circuit_rates(laws, unit, &at);
    let mut all = [T::constant(0.0); ELEMENT];
    all[..CIRCUIT].copy_from_slice(&rates);
    all[LENGTH] = speed;
    all[SPEED] = element.acceleration(force, length, speed, t);
    all[IMPULSE] = force;
    all[MOMENT] = force * t;
    all
}

/// A circuit with an element that it moves.
#[derive(Clone, Copy, Debug)]
pub struct Coupled<'a> {
    pub laws: &'a Equations,
    pub surroundings: Surroundings,
    pub element: Element<f64>,
    /// Stroke of the cylinder [m].
    pub stroke: f64,
}

impl Coupled<'_> {
    #[inline]
    fn ports<T: Number>(&self, t: f64, supply: T) -> [T; 3] {
        let Surroundings { tank, command, .. } = &self.surroundings;
        [self.surroundings.supply(t, supply), T::constant(tank.at(t)), T::constant(command.at(t))]
    }
}

impl System<ELEMENT> for Coupled<'_> {
    const CAN_BE_STIFF: bool = true;

    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64; ELEMENT]) -> [f64; ELEMENT] {
        element_rates(self.laws, self.surroundings.unit.as_ref(), &self.element, self.ports(t, y[SUPPLY]), t, y)
    }

    #[inline]
    fn scale(&mut self, y: &[f64; ELEMENT], _f: &[f64; ELEMENT]) -> [f64; ELEMENT] {
        let mut scale = [FREE; ELEMENT];
        scale[..CIRCUIT].copy_from_slice(&circuit_scale(self.laws, y));
        (scale[LENGTH], scale[SPEED]) = (self.stroke, y[SPEED].abs().max(SPEED_FLOOR));
        scale
    }

    fn jacobian(&mut self, t: f64, y: &[f64; ELEMENT]) -> [[f64; ELEMENT]; ELEMENT] {
        let mut duals: [Dual<7>; ELEMENT] = y.map(Dual::constant);
        for (k, component) in DRIVING.into_iter().enumerate() {
            duals[component] = Dual::variable(y[component], k);
        }
        let Element { mass, mass_derivative, load, load_derivative, load_rate, length } = self.element;
        let [mass, mass_derivative, load] = [mass, mass_derivative, load].map(Dual::constant);
        let [load_derivative, load_rate, length] = [load_derivative, load_rate, length].map(Dual::constant);
        let element = Element { mass, mass_derivative, load, load_derivative, load_rate, length };
        let (unit, ports) = (self.surroundings.unit.as_ref(), self.ports(t, duals[SUPPLY]));
        let rates = element_rates(self.laws, unit, &element, ports, Dual::constant(t), &duals);
        rates.map(|rate| row(rate.slope))
    }
}

/// Components of the state of a circuit with an element, and of its derivative along one direction.
pub const TANGENT: usize = 2 * ELEMENT;

/// A circuit with an element, and the derivative of its motion along one direction of the inputs: the variational
/// equations, by dual numbers.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<'a> {
    pub coupled: Coupled<'a>,
    /// The element with its change along the direction.
    pub element: Element<Dual<1>>,
    /// Change of supply, tank and command along the direction.
    pub ports: [f64; 3],
}

impl System<TANGENT> for Tangent<'_> {
    fn derivative(&mut self, t: f64, y: &[f64; TANGENT]) -> [f64; TANGENT] {
        let duals = std::array::from_fn(|k| Dual { value: y[k], slope: [y[ELEMENT + k]] });
        let unit = self.coupled.surroundings.unit.as_ref();
        let mut ports: [Dual<1>; 3] = self.coupled.ports(t, duals[SUPPLY]);
        for (k, (port, change)) in ports.iter_mut().zip(self.ports).enumerate() {
            // The pressure of an accumulator is a component of the state.
            if k > 0 || unit.is_none() {
                port.slope = [change];
            }
        }
        let rates = element_rates(self.coupled.laws, unit, &self.element, ports, Dual::constant(t), &duals);
        std::array::from_fn(|k| if k < ELEMENT { rates[k].value } else { rates[k - ELEMENT].slope[0] })
    }

    fn scale(&mut self, y: &[f64; TANGENT], f: &[f64; TANGENT]) -> [f64; TANGENT] {
        let values = std::array::from_fn(|k| y[k]);
        let scale = self.coupled.scale(&values, &std::array::from_fn(|k| f[k]));
        // The derivative is as exact as the motion, which the control of its errors sees to.
        std::array::from_fn(|k| if k < ELEMENT { scale[k] } else { FREE })
    }
}
