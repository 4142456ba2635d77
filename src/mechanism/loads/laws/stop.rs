//! The law of a stop: rigid, or a bumper.
//!
//! In: displacement S of its load, S_dot. Out: distance beyond the stop, push of the bumper. It must not know the
//! linkage.
use crate::mechanism::definition::Limit;
use std::ops::{Add, Mul};

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

    /// Push of the bumper in contact [N or N.m], at a distance beyond the stop that grows at `rate`. The push is odd in
    /// both: with S - value and S_dot for them it is the force that resists S at either end.
    pub fn push<T: Add<Output = T> + Mul<f64, Output = T>>(&self, beyond: T, rate: T) -> T {
        beyond * self.stiffness + rate * self.damping
    }
}
