//! The law of a spring with a damper.
//!
//! In: displacement S of its load, S_dot. Out: the force that resists S, its slopes, energy, power lost. It must not
//! know the linkage.
use super::gas::Gas;
use crate::numerics::dual::Number;
use crate::numerics::piecewise::Piecewise;

/// Law of a spring with a damper: F = preload + stiffness (S - free) + characteristic(S) + damping S_dot +
/// damper(S_dot).
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Name.
    pub name: String,
    /// Index of its load.
    pub load: usize,
    /// Stiffness [N/m or N.m/rad].
    pub stiffness: f64,
    /// Damping [N.s/m or N.m.s/rad].
    pub damping: f64,
    /// S at which the force is the preload [m or rad].
    pub free: f64,
    /// Preload [N or N.m].
    pub preload: f64,
    /// Further force as a function of S.
    pub characteristic: Option<Characteristic>,
    /// Further force as a function of S_dot.
    pub damper: Option<Piecewise>,
    /// Index of a second load like its own, of the part of the force that the state sizes; none where no part may be.
    pub state_load: Option<usize>,
}

/// Force of a spring as a nonlinear function of S.
#[derive(Clone, Debug, PartialEq)]
pub enum Characteristic {
    /// Through points of S [m or rad] and force [N or N.m].
    Points(Piecewise),
    /// Of a gas that S expands from the free length on.
    Gas(Gas),
}

impl Characteristic {
    /// Force [N or N.m], its slope and its curvature at S; `free`: S at which a gas has the volume that is stated.
    fn force(&self, s: f64, free: f64) -> [f64; 3] {
        match self {
            Self::Points(points) => points.at(s),
            Self::Gas(gas) => gas.force(s - free),
        }
    }

    /// Energy stored, less that at S = free [J].
    fn energy(&self, s: f64, free: f64) -> f64 {
        match self {
            Self::Points(points) => points.integral(s) - points.integral(free),
            Self::Gas(gas) => gas.energy(s - free),
        }
    }
}

impl Spring {
    /// Linear part of the force at rest [N or N.m], its slope and its curvature.
    fn linear(&self, s: f64) -> [f64; 3] {
        [self.preload + self.stiffness * (s - self.free), self.stiffness, 0.0]
    }

    /// Force at rest [N or N.m], its slope and its curvature.
    fn force_and_slopes(&self, s: f64) -> [f64; 3] {
        let linear = self.linear(s);
        match &self.characteristic {
            None => linear,
            Some(characteristic) => {
                let further = characteristic.force(s, self.free);
                [0, 1, 2].map(|order| linear[order] + further[order])
            }
        }
    }

    /// Force at rest [N or N.m].
    pub fn force<T: Number>(&self, s: T) -> T {
        s.compose(self.force_and_slopes(s.value()))
    }

    /// Force at rest without the characteristic [N or N.m].
    pub fn linear_force<T: Number>(&self, s: T) -> T {
        s.compose(self.linear(s.value()))
    }

    /// Force of the characteristic [N or N.m]; 0 without one.
    pub fn characteristic_force<T: Number>(&self, s: T) -> T {
        let further = self.characteristic.as_ref().map_or([0.0; 3], |c| c.force(s.value(), self.free));
        s.compose(further)
    }

    /// Force of the linear damper at the rate S_dot [N or N.m].
    pub fn linear_damping<T: Number>(&self, rate: T) -> T {
        T::constant(self.damping) * rate
    }

    /// Force of the damper with a curve at the rate S_dot [N or N.m]; 0 without one.
    pub fn damper_force<T: Number>(&self, rate: T) -> T {
        match &self.damper {
            Some(damper) => rate.compose(damper.at(rate.value())),
            None => T::constant(0.0),
        }
    }

    /// Force of the dampers at the rate S_dot [N or N.m].
    pub fn damping_force<T: Number>(&self, rate: T) -> T {
        let linear = self.linear_damping(rate);
        if self.damper.is_some() { linear + self.damper_force(rate) } else { linear }
    }

    /// Energy stored, less the energy at S = free [J].
    pub fn energy<T: Number>(&self, s: T) -> T {
        let extension = s.value() - self.free;
        let linear = extension * (self.preload + 0.5 * self.stiffness * extension);
        let further = self.characteristic.as_ref().map_or(0.0, |c| c.energy(s.value(), self.free));
        let [force, slope, _] = self.force_and_slopes(s.value());
        s.compose([linear + further, force, slope])
    }

    /// Power lost in the dampers at the rate S_dot [W].
    pub fn lost_power(&self, rate: f64) -> f64 {
        let linear = self.linear_power(rate);
        if self.damper.is_some() { linear + self.damper_force(rate) * rate } else { linear }
    }

    /// Natural power lost in the linear damper at the rate S_dot [W].
    pub fn linear_power(&self, rate: f64) -> f64 {
        self.damping * rate.powi(2)
    }

    /// Natural size of the force for displacements of size `s` [N or N.m].
    pub fn force_scale(&self, s: f64) -> f64 {
        let further = match &self.characteristic {
            None => 0.0,
            Some(Characteristic::Points(points)) => points.largest(),
            Some(Characteristic::Gas(gas)) => gas.pressure * gas.area,
        };
        self.preload.abs() + self.stiffness * s + further
    }

    /// Change of the linear force over a revolution in which S grows by `growth` [N or N.m]. A characteristic does not
    /// repeat itself over a revolution, so that the state sizes it.
    pub fn winding_force(&self, growth: f64) -> f64 {
        self.stiffness * growth
    }

    /// Change of the force at S and S_dot for small changes of both [N or N.m].
    pub fn force_change(&self, [s, s_dot]: [f64; 2], [change, rate]: [f64; 2]) -> f64 {
        let damping = self.damping + self.damper.as_ref().map_or(0.0, |damper| damper.at(s_dot)[1]);
        self.force_and_slopes(s)[1] * change + damping * rate
    }

    /// Whether a damper acts.
    pub fn is_damped(&self) -> bool {
        self.damping != 0.0 || self.damper.is_some()
    }

    /// Values of S at which the law changes its polynomial.
    pub fn knots(&self) -> &[f64] {
        match &self.characteristic {
            Some(Characteristic::Points(points)) => points.knots(),
            _ => &[],
        }
    }

    /// Those at and beside which the force of the points ceases to rise or to fall, as in a detent: what lies between
    /// them may be narrow and weak.
    pub fn turning_knots(&self) -> Vec<f64> {
        match &self.characteristic {
            Some(Characteristic::Points(points)) => points.turning_knots(),
            _ => Vec::new(),
        }
    }
}
