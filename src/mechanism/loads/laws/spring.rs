//! The law of a spring with a damper.
//!
//! In: displacement S of its load, S_dot. Out: the force that resists S, its slopes, energy. It must not know the
//! linkage.
use crate::numerics::dual::Number;

/// Law of a spring with a damper: F = preload + stiffness (S - free) + damping S_dot.
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
}

impl Spring {
    /// Force at rest [N or N.m].
    pub fn force<T: Number>(&self, s: T) -> T {
        s.chain(self.preload + self.stiffness * (s.value() - self.free), self.stiffness)
    }

    /// Force of the damper at the rate S_dot [N or N.m].
    pub fn damping_force<T: Number>(&self, rate: T) -> T {
        T::constant(self.damping) * rate
    }

    /// Energy stored, less the energy at S = free [J].
    pub fn energy<T: Number>(&self, s: T) -> T {
        let extension = s.value() - self.free;
        s.compose([
            extension * (self.preload + 0.5 * self.stiffness * extension),
            self.force(s.value()),
            self.stiffness,
        ])
    }

    /// Power lost in the damper at the rate S_dot [W].
    pub fn lost_power(&self, rate: f64) -> f64 {
        self.damping * rate.powi(2)
    }

    /// Natural size of the force for displacements of size `s` [N or N.m].
    pub fn force_scale(&self, s: f64) -> f64 {
        self.preload.abs() + self.stiffness * s
    }

    /// Change of the force for changes of S and of S_dot [N or N.m].
    pub fn force_change(&self, s: f64, rate: f64) -> f64 {
        self.stiffness * s + self.damping * rate
    }

    /// Whether the damper acts.
    pub fn is_damped(&self) -> bool {
        self.damping != 0.0
    }
}
