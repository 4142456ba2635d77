//! Outputs of a state: angles, forces in joints, energies. None allocates.
use super::element::Span;
use super::mesh::TablePosition;
use super::{RigidFem, State, Workspace};
use crate::mechanism::linkage::{Point, Vec2};
use crate::mechanism::reactions::Reaction;

impl RigidFem {
    /// Angle of a body's x axis [rad], counted on over whole turns; `body` is its place in
    /// [`crate::mechanism::linkage::Linkage::bodies`], 0 for the ground.
    pub fn angle(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| state.angles[i] - self.mesh.axis[i])
    }

    /// Angular speed of a body [rad/s].
    pub fn speed(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1).map_or(0.0, |i| {
            Span::new(self.mesh.place(i, &state.positions)).speed(self.mesh.rate(i, &state.velocities))
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
        match self.mesh.spot(point) {
            TablePosition::Fixed(position) => [position, Vec2::zeros(), Vec2::zeros()],
            TablePosition::Moving { element, place } => {
                let ends = self.mesh.ends(element, &state.positions, &state.velocities, &state.accelerations);
                [ends.x, ends.v, ends.a].map(|s| place.interpolate(s))
            }
        }
    }

    /// Displacement S of a load and its rate S_dot; `load` is its place in [`crate::mechanism::loads::resolved::Loading::loads`].
    pub fn displacement(&self, state: &State, load: usize) -> [f64; 2] {
        let (load, at) = (&self.loads[load], state.present());
        [load.displacement(&self.mesh, &at), load.rate(&self.mesh, &at)]
    }

    /// Second derivative of a load's displacement, from the state's accelerations.
    pub fn displacement_acceleration(&self, state: &State, load: usize) -> f64 {
        self.loads[load].acceleration(&self.mesh, &state.present(), &state.accelerations)
    }

    /// What the first-named body of each joint exerts on the second, under loads of these sizes, which must be those that
    /// the state's accelerations are in balance with: Newton's and Euler's equations of the elements, whose two nodal forces
    /// are their inertia and their rod's force less the loads on them. `out` has one place for each joint of the linkage.
    pub fn reactions(&self, state: &State, room: &mut Workspace, sizes: &[f64], out: &mut [Reaction]) {
        self.reactions_after(state, state, room, sizes, 0.0, out);
    }

    /// [`Self::reactions`] of a state that [`RigidFem::rebalance`] with the step `h` [s] made of `before`. The rods' forces
    /// have not followed yet; their part K_e h^2 / 4 of the change of accelerations, with which the sizes are in balance,
    /// stands for what they will take up.
    pub fn reactions_after(
        &self,
        before: &State,
        state: &State,
        room: &mut Workspace,
        sizes: &[f64],
        h: f64,
        out: &mut [Reaction],
    ) {
        let forces = room.forces_mut();
        self.pin_forces(&state.present(), &state.accelerations, sizes, forces);
        for (i, (element, force)) in self.mesh.elements.iter().zip(&mut *forces).enumerate() {
            let span = Span::new(self.mesh.place(i, &state.positions));
            let [now, then] = [state, before].map(|s| self.mesh.rate(i, &s.accelerations));
            let apart = span.along.dot(&((now[1] - then[1]) - (now[0] - then[0])));
            let pull = 0.25 * h * h * element.axial_stiffness / element.length * apart * span.along;
            *force = [force[0] - pull, force[1] + pull];
        }
        for (reaction, shares) in out.iter_mut().zip(&self.mesh.joints) {
            *reaction = Reaction::default();
            for share in shares {
                reaction.force += share.weight * forces[share.element][share.end];
            }
        }
    }

    /// Force in the rod of a body [N], > 0 if it pulls.
    pub fn axial_force(&self, state: &State, body: usize) -> f64 {
        body.checked_sub(1)
            .map_or(0.0, |i| self.mesh.elements[i].axial_force(&Span::new(self.mesh.place(i, &state.positions))))
    }

    /// Kinetic energy v^T M v / 2 [J].
    pub fn kinetic(&self, state: &State) -> f64 {
        let ends = |i| self.mesh.ends(i, &state.positions, &state.velocities, &state.accelerations);
        self.mesh.elements.iter().enumerate().map(|(i, e)| e.kinetic(&ends(i))).sum()
    }

    /// Energy of the stretched rods [J].
    pub fn strain(&self, state: &State) -> f64 {
        let span = |i| Span::new(self.mesh.place(i, &state.positions));
        self.mesh.elements.iter().enumerate().map(|(i, e)| e.strain(&span(i))).sum()
    }

    /// Potential of all loads of these sizes: less the sum of size times displacement, and the springs' energy [J].
    pub fn load_potential(&self, state: &State, sizes: &[f64]) -> f64 {
        let at = state.present();
        let sized: f64 = self.loads.iter().zip(sizes).map(|(l, size)| size * l.displacement(&self.mesh, &at)).sum();
        let springs = self.springs.iter().map(|s| s.energy(self.loads[s.load].displacement(&self.mesh, &at)));
        springs.sum::<f64>() - sized
    }

    /// Kinetic energy, strain energy and the loads' potential [J]: constant at constant sizes, but for what dampers take and
    /// for the error of the steps.
    pub fn energy(&self, state: &State, sizes: &[f64]) -> f64 {
        self.kinetic(state) + self.strain(state) + self.load_potential(state, sizes)
    }
}
