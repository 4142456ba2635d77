//! The place on the curve that fits a finite-element state best.
//!
//! In: the bodies' angles and speeds. Out: sigma, the least of 1/2 sum (q(sigma) - q_fem)^2 next to the last one, and
//! sigma_dot, the projection of the speeds: sum q_sigma q_dot / sum q_sigma^2.
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem};
use crate::mechanism::{ModelError, motion::state::State};
use crate::numerics::table::Table;

/// Newton's corrections in each step; the prediction is off by some (sigma_dot h)^2, the second correction by rounding.
const CORRECTIONS: usize = 3;

/// Follows the curve from step to step.
pub struct Track<'a> {
    table: &'a Table,
    sigma: f64,
    sigma_dot: f64,
    revolutions: f64,
}

/// Sums over the coordinates at a sigma.
struct Sums {
    /// (q - q_fem) q_sigma.
    gradient: f64,
    /// q_sigma^2 + (q - q_fem) q_second.
    curvature: f64,
    /// q_sigma^2.
    square: f64,
    /// q_sigma q_dot.
    along: f64,
}

impl<'a> Track<'a> {
    /// From the last place.
    ///
    /// # Errors
    /// The coordinates are not smooth along the curve.
    pub fn new(reduced: &'a Reduced, rigid: &State) -> Result<Self, ModelError> {
        let table = reduced.coordinates().map_err(|at| ModelError::Table {
            name: "solver.method".into(),
            position: reduced.curve().describe(at.sigma, rigid.revolutions),
        })?;
        Ok(Self { table, sigma: rigid.sigma, sigma_dot: rigid.sigma_dot, revolutions: rigid.revolutions })
    }

    /// The place for a state that is `h` [s] after the last.
    ///
    /// # Errors
    /// The state has left the stretch that was traced.
    pub fn follow(
        &mut self,
        reduced: &Reduced,
        fem: &RigidFem,
        state: &rigid_fem::State,
        h: f64,
    ) -> Result<(), ModelError> {
        self.sigma += self.sigma_dot * h;
        for _ in 0..CORRECTIONS {
            self.wrap(reduced)?;
            let sums = self.sums(reduced, fem, state);
            let curvature = if sums.curvature > 0.0 { sums.curvature } else { sums.square };
            self.sigma -= sums.gradient / curvature;
            self.sigma_dot = sums.along / sums.square;
        }
        self.wrap(reduced)
    }

    /// Sigma, sigma_dot and whole revolutions of the place reached.
    pub fn place(&self) -> (f64, f64, f64) {
        (self.sigma, self.sigma_dot, self.revolutions)
    }

    fn sums(&self, reduced: &Reduced, fem: &RigidFem, state: &rigid_fem::State) -> Sums {
        let spot = self.table.position(self.sigma);
        let mut sums = Sums { gradient: 0.0, curvature: 0.0, square: 0.0, along: 0.0 };
        for (place, body) in reduced.linkage().bodies.iter().enumerate() {
            let Some(turn) = body.angle_coordinate else { continue };
            let q = self.table.value(spot, 3 * turn) + self.revolutions * reduced.growth(turn);
            let (q_sigma, q_second) = (self.table.value(spot, 3 * turn + 1), self.table.value(spot, 3 * turn + 2));
            let miss = q - (fem.angle(state, place) - body.offset);
            sums.gradient += miss * q_sigma;
            sums.curvature += q_sigma * q_sigma + miss * q_second;
            sums.square += q_sigma * q_sigma;
            sums.along += q_sigma * fem.speed(state, place);
        }
        sums
    }

    /// On a closed curve back into the first turn.
    fn wrap(&mut self, reduced: &Reduced) -> Result<(), ModelError> {
        let (first, last) = reduced.curve().range();
        if (first..=last).contains(&self.sigma) {
            return Ok(());
        }
        match reduced.period() {
            Some(period) if self.sigma.is_finite() => {
                let around = ((self.sigma - first) / period).floor();
                self.sigma -= around * period;
                self.revolutions += around;
                Ok(())
            }
            _ => Err(ModelError::Travel { position: reduced.curve().describe(self.sigma, self.revolutions) }),
        }
    }
}
