//! The loop equations: what the joints outside the tree demand.
//!
//! A revolute joint gives two rows, the gap between its points [m]; a prismatic one gives one, the gap normal to its
//! axis (its bodies already turn together).
use super::{Freedom, Linkage, Positions, Rates, Vec2, quarter};
use nalgebra::DMatrix;

impl Linkage {
    /// Number of loop equations.
    pub fn rows(&self) -> usize {
        self.cuts.iter().map(|&j| if self.joints[j].freedom == Freedom::Turn { 2 } else { 1 }).sum()
    }

    /// The joint behind each loop equation.
    pub fn row_joints(&self) -> Vec<usize> {
        let twice = |&j: &usize| vec![j; if self.joints[j].freedom == Freedom::Turn { 2 } else { 1 }];
        self.cuts.iter().flat_map(twice).collect()
    }

    /// Residuals [m].
    pub fn gaps(&self, p: &Positions) -> Vec<f64> {
        let mut out = Vec::with_capacity(2 * self.cuts.len());
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let gap = p.point(joint.second) - p.point(joint.first);
            match joint.freedom {
                Freedom::Turn => out.extend([gap.x, gap.y]),
                Freedom::Slide(e) => out.push(quarter(p.vector(joint.first.body, e)).dot(&gap)),
            }
        }
        out
    }

    /// First derivatives of the residuals, given the rates.
    pub fn gap_rates(&self, p: &Positions, r: &Rates) -> Vec<f64> {
        let mut out = Vec::with_capacity(2 * self.cuts.len());
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let rate = p.velocity(r, joint.second) - p.velocity(r, joint.first);
            match joint.freedom {
                Freedom::Turn => out.extend([rate.x, rate.y]),
                Freedom::Slide(e) => {
                    let axis = p.vector(joint.first.body, e);
                    let gap = p.point(joint.second) - p.point(joint.first);
                    out.push(quarter(axis).dot(&rate) - r.angle[joint.first.body] * axis.dot(&gap));
                }
            }
        }
        out
    }

    /// Second derivatives of the residuals, given the rates and second rates.
    pub fn gap_second_rates(&self, p: &Positions, r: &Rates, a: &Rates) -> Vec<f64> {
        let mut out = Vec::with_capacity(2 * self.cuts.len());
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let second = p.acceleration(r, a, joint.second) - p.acceleration(r, a, joint.first);
            match joint.freedom {
                Freedom::Turn => out.extend([second.x, second.y]),
                Freedom::Slide(e) => {
                    let axis: Vec2 = p.vector(joint.first.body, e);
                    let gap = p.point(joint.second) - p.point(joint.first);
                    let rate = p.velocity(r, joint.second) - p.velocity(r, joint.first);
                    let (omega, alpha) = (r.angle[joint.first.body], a.angle[joint.first.body]);
                    let normal = quarter(axis);
                    out.push(
                        normal.dot(&second)
                            - 2.0 * omega * axis.dot(&rate)
                            - alpha * axis.dot(&gap)
                            - omega * omega * normal.dot(&gap),
                    );
                }
            }
        }
        out
    }

    /// Jacobian of the residuals, rows by coordinates.
    pub fn jacobian(&self, p: &Positions, q: &[f64]) -> DMatrix<f64> {
        let n = q.len();
        let mut out = DMatrix::zeros(self.rows(), n);
        let mut unit = vec![0.0; n];
        for column in 0..n {
            unit[column] = 1.0;
            let rates = self.rates(p, q, &unit);
            for (row, value) in self.gap_rates(p, &rates).into_iter().enumerate() {
                out[(row, column)] = value;
            }
            unit[column] = 0.0;
        }
        out
    }
}
