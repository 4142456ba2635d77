//! Newmark's method: one step of constant length, with equilibrium iterations at its end.
//!
//! In: a state, sizes of the loads, a step. Out: the state after it. gamma = 1/2, beta = 1/4 (average acceleration):
//!
//! ```text
//! x1 = x0 + h v0 + h^2 (a0 + a1) / 4,    v1 = v0 + h (a0 + a1) / 2
//! ```
//!
//! where a1 satisfies the equations of motion at the end of the step. The method is of second order in h. In linear
//! problems it neither damps nor amplifies vibrations, for any h. Here the rods turn, and with h longer than their
//! periods, in fast motion and after many steps, the energy of their vibrations may grow. Energy drift shows this
//! early, and a strain beyond that of a rigid link is an error. It must not know events.
use super::error::RigidFemError;
use super::lu::Lu;
use super::mesh::Present;
use super::model::{RigidFem, State};
use crate::mechanism::loads::laws::spring::Spring;
use crate::numerics::plane::Vec2;

/// Correction of positions at which the iterations end, relative to the linkage's size. The last correction leaves an
/// error smaller by the rate of convergence, about (h omega)^2.
const CONVERGED: f64 = 1e-12;
/// Largest number of corrections. The gear takes at most five at h = 2 ms.
const ITERATIONS: usize = 40;
/// Relative excess of a step over a multiple of `h_fem` that counts as rounding of the host's times.
const ROUNDING: f64 = 1e-6;
/// Largest number of substeps.
const SUBSTEPS: f64 = 1e9;
/// Largest strain |l - L| / L of a rod that represents a rigid link [1]: several times that of steel at yield.
const STRAIN: f64 = 1e-2;

/// Number of equal substeps of at most `h_fem` [s] in a step of `h` [s].
pub fn substeps(h: f64, h_fem: f64) -> f64 {
    (h / h_fem * (1.0 - ROUNDING)).ceil().max(1.0)
}

/// Scratch for a step.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// State at the end of the substep.
    next: State,
    /// State before the step, restored if a substep fails.
    backup: State,
    /// Forces at the nodes of every element [N].
    pub(super) forces: Vec<[Vec2; 2]>,
    residual: Vec<f64>,
    gradient: Vec<f64>,
    tangent: Lu,
}

impl RigidFem {
    /// Scratch for steps of this linkage.
    pub fn scratch(&self) -> Scratch {
        let (n, elements) = (self.mesh.moving, self.mesh.elements.len());
        let state = self.blank();
        Scratch {
            next: state.clone(),
            backup: state,
            forces: vec![[Vec2::zeros(); 2]; elements],
            residual: vec![0.0; 2 * n],
            gradient: vec![0.0; 2 * n],
            tangent: Lu::new(2 * n),
        }
    }

    /// Advance by `h` [s] in ceil(h / h_fem) equal steps, under loads of constant `sizes`. Returns the energy lost in
    /// dampers [J], by the trapezoidal rule. On an error the state is unchanged.
    ///
    /// # Errors
    /// A step is not finite and > 0; too many steps; no equilibrium at the end of a step; a strain of more than 1 %.
    pub fn advance(
        &self,
        state: &mut State,
        scratch: &mut Scratch,
        sizes: &[f64],
        h: f64,
        h_fem: f64,
    ) -> Result<f64, RigidFemError> {
        self.advance_watched(state, scratch, sizes, [h, h_fem], &mut |_, _| Ok(()))
    }

    /// [`Self::advance`] by `h` in steps of at most `h_fem` [s], with a call of `watch` after each of these steps: with
    /// the state and the length of the step [s].
    ///
    /// # Errors
    /// [`Self::advance`]'s; errors of `watch`.
    pub fn advance_watched<E: From<RigidFemError>>(
        &self,
        state: &mut State,
        scratch: &mut Scratch,
        sizes: &[f64],
        [h, h_fem]: [f64; 2],
        watch: &mut dyn FnMut(&State, f64) -> Result<(), E>,
    ) -> Result<f64, E> {
        for (name, value) in [("h", h), ("h_fem", h_fem)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(RigidFemError::StepSize { name, value }.into());
            }
        }
        let count = substeps(h, h_fem);
        if count > SUBSTEPS {
            return Err(RigidFemError::Substeps { count, limit: SUBSTEPS }.into());
        }
        let substep = h / count;
        scratch.backup.copy_from(state);
        let mut lost = 0.0;
        let mut power = self.lost_power(state);
        for _ in 0..count as u64 {
            let done = self.substep(state, scratch, sizes, substep).map_err(E::from);
            if let Err(error) = done.and_then(|()| watch(state, substep)) {
                state.copy_from(&scratch.backup);
                return Err(error);
            }
            let after = self.lost_power(state);
            lost += 0.5 * substep * (power + after);
            power = after;
        }
        Ok(lost)
    }

    /// Balance the accelerations with changed sizes of the loads: a + da with (M + h^2 K_e / 4) da = residual. This is
    /// Newton's law for the motion of the rigid links, and to O(h^2) for vibrations that h resolves; faster ones are
    /// not excited.
    ///
    /// # Errors
    /// `h` is not finite and > 0; the forces are not finite.
    pub fn rebalance(
        &self,
        state: &mut State,
        scratch: &mut Scratch,
        sizes: &[f64],
        h: f64,
    ) -> Result<(), RigidFemError> {
        if !(h.is_finite() && h > 0.0) {
            return Err(RigidFemError::StepSize { name: "h_fem", value: h });
        }
        scratch.backup.copy_from(state);
        self.pin_forces(&state.present(), sizes, &mut scratch.forces);
        self.assemble(&scratch.forces, &mut scratch.residual);
        self.assemble_tangent(&state.present(), h, false, &mut scratch.tangent);
        let solved = scratch.tangent.factor();
        scratch.tangent.solve(&mut scratch.residual);
        for (a, da) in state.accelerations.iter_mut().zip(scratch.residual.chunks_exact(2)) {
            *a += Vec2::new(da[0], da[1]);
        }
        if solved && state.accelerations.iter().all(|a| a.norm().is_finite()) {
            return Ok(());
        }
        state.copy_from(&scratch.backup);
        Err(RigidFemError::Equilibrium { h, correction: f64::INFINITY, limit: CONVERGED * self.size })
    }

    fn substep(&self, state: &mut State, scratch: &mut Scratch, sizes: &[f64], h: f64) -> Result<(), RigidFemError> {
        let limit = CONVERGED * self.size;
        let mut correction = f64::INFINITY;
        scratch.next.accelerations.copy_from_slice(&state.accelerations);
        for _ in 0..ITERATIONS {
            self.follow(state, &mut scratch.next, h);
            let at = scratch.next.present();
            self.pin_forces(&at, sizes, &mut scratch.forces);
            self.assemble(&scratch.forces, &mut scratch.residual);
            self.assemble_tangent(&at, h, true, &mut scratch.tangent);
            self.add_springs(&at, h, &mut scratch.forces, &mut scratch.gradient, &mut scratch.tangent);
            if !scratch.tangent.factor() {
                break;
            }
            scratch.tangent.solve(&mut scratch.residual);
            let mut largest: f64 = 0.0;
            for (a, da) in scratch.next.accelerations.iter_mut().zip(scratch.residual.chunks_exact(2)) {
                let da = Vec2::new(da[0], da[1]);
                *a += da;
                // Not max(), which would hide a NaN.
                let size = da.norm();
                largest = if size <= largest { largest } else { size };
            }
            correction = 0.25 * h * h * largest;
            if !correction.is_finite() {
                break;
            }
            if correction <= limit {
                self.follow(state, &mut scratch.next, h);
                self.check_strains(&scratch.next, h)?;
                state.copy_from(&scratch.next);
                return Ok(());
            }
        }
        Err(RigidFemError::Equilibrium { h, correction, limit })
    }

    fn check_strains(&self, state: &State, h: f64) -> Result<(), RigidFemError> {
        for (i, element) in self.mesh.elements.iter().enumerate() {
            let length = self.mesh.span(i, &state.positions).length;
            let strain = (length - element.length) / element.length;
            if strain.abs() > STRAIN {
                return Err(RigidFemError::Strain { body: self.names[i].clone(), strain, limit: STRAIN, h });
            }
        }
        Ok(())
    }

    /// Positions, velocities and angles at the end of a step for the accelerations at its end.
    fn follow(&self, from: &State, to: &mut State, h: f64) {
        for (i, &a1) in to.accelerations.iter().enumerate() {
            let (x0, v0, a0) = (from.positions[i], from.velocities[i], from.accelerations[i]);
            to.positions[i] = x0 + h * (v0 + 0.25 * h * (a0 + a1));
            to.velocities[i] = v0 + 0.5 * h * (a0 + a1);
        }
        for (i, before) in from.angles.iter().enumerate() {
            to.angles[i] = self.angle_near(i, &to.positions, *before);
        }
    }

    /// M + h^2 K / 4 with the rods' tangent stiffness K, or with its material part only.
    fn assemble_tangent(&self, at: &Present, h: f64, geometric: bool, tangent: &mut Lu) {
        tangent.clear();
        let part = 0.25 * h * h;
        for (i, element) in self.mesh.elements.iter().enumerate() {
            let span = self.mesh.span(i, at.x);
            let k = if geometric { element.stiffness_matrix(&span) } else { element.material_matrix(&span) };
            let k = part * k + element.mass_matrix(span.across);
            for (row, first) in self.mesh.unknowns_of(i) {
                for (column, second) in self.mesh.unknowns_of(i) {
                    tangent.add(row, column, k[(first, second)]);
                }
            }
        }
    }

    /// Add springs and dampers to the tangent: (h^2 k / 4 + h c / 2) g g^T with g = dS/dx and k = dF/dS, for
    /// convergence with a stiff spring.
    fn add_springs(&self, at: &Present, h: f64, forces: &mut [[Vec2; 2]], g: &mut [f64], tangent: &mut Lu) {
        for spring in &self.springs {
            let load = &self.loads[spring.load];
            let s_dot = if spring.damper.is_some() { load.displacement(&self.mesh, at, 1) } else { 0.0 };
            let part = spring.force_change([load.displacement(&self.mesh, at, 0), s_dot], [0.25 * h * h, 0.5 * h]);
            if part == 0.0 {
                continue;
            }
            forces.fill([Vec2::zeros(); 2]);
            self.loads[spring.load].push(&self.mesh, at, 1.0, forces);
            self.assemble(forces, g);
            for (row, first) in g.iter().enumerate().filter(|(_, first)| **first != 0.0) {
                for (column, second) in g.iter().enumerate() {
                    tangent.add(row, column, part * first * second);
                }
            }
        }
    }

    /// Power lost in dampers [W].
    fn lost_power(&self, state: &State) -> f64 {
        let power = |s: &Spring| s.lost_power(self.loads[s.load].displacement(&self.mesh, &state.present(), 1));
        self.springs.iter().filter(|s| s.is_damped()).map(power).sum()
    }
}
