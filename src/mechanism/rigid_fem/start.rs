//! The start: a state in which the rods do not vibrate.
//!
//! In: coordinates and speeds of the rigid linkage, sizes of the loads. Out: a state. It must not know time steps.
use super::element::{Span, difference};
use super::error::RigidFemError;
use super::mesh::Present;
use super::model::{RigidFem, State};
use crate::mechanism::linkage::Linkage;
use crate::numerics::plane::Vec2;
use crate::numerics::pseudo_inverse::pseudo_inverse;
use nalgebra::{DMatrix, DVector};

/// Correction of positions at which the iterations end, relative to the linkage's size: some ten units of rounding.
const CONVERGED: f64 = 2e-15;
/// Largest number of iterations. Each reduces the error by a factor of the rods' strain, so a few suffice.
const ITERATIONS: usize = 30;
/// Singular values below this part of the largest are due to redundant rods.
const RANK: f64 = 1e-11;
/// An eigenvalue of the mass matrix below this part of the largest is rounding.
const MASSLESS: f64 = 1e-12;

impl RigidFem {
    /// State of the rigid linkage at its coordinates `q` [rad] and speeds `q_dot` [rad/s], without strain and
    /// acceleration.
    pub fn unstretched(&self, linkage: &Linkage, q: &[f64], q_dot: &[f64]) -> State {
        let p = linkage.positions(q);
        let rates = linkage.rates(&p, q, q_dot);
        let points = &self.mesh.points[..self.mesh.moving];
        let angles = self.mesh.axis.iter().zip(&p.angle[1..]).map(|(axis, angle)| axis + angle).collect();
        State {
            positions: points.iter().map(|&point| p.point(point)).collect(),
            velocities: points.iter().map(|&point| p.velocity(&rates, point)).collect(),
            accelerations: vec![Vec2::zeros(); points.len()],
            angles,
        }
    }

    /// The start for coordinates `q` [rad] and speeds `q_dot` [rad/s] of the rigid linkage, under loads of these sizes.
    ///
    /// Without initial strain (M a = Q - c) the rods would vibrate about their static strain with an amplitude equal to
    /// it, undamped by Newmark's method: the joints' forces would oscillate between zero and twice those of rigid
    /// links. On the landing gear the joints' forces then differ from those of rigid links by 58 % of the largest
    /// during the first 10 ms; with the start below, by 0.005 %.
    ///
    /// The rods start with their static strain and constant lengths: l_dot = l_ddot = 0. Positions x, velocities v,
    /// accelerations a and rods' forces N follow from
    ///
    /// ```text
    /// M a + G^T N = Q - c,    G a = -l omega^2,    l - L = N L / (E A),    G v = 0,    G = dl/dx
    /// ```
    ///
    /// with x and v nearest to the rigid linkage's in the kinetic metric: M (x - x_rigid) and M (v - v_rigid) are
    /// combinations of the rows of G, so the mechanism's own degree of freedom is unchanged. The remaining vibration is
    /// due to the rate of change of N. With redundant rods, N has the least strain energy.
    ///
    /// # Errors
    /// A node can move without moving any mass; the iterations for the strain do not converge.
    pub fn start(&self, linkage: &Linkage, q: &[f64], q_dot: &[f64], sizes: &[f64]) -> Result<State, RigidFemError> {
        let rigid = self.unstretched(linkage, q, q_dot);
        let mut state = rigid.clone();
        self.check_masses(&System::new(self, &state).mass)?;
        let limit = CONVERGED * self.size;
        let mut correction = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let system = System::new(self, &state);
            let n = self.mesh.unknowns();
            // Velocities at constant lengths.
            let speeds = flat(&rigid.velocities);
            let (change, _) = system.solve(&DVector::zeros(n), &-(&system.rows * &speeds));
            state.velocities = nodal(&(speeds + change));
            // Accelerations and forces in the rods: the residual at a = 0 is Q - c less the rods' present forces.
            let mut forces = vec![[Vec2::zeros(); 2]; self.mesh.elements.len()];
            let still = vec![Vec2::zeros(); self.mesh.moving];
            self.pin_forces(&Present { a: &still, ..state.present() }, sizes, &mut forces);
            let mut residual = vec![0.0; n];
            self.assemble(&forces, &mut residual);
            let spans = (0..self.mesh.elements.len()).map(|i| self.mesh.span(i, &state.positions));
            let spans: Vec<Span> = spans.collect();
            let turning = spans.iter().enumerate().map(|(i, span)| {
                let omega = span.speed(self.mesh.node_rates(i, &state.velocities));
                -span.length * omega * omega
            });
            let turning = DVector::from_iterator(spans.len(), turning);
            let (accelerations, extra) = system.solve(&DVector::from_vec(residual), &turning);
            state.accelerations = nodal(&accelerations);
            // Elongations for these forces.
            let stretch = self.mesh.elements.iter().zip(extra.iter()).map(|(e, n)| n * e.length / e.axial_stiffness);
            let stretch = DVector::from_iterator(spans.len(), stretch);
            let moved = flat(&state.positions) - flat(&rigid.positions);
            let (change, _) = system.solve(&-(&system.mass * moved), &stretch);
            correction = change.amax();
            if correction <= limit {
                return Ok(state);
            }
            if !correction.is_finite() {
                break;
            }
            for (x, dx) in state.positions.iter_mut().zip(nodal(&change)) {
                *x += dx;
            }
            for i in 0..spans.len() {
                state.angles[i] = self.angle_near(i, &state.positions, state.angles[i]);
            }
        }
        Err(RigidFemError::Stretch { correction, limit })
    }

    /// Check that the mass matrix is positive definite: the accelerations of a massless motion would grow with each
    /// step.
    fn check_masses(&self, mass: &DMatrix<f64>) -> Result<(), RigidFemError> {
        // No eigenvalue is negative, so singular values and vectors are those of the eigenvalues.
        let svd = mass.clone().svd(true, false);
        let (values, Some(vectors)) = (&svd.singular_values, &svd.u) else { return Ok(()) };
        if values.min() > MASSLESS * values.max() {
            return Ok(());
        }
        let node = vectors.column(values.imin()).iamax() / 2;
        let at_node = (0..self.names.len()).filter(|&i| self.mesh.nodes[i].contains(&node));
        let lightest = at_node.min_by(|&i, &k| self.mesh.elements[i].mass.total_cmp(&self.mesh.elements[k].mass));
        let i = lightest.unwrap_or_default();
        Err(RigidFemError::Massless { body: self.names[i].clone(), mass: self.mesh.elements[i].mass })
    }
}

/// The equations with the matrix [M, G^T; G, 0] at a state.
struct System {
    mass: DMatrix<f64>,
    rows: DMatrix<f64>,
    /// Scaled square roots of E A / L: weights for which the solution of least norm has the least strain energy.
    weights: DVector<f64>,
    inverse: DMatrix<f64>,
}

impl System {
    fn new(fem: &RigidFem, state: &State) -> Self {
        let (n, m) = (fem.mesh.unknowns(), fem.mesh.elements.len());
        let mut mass = DMatrix::zeros(n, n);
        let mut rows = DMatrix::zeros(m, n);
        for (i, element) in fem.mesh.elements.iter().enumerate() {
            let span = fem.mesh.span(i, &state.positions);
            let (own, slopes) = (element.mass_matrix(span.across), difference(span.along));
            for (row, first) in fem.mesh.unknowns_of(i) {
                rows[(i, row)] = slopes[first];
                for (column, second) in fem.mesh.unknowns_of(i) {
                    mass[(row, column)] += own[(first, second)];
                }
            }
        }
        let stiffness = fem.mesh.elements.iter().map(|e| (e.axial_stiffness / e.length).sqrt());
        let mut weights = DVector::from_iterator(m, stiffness);
        // Scaled to the masses, so that singular values are comparable.
        weights *= mass.amax() / weights.amax();
        let mut matrix = DMatrix::zeros(n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&mass);
        for i in 0..m {
            for k in 0..n {
                matrix[(n + i, k)] = weights[i] * rows[(i, k)];
                matrix[(k, n + i)] = matrix[(n + i, k)];
            }
        }
        let rank = RANK * matrix.amax();
        let inverse = pseudo_inverse(matrix, rank);
        Self { mass, rows, weights, inverse }
    }

    /// y and N with M y + G^T N = force and G y = stretch.
    fn solve(&self, force: &DVector<f64>, stretch: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let (n, m) = (force.len(), stretch.len());
        let mut right = DVector::zeros(n + m);
        right.rows_mut(0, n).copy_from(force);
        right.rows_mut(n, m).copy_from(&stretch.component_mul(&self.weights));
        let solution = &self.inverse * right;
        (solution.rows(0, n).into_owned(), solution.rows(n, m).component_mul(&self.weights))
    }
}

fn flat(nodes: &[Vec2]) -> DVector<f64> {
    DVector::from_iterator(2 * nodes.len(), nodes.iter().flat_map(|v| [v.x, v.y]))
}

fn nodal(components: &DVector<f64>) -> Vec<Vec2> {
    components.as_slice().chunks_exact(2).map(|c| Vec2::new(c[0], c[1])).collect()
}
