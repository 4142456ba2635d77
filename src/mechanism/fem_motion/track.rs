//! The position on the curve that fits a finite-element state best.
//!
//! In: the bodies' angles and speeds. Out: sigma, the minimum of 1/2 sum (q(sigma) - q_fem)^2 next to the last sigma,
//! and sigma_dot, the projection of the speeds: sum q_sigma q_dot / sum q_sigma^2. It must not know forces.
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::MOST_REVOLUTIONS;
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::Reduced;
use crate::mechanism::rigid_fem::{self, RigidFem};
use crate::numerics::table::Table;

/// Newton's corrections in each step: the prediction has an error of about (sigma_dot h)^2, the second correction one
/// of rounding.
const CORRECTIONS: usize = 3;

/// Follows the curve from step to step.
pub struct Track<'a> {
    /// The stretch of the curve on which it is, and the coordinates there.
    stretch: &'a Reduced,
    table: &'a Table,
    pub sigma: f64,
    pub sigma_dot: f64,
    /// Whole revolutions.
    pub revolutions: f64,
}

impl<'a> Track<'a> {
    /// Start from the last position.
    ///
    /// # Errors
    /// The coordinates are not smooth along the curve.
    pub fn new(reduced: &'a Reduced, rigid: &State) -> Result<Self, ModelError> {
        let stretch = reduced.at(rigid.sigma);
        let table = coordinates(stretch, rigid.revolutions)?;
        Ok(Self { stretch, table, sigma: rigid.sigma, sigma_dot: rigid.sigma_dot, revolutions: rigid.revolutions })
    }

    /// Move to the position of a state that is `h` [s] after the last.
    ///
    /// # Errors
    /// The state has left the traced part of the curve.
    pub fn follow(
        &mut self,
        reduced: &'a Reduced,
        fem: &RigidFem,
        state: &rigid_fem::State,
        h: f64,
    ) -> Result<(), ModelError> {
        self.sigma += self.sigma_dot * h;
        for _ in 0..CORRECTIONS {
            self.wrap(reduced)?;
            let position = self.table.position(self.sigma);
            let (mut gradient, mut curvature, mut square, mut along) = (0.0, 0.0, 0.0, 0.0);
            for (index, body) in reduced.linkage().bodies.iter().enumerate() {
                let Some(angle) = body.angle_coordinate else { continue };
                let [q, q_sigma, q_second] = [0, 1, 2].map(|order| self.table.value(position, 3 * angle + order));
                let q = q + self.revolutions * reduced.curve().growth(angle);
                let miss = q - (fem.angle(state, index, 0) - body.offset);
                gradient += miss * q_sigma;
                curvature += q_sigma * q_sigma + miss * q_second;
                square += q_sigma * q_sigma;
                along += q_sigma * fem.angle(state, index, 1);
            }
            self.sigma -= gradient / if curvature > 0.0 { curvature } else { square };
            self.sigma_dot = along / square;
        }
        self.wrap(reduced)
    }

    /// On a closed curve back into the first revolution, on an open one on to the stretch that holds sigma.
    fn wrap(&mut self, reduced: &'a Reduced) -> Result<(), ModelError> {
        let (first, last) = self.stretch.curve().range;
        if self.stretch.holds(self.sigma) || (self.sigma == last && !reduced.is_open()) {
            return Ok(());
        }
        match reduced.period() {
            Some(period) if self.sigma.is_finite() => {
                let around = ((self.sigma - first) / period).floor();
                self.sigma -= around * period;
                self.revolutions += around;
                if self.revolutions.abs() > MOST_REVOLUTIONS {
                    return Err(ModelError::Overflow { name: "the number of revolutions".into() });
                }
                Ok(())
            }
            _ => {
                self.stretch = reduced.reach(self.sigma).map_err(|end| ModelError::travel(end, self.sigma))?;
                self.table = coordinates(self.stretch, self.revolutions)?;
                Ok(())
            }
        }
    }
}

/// The coordinates on a stretch of the curve.
fn coordinates(stretch: &Reduced, revolutions: f64) -> Result<&Table, ModelError> {
    stretch.coordinates().map_err(|at| ModelError::table(stretch, "solver.method", at, revolutions))
}
