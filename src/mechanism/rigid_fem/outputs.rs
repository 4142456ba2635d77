//! Outputs of a state, without allocation.
//!
//! In: a state, sizes of the loads. Out: angles, positions, forces in joints, energies. It must not know time.
use super::element::Span;
use super::mesh::MeshPoint;
use super::model::{RigidFem, State};
use super::newmark::Scratch;
use crate::mechanism::linkage::Point;
use crate::mechanism::reactions::Reaction;
use crate::numerics::plane::Vec2;

impl RigidFem {
    /// Angle of a body's x axis [rad], with all revolutions counted; `body`: index in the linkage, 0 for the ground.
    pub fn angle(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| state.angles[i] - self.mesh.axis[i])
    }

    /// Angular speed of a body [rad/s].
    pub fn speed(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| {
            Span::new(self.mesh.node_positions(i, &state.positions)).speed(self.mesh.node_rates(i, &state.velocities))
        })
    }

    /// Angular acceleration of a body [rad/s2], from the state's accelerations.
    pub fn acceleration(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| {
            let ends = self.mesh.ends(i, &state.positions, &state.velocities, &state.accelerations);
            self.mesh.elements[i].angular_acceleration(&ends)
        })
    }

    /// Position [m], velocity [m/s] and acceleration [m/s2] of a point of a body.
    pub fn point(&self, state: &State, point: Point) -> [Vec2; 3] {
        match self.mesh.locate(point) {
            MeshPoint::Fixed(position) => [position, Vec2::zeros(), Vec2::zeros()],
            MeshPoint::Moving { element, local } => {
                let ends = self.mesh.ends(element, &state.positions, &state.velocities, &state.accelerations);
                [ends.x, ends.v, ends.a].map(|s| local.interpolate(s))
            }
        }
    }

    /// Displacement S of a load and its rate S_dot; `load`: index in the loading.
    pub fn displacement(&self, state: &State, load: usize) -> [f64; 2] {
        let (load, at) = (&self.loads[load], state.present());
        [load.displacement(&self.mesh, &at), load.rate(&self.mesh, &at)]
    }

    /// Second derivative of a load's displacement, from the state's accelerations.
    pub fn displacement_acceleration(&self, state: &State, load: usize) -> f64 {
        self.loads[load].acceleration(&self.mesh, &state.present(), &state.accelerations)
    }

    /// Reactions of all joints under loads of these sizes, with which the state's accelerations must be in balance.
    /// They follow from Newton's and Euler's equations of the elements: the forces at an element's nodes are its
    /// inertia and its rod's force less the loads on it. `out` has an entry for each joint of the linkage.
    pub fn reactions(&self, state: &State, scratch: &mut Scratch, sizes: &[f64], out: &mut [Reaction]) {
        self.reactions_after(state, state, scratch, sizes, 0.0, out);
    }

    /// [`Self::reactions`] of a state that results from `before` by [`RigidFem::rebalance`] with the step `h` [s]. The
    /// rods are still those of `before`; K_e h^2 / 4 times the change of accelerations is added for their future
    /// change.
    pub fn reactions_after(
        &self,
        before: &State,
        state: &State,
        scratch: &mut Scratch,
        sizes: &[f64],
        h: f64,
        out: &mut [Reaction],
    ) {
        let forces = scratch.forces_mut();
        self.pin_forces(&state.present(), &state.accelerations, sizes, forces);
        for (i, (element, force)) in self.mesh.elements.iter().zip(&mut *forces).enumerate() {
            let span = Span::new(self.mesh.node_positions(i, &state.positions));
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

    /// Force in the rod of a body [N], > 0 in tension.
    pub fn axial_force(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| {
            self.mesh.elements[i].axial_force(&Span::new(self.mesh.node_positions(i, &state.positions)))
        })
    }

    /// Kinetic energy v^T M v / 2 [J].
    pub fn kinetic(&self, state: &State) -> f64 {
        let ends = |i| self.mesh.ends(i, &state.positions, &state.velocities, &state.accelerations);
        self.mesh.elements.iter().enumerate().map(|(i, e)| e.kinetic(&ends(i))).sum()
    }

    /// Strain energy of the rods [J].
    pub fn strain(&self, state: &State) -> f64 {
        let span = |i| Span::new(self.mesh.node_positions(i, &state.positions));
        self.mesh.elements.iter().enumerate().map(|(i, e)| e.strain(&span(i))).sum()
    }

    /// Potential of all loads of these sizes [J]: the springs' energy less the sum of size times displacement.
    pub fn load_potential(&self, state: &State, sizes: &[f64]) -> f64 {
        let at = state.present();
        let sized: f64 = self.loads.iter().zip(sizes).map(|(l, size)| size * l.displacement(&self.mesh, &at)).sum();
        let springs = self.springs.iter().map(|s| s.energy(self.loads[s.load].displacement(&self.mesh, &at)));
        springs.sum::<f64>() - sized
    }

    /// Kinetic energy, strain energy and the loads' potential [J]: conserved at constant sizes without dampers.
    pub fn energy(&self, state: &State, sizes: &[f64]) -> f64 {
        self.kinetic(state) + self.strain(state) + self.load_potential(state, sizes)
    }
}
