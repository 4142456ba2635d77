//! The circuit as systems of differential equations: under a prescribed motion, and with one element that it moves.
//!
//! In: the laws of a circuit, inputs as functions of time, a point-mass model of what the actuator moves. Out:
//! right-hand sides, Jacobians and error weights for the integration. It must not know how steps are made, nor events.
use super::circuit::{CIRCUIT, DYNAMIC, ENERGIES, Equations, FREE, Point, Rates};
use super::events::Guard;
use super::inputs::{Polynomial, Surroundings};
use foundation::integrator::System;
use foundation::numerics::dual::{Dual, Number};

/// Components of the state of a circuit with one element: the leading ones of the circuit, length and speed, then the
/// integrals beside them: the energies, impulse and first moment of the force.
pub const ELEMENT: usize = CIRCUIT + 4;
/// Number of leading components, on which the rates depend.
const LEADING: usize = DYNAMIC + 2;
/// Index of the length in the state of a circuit with an element.
pub const LENGTH: usize = DYNAMIC;
/// Index of the speed.
pub const SPEED: usize = LENGTH + 1;
/// Index of the impulse of the force, int F dt [N s].
pub const IMPULSE: usize = LEADING + ENERGIES;
/// Index of the first moment of the force, int F t dt [N s2].
pub const MOMENT: usize = IMPULSE + 1;

/// State of a circuit with an element.
pub fn with_element<T: Number>(circuit: &[T; CIRCUIT], [length, speed]: [T; 2]) -> [T; ELEMENT] {
    let ([a, b, y, rate, supply, e1, e2, e3, e4, e5, e6], zero) = (*circuit, T::constant(0.0));
    [a, b, y, rate, supply, length, speed, e1, e2, e3, e4, e5, e6, zero, zero]
}

/// The state of the circuit in that of a circuit with an element.
pub fn without_element<T: Copy>(y: &[T; ELEMENT]) -> [T; CIRCUIT] {
    let [a, b, y, rate, supply, _, _, e1, e2, e3, e4, e5, e6, _, _] = *y;
    [a, b, y, rate, supply, e1, e2, e3, e4, e5, e6]
}

/// Speed of the element below which errors are absolute [m/s].
const SPEED_FLOOR: f64 = 0.01;

/// A system whose integration can end at an event of the circuit.
pub trait Watched<const N: usize>: System<N> + Copy {
    /// Guard of an event of [`EVENTS`](super::circuit::EVENTS) at a time [s] and a state, for a tolerance.
    fn guard(&self, event: usize, t: f64, y: &[f64; N], tolerance: f64) -> Guard;
}

impl Watched<CIRCUIT> for Driven<'_> {
    fn guard(&self, event: usize, t: f64, y: &[f64; CIRCUIT], tolerance: f64) -> Guard {
        let [a, b, spool, rate, supply, ..] = *y;
        self.laws.guard(event, [a, b, spool, rate, supply], self.length.at(t), tolerance)
    }
}

impl Watched<ELEMENT> for Coupled<'_> {
    fn guard(&self, event: usize, _t: f64, y: &[f64; ELEMENT], tolerance: f64) -> Guard {
        let [a, b, spool, rate, supply, length, ..] = *y;
        self.laws.guard(event, [a, b, spool, rate, supply], length, tolerance)
    }
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
    #[inline]
    fn point<T: Number>(&self, t: f64, state: [T; DYNAMIC]) -> Point<T> {
        let motion = [self.length.at(t), self.speed.at(t)].map(T::constant);
        self.laws.point(state, motion, self.surroundings.at(t).map(T::constant))
    }
}

impl System<CIRCUIT> for Driven<'_> {
    const CAN_BE_STIFF: bool = true;
    const LEADING: usize = DYNAMIC;

    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64; CIRCUIT]) -> [f64; CIRCUIT] {
        let [a, b, spool, rate, supply, ..] = *y;
        self.laws.rates(&self.point(t, [a, b, spool, rate, supply])).state
    }

    /// Without powers: the motion is given, so pressures and spool do not depend on the friction of the seals.
    #[inline]
    fn leading(&mut self, t: f64, y: &[f64; CIRCUIT]) -> [f64; CIRCUIT] {
        let ([a, b, spool, rate, supply, ..], mut rates) = (*y, [0.0; CIRCUIT]);
        rates[..DYNAMIC].copy_from_slice(&self.laws.dynamic_rates(&self.point(t, [a, b, spool, rate, supply])));
        rates
    }

    #[inline]
    fn scale(&mut self, y: &[f64; CIRCUIT], _f: &[f64; CIRCUIT]) -> [f64; CIRCUIT] {
        let ([a, b, spool, rate, supply, ..], mut sizes) = (*y, [FREE; CIRCUIT]);
        sizes[..DYNAMIC].copy_from_slice(&self.laws.sizes([a, b, spool, rate, supply]));
        sizes
    }

    #[inline]
    fn admits(&mut self, y: &[f64; CIRCUIT]) -> bool {
        let [a, b, spool, rate, supply, ..] = *y;
        self.laws.has_pressures([a, b, spool, rate, supply])
    }

    fn jacobian(&mut self, t: f64, y: &[f64; CIRCUIT]) -> [[f64; CIRCUIT]; CIRCUIT] {
        let duals: [Dual<DYNAMIC>; DYNAMIC] = std::array::from_fn(|k| Dual::variable(y[k], k));
        self.laws.rates(&self.point(t, duals)).state.map(|rate| row(rate.slope))
    }
}

/// Row of a Jacobian, from the derivatives by the leading components.
fn row<const K: usize, const N: usize>(slope: [f64; K]) -> [f64; N] {
    let mut row = [0.0; N];
    row[..K].copy_from_slice(&slope);
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
    /// Least and largest length to which stops and locks let it go [m].
    pub limits: [f64; 2],
}

impl<T: Number> Element<T> {
    /// The load [N] at a length, t [s] after the beginning.
    #[inline]
    pub fn load_at(&self, length: T, t: T) -> T {
        self.load + self.load_derivative * (length - self.length) + self.load_rate * t
    }

    /// Acceleration [m/s2] under a force, t [s] after the beginning; NaN where the element has no mass.
    #[inline]
    pub fn acceleration(&self, force: T, length: T, speed: T, t: T) -> T {
        let mass = self.mass + self.mass_derivative * (length - self.length);
        let load = self.load_at(length, t) + self.mass_derivative * speed * speed * 0.5;
        let mass = if mass.value() > 0.0 { mass } else { T::constant(f64::NAN) };
        (force - load) / mass
    }
}

/// Rates of a circuit with an element, at the time t [s] after the beginning. `ports`: pressures of supply and tank,
/// and the command.
#[inline]
pub fn element_rates<T: Number>(
    laws: &Equations,
    element: &Element<T>,
    ports: [T; 3],
    t: T,
    y: &[T; ELEMENT],
) -> [T; ELEMENT] {
    let [a, b, spool, rate, supply, length, speed, ..] = *y;
    let Rates { state, force } = laws.rates(&laws.point([a, b, spool, rate, supply], [length, speed], ports));
    let mut all = with_element(&state, [speed, element.acceleration(force, length, speed, t)]);
    all[IMPULSE] = force;
    all[MOMENT] = force * t;
    all
}

/// What holds the element at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// Nothing.
    #[default]
    Free,
    /// A stop or a lock of what the actuator moves: the force of the actuator is that of the oil.
    Stop,
    /// An end of the cylinder: the force of the actuator is the load.
    End,
}

impl Hold {
    /// Whether anything does.
    pub fn is_held(self) -> bool {
        self != Self::Free
    }

    /// Rates of a circuit with an element that this holds, from those of one that is free.
    #[inline]
    fn rates<T: Number>(self, element: &Element<T>, t: T, length: T, mut rates: [T; ELEMENT]) -> [T; ELEMENT] {
        if self.is_held() {
            (rates[LENGTH], rates[SPEED]) = (T::constant(0.0), T::constant(0.0));
        }
        if self == Self::End {
            let load = element.load_at(length, t);
            (rates[IMPULSE], rates[MOMENT]) = (load, load * t);
        }
        rates
    }
}

/// A circuit with an element that it moves.
#[derive(Clone, Copy, Debug)]
pub struct Coupled<'a> {
    pub laws: &'a Equations,
    pub surroundings: Surroundings,
    pub element: Element<f64>,
    /// Stroke of the cylinder [m].
    pub stroke: f64,
    /// What holds the element.
    pub hold: Hold,
}

impl System<ELEMENT> for Coupled<'_> {
    const CAN_BE_STIFF: bool = true;
    const LEADING: usize = LEADING;

    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64; ELEMENT]) -> [f64; ELEMENT] {
        let rates = element_rates(self.laws, &self.element, self.surroundings.at(t), t, y);
        self.hold.rates(&self.element, t, y[LENGTH], rates)
    }

    #[inline]
    fn scale(&mut self, y: &[f64; ELEMENT], _f: &[f64; ELEMENT]) -> [f64; ELEMENT] {
        let ([a, b, spool, rate, supply, _, speed, ..], mut scale) = (*y, [FREE; ELEMENT]);
        scale[..DYNAMIC].copy_from_slice(&self.laws.sizes([a, b, spool, rate, supply]));
        (scale[LENGTH], scale[SPEED]) = (self.stroke, speed.abs().max(SPEED_FLOOR));
        scale
    }

    #[inline]
    fn admits(&mut self, y: &[f64; ELEMENT]) -> bool {
        let [a, b, spool, rate, supply, ..] = *y;
        self.laws.has_pressures([a, b, spool, rate, supply])
    }

    fn jacobian(&mut self, t: f64, y: &[f64; ELEMENT]) -> [[f64; ELEMENT]; ELEMENT] {
        let mut duals: [Dual<LEADING>; ELEMENT] = y.map(Dual::constant);
        for (k, dual) in duals.iter_mut().enumerate().take(LEADING) {
            *dual = Dual::variable(y[k], k);
        }
        let Element { mass, mass_derivative, load, load_derivative, load_rate, length, limits } = self.element;
        let [mass, mass_derivative, load] = [mass, mass_derivative, load].map(Dual::constant);
        let [load_derivative, load_rate, length] = [load_derivative, load_rate, length].map(Dual::constant);
        let element = Element { mass, mass_derivative, load, load_derivative, load_rate, length, limits };
        let ports = self.surroundings.at(t).map(Dual::constant);
        let t = Dual::constant(t);
        let rates = element_rates(self.laws, &element, ports, t, &duals);
        self.hold.rates(&element, t, duals[LENGTH], rates).map(|rate| row(rate.slope))
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
        let values = self.coupled.surroundings.at(t);
        let ports = std::array::from_fn(|k| Dual { value: values[k], slope: [self.ports[k]] });
        let t = Dual::constant(t);
        let rates = element_rates(self.coupled.laws, &self.element, ports, t, &duals);
        let rates = self.coupled.hold.rates(&self.element, t, duals[LENGTH], rates);
        std::array::from_fn(|k| if k < ELEMENT { rates[k].value } else { rates[k - ELEMENT].slope[0] })
    }

    fn scale(&mut self, y: &[f64; TANGENT], f: &[f64; TANGENT]) -> [f64; TANGENT] {
        let values = std::array::from_fn(|k| y[k]);
        let scale = self.coupled.scale(&values, &std::array::from_fn(|k| f[k]));
        // The derivative is as exact as the motion, which the control of its errors sees to.
        std::array::from_fn(|k| if k < ELEMENT { scale[k] } else { FREE })
    }

    fn admits(&mut self, y: &[f64; TANGENT]) -> bool {
        y.first_chunk().is_some_and(|values| self.coupled.admits(values))
    }
}
