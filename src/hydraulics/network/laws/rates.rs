//! Rates of the state of a network.
//!
//! In: flows, motions of the cylinders. Out: rates of all components of the state; forces; what a cylinder moves, as
//! one element. It must not know how the laws are integrated.
use super::{Laws, Point};
use crate::circuit::settling_acceleration;
use crate::network::definition::MOST_CYLINDERS;
use crate::network::layout::Total;
use foundation::numerics::dual::Number;

/// What a cylinder moves, as one element along it: (m + m' (s - s_0)) v' = F - W_0 - W_1 (s - s_0) - W_t t - m' v^2/2.
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
    pub fn acceleration(&self, force: T, [length, speed]: [T; 2], t: T) -> T {
        let mass = self.mass_at(length);
        let load = self.load_at(length, t) + self.mass_derivative * speed * speed * 0.5;
        let mass = if mass.value() > 0.0 { mass } else { T::constant(f64::NAN) };
        (force - load) / mass
    }

    /// Mass [kg] at a length.
    #[inline]
    pub fn mass_at(&self, length: T) -> T {
        self.mass + self.mass_derivative * (length - self.length)
    }

    /// Load [N] at a length and no speed, t [s] after the beginning.
    #[inline]
    pub fn load_at(&self, length: T, t: T) -> T {
        self.load + self.load_derivative * (length - self.length) + self.load_rate * t
    }

    /// With values that nothing changes.
    pub fn constant<U: Number>(&self) -> Element<U> {
        let of = |value: T| U::constant(value.value());
        Element {
            mass: of(self.mass),
            mass_derivative: of(self.mass_derivative),
            load: of(self.load),
            load_derivative: of(self.load_derivative),
            load_rate: of(self.load_rate),
            length: of(self.length),
        }
    }
}

/// What moves a cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive<T> {
    /// Its length and speed are given.
    Given([T; 2]),
    /// Its force moves an element.
    Element(Element<T>),
    /// A stop or a lock holds it at this length [m].
    Held(T),
    /// An end of the cylinder holds it.
    End(Rest<T>),
}

/// A piston at rest on an end of its cylinder: the force of the cylinder is the load of the element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest<T> {
    /// Element that the cylinder moves.
    pub element: Element<T>,
    /// Length of the cylinder there [m].
    pub end: f64,
    /// Time [s] in which a mean force that is held brings the element there; less than the step: the step.
    pub settling: f64,
}

impl<T: Number> Rest<T> {
    /// Mean force [N] over a step of size h that brings an element with this motion to rest at the end.
    pub fn mean_force(&self, [length, speed]: [T; 2], h: T) -> T {
        let end = T::constant(self.end);
        let acceleration = settling_acceleration([length, end], speed, self.settling, h);
        self.element.load_at(end, h * 0.5) - self.element.mass * acceleration
    }
}

impl Laws {
    /// Rates of the state y at the time t [s] after the beginning of a step.
    #[inline]
    pub fn rates<T: Number, const N: usize>(&self, drives: &[Drive<T>], u: &[T], t: T, y: &[T; N]) -> [T; N] {
        let (zero, layout) = (T::constant(0.0), &self.layout);
        let mut motion = [[zero; 2]; MOST_CYLINDERS];
        for (index, drive) in drives.iter().enumerate() {
            let own = layout.motion(index);
            motion[index] = match *drive {
                Drive::Given(motion) => motion,
                Drive::Element(_) => [y[own], y[own + 1]],
                Drive::Held(length) => [length, zero],
                Drive::End(rest) => [T::constant(rest.end), zero],
            };
        }
        let (mut rates, mut net) = ([zero; N], [zero; N]);
        let powers = self.flows(&Point { y, u, motion: &motion }, &mut net, |_, _| {});
        let mut compliances = [zero; N];
        for (index, node) in self.nodes.iter().enumerate() {
            compliances[index] = T::constant(node.volume) / self.oil.bulk_modulus(y[index]) + T::constant(node.hoses);
        }
        let (mut piston, mut seal) = (zero, zero);
        for (index, (cylinder, drive)) in self.cylinders.iter().zip(drives).enumerate() {
            let ([length, speed], chamber) = (motion[index], layout.chamber(index));
            let (laws, pressures) = (&cylinder.laws, [y[chamber], y[chamber + 1]]);
            let (volumes, areas) = (laws.oil_volumes(laws.volumes(length)), laws.areas());
            for side in 0..2 {
                let modulus = laws.chamber_modulus(side, pressures[side], volumes[side]);
                compliances[chamber + side] = volumes[side] / modulus;
            }
            net[chamber] = net[chamber] - speed * areas[0];
            net[chamber + 1] = net[chamber + 1] + speed * areas[1];
            let friction = laws.seal_friction(pressures, speed);
            let force = pressures[0] * areas[0] - pressures[1] * areas[1] - friction;
            (piston, seal) = (piston + force * speed, seal + friction * speed);
            let (own, impulse) = (layout.motion(index), layout.impulse(index));
            if let Drive::Element(element) = drive {
                (rates[own], rates[own + 1]) = (speed, element.acceleration(force, [length, speed], t));
            }
            if !layout.is_carried {
                let force = match drive {
                    Drive::End(rest) => rest.element.load_at(length, t),
                    _ => force,
                };
                (rates[impulse], rates[impulse + 1]) = (force, force * t);
            }
        }
        for accumulator in &self.accumulators {
            let own = &mut compliances[accumulator.at];
            *own = *own + accumulator.compliance(y[accumulator.at], self.ambient);
        }
        let (mut compressed, mut compression, volumes) = (zero, zero, layout.volumes());
        for index in 0..volumes {
            rates[index] = net[index] / compliances[index];
            compressed = compressed + net[index];
            compression = compression + y[index] * net[index];
        }
        let (mut from, mut work) = (zero, zero);
        for index in 0..layout.reservoirs {
            from = from - net[volumes + index];
            work = work - u[index] * net[volumes + index];
        }
        for (index, valve) in self.valves.iter().enumerate() {
            if let Some((omega, zeta, spool)) = valve.dynamics {
                let own = layout.spool(spool);
                rates[own] = y[own + 1];
                rates[own + 1] =
                    (u[layout.command(index)] - y[own]) * (omega * omega) - y[own + 1] * (2.0 * zeta * omega);
            }
        }
        let totals =
            [from, powers.leaked, compressed, powers.pumps, work, piston, seal, compression, powers.throttling];
        rates[layout.total(Total::Reservoirs)..layout.components()].copy_from_slice(&totals);
        rates
    }
}
