//! The law of a stop: rigid, or a bumper.
//!
//! In: displacement S of its load, S_dot. Out: distance beyond the stop, push of the bumper. It must not know the
//! linkage.
use crate::mechanism::definition::Limit;
use crate::numerics::dual::Number;
use crate::numerics::enclosure::Enclosure;
use crate::numerics::piecewise::Piecewise;

/// A stop at one end of the travel of S.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Name.
    pub name: String,
    /// Index of its load.
    pub load: usize,
    /// End of the travel.
    pub limit: Limit,
    /// S at the stop [rad or m].
    pub value: f64,
    /// Name of the quantity S.
    pub quantity: &'static str,
    /// Whether the stop acts.
    pub enabled: bool,
    /// Whether the stop is rigid; else it is a bumper.
    pub rigid: bool,
    /// Speed after an impact on a rigid stop over the speed before [1].
    pub restitution: f64,
    /// Stiffness of the bumper [N/m or N.m/rad].
    pub stiffness: f64,
    /// Damping of the bumper [N.s/m or N.m.s/rad].
    pub damping: f64,
    /// Further push of the bumper as a function of the distance beyond the stop, 0 at 0 and nowhere falling.
    pub curve: Option<Piecewise>,
    /// Whether the stop is an end of the cylinder of the hydraulic drive, whose displacement it has.
    pub of_cylinder: bool,
}

impl Stop {
    /// Distance of S beyond the stop [rad or m]; negative within the travel.
    pub fn beyond(&self, s: f64) -> f64 {
        match self.limit {
            Limit::Lower => self.value - s,
            Limit::Upper => s - self.value,
        }
    }

    /// Sign of S beyond the stop, seen from the stop.
    pub fn sign(&self) -> f64 {
        match self.limit {
            Limit::Lower => -1.0,
            Limit::Upper => 1.0,
        }
    }

    /// Push of the bumper in contact [N or N.m], at a distance beyond the stop that grows at `rate`.
    #[inline]
    pub fn push<T: Number>(&self, beyond: T, rate: T) -> T {
        let linear = beyond * T::constant(self.stiffness) + rate * T::constant(self.damping);
        match &self.curve {
            Some(curve) => linear + beyond.compose(curve.at(beyond.value())),
            None => linear,
        }
    }

    /// Bounds of [`Self::push`].
    pub fn push_bounds(&self, beyond: Enclosure, rate: Enclosure) -> Enclosure {
        let linear = beyond * self.stiffness + rate * self.damping;
        match &self.curve {
            Some(curve) => linear + beyond.chain(curve.bounds(beyond.value)),
            None => linear,
        }
    }

    /// Force of the bumper in contact on the load [N or N.m], at S - value and the rate S_dot.
    pub fn force<T: Number>(&self, s: T, rate: T) -> T {
        match self.limit {
            Limit::Upper => -self.push(s, rate),
            Limit::Lower => self.push(-s, -rate),
        }
    }
}
