//! Outputs of a state, without allocation.
//!
//! In: a state, sizes of the loads. Out: angles, positions, forces in joints, energies. It must not know time.
use super::model::{RigidFem, State};
use super::newmark::Scratch;
use crate::mechanism::linkage::Point;
use crate::mechanism::reactions::Reaction;
use crate::numerics::plane::Vec2;

impl RigidFem {
    /// Angle of a body's x axis [rad], with all revolutions counted, or its time derivative of order 1 or 2; `body`:
    /// index in the linkage, 0 for the ground.
    pub fn angle(&self, state: &State, body: usize, order: usize) -> f64 {
        self.mesh.angle(body.checked_sub(1), &state.present(), order)
    }

    /// Position of a point of a body [m], or its time derivative of order 1 or 2.
    pub fn point(&self, state: &State, point: Point, order: usize) -> Vec2 {
        self.mesh.point(self.mesh.locate(point), &state.present(), order)
    }

    /// Displacement S of a load, or its time derivative of order 1 or 2; `load`: index in the loading.
    pub fn displacement(&self, state: &State, load: usize, order: usize) -> f64 {
        self.loads[load].displacement(&self.mesh, &state.present(), order)
    }

    /// Reactions of all joints under loads of these sizes, with which the state's accelerations must be in balance.
    /// They follow from Newton's and Euler's equations of the elements: the forces at an element's nodes are its
    /// inertia and its rod's force less the loads on it. `out` has an entry for each joint of the linkage.
    ///
    /// A state that results from `before` by [`RigidFem::rebalance`] with the step `h` [s] still has the rods of
    /// `before`: K_e h^2 / 4 times the change of accelerations is added for their future change. Of any other state,
    /// `before` is the state itself.
    pub fn reactions(
        &self,
        before: &State,
        state: &State,
        scratch: &mut Scratch,
        sizes: &[f64],
        h: f64,
        out: &mut [Reaction],
    ) {
        let forces = &mut scratch.forces;
        self.pin_forces(&state.present(), sizes, forces);
        for (i, (element, force)) in self.mesh.elements.iter().zip(&mut *forces).enumerate() {
            let span = self.mesh.span(i, &state.positions);
            let [now, then] = [state, before].map(|s| self.mesh.node_rates(i, &s.accelerations));
            let apart = span.along.dot(&((now[1] - then[1]) - (now[0] - then[0])));
            let tension = 0.25 * h * h * element.axial_stiffness / element.length * apart * span.along;
            *force = [force[0] - tension, force[1] + tension];
        }
        for (reaction, shares) in out.iter_mut().zip(&self.mesh.joints) {
            *reaction = Reaction::default();
            for share in shares {
                reaction.force += share.weight * forces[share.element][share.end];
            }
        }
    }

    /// Kinetic energy v^T M v / 2 [J].
    pub fn kinetic(&self, state: &State) -> f64 {
        let at = state.present();
        self.mesh.elements.iter().enumerate().map(|(i, e)| e.kinetic(&self.mesh.ends(i, &at))).sum()
    }

    /// Kinetic energy, strain energy of the rods, and potential of all loads of these sizes [J], which is the springs'
    /// energy less the sum of size times displacement: conserved at constant sizes without dampers.
    pub fn energy(&self, state: &State, sizes: &[f64]) -> f64 {
        let elements = self.mesh.elements.iter().enumerate();
        let strain: f64 = elements.map(|(i, e)| e.strain(&self.mesh.span(i, &state.positions))).sum();
        let sized: f64 = (0..).zip(sizes).map(|(load, size)| size * self.displacement(state, load, 0)).sum();
        let springs: f64 = self.springs.iter().map(|s| s.energy(self.displacement(state, s.load, 0))).sum();
        self.kinetic(state) + strain + (springs - sized)
    }
}
